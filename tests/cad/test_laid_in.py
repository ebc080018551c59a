"""Sensor that is laid into an open trough: room for what is sold, open vent, and what the bone holds."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes import finger
from fingertip.cad.shapes.parts import PARTS
from fingertip.cad.verification.bone import check_bone, check_laid_in
from fingertip.cad.verification.check import Solids
from fingertip.design import Design
from fingertip.design.geometry.solids import Box, difference, union

DESIGN = Design.load("first_finger")
DIMS = DESIGN.dimensions
STANDARD = ["sensor.model=fsr400", "bone.base_length_mm=27", "strength.grip_force_n=14"]
"""Words of the design's heading."""


def find_failed(design: Design = DESIGN) -> set[str]:
    solids = Solids.of(design, MeshEvaluator(0.02), ("bone", "skin"))
    checks = (*check_bone(design, solids), *check_laid_in(design, solids))
    return {check.name for check in checks if not check.passed}


def shorten(solid: Any, *_: object) -> Any:
    """End the trough before the longest tail, a millimetre into the room of its tabs."""
    return difference(solid, Box((-9.0, -20.0, -20.0), (9.0, 20.0, -6.5)))


def close(solid: Any, *_: object) -> Any:
    """Leave a closed slot of the film's height where the trough was, from just behind the end of the tail."""
    return difference(solid, Box((-9.0, -20.0, -20.0), (9.0, 20.0, DIMS.tail_end_z - 0.2)))


@pytest.mark.every_case
@pytest.mark.parametrize(
    ("name", "change", "failed"),
    [
        ("sensor_recess", shorten, {"sensor.room_overlap"}),
        ("sensor_recess", close, {"sensor.room_overlap", "sensor.vent_open"}),
        (
            "sensor_recess", lambda solid, _: union(solid, Box((-9.0, -9.0, -5.0), (9.0, -2.0, -4.0))),
            {"bone.wall.sensor_to_outside"},
        ),
    ],
)  # fmt: skip
def test_each_defect_is_found(name: str, change: Callable[..., object], failed: set[str], monkeypatch: Any) -> None:
    original = getattr(finger, name)
    monkeypatch.setattr(finger, name, lambda design: change(original(design), design))
    assert find_failed() == failed


@pytest.mark.parametrize(
    ("name", "changes"),
    [
        ("first_finger", ()),
        ("first_finger", STANDARD),
        ("fsr402", ()),
        ("fsr402", ("sensor.model=fsr402", "bone.base_length_mm=37")),
        ("article", ()),
        ("adult_finger", ()),
    ],
)
def test_sensors_are_laid_in(name: str, changes: tuple[str, ...]) -> None:
    design = Design.load(name, changes=changes)
    part = PARTS["bone"]
    assert find_failed(design) == set()
    assert MeshEvaluator(0.05).manifold(part.solid(design)).genus() == part.genus(design)
