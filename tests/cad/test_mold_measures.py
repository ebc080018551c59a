"""Sabotage of what is measured in the mold: gate, vents, land, walls, draft."""

from __future__ import annotations

from dataclasses import replace

import pytest

from fingertip.cad.shapes import bone, core, mold
from fingertip.cad.solids import Box, Cone, ElbowTube, Solid, cylinder, scaled, union
from fingertip.design import Design
from tests.cad.measured import SLEEVE, TOLERANCE, failures, measured

BOXY = [
    "skin.width_mm=24.4",
    "bone.squareness_palmar=4",
    "skin.semi_axis_palmar_mm=7",
    "skin.squareness_palmar=1.2",
    "skin.min_thickness_mm=0.6",
]


def test_a_bolt_at_the_cavitys_edge(monkeypatch: pytest.MonkeyPatch) -> None:
    original = mold.bolts

    def inwards(design: Design, m: object) -> tuple[object, ...]:
        first, *others = original(design, m)  # type: ignore[arg-type]
        assert isinstance(first, Cone)
        return replace(first, centre=(20.0, -11.5)), *others

    monkeypatch.setattr(mold, "bolts", inwards)
    assert failures() == {"mold.land.bolts_to_cavity"}


def test_a_vent_that_does_not_reach(monkeypatch: pytest.MonkeyPatch) -> None:
    original = mold.runners

    def short(design: Design, m: object) -> tuple[object, ...]:
        *others, last = original(design, m)  # type: ignore[arg-type]
        assert isinstance(last, Cone)
        return (*others, replace(last, high=36.0))

    monkeypatch.setattr(mold, "runners", short)
    assert failures() == {"mold.gate_and_vents_reach_outside"}


def test_a_vent_that_misses_the_cavity(monkeypatch: pytest.MonkeyPatch) -> None:
    original = mold.runners

    def high(design: Design, m: object) -> tuple[object, ...]:
        *others, last = original(design, m)  # type: ignore[arg-type]
        assert isinstance(last, Cone)
        return (*others, replace(last, low=36.0))

    monkeypatch.setattr(mold, "runners", high)
    assert failures() == {"mold.hollows_connected"}


def test_an_apex_without_a_vent(monkeypatch: pytest.MonkeyPatch) -> None:
    original = mold.runners

    def moved(design: Design, m: object) -> tuple[object, ...]:
        gate, funnel, apex, second = original(design, m)  # type: ignore[arg-type]
        assert isinstance(apex, Cone)
        return gate, funnel, replace(apex, centre=(2.4, 0.0)), second

    monkeypatch.setattr(mold, "runners", moved)
    assert failures() == {"mold.unvented_height"}


def test_nut_traps_into_the_cavity_and_keys_beside_it() -> None:
    assert measured("mold.wall_mm=1.2", "mold.engraving_depth_mm=0")["mold.wall.cavity_to_outside"].value == (
        pytest.approx(1.2, abs=0.01)
    )
    assert measured()["mold.land.keys_to_cavity"].value > 3.0


def test_an_engraving_too_deep(monkeypatch: pytest.MonkeyPatch) -> None:
    original = mold.engraving

    def deep(design: Design, m: object, half: str) -> tuple[object, ...]:
        deeper = 3.6 if half == "palmar" else 0.0
        return tuple(replace(p, high=p.high + deeper) for p in original(design, m, half))  # type: ignore[arg-type, union-attr, type-var]

    monkeypatch.setattr(mold, "engraving", deep)
    assert failures() == {"mold.wall.cavity_to_cuts"}


def test_a_key_at_the_cavitys_edge(monkeypatch: pytest.MonkeyPatch) -> None:
    original = mold.keys

    def inwards(design: Design, m: object, gap_mm: float = 0.0) -> tuple[object, ...]:
        first, second = original(design, m, gap_mm)  # type: ignore[arg-type]
        assert isinstance(first, Cone)
        return replace(first, centre=(first.centre[0], first.centre[1] + 2.5)), second

    monkeypatch.setattr(mold, "keys", inwards)
    assert "mold.land.keys_to_cavity" in failures()


def test_cables_that_come_out_into_the_mold(monkeypatch: pytest.MonkeyPatch) -> None:
    """Overmolding closes the mold with the cables in place; a sleeve's core has none."""
    original = bone.cable_channel

    def nearer(design: Design) -> ElbowTube:
        tube = original(design)
        assert isinstance(tube, ElbowTube)
        return replace(tube, start_z=-1.0, exit_z=-6.0)

    monkeypatch.setattr(bone, "cable_channel", nearer)
    assert "mold.across_the_cables" in failures()
    assert "mold.across_the_cables" not in failures(*SLEEVE)


def test_a_hollow_that_looks_back(monkeypatch: pytest.MonkeyPatch) -> None:
    """A ball-ended groove below the parting plane: the palmar half would hold what flows into it."""
    original = mold.openings
    groove = cylinder("z", (8.0, -3.0), 5.0, 15.0, 0.7)
    monkeypatch.setattr(mold, "openings", lambda design: union(original(design), groove))
    assert "mold_palmar.undercut" in failures()
    assert "mold_dorsal.undercut" not in failures()


def test_a_core_whose_base_is_scaled_too(monkeypatch: pytest.MonkeyPatch) -> None:
    """Shrinkage is the silicone's: what lies in the recess must keep the fit's clearance."""
    shrinking = [*SLEEVE, "mold.silicone_shrinkage_percent=1.2"]
    assert failures(*shrinking) == set()
    monkeypatch.setattr(core, "dummy_core", lambda d: scaled(core.core(d, 0.15), d.dimensions.shrinkage))
    assert failures(*shrinking) == {"mold_palmar.gap_in_recess", "mold_dorsal.gap_in_recess"}


def test_the_gap_in_the_recess_is_the_fits() -> None:
    for changes in ([], [*SLEEVE, "mold.silicone_shrinkage_percent=5"]):
        found = measured("mold.fit_clearance_mm=0.2", *changes)
        for half in ("mold_palmar", "mold_dorsal"):
            assert found[f"{half}.gap_in_recess"].value == pytest.approx(0.2, abs=TOLERANCE)


def test_a_recess_without_draft(monkeypatch: pytest.MonkeyPatch) -> None:
    """The FSR 402's bone is nearly a box: without walls of its own its recess stands upright beside it."""
    original = mold.drafted
    monkeypatch.setattr(mold, "drafted", lambda section, slope, flat=None: original(section, 1e-6, flat))
    assert failures(*BOXY) == {"mold_palmar.leaves_the_bone"}


def test_a_collar_whose_foot_is_flat(monkeypatch: pytest.MonkeyPatch) -> None:
    def flat(design: Design, gap_mm: float = 0.0) -> Solid:
        return Box((-30.0, -30.0, -design.bone.collar_length_mm - gap_mm), (30.0, 30.0, 30.0))

    for module in (mold, core):
        monkeypatch.setattr(module, "above_foot", flat)
    assert failures() == {"mold_palmar.leaves_the_bone", "mold_dorsal.leaves_the_bone"}


def test_keys_without_draft(monkeypatch: pytest.MonkeyPatch) -> None:
    original = mold.keys

    def straight(design: Design, m: object, gap_mm: float = 0.0) -> tuple[Cone, ...]:
        found = original(design, m, gap_mm)  # type: ignore[arg-type]
        return tuple(replace(k, low_radius=2.0 + gap_mm, high_radius=2.0 + gap_mm) for k in found)  # type: ignore[type-var]

    monkeypatch.setattr(mold, "keys", straight)
    assert failures() == {"mold_palmar.leaves_the_keys"}
