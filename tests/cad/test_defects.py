"""Checks of bone, sensor, skin, mold and joint: each fails when its feature is broken, and its value is measured."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.printing import orientations
from fingertip.cad.shapes import bone, insert, mold, parts
from fingertip.cad.verification import skin as skin_checks
from fingertip.cad.verification import verify
from fingertip.cad.verification.check import search_distance
from fingertip.cad.verification.skin import check_fitting_stretch
from fingertip.design import Design
from fingertip.design.geometry.seat import find_losses, min_skin_thickness, worst
from fingertip.design.geometry.solids import Box, cylinder, difference, union
from fingertip.design.interfaces import INTERFACES, clevis_solids
from fingertip.foundation.errors import DesignError
from tests.cad.part_checks import SOCKET, TOLERANCE, failed_checks, run_checks

DESIGN = Design()
LAYOUT = DESIGN.mold_layout
# Nearly rectangular bone, as that of the FSR 402: beside the parting plane its outline has no draft of its own.
BOXY = [
    "skin.width_mm=24.4",
    "bone.palmar_fullness=0.9924",
    "skin.semi_axis_palmar_mm=7",
    "skin.pulp_fullness=0.9345",
    "skin.min_thickness_mm=0.6",
    "printer.surface_error_mm=0",
]
TONGUE = ["hand.knuckle=fork", "bone.base_length_mm=14.9", "strength.min_shock_factor=0"]
THICK = [
    "sensor.model=custom", "custom_sensor.thickness_mm=1.2", "sensor.adhesive_thickness_mm=0.5",
    "mold.chaplet_screw=M1.6", "mold.chaplet_diameter_mm=5",
]  # fmt: skip
ADD_DRAFT, EYE, SPACE = mold.add_draft, clevis_solids.eye_profile, clevis_solids.space


@dataclass(frozen=True)
class Defect:
    """A function that returns another shape, and the checks that fail for it."""

    owner: object
    name: str
    change: Callable[..., object]
    """Called with what the function returns and with its arguments."""
    failed: set[str]
    changes: Sequence[str] = ()
    design: str = "fsr400"


def add(added: Any) -> Callable[..., object]:
    return lambda solid, *_: union(solid, added)


def cut(removed: Any) -> Callable[..., object]:
    return lambda solid, *_: difference(solid, removed)


def move(z: float, x: float, index: int = 0) -> Callable[..., object]:
    """Move one of some cones along y."""

    def change(cones: Any, *_: object) -> object:
        moved = replace(cones[index], centre=(cones[index].centre[0] + z, cones[index].centre[1] + x))
        return *cones[:index], moved, *cones[index + 1 :]

    return change


def outwards(x: float, half_size: float, gap: float) -> Callable[..., object]:
    """Move the first cone, which stands at x, so close to the side of the mold that a gap is left."""
    distance = LAYOUT.half_width - abs(x) - half_size - gap
    return move(0.0, distance if x > 0 else -distance)


def towards_a_bolt() -> Callable[..., object]:
    """Move the first key along the mold to the nearest bolt on its side, but for 0.3 mm."""
    x, z, root = LAYOUT.keys[0]
    bolt_z = min((b[1] for b in LAYOUT.bolts if b[0] * x > 0), key=lambda at: abs(at - z))
    distance = abs(bolt_z - z) - root / 2 - DESIGN.mold.bolt_diameter_mm / 2 - DESIGN.mold.key_clearance_mm - 0.3
    return move(distance if bolt_z > z else -distance, 0.0)


def change_runner(shift: float) -> Callable[..., object]:
    """Move the end of the runner at the cavity."""

    def change(found: Any, design: Design) -> object:
        sprue, runner, *others = found
        gate = min(x for _, x in runner.corners)
        corners = tuple((z, x + shift if x == gate else x) for z, x in runner.corners)
        return sprue, replace(runner, corners=corners), *others

    return change


def change_socket(**sizes: float) -> Callable[..., object]:
    return lambda shapes, design: (shapes[0], (replace(shapes[1][0], **sizes), *shapes[1][1:]))


DEFECTS = {
    "bump that matters only when misaligned": Defect(
        skin_checks, "skin_interior", add(cylinder("y", (12.0, 0.0), 0.0, 5.9, 0.8)), {"skin.min_thickness_misaligned"}
    ),
    "bump under the skin": Defect(
        skin_checks, "skin_interior", add(cylinder("y", (12.0, 0.0), 0.0, 6.4, 0.8)),
        {"skin.min_thickness", "skin.min_thickness_misaligned"},
    ),
    "channel too close to the surface": Defect(
        bone, "cable_channel", lambda tube, design: replace(tube, start_y=tube.start_y - 0.5),
        {"bone.wall.channel_to_outside"},
    ),
    "pocket without a rim": Defect(
        bone, "sensor_recess", add(Box((-5.3, -9.0, 20.0), (5.3, -4.0, 25.0))),
        {"bone.wall.sensor_to_outside", "mold.open_paths"},
    ),
    "pocket without clearance": Defect(
        bone, "sensor_recess", cut(Box((3.85, -9.0, 20.0), (4.5, 9.0, 25.0))), {"sensor.pocket_clearance"}
    ),
    "burr on the seat": Defect(
        bone, "sensor_recess", cut(Box((-0.3, -4.3, 22.0), (0.3, 0.0, 22.6))),
        {"sensor.pocket_clearance", "overlap.bone.sensor"},
    ),
    "hole in the seat": Defect(
        bone, "sensor_recess", add(cylinder("y", (21.0, 1.0), -5.0, -1.5, 0.5)), {"sensor.unsupported_area"}
    ),
    "socket too close to the outside": Defect(
        INTERFACES["socket"], "shapes", change_socket(low_radius=3.6, high_radius=3.6),
        {"bone.wall.socket_to_outside"}, SOCKET,
    ),
    "socket too close to the solder relief": Defect(
        INTERFACES["socket"], "shapes", change_socket(high=-14.5),
        {"bone.wall.socket_to_sensor", "bone.wall.channel_to_interface"}, SOCKET,
    ),
    "cross bolt too close to the channel": Defect(
        INTERFACES["post"], "shapes", lambda shapes, design: (shapes[0], (replace(*shapes[1], centre=(3.0, -19.6)),)),
        {"bone.wall.channel_to_interface"},
    ),
    "bolt too close to the cavity": Defect(
        mold, "bolt_holes", lambda holes, design: (replace(holes[0], centre=(10.0, -11.5)), *holes[1:]),
        {"mold.land.bolts_to_cavity"},
    ),
    "bolt too close to the inlet": Defect(mold, "bolt_holes", move(1.0, 0.0, index=2), {"mold.land.bolts_to_runner"}),
    "bolt too close to the outside": Defect(
        mold, "bolt_holes",
        outwards(mold.bolt_holes(DESIGN)[0].centre[1], DESIGN.mold.bolt_diameter_mm / 2, 0.05),
        {"mold.wall.bolts_to_outside"},
    ),
    "vent that does not reach the outside": Defect(
        mold, "runners", lambda found, design: (*found[:-1], replace(found[-1], high=10.0)),
        {"mold.inlet_and_vent_openings"},
    ),
    "vent that does not reach the cavity": Defect(
        mold, "runners", lambda found, design: (*found[:-1], replace(found[-1], low=10.0)),
        {"mold.hollow_bodies", "mold_dorsal.undercut"},
    ),
    "runner that ends before the cavity": Defect(mold, "runners", change_runner(3.0), {"mold.hollow_bodies"}),
    "engraving too deep": Defect(
        mold, "engraved_text",
        lambda found, design, half: tuple(replace(p, high=p.high + 3.6 * (half == "palmar")) for p in found),
        {"mold.wall.cavity_to_cutouts"},
    ),
    "key too close to the cavity": Defect(mold, "key_frustums", move(0.0, 2.5), {"mold.land.keys_to_cavity"}),
    "key too close to the outside": Defect(
        mold, "key_frustums",
        outwards(LAYOUT.keys[0][0], LAYOUT.keys[0][2] / 2 + DESIGN.mold.key_clearance_mm, 0.2),
        {"mold.wall.keys_to_outside"},
    ),
    "key too close to a bolt": Defect(mold, "key_frustums", towards_a_bolt(), {"mold.wall.keys_to_bolts"}),
    "missing key": Defect(mold, "key_frustums", lambda keys, *_: keys[:1], {"mold_dorsal.key_count"}),
    "keys without draft": Defect(
        mold, "key_frustums",
        lambda keys, design, gap=0.0: tuple(replace(key, low_radius=2.0 + gap, high_radius=2.0 + gap) for key in keys),
        {"mold_palmar.draft_clearance_gain.keys"},
    ),
    "two equal keys, placed symmetrically about the middle of the block": Defect(
        mold, "key_frustums",
        lambda keys, *_: (
            keys[0],
            replace(keys[0], centre=(LAYOUT.proximal_z + LAYOUT.distal_z - keys[0].centre[0], -keys[0].centre[1])),
        ),
        {"mold.reversed_assembly_overlap", "mold.wall.runners_to_keys", "mold_dorsal.overhang"},
    ),
    "cables that leave the bone inside the mold": Defect(
        bone, "cable_channel", lambda tube, design: replace(tube, start_z=-1.0, exit_z=-6.0),
        {"mold.cable_channel_overlap"},
    ),
    # A round groove below the parting plane, in which the palmar half would hold the casting.
    "undercut in one half only": Defect(
        mold, "cast_hollow", add(cylinder("z", (8.0, -3.0), 5.0, 15.0, 0.7)), {"mold_palmar.undercut"}
    ),
    "recess without draft": Defect(
        mold, "add_draft", lambda _, section, slope, flat=None: ADD_DRAFT(section, 1e-6, flat),
        {"mold_palmar.draft_clearance_gain.bone"}, BOXY,
    ),
    "thin lid": Defect(
        bone, "tail_space", add(Box((-1.0, 3.0, 2.0), (1.0, 6.9, 8.0))), {"lid.wall"}, design="fsr400_compact"
    ),
    "thin wall beside the trough": Defect(
        bone, "sensor_recess", add(Box((-6.7, 2.9, 2.0), (0.0, 3.3, 4.0))),
        {"bone.wall.trough_to_outside", "bone.wall.sensor_to_outside"}, design="fsr400_compact",
    ),
    "thin cheek": Defect(
        bone, "sensor_recess", add(Box((-7.0, -1.0, -5.0), (0.0, 1.0, -4.0))),
        {"bone.wall.window_to_outside", "bone.overhang"}, design="fsr400_compact",
    ),
    "groove that ends within the mold": Defect(
        bone, "cable_channel", cut(Box((-9.0, 0.0, -20.0), (9.0, 20.0, -8.0))), {"mold.cable_groove_outside"},
        design="fsr400_compact",
    ),
    "tight trough": Defect(
        bone, "sensor_body", add(Box((-1, 2.6, 1), (1, 2.9, 3))),
        {"sensor.tail_clearance", "overlap.bone.sensor"}, design="fsr400_compact",
    ),
    "eyes so large that they block the travel": Defect(
        clevis_solids, "eye_profile", lambda eye, joint, reach: clevis_solids.union(
            eye, clevis_solids.cylinder("x", (joint.axis_y, joint.axis_z), -reach, reach, joint.radius + 0.5)
        ),
        {"joint.travel_overlap"}, design="adult_finger",
    ),
    "missing stops": Defect(
        clevis_solids, "eye_profile", lambda _, joint, reach: EYE(replace(joint, travel_deg=0.0), reach),
        {"joint.stop_straight_overlap", "joint.stop_bent_overlap"}, design="adult_finger",
    ),
    "missing way of the tendon": Defect(
        clevis_solids, "tendon_way", lambda _, design, anchor, joint: (), {"joint.tendon_overlap"},
        design="adult_finger",
    ),
    "narrow joint": Defect(
        clevis_solids, "space",
        lambda _, design, joint: SPACE(design, replace(joint, half_width=joint.half_width - 0.2)),
        {"joint.clearance"}, design="adult_finger",
    ),
}  # fmt: skip


def replace_function(monkeypatch: pytest.MonkeyPatch, defect: Defect) -> None:
    original = getattr(defect.owner, defect.name)

    def changed(*arguments: object, **named: object) -> object:
        return defect.change(original(*arguments, **named), *arguments, **named)

    monkeypatch.setattr(defect.owner, defect.name, changed)


@pytest.mark.full
@pytest.mark.parametrize("name", DEFECTS)
def test_defect_is_found(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    defect = DEFECTS[name]
    replace_function(monkeypatch, defect)
    found = failed_checks(*defect.changes, name=defect.design)
    assert found == defect.failed


@pytest.mark.full
def test_collar_with_a_level_foot_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    def level(design: Design, gap_mm: float = 0.0) -> Box:
        return Box((-30.0, -30.0, -design.bone.collar_length_mm - gap_mm), (30.0, 30.0, 30.0))

    for module in (mold, insert):
        monkeypatch.setattr(module, "above_collar_foot", level)
    assert failed_checks() == {"mold_palmar.draft_clearance_gain.bone", "mold_dorsal.draft_clearance_gain.bone"}


def test_closed_air_vent_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    """With the tail's passage through the collar filled, air is trapped behind the sensor."""
    part = parts.PARTS["bone"]
    plug = Box((-4.0, -5.0, -3.0), (4.0, 1.0, 1.0))
    monkeypatch.setitem(parts.PARTS, "bone", replace(part, solid=lambda d: union(part.solid(d), plug)))
    assert failed_checks() == {"sensor.air_volumes", "overlap.bone.sensor", "sensor.pocket_clearance", "bone.overhang"}


@pytest.mark.full
@pytest.mark.parametrize("fullness", [None, 0.9721, 0.9784, 0.9815, 0.0])
def test_min_skin_thickness_agrees_with_the_design_rule(fullness: float | None) -> None:
    """The squarer edges of the bone are closer to the surface than its sides; meshes and sections agree.

    The last skin is thinnest in the middle of the dorsal side, where its thickness is stated.
    """
    changes = [
        "skin.thickness_side_mm=1.2", "skin.min_thickness_mm=0.3", "mold.fit_clearance_mm=0.02",
        "printer.surface_error_mm=0", f"bone.palmar_fullness={fullness}",
    ] if fullness else [] if fullness is None else ["skin.thickness_dorsal_mm=1"]  # fmt: skip
    expected = 1.0 if fullness == 0.0 else min_skin_thickness(Design.load(changes=changes).dimensions, 0.0)
    assert run_checks(*changes)["skin.min_thickness"].value == pytest.approx(expected, abs=0.01)


@pytest.mark.full
@pytest.mark.parametrize("changes", [[], ["bone.palmar_fullness=0.969"], ["mold.fit_clearance_mm=0.1"]], ids=str)
def test_misaligned_skin_thickness_agrees_with_the_design_rule(changes: list[str]) -> None:
    """The bone is moved on the meshes as the linear program says; the rule measures its sections."""
    losses = Design.load(changes=changes).losses
    checks = run_checks(*changes)
    expected = min(loss.left_mm for loss in losses)
    assert checks["skin.min_thickness_misaligned"].value == pytest.approx(expected, abs=0.05)
    assert checks["skin.retained_over_sensor"].value == pytest.approx(100 * worst(losses, True).retained)
    assert checks["skin.retained_elsewhere"].value == pytest.approx(100 * worst(losses, False).retained)


@pytest.mark.full
def test_a_thick_adhesive_under_the_film_on_the_ramp_passes() -> None:
    """Measured at right angles to the ramp, its gap is less than the thickness by which the slot is deeper."""
    check = run_checks(
        "sensor.adhesive_thickness_mm=0.35", "sensor.clearance_mm=0.35", "bone.rim_mm=0.4", *THICK[3:],
        "printer.surface_error_mm=0",
    )["sensor.pocket_clearance"]  # fmt: skip
    assert check.value == pytest.approx(0.35 / math.hypot(1.0, 0.4), abs=1e-3)
    assert check.passed


def test_loose_bone_leaves_too_thin_a_skin_and_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """A play of 0.4 mm on every side moves the bone further than the rules allow."""
    design, evaluator = Design(), MeshEvaluator(TOLERANCE)
    monkeypatch.setitem(vars(design), "losses", find_losses(design, design.dimensions, 0.4))
    checks = skin_checks.check_skin(design, evaluator, evaluator.mesh(insert.skin(design)))
    assert "skin.retained_elsewhere" in {check.name for check in checks if not check.passed}
    tight, loose = (find_losses(DESIGN, DESIGN.dimensions, clearance) for clearance in (0.05, 0.3))
    assert worst(loose, True).retained < worst(tight, True).retained + 1e-9
    assert worst(loose, False).retained < 0.8 < worst(tight, False).retained
    with pytest.raises(DesignError, match=r"0\.3 mm lets the bone lie off until .* are needed; at most 0\.\d+ mm"):
        Design.load(changes=["mold.fit_clearance_mm=0.3", "bone.collar_inset_mm=0.9"])


@pytest.mark.full
def test_parts_larger_than_the_build_volume_fail(monkeypatch: pytest.MonkeyPatch) -> None:
    """The bone is 62 mm high. The halves lie on a face of 42.4 x 50.1 mm and may be rotated by 90 degrees."""
    halves = {"mold_palmar.build_volume_excess", "mold_dorsal.build_volume_excess"}
    assert failed_checks("printer.bed_z_mm=50") == {"bone.build_volume_excess"}
    assert failed_checks("printer.bed_x_mm=40") == halves
    assert failed_checks("printer.bed_x_mm=43", "printer.bed_y_mm=51") == set()
    assert failed_checks("printer.bed_x_mm=51", "printer.bed_y_mm=43") == set()
    upright = orientations.Orientation(0.0, "its end", needs_supports=False)
    original = orientations.print_orientations
    monkeypatch.setattr(verify, "print_orientations", lambda design: original(design) | {"mold_palmar": upright})
    assert failed_checks("printer.bed_x_mm=40") == {"mold_dorsal.build_volume_excess"}


def test_skin_that_must_stretch_too_far_fails() -> None:
    """A skin may stretch by a fifth of the silicone's elongation at break while it is pulled over the bone."""
    own = "silicone.product=own silicone.elongation_percent={}".format
    check = check_fitting_stretch(Design.load("first_finger"), MeshEvaluator(TOLERANCE))
    assert 5 < check.value < 50
    for elongation, passes in ((5.02 * check.value, True), (4.98 * check.value, False)):
        design = Design.load("first_finger", changes=own(elongation).split())
        assert check_fitting_stretch(design, MeshEvaluator(TOLERANCE)).passed == passes


def test_search_for_a_distance_that_does_not_exist_ends() -> None:
    assert 500.0 <= search_distance(lambda reach_mm: reach_mm, 1.6) <= 1000.0
    for first_mm in (1.6, 0.0, -0.4):  # a limit less a coarse tolerance may be negative; the search then never ended
        assert search_distance(lambda reach_mm: min(reach_mm, 7.25), first_mm) == 7.25
