"""Clevis and folded tail: presets pass every check, the joint moves as stated, and the film has its length."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes import bone
from fingertip.cad.verification import assembly as joint_checks
from fingertip.cad.verification.strength import assess_strength
from fingertip.design import Design
from fingertip.design.formulas.stress import pin_peak
from fingertip.design.geometry.features import SLIDING_MM, Joint, fold_tail
from fingertip.design.interfaces import clevis, interface_of
from fingertip.design.new_design import PRESETS
from fingertip.design.parameters.finger import Sensor
from fingertip.tasks.build import build
from tests.cad.part_checks import run_all_checks
from tests.conftest import design_file


def load(name: str, *changes: str) -> Design:
    return Design.load(design_file(name), changes=changes)


@pytest.mark.full
@pytest.mark.parametrize("name", PRESETS)
def test_preset_passes_all_mesh_checks_with_its_safety_factors(name: str) -> None:
    design = load(name)
    checks = run_all_checks(design)
    dims, line, joint = design.dimensions, design.hand.tendon_diameter_mm, design.dimensions.joint
    assert {check.name for check in checks.values() if not check.passed} == set()
    assert (design.strength.min_grip_factor, design.strength.min_shock_factor) == (2.0, 1.2)
    assert (design.strength.grip_force_n, design.strength.shock_force_n) == (20.0, 60.0) or name != "adult_finger"
    assert checks["bone.safety_factor.grip"].value >= 2.0
    assert checks["bone.safety_factor.shock"].value >= 1.2
    # The tendon has room between its anchor and the film.
    fold, anchor = dims.fold, dims.anchor
    film = fold.radius + dims.sensor.thickness_mm
    assert math.hypot(anchor.y - fold.nose_y, anchor.z - fold.nose_z) - film - anchor.radius >= line + 0.299
    # The eyes are a clearance smaller than the space that the hand states, apart from the stops.
    assert joint.eye_radius == pytest.approx(design.hand.clearance_radius_mm - design.bone.joint_clearance_mm)
    assert interface_of(design).genus(design) == 4


@pytest.mark.parametrize("travel_deg", [20.0, 60.0, 90.0, 110.0])
def test_profile_between_the_stops_never_meets_the_shoulder(travel_deg: float) -> None:
    """Every corner stays on the near side of the shoulder, in the frame of the bone, at all angles of the travel."""
    joint = Joint(0.0, 0.0, 1.0, 4.0, 0.3, True, 3.0, travel_deg, 0.0)
    corners = [point for point in joint.stopped_profile(20.0) if math.hypot(*point) > 0.0]
    for i in range(101):
        angle = math.radians(travel_deg * i / 100)
        assert max(-y * math.sin(angle) - z * math.cos(angle) for y, z in corners) <= 4.0 + 1e-9
    for angle in (0.0, math.radians(travel_deg)):
        reached = max(-y * math.sin(angle) - z * math.cos(angle) for y, z in corners)
        assert reached == pytest.approx(4.0)


def test_forces_of_the_joint_follow_from_its_levers() -> None:
    """36.2 mm of lever about the pin against 5.04 mm of the tendon, and two thirds of the stop, beside the gap."""
    design = load("adult_finger")
    assert clevis.tendon_force_per_n(design, 25.0) == pytest.approx(36.2 / 5.04)
    stresses = {found.place: found for found in interface_of(design).local_stresses(design, 25.0)}
    section, joint = design.dimensions.collar.section, design.dimensions.joint
    assert joint
    pull = 36.2 / (2 / 3 * (section.dorsal_height_at(3.55) - joint.axis_y)) + 1.0
    cheek = section.half_width_at(joint.axis_y + 1.0) - joint.half_width
    assert stresses["end of the eye"].stress_per_n == pytest.approx(math.sqrt(3) * pull / (4 * cheek * (3.7 - 1.0)))
    assert not stresses["hole of the anchor"].at_shock
    force, anchor = 36.2 / 5.04, design.dimensions.anchor
    assert anchor
    assert stresses["bearing of the pin"].stress_per_n == pytest.approx((force + 1.0) / (2 * cheek * 2.0))
    window = design.dimensions.sensor.tail_width_mm / 2 + design.sensor.clearance_mm
    length = 2 * (design.dimensions.collar.section.half_width_at(anchor.y) - window)
    assert stresses["hole of the anchor"].stress_per_n == pytest.approx(force / (2 * 1.15 * 1.72))
    assert stresses["wall at the anchor"].stress_per_n == pytest.approx(math.sqrt(3) * force / (2 * length * 0.8))
    assert assess_strength(design, MeshEvaluator(0.02)).tendon_force_n == pytest.approx(20.0 * force)
    # The pin is a beam on an elastic bed: rigid in a thin cheek, and in a thick one its end alone presses.
    assert pin_peak(0.1, 2.0, 2900.0) == pytest.approx(1.0, abs=1e-3)
    assert pin_peak(30.0, 2.0, 2900.0) == pytest.approx(30.0 * (2900.0 / (4 * 200e3 * math.pi / 4)) ** 0.25, rel=1e-3)
    at_bore = 3.65 * pin_peak(cheek, 2.0, 2900.0) * pull / (2 * cheek * 2 * (3.7 - 1.0))
    assert stresses["eye"].stress_per_n == pytest.approx(at_bore)
    assert stresses["eye"].at_shock


@pytest.mark.full
def test_step_file_holds_pin_eye_and_nose_where_they_belong(tmp_path: Path) -> None:
    """The text of bone.step, read without a geometry kernel: radii and axes of its cylinders."""
    design = load("adult_finger")
    build(design, tmp_path, parts=["bone", "skin"], formats=["step"])
    cylinders = read_cylinders((tmp_path / "bone.step").read_text())
    joint, fold = design.dimensions.joint, design.dimensions.fold
    assert joint
    assert fold
    along_x = {(round(r, 6), round(y, 6), round(z, 6)) for r, (_, y, z), axis in cylinders if abs(axis[0]) > 0.999}
    pin = (1.0, round(joint.axis_y, 6), -11.2)
    assert {pin, (3.7, *pin[1:]), (2.5, round(fold.nose_y, 6), -2.5)} <= along_x
    # The apex is the highest point that the skin's file names.
    apex = max(z for _, _, z in read_points((tmp_path / "skin.step").read_text()).values())
    assert apex - pin[2] == pytest.approx(36.2, abs=1e-6)


def test_a_mesh_so_coarse_that_nothing_is_left_of_a_wall_can_be_checked() -> None:
    """The hole of the tendon's anchor was once turned inside out, and other commands sought a distance for ever."""
    found = list(joint_checks.check_joint(load("child_thumb"), MeshEvaluator(1.0)))
    (anchor,) = (check for check in found if check.name == "bone.wall.anchor_to_outside")
    assert anchor.passed
    assert anchor.value > 0.5
    assert anchor.limit < 0.0


def read_points(step: str) -> dict[str, tuple[float, ...]]:
    """All points and directions of a STEP file, by their numbers."""
    found = re.findall(r"(#\d+) = (?:CARTESIAN_POINT|DIRECTION)\('[^']*',\(([^)]*)\)\)", re.sub(r"\s+", " ", step))
    return {name: tuple(map(float, text.split(","))) for name, text in found if text.count(",") == 2}


def read_cylinders(step: str) -> list[tuple[float, tuple[float, ...], tuple[float, ...]]]:
    """Radius, a point on the axis, and direction of every cylindrical surface of a STEP file."""
    points, step = read_points(step), re.sub(r"\s+", " ", step)
    places = dict(re.findall(r"(#\d+) = AXIS2_PLACEMENT_?3D\('[^']*',(#\d+,#\d+)", step))
    return [
        (float(radius), *(points[name] for name in places[place].split(",")))  # type: ignore[misc]
        for place, radius in re.findall(r"CYLINDRICAL_SURFACE\('[^']*',(#\d+),([\d.Ee+-]+)\)", step)
    ]


@pytest.mark.parametrize("radius", [2.5, 3.0])
def test_course_has_the_length_of_the_film(radius: float) -> None:
    """Straight to the nose, half round it at the middle of the film's thickness, straight to the end."""
    sensor = Sensor(fold_radius_mm=radius, tab_length_mm=4.3, crimp_height_mm=0.6, wire_diameter_mm=0.5)
    fold = fold_tail(sensor, 34.19, 0.3, 3.54, pocket_floor_y=-2.2, sensor_z=15.0, seal_length_mm=2.0)
    length = (15.0 - fold.nose_z) + math.pi * (radius + 0.15) + (fold.film_end_z - fold.nose_z)
    assert length == pytest.approx(34.19)
    assert fold.tabs_end_z == pytest.approx(fold.film_end_z + 4.3)
    assert fold.floor_y == pytest.approx(-2.2 + 2 * radius, abs=0.11)


@pytest.mark.full
@pytest.mark.parametrize(
    "changes",
    [
        [],
        [
            "bone.interface=flange",
            "bone.base_length_mm=16.2",
            "bone.flange_spacing_x_mm=24.5",
            "bone.flange_width_mm=30",
        ],
        ["bone.interface=socket", "bone.base_length_mm=18.7"],
        ["sensor.fold_radius_mm=2.6", "sensor.tab_length_mm=0", "sensor.crimp_height_mm=0.4"],
    ],
)
def test_both_kernels_pass_all_checks(changes: list[str], tmp_path: Path) -> None:
    result = build(load("fsr400_compact", *changes), tmp_path, formats=["stl", "step"], tolerance_mm=0.02)
    assert [check.name for check in result.checks if not check.passed] == []
    names = {check.name for check in result.checks}
    expected = {"bone.wall.trough_to_outside", "bone.wall.window_to_outside", "lid.wall", "mold.cable_groove_outside"}
    assert expected <= names


def test_sensor_has_the_volume_of_its_film() -> None:
    """Bent film keeps the area along its middle: the volume is that of the flat sensor with its tabs."""
    design = load("fsr400_compact")
    dims, sensor = design.dimensions, design.dimensions.sensor
    fold = dims.fold
    assert fold
    volume = MeshEvaluator(0.005).manifold(bone.sensor_body(design)).volume()
    head = math.pi / 8 * sensor.head_diameter_mm**2  # the far half; the tail begins at its middle
    near = math.pi / 8 * sensor.head_diameter_mm**2 - _segment(sensor.head_diameter_mm / 2, sensor.tail_width_mm / 2)
    tail = sensor.tail_width_mm * (sensor.length_mm - sensor.head_diameter_mm / 2)
    tabs = 2 * (fold.tabs_half_width - SLIDING_MM) * design.sensor.tab_length_mm
    assert volume == pytest.approx((head + near + tail + tabs) * sensor.thickness_mm, rel=0.03)


def _segment(radius: float, half: float) -> float:
    """Area of half a circle within a strip about its middle."""
    return half * math.sqrt(radius**2 - half**2) + radius**2 * math.asin(half / radius)
