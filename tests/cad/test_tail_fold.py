"""Folded tail: its course against the length of the film, the parts around it, and checks that see a fault."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes import bone
from fingertip.cad.shapes.insert import filled_bone
from fingertip.cad.shapes.parts import PARTS
from fingertip.design import Design
from fingertip.design.geometry.features import SLIDING_MM, SensorTail, fold_tail
from fingertip.tasks.build import build
from tests.conftest import design_file

COMPACT = design_file("fsr400_compact")


def compact(*changes: str) -> Design:
    return Design.load(COMPACT, changes=changes)


@pytest.mark.parametrize("radius", [2.5, 3.0])
def test_course_has_the_length_of_the_film(radius: float) -> None:
    """Straight to the nose, half round it at the middle of the film's thickness, straight to the end."""
    fold = fold_tail(-2.2, 15.0, 2.0, radius, SensorTail(34.19, 0.3, 4.3, 3.54, 0.6, 0.5))
    length = (15.0 - fold.nose_z) + math.pi * (radius + 0.15) + (fold.film_end_z - fold.nose_z)
    assert length == pytest.approx(34.19)
    assert fold.tabs_end_z == pytest.approx(fold.film_end_z + 4.3)
    assert fold.floor_y == pytest.approx(-2.2 + 2 * radius, abs=0.11)


@pytest.mark.full
@pytest.mark.parametrize(
    "changes",
    [
        [],
        ["mold.method=sleeve"],
        ["bone.interface=flange", "bone.base_length_mm=14"],
        ["bone.interface=socket", "bone.base_length_mm=18.5"],
        ["sensor.fold_radius_mm=2.6", "sensor.tab_length_mm=0", "sensor.crimp_height_mm=0.4"],
    ],
)
def test_both_kernels_pass_all_checks(changes: list[str], tmp_path: Path) -> None:
    result = build(compact(*changes), tmp_path, formats=["stl", "step"], tolerance_mm=0.02)
    assert [check.name for check in result.checks if not check.passed] == []
    names = {check.name for check in result.checks}
    assert {"bone.wall.trough_to_outside", "bone.wall.window_to_outside", "lid.wall"} <= names
    assert ("mold.cable_groove_outside" in names) == ("mold.method=sleeve" not in changes)


def test_sensor_has_the_volume_of_its_film() -> None:
    """Bent film keeps the area along its middle: the volume is that of the flat sensor with its tabs."""
    design = compact()
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


def test_lid_fills_the_trough_up_to_its_gaps() -> None:
    """Bone, lid, the space below it and the gap around it add up to the filled bone there."""
    design = compact()
    evaluator, fold = MeshEvaluator(0.01), design.dimensions.fold
    assert fold
    lid, whole = (evaluator.manifold(solid) for solid in (PARTS["lid"].solid(design), filled_bone(design)))
    half, gap = design.dimensions.sensor.tail_width_mm / 2, design.sensor.clearance_mm
    low, high = fold.nose_z, fold.trough_end_z - gap
    column = whole.trim_by_plane((1.0, 0.0, 0.0), -half).trim_by_plane((-1.0, 0.0, 0.0), -half)
    column = column.trim_by_plane((0.0, 0.0, 1.0), low).trim_by_plane((0.0, 0.0, -1.0), -high)
    above = column.trim_by_plane((0.0, 1.0, 0.0), fold.floor_y + fold.film_space_mm).volume()
    higher = 2 * fold.tabs_half_width * (high - low) * (fold.tabs_space_mm - fold.film_space_mm)
    feet = 2 * (half - fold.tabs_half_width) * (fold.film_space_mm - 0.05) * (high - fold.film_end_z - 1.5)
    assert lid.volume() == pytest.approx(above - higher + feet, rel=1e-6)
    assert (lid ^ evaluator.manifold(PARTS["bone"].solid(design))).volume() == 0.0
