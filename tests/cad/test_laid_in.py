"""Sensor that is laid into an open trough: room for what is sold, open vent, wires held, and what the bone holds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes import bone
from fingertip.cad.shapes.parts import PARTS
from fingertip.cad.verification.bone import check_bone
from fingertip.cad.verification.laid_in import check_laid_in
from fingertip.design import Design
from fingertip.design.geometry.solids import Box, difference, union

DESIGN = Design.load("first_finger")
DIMS = DESIGN.dimensions
STANDARD = (  # the words of the design's heading
    "sensor.model=fsr400", "bone.base_length_mm=30", "strength.grip_force_n=14", "strength.shock_force_n=24",
)  # fmt: skip
LARGE = (
    "mold.method=plunge",
    "sensor.tail=straight",
    "sensor.clearance_mm=0.25",
    "skin.width_mm=24.6",
    "bone.post_length_mm=10",
)
SHORT = ("sensor.model=fsr400_short", "sensor.tail=straight", "sensor.clearance_mm=0.25")


def find_failed(design: Design = DESIGN) -> set[str]:
    evaluator = MeshEvaluator(0.02)
    checks = (*check_bone(design, evaluator), *check_laid_in(design, evaluator))
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
        ("tie_notches", lambda *_: (), {"sensor.wires_held"}),
        ("cable_channel", lambda tube, _: replace(tube, exit_z=tube.exit_z - 2.0), {"sensor.wires_held"}),
        (
            "sensor_recess", lambda solid, _: union(solid, Box((-9.0, -9.0, -5.0), (9.0, -2.0, -4.0))),
            {"bone.wall.sensor_to_outside"},
        ),
    ],
)  # fmt: skip
def test_each_defect_is_found(name: str, change: Callable[..., object], failed: set[str], monkeypatch: Any) -> None:
    original = getattr(bone, name)
    monkeypatch.setattr(bone, name, lambda design: change(original(design), design))
    assert find_failed() == failed


@pytest.mark.every_case
@pytest.mark.parametrize(
    ("name", "changes"),
    [
        ("first_finger", ()),
        ("first_finger", STANDARD),
        ("fsr402", LARGE),
        ("fsr402", (*LARGE, "sensor.model=fsr402", "bone.base_length_mm=37")),
        ("fsr400_compact", (*SHORT, "mold.method=plunge", "bone.base_length_mm=12", "bone.post_length_mm=10")),
    ],
)
def test_sensors_are_laid_in(name: str, changes: tuple[str, ...]) -> None:
    design = Design.load(name, changes=changes)
    part = PARTS["bone"]
    assert find_failed(design) == set()
    assert MeshEvaluator(0.05).manifold(part.solid(design)).genus() == part.genus(design)
