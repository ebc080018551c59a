"""Each check of the mold fails when the feature it verifies is broken: inlet, vents, walls, fit, draft, keys."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from fingertip.cad.shapes import bone, insert, mold
from fingertip.cad.shapes import mold as runners
from fingertip.cad.verification import mold as verification
from fingertip.cad.verification.check import search_distance
from fingertip.design import Design
from fingertip.design.geometry.solids import Box, Cone, ElbowTube, Prism, Solid, cylinder, scaled, union
from fingertip.foundation.errors import DesignError
from tests.cad.part_checks import SLEEVE, TOLERANCE, failed_checks, run_checks

Solids = tuple[Solid, ...]

# Nearly rectangular bone, as that of the FSR 402: beside the parting plane its outline has no draft of its own.
BOXY = [
    "skin.width_mm=24.4",
    "bone.palmar_fullness=0.9924",
    "skin.semi_axis_palmar_mm=7",
    "skin.pulp_fullness=0.9345",
    "skin.min_thickness_mm=0.6",
]


def move_one(original: Callable[..., Solids], z: float, x: float, index: int = 0) -> Callable[..., Solids]:
    """Wrap a function that returns cones along y, so that one of them is moved along z and x."""

    def changed(*arguments: object) -> Solids:
        solids = list(original(*arguments))
        cone = solids[index]
        assert isinstance(cone, Cone)
        solids[index] = replace(cone, centre=(cone.centre[0] + z, cone.centre[1] + x))
        return tuple(solids)

    return changed


@pytest.mark.full
def test_bolt_too_close_to_the_cavity_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    original = mold.bolt_holes

    def inwards(design: Design) -> Solids:
        first, *others = original(design)
        assert isinstance(first, Cone)
        return replace(first, centre=(10.0, -11.5)), *others

    monkeypatch.setattr(mold, "bolt_holes", inwards)
    assert failed_checks() == {"mold.land.bolts_to_cavity"}


@pytest.mark.full
def test_vent_that_does_not_reach_the_outside_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    original = mold.runners

    def short(design: Design) -> Solids:
        *others, last = original(design)
        assert isinstance(last, Cone)
        return (*others, replace(last, high=10.0))

    monkeypatch.setattr(mold, "runners", short)
    assert failed_checks() == {"mold.inlet_and_vent_openings"}


@pytest.mark.full
def test_vent_that_does_not_reach_the_cavity_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    original = mold.runners

    def high(design: Design) -> Solids:
        *others, last = original(design)
        assert isinstance(last, Cone)
        return (*others, replace(last, low=10.0))

    monkeypatch.setattr(mold, "runners", high)
    assert failed_checks() == {"mold.hollow_bodies", "mold_dorsal.undercut"}


@pytest.mark.full
def test_runner_that_ends_before_the_cavity_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    original = mold.runners

    def short(design: Design) -> Solids:
        sprue, runner, *others = original(design)
        assert isinstance(runner, Prism)
        gate = min(x for _, x in runner.corners)
        corners = tuple((z, x + 3.0 if x == gate else x) for z, x in runner.corners)
        return (sprue, replace(runner, corners=corners), *others)

    monkeypatch.setattr(mold, "runners", short)
    assert failed_checks() == {"mold.hollow_bodies"}


@pytest.mark.full
def test_inlet_too_close_to_a_bolt_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mold, "bolt_holes", move_one(mold.bolt_holes, 1.0, 0.0, index=2))
    assert failed_checks() == {"mold.land.bolts_to_runner"}


@pytest.mark.full
def test_funnel_through_the_outer_face_fails_and_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    wide = ["mold.filling=gravity", "skin.width_mm=34", "mold.fit_clearance_mm=0.05"]
    with pytest.raises(DesignError, match=r"goes through the outside of the mold; at most 18\.42 mm"):
        Design.load(changes=[*wide, "mold.funnel_diameter_mm=24"])
    original = runners.gate_and_funnel

    def wider(design: Design) -> Solids:
        gate, funnel = original(design)
        assert isinstance(funnel, Cone)
        return gate, replace(funnel, high_radius=funnel.high_radius + 14.0)

    monkeypatch.setattr(runners, "gate_and_funnel", wider)
    assert "mold.wall.runners_to_outside" in failed_checks(*wide)


@pytest.mark.full
def test_cavity_without_a_vent_at_its_apex_traps_air(monkeypatch: pytest.MonkeyPatch) -> None:
    original = mold.runners

    def moved(design: Design) -> Solids:
        gate, funnel, apex, second = original(design)
        assert isinstance(apex, Cone)
        return gate, funnel, replace(apex, centre=(2.4, 0.0)), second

    monkeypatch.setattr(verification, "runners", moved)
    assert failed_checks("mold.filling=gravity", "silicone.product=sylgard_184") == {
        "mold.air_trap_height",
        "mold.leak_length",
    }


@pytest.mark.full
def test_wall_and_land_of_the_cavity_are_measured() -> None:
    thin = run_checks("mold.wall_mm=1.2", "mold.engraving_depth_mm=0")
    assert thin["mold.wall.cavity_to_outside"].value == pytest.approx(1.2, abs=0.01)
    assert run_checks()["mold.land.keys_to_cavity"].value > 3.0


@pytest.mark.full
def test_walls_much_thicker_than_the_limit_are_measured() -> None:
    """The default wall of the mold is 4 mm, five times the minimum wall."""
    design, checks = Design(), run_checks()
    assert checks["mold.wall.cavity_to_outside"].value == pytest.approx(4.0, abs=TOLERANCE)
    assert checks["mold.wall.keys_to_bolts"].value > 4.0
    # The frustums of the keys are widest inside the dorsal half, at half its height.
    layout = design.mold_layout
    widening = design.dimensions.draft_slope * layout.dorsal_height / 2 + design.mold.key_clearance_mm
    side = layout.half_width - max(abs(x) + root / 2 for x, _, root in layout.keys) - widening
    assert checks["mold.wall.keys_to_outside"].value == pytest.approx(side, abs=TOLERANCE)


def test_search_for_a_distance_that_does_not_exist_ends() -> None:
    assert 500.0 <= search_distance(lambda reach_mm: reach_mm, 1.6) <= 1000.0
    for first_mm in (1.6, 0.0, -0.4):  # a limit less a coarse tolerance may be negative; the search then never ended
        assert search_distance(lambda reach_mm: min(reach_mm, 7.25), first_mm) == 7.25


@pytest.mark.full
def test_engraving_too_deep_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    original = mold.engraved_text

    def deep(design: Design, half: str) -> Solids:
        extra_depth = 3.6 if half == "palmar" else 0.0
        prisms = original(design, half)
        assert all(isinstance(prism, Prism) for prism in prisms)
        return tuple(replace(p, high=p.high + extra_depth) for p in prisms if isinstance(p, Prism))

    monkeypatch.setattr(mold, "engraved_text", deep)
    assert failed_checks() == {"mold.wall.cavity_to_cutouts"}


@pytest.mark.full
def test_key_too_close_to_the_cavity_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mold, "key_frustums", move_one(mold.key_frustums, 0.0, 2.5))
    assert "mold.land.keys_to_cavity" in failed_checks()


@pytest.mark.full
def test_cables_that_leave_the_bone_inside_the_mold_fail(monkeypatch: pytest.MonkeyPatch) -> None:
    """The cables are in place during overmolding. The core of a sleeve has none."""
    original = bone.cable_channel

    def nearer(design: Design) -> ElbowTube:
        tube = original(design)
        assert isinstance(tube, ElbowTube)
        return replace(tube, start_z=-1.0, exit_z=-6.0)

    monkeypatch.setattr(bone, "cable_channel", nearer)
    assert "mold.cable_channel_overlap" in failed_checks()
    assert "mold.cable_channel_overlap" not in failed_checks(*SLEEVE)


@pytest.mark.full
def test_undercut_fails_in_its_own_half_only(monkeypatch: pytest.MonkeyPatch) -> None:
    """A round groove below the parting plane, in which the palmar half would hold the casting."""
    original = mold.cast_hollow
    groove = cylinder("z", (8.0, -3.0), 5.0, 15.0, 0.7)
    monkeypatch.setattr(mold, "cast_hollow", lambda design: union(original(design), groove))
    assert "mold_palmar.undercut" in failed_checks()
    assert "mold_dorsal.undercut" not in failed_checks()


@pytest.mark.full
def test_core_whose_base_is_enlarged_for_shrinkage_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    """Only silicone shrinks: the base in the recess must keep the fit clearance."""
    shrinking = [*SLEEVE, "mold.silicone_shrinkage_percent=1.2"]
    assert failed_checks(*shrinking) == set()
    monkeypatch.setattr(insert, "sleeve_core", lambda d: scaled(insert.filled_bone(d, 0.15), d.dimensions.shrinkage))
    assert failed_checks(*shrinking) == {"mold_palmar.recess_clearance", "mold_dorsal.recess_clearance"}


@pytest.mark.full
def test_clearance_in_the_recess_is_the_fit_clearance() -> None:
    for changes in ([], [*SLEEVE, "mold.silicone_shrinkage_percent=5"]):
        checks = run_checks("mold.fit_clearance_mm=0.2", *changes)
        for half in ("mold_palmar", "mold_dorsal"):
            assert checks[f"{half}.recess_clearance"].value == pytest.approx(0.2, abs=TOLERANCE)


@pytest.mark.full
def test_recess_without_draft_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    original = mold.add_draft
    monkeypatch.setattr(mold, "add_draft", lambda section, slope, flat=None: original(section, 1e-6, flat))
    assert failed_checks(*BOXY) == {"mold_palmar.draft_clearance_gain.bone"}


@pytest.mark.full
def test_collar_with_a_level_foot_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    def level(design: Design, gap_mm: float = 0.0) -> Solid:
        return Box((-30.0, -30.0, -design.bone.collar_length_mm - gap_mm), (30.0, 30.0, 30.0))

    for module in (mold, insert):
        monkeypatch.setattr(module, "above_collar_foot", level)
    assert failed_checks() == {"mold_palmar.draft_clearance_gain.bone", "mold_dorsal.draft_clearance_gain.bone"}


@pytest.mark.full
def test_keys_without_draft_fail(monkeypatch: pytest.MonkeyPatch) -> None:
    original = mold.key_frustums

    def straight(design: Design, clearance_mm: float) -> Solids:
        radius = 2.0 + clearance_mm
        cones = (key for key in original(design, clearance_mm) if isinstance(key, Cone))
        return tuple(replace(key, low_radius=radius, high_radius=radius) for key in cones)

    monkeypatch.setattr(mold, "key_frustums", straight)
    assert failed_checks() == {"mold_palmar.draft_clearance_gain.keys"}


@pytest.mark.full
@pytest.mark.parametrize("changes", [[], SLEEVE], ids=str)
def test_default_design_has_two_keys_and_closes_in_one_way_only(changes: list[str]) -> None:
    checks = run_checks(*changes)
    assert checks["mold_dorsal.key_count"].value == 2
    assert checks["mold.reversed_assembly_overlap"].value > 20.0
    assert checks["mold.wall.bolts_to_outside"].value > 2.0


@pytest.mark.full
def test_bolt_too_close_to_the_outside_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    design = Design()
    bolt = mold.bolt_holes(design)[0]
    assert isinstance(bolt, Cone)
    distance = design.mold_layout.half_width - abs(bolt.centre[1]) - design.mold.bolt_diameter_mm / 2 - 0.05
    monkeypatch.setattr(
        mold, "bolt_holes", move_one(mold.bolt_holes, 0.0, distance if bolt.centre[1] > 0 else -distance)
    )
    assert failed_checks() == {"mold.wall.bolts_to_outside"}


@pytest.mark.full
def test_key_too_close_to_the_outside_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    design = Design()
    x, _, root = design.mold_layout.keys[0]
    distance = design.mold_layout.half_width - abs(x) - root / 2 - design.mold.key_clearance_mm - 0.2
    monkeypatch.setattr(mold, "key_frustums", move_one(mold.key_frustums, 0.0, distance if x > 0 else -distance))
    assert failed_checks() == {"mold.wall.keys_to_outside"}


@pytest.mark.full
def test_key_too_close_to_a_bolt_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    design = Design()
    x, z, root = design.mold_layout.keys[0]
    bolt_z = min((b[1] for b in design.mold_layout.bolts if b[0] * x > 0), key=lambda at: abs(at - z))
    distance = abs(bolt_z - z) - root / 2 - design.mold.bolt_diameter_mm / 2 - design.mold.key_clearance_mm - 0.3
    monkeypatch.setattr(mold, "key_frustums", move_one(mold.key_frustums, distance if bolt_z > z else -distance, 0.0))
    assert "mold.wall.keys_to_bolts" in failed_checks()


@pytest.mark.full
def test_missing_key_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    original = mold.key_frustums
    monkeypatch.setattr(mold, "key_frustums", lambda *arguments: original(*arguments)[:1])
    assert failed_checks() == {"mold_dorsal.key_count"}


@pytest.mark.full
def test_keys_that_fit_in_reverse_fail(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two equal keys, placed symmetrically about the middle of the block."""
    original = mold.key_frustums

    def symmetric(design: Design, clearance_mm: float) -> Solids:
        m, first = design.mold_layout, original(design, clearance_mm)[0]
        assert isinstance(first, Cone)
        z, x = first.centre
        return first, replace(first, centre=(m.proximal_z + m.distal_z - z, -x))

    monkeypatch.setattr(mold, "key_frustums", symmetric)
    assert "mold.reversed_assembly_overlap" in failed_checks()
