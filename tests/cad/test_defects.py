"""Checks of bone, sensor, skin and joint: each fails when its
feature is broken, and its value is measured.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.verification import skin as skin_checks
from fingertip.cad.verification.bone import check_bone, check_laid_in
from fingertip.cad.verification.check import Solids, search_distance
from fingertip.cad.verification.printing import part_genus
from fingertip.design import Design
from fingertip.design.geometry.skin_thickness import min_skin_thickness
from fingertip.models import bone as finger
from fingertip.models import clevis as clevis_models
from fingertip.models import interfaces, parts, sensor_pocket
from fingertip.models.solids import Box, cylinder
from fingertip.pad.survey import GRASP_DEG, WIDE_DEG, survey_pad
from tests.cad.part_checks import SOCKET, TOLERANCE, failed_checks, run_checks

EYE = clevis_models.eye_profile
SPACE = clevis_models.space
UNLIMITED = [*SOCKET, "strength.min_grip_factor=0", "strength.min_knock_factor=0"]


@dataclass(frozen=True)
class Defect:
    """A function that returns another shape, and the checks that fail for it."""

    owner: Any
    """Module, or a mapping of functions."""
    name: str
    change: Callable[..., object]
    """Called with what the function returns and with its arguments."""
    failed: set[str]
    changes: Sequence[str] = ()
    design: str = "fsr400"


def add(added: Any) -> Callable[..., object]:
    return lambda solid, *_: solid.union(added)


def cut(removed: Any) -> Callable[..., object]:
    return lambda solid, *_: solid.cut(removed)


def change_socket(**sizes: float) -> Callable[..., object]:
    return lambda shapes, design: (shapes[0], (replace(shapes[1][0], **sizes), *shapes[1][1:]))


DEFECTS = {
    "bump under the skin": Defect(
        skin_checks,
        "skin_interior",
        add(cylinder("y", (12.0, 0.0), 0.0, 7.2, 0.8)),
        {"skin.min_thickness"},
    ),
    "channel too close to the surface": Defect(
        finger,
        "cable_channel",
        lambda tube, design: replace(tube, start_z=tube.start_z - 0.5, exit_z=tube.exit_z - 0.5),
        {"bone.wall.channel_to_outside"},
    ),
    "pocket without a rim": Defect(
        sensor_pocket,
        "sensor_recess",
        add(Box((-5.3, -9.0, 20.0), (5.3, -4.0, 25.0))),
        {"bone.wall.sensor_to_outside"},
    ),
    "pocket without clearance": Defect(
        sensor_pocket,
        "sensor_recess",
        cut(Box((3.85, -9.0, 20.0), (4.5, 9.0, 25.0))),
        {"sensor.pocket_clearance", "sensor.room_overlap"},
    ),
    "burr on the seat": Defect(
        sensor_pocket,
        "sensor_recess",
        cut(Box((-0.3, -4.3, 22.0), (0.3, 0.0, 22.6))),
        {"sensor.pocket_clearance", "overlap.bone.sensor", "sensor.room_overlap"},
    ),
    "hole in the seat": Defect(
        sensor_pocket,
        "sensor_recess",
        add(cylinder("y", (21.0, 1.0), -5.0, -1.5, 0.5)),
        {"sensor.unsupported_area"},
    ),
    "socket too close to the outside": Defect(
        interfaces.SHAPES,
        "socket",
        change_socket(low_radius=5.0, high_radius=5.0),
        {"bone.wall.socket_to_outside"},
        UNLIMITED,
    ),
    "socket too close to sensor and channel": Defect(
        interfaces.SHAPES,
        "socket",
        change_socket(high=-6.0, low_radius=3.4, high_radius=3.4),
        {"bone.wall.socket_to_sensor", "bone.wall.channel_to_interface"},
        UNLIMITED,
    ),
    "cross bolt too close to the channel": Defect(
        interfaces.SHAPES,
        "post",
        lambda shapes, design: (shapes[0], (replace(*shapes[1], centre=(0.0, -19.6)),)),
        {"bone.wall.channel_to_interface", "stand.bolt_overlap"},
    ),
    "eyes so large that they block the travel": Defect(
        clevis_models,
        "eye_profile",
        lambda eye, joint, reach: eye.union(
            clevis_models.cylinder(
                "x", (joint.axis_y, joint.axis_z), -reach, reach, joint.radius + 0.5
            ),
        ),
        {"joint.travel_overlap", "hand_stub.travel_overlap"},
        design="adult_finger",
    ),
    "missing stops": Defect(
        clevis_models,
        "eye_profile",
        lambda _, joint, reach: EYE(replace(joint, travel_deg=0.0), reach),
        {"joint.stop_straight_overlap", "joint.stop_bent_overlap"},
        design="adult_finger",
    ),
    "missing way of the tendon": Defect(
        clevis_models,
        "tendon_way",
        lambda _, design, anchor, joint: (),
        {"joint.tendon_overlap"},
        design="adult_finger",
    ),
    "narrow joint": Defect(
        clevis_models,
        "space",
        lambda _, design, joint: SPACE(design, replace(joint, half_width=joint.half_width - 0.2)),
        {"joint.clearance", "hand_stub.clearance"},
        design="adult_finger",
    ),
}


@pytest.mark.full
@pytest.mark.parametrize("name", DEFECTS)
def test_defect_is_found(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    defect = DEFECTS[name]
    functions = defect.owner if isinstance(defect.owner, dict) else vars(defect.owner)
    original = functions[defect.name]

    def changed(*arguments: object, **named: object) -> object:
        return defect.change(original(*arguments, **named), *arguments, **named)

    monkeypatch.setitem(functions, defect.name, changed)
    assert failed_checks(*defect.changes, name=defect.design) == defect.failed


@pytest.mark.full
def test_closed_air_vent_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    """With the tail's passage through the collar filled, air is trapped behind the sensor."""
    part = parts.PARTS["bone"]
    plug = Box((-4.0, -5.0, -3.0), (4.0, 1.0, 1.0))
    monkeypatch.setitem(
        parts.PARTS, "bone", replace(part, solid=lambda d: part.solid(d).union(plug))
    )
    assert failed_checks() == {
        "sensor.air_volumes",
        "overlap.bone.sensor",
        "sensor.pocket_clearance",
        "bone.overhang",
        "sensor.room_overlap",
    }


@pytest.mark.full
@pytest.mark.parametrize("fullness", [None, 0.9721, 0.9784, 0.9815, 0.0])
def test_min_skin_thickness_agrees_with_the_design_rule(fullness: float | None) -> None:
    """The squarer edges of the bone are closer to the surface than its sides; meshes and sections
    agree.

    The first skin is thinnest beside the end of the bone's flat, the last one in the middle of the
    dorsal side.
    """
    if fullness:
        changes = [
            "skin.thickness_side_mm=1.2",
            "skin.min_thickness_mm=0.3",
            "mold.core_inset_mm=0",
            "bone.post_width_mm=10",
            f"bone.palmar_fullness={fullness}",
        ]
    elif fullness is None:
        changes = ["skin.crown_radius_mm=9"]
    else:
        changes = ["skin.thickness_dorsal_mm=1"]
    design = Design.load(changes=changes)
    expected = 1.0 if fullness == 0.0 else min_skin_thickness(design, design.dimensions)
    assert run_checks(*changes)["skin.min_thickness"].value == pytest.approx(expected, abs=0.01)


@pytest.mark.full
def test_parts_larger_than_the_build_volume_fail(monkeypatch: pytest.MonkeyPatch) -> None:
    """The bone is 66 mm high.

    The plate of the core, of 41 x 37.3 mm, may be rotated by 90 degrees.
    """
    assert failed_checks("printer.bed_z_mm=50") == {"bone.build_volume_excess"}
    assert failed_checks("printer.bed_x_mm=36") == {"core.build_volume_excess"}
    assert failed_checks("printer.bed_x_mm=38", "printer.bed_y_mm=42") == set()
    assert failed_checks("printer.bed_x_mm=42", "printer.bed_y_mm=38") == set()


def test_skin_that_must_stretch_too_far_fails() -> None:
    """A skin may stretch by a fifth of the silicone's elongation at
    break while it is pulled over the bone.
    """
    own = "silicone.product=own silicone.elongation_percent={}".format
    check = skin_checks.check_fitting_stretch(Design.load("first_finger"), MeshEvaluator(TOLERANCE))
    assert 5 < check.value < 50
    for elongation, passes in ((5.02 * check.value, True), (4.98 * check.value, False)):
        design = Design.load("first_finger", changes=own(elongation).split())
        assert skin_checks.check_fitting_stretch(design, MeshEvaluator(TOLERANCE)).passed == passes


def test_search_for_a_distance_that_does_not_exist_ends() -> None:
    assert 500.0 <= search_distance(lambda reach_mm: reach_mm, 1.6) <= 1000.0
    # A limit less a coarse tolerance may be negative; the search then never ended.
    for first_mm in (
        1.6,
        0.0,
        -0.4,
    ):
        assert search_distance(lambda reach_mm: min(reach_mm, 7.25), first_mm) == 7.25


STANDARD = ["sensor.model=fsr400", "bone.base_length_mm=27", "strength.grip_force_n=14"]
"""Words of the heading of `first_finger`."""
OPEN_TROUGHS = {
    "no room for the tabs of the longest tail": (
        cut(Box((-9.0, -20.0, -20.0), (9.0, 20.0, -6.5))),
        {"sensor.room_overlap"},
    ),
    "closed slot of the film's height behind the tail": (
        cut(
            Box(
                (-9.0, -20.0, -20.0),
                (9.0, 20.0, Design.load("first_finger").dimensions.tail_end_z - 0.2),
            )
        ),
        {"sensor.room_overlap", "sensor.vent_open"},
    ),
    "trough without walls": (
        add(Box((-9.0, -9.0, -5.0), (9.0, -2.0, -4.0))),
        {"bone.wall.sensor_to_outside"},
    ),
}


def find_failed(design: Design) -> set[str]:
    solids = Solids.of(design, MeshEvaluator(0.02), ("bone", "skin"))
    return {
        check.name
        for check in (*check_bone(design, solids), *check_laid_in(design, solids))
        if not check.passed
    }


@pytest.mark.every_case
@pytest.mark.parametrize("name", OPEN_TROUGHS)
def test_defect_of_an_open_trough_is_found(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    change, failed = OPEN_TROUGHS[name]
    original = sensor_pocket.sensor_recess
    monkeypatch.setattr(sensor_pocket, "sensor_recess", lambda design: change(original(design)))
    assert find_failed(Design.load("first_finger")) == failed


@pytest.mark.parametrize(
    ("name", "changes"),
    [
        ("first_finger", STANDARD),
        ("fsr402", ("sensor.model=fsr402", "bone.base_length_mm=37")),
    ],
)
def test_longer_sensors_are_laid_in(name: str, changes: tuple[str, ...]) -> None:
    """Those of the bundled designs are, as tests/cad/test_approved.py and test_clevis.py find."""
    design = Design.load(name, changes=changes)
    part = parts.PARTS["bone"]
    assert find_failed(design) == set()
    assert MeshEvaluator(0.05).manifold(part.solid(design)).genus() == part_genus(design, "bone")


def test_the_first_finger_reaches_what_is_wanted() -> None:
    design = Design.load("first_finger")
    loose = survey_pad(design, is_loose=True)
    assert skin_checks.check_rest_force(design).value < 0.5 * skin_checks.MAX_REST_N
    assert loose.dead_zone_n(*GRASP_DEG) <= 0.30
    assert loose.dead_zone_n(*WIDE_DEG) <= 0.40
    assert loose.least_share(*GRASP_DEG) >= 0.60
    assert loose.least_share(*WIDE_DEG) >= 0.52
    told = skin_checks.describe_lying_skin(design)
    assert told["pull_off_n"] < told["pull_off_glued_n"]
    assert told["loose"]["tilts"][0]["share"] == pytest.approx(loose.shares[0], abs=1e-4)


def test_bump_that_presses_on_the_sensor_at_rest_fails() -> None:
    assert not skin_checks.check_rest_force(
        Design.load("first_finger", changes=["skin.bump_radius_mm=2.54"])
    ).passed


def test_hold_and_slide_are_those_of_the_study() -> None:
    """Its rib of 0.8 mm, of 1.2 MPa, held 13 N at a friction of 0.3;
    a bead some 20 N more; it slid by 0.16 mm.
    """
    design = Design.load(
        "first_finger", changes=["silicone.product=own", "silicone.modulus_mpa=1.2"]
    )
    assert skin_checks.pull_off_n(design) == pytest.approx(13.0, rel=0.15)
    assert skin_checks.pull_off_n(design, is_glued=True) - skin_checks.pull_off_n(
        design
    ) == pytest.approx(20.0, rel=0.05)
    assert skin_checks.slide_mm(design) == pytest.approx(0.16, abs=0.04)
    tight = Design.load("first_finger", changes=["mold.core_inset_mm=0.1"])
    assert (
        0.3
        < skin_checks.pull_off_n(tight) - skin_checks.pull_off_n(Design.load("first_finger"))
        < 2.0
    )
