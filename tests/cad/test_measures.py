"""Sabotage of what is measured (walls, gaps, vents, stretch): broken in the geometry, its check must see it."""

from __future__ import annotations

from dataclasses import replace

import pytest

from fingertip.cad import bone, measures, mold, parts
from fingertip.cad.core import inside_skin
from fingertip.cad.mesh import Evaluator
from fingertip.cad.solids import Box, Cone, ElbowTube, cylinder, union
from fingertip.design import Design
from fingertip.design.cover import least_cover

TOLERANCE = 0.02
SOCKET = ["bone.interface=socket", "bone.base_length_mm=32"]
SLEEVE = ["mold.method=sleeve"]


def measured(*changes: str) -> dict[str, measures.Check]:
    design, evaluator = Design.load(changes=changes), Evaluator(TOLERANCE)
    meshes = {name: evaluator.mesh(part.describe(design)) for name, part in parts.parts_of(design).items()}
    return {check.name: check for check in measures.of_parts(design, evaluator, meshes)}


def failures(*changes: str) -> set[str]:
    return {name for name, check in measured(*changes).items() if not check.passed}


@pytest.mark.parametrize("changes", [[], SOCKET, SLEEVE, ["sensor.model=fsr400_short"]], ids=str)
def test_nothing_fails_untouched(changes: list[str]) -> None:
    assert failures(*changes) == set()


def test_the_thinnest_skin_is_found_where_it_is() -> None:
    """1.5 mm on the back, less what the taper takes: nowhere else is this skin thinner."""
    assert measured()["skin.thinnest"].value == pytest.approx(1.5, abs=0.01)


@pytest.mark.parametrize("weight", [2.0, 2.3, 2.5])
def test_the_thinnest_skin_is_as_thin_as_the_rule_says(weight: float) -> None:
    """The bone's squarer edges come nearer than its sides; solids and sections find the same."""
    changes = ["skin.thickness_side_mm=1.2", "skin.least_thickness_mm=0.45", f"bone.squareness_palmar={weight}"]
    expected = least_cover(Design.load(changes=changes).dimensions, 0.0)
    assert measured(*changes)["skin.thinnest"].value == pytest.approx(expected, abs=0.01)


def test_a_bump_under_the_skin(monkeypatch: pytest.MonkeyPatch) -> None:
    bump = cylinder("y", (12.0, 0.0), 0.0, 6.4, 0.8)
    monkeypatch.setattr(measures, "inside_skin", lambda design: union(inside_skin(design), bump))
    assert failures() == {"skin.thinnest"}


def test_a_channel_too_near_the_surface(monkeypatch: pytest.MonkeyPatch) -> None:
    original = bone.cable_channel

    def sunk(design: Design) -> ElbowTube:
        tube = original(design)
        assert isinstance(tube, ElbowTube)
        return replace(tube, start_y=tube.start_y - 0.5)

    monkeypatch.setattr(bone, "cable_channel", sunk)
    assert failures() == {"bone.wall.channel_to_outside"}


def test_a_tie_hole_in_the_way_of_the_channel(monkeypatch: pytest.MonkeyPatch) -> None:
    original = bone.tie_hole

    def nearer(design: Design) -> Cone:
        hole = original(design)
        assert isinstance(hole, Cone)
        return replace(hole, centre=(hole.centre[0] - 1.5, hole.centre[1] + 1.2))

    monkeypatch.setattr(bone, "tie_hole", nearer)
    assert failures() == {"bone.wall.channel_to_tie_hole"}


def test_a_pocket_that_leaves_no_rim(monkeypatch: pytest.MonkeyPatch) -> None:
    original = bone.sensor_recess
    wide = Box((-5.3, -9.0, 20.0), (5.3, -2.3, 25.0))
    monkeypatch.setattr(bone, "sensor_recess", lambda design: union(original(design), wide))
    assert "bone.wall.beside_sensor" in failures()


def test_a_socket_through_the_side(monkeypatch: pytest.MonkeyPatch) -> None:
    original = bone.interface

    def wider(design: Design) -> object:
        plus, (socket, *rest) = original(design)
        assert isinstance(socket, Cone)
        return plus, (replace(socket, low_radius=3.6, high_radius=3.6), *rest)

    monkeypatch.setattr(bone, "interface", wider)
    assert failures(*SOCKET) == {"bone.wall.socket_to_outside"}


def test_a_cross_bolt_in_the_way_of_the_channel(monkeypatch: pytest.MonkeyPatch) -> None:
    original = bone.interface

    def higher(design: Design) -> object:
        plus, (hole,) = original(design)
        assert isinstance(hole, Cone)
        return plus, (replace(hole, centre=(3.0, -20.0)),)

    monkeypatch.setattr(bone, "interface", higher)
    assert "bone.wall.channel_to_interface" in failures()


def test_a_tie_hole_into_the_relief(monkeypatch: pytest.MonkeyPatch) -> None:
    original = bone.tie_hole

    def lower(design: Design) -> Cone:
        hole = original(design)
        assert isinstance(hole, Cone)
        return replace(hole, centre=(1.8, -11.0))

    monkeypatch.setattr(bone, "tie_hole", lower)
    assert failures() == {"bone.wall.sensor_to_tie_hole"}


def test_a_socket_into_the_relief(monkeypatch: pytest.MonkeyPatch) -> None:
    original = bone.interface

    def deeper(design: Design) -> object:
        plus, (socket, *rest) = original(design)
        assert isinstance(socket, Cone)
        return plus, (replace(socket, high=-14.5), *rest)

    monkeypatch.setattr(bone, "interface", deeper)
    assert "bone.wall.socket_to_sensor" in failures(*SOCKET)


def test_a_bolt_at_the_cavitys_edge(monkeypatch: pytest.MonkeyPatch) -> None:
    original = mold.bolts

    def inwards(design: Design, m: object) -> tuple[object, ...]:
        first, *others = original(design, m)  # type: ignore[arg-type]
        assert isinstance(first, Cone)
        return replace(first, centre=(10.0, -11.5)), *others

    monkeypatch.setattr(mold, "bolts", inwards)
    assert failures() == {"mold.land.bolts_to_cavity"}


def test_a_vent_that_is_shut(monkeypatch: pytest.MonkeyPatch) -> None:
    """The tail's passage through the collar is filled: air stays behind the sensor."""
    part = parts.PARTS["bone"]
    plug = Box((-4.0, -5.0, -3.0), (4.0, 1.0, 1.0))
    monkeypatch.setitem(parts.PARTS, "bone", replace(part, describe=lambda d: union(part.describe(d), plug)))
    assert failures() == {"sensor.vent_open_to_outside"}


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


def test_parts_larger_than_the_printer() -> None:
    assert failures("printer.bed_x_mm=40", "printer.bed_y_mm=60", "printer.bed_z_mm=50") == {
        "bone.past_the_printer",
    }


def test_a_sleeve_that_must_stretch_too_far() -> None:
    stretch = measured(*SLEEVE)["skin.stretch_to_strip"].value
    assert 5 < stretch < 50
    assert failures(*SLEEVE, f"mold.most_stretch_percent={stretch - 1}") == {"skin.stretch_to_strip"}
