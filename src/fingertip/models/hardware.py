"""Hardware that is bought for a finger, as plain solids for the assembly.

Threads are cylinders of their nominal diameter. No check of a part reads these solids.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import TYPE_CHECKING

from .joint import Joint
from .parts import PARTS
from .sensor_pocket import sensor_body
from .solids import Solid, cylinder

if TYPE_CHECKING:
    from .program_types import Finger

_STEEL_COLOUR = (0.55, 0.56, 0.58)
"""Red, green and blue of a steel pin, 0 to 1."""
_SENSOR_COLOUR = (0.20, 0.22, 0.25)
"""Red, green and blue of the sensor's film, 0 to 1."""


@dataclass(frozen=True)
class HardwareItem:
    """Bought item in its place in the finger."""

    name: str
    solid: Solid
    colour: tuple[float, float, float]
    """Red, green and blue in STEP files, 0 to 1."""


def hardware(finger: Finger, parts: Collection[str]) -> tuple[HardwareItem, ...]:
    """List what lies in the given parts: the sensor, and the pin of a joint."""
    if "bone" not in parts:
        return ()

    sensor = HardwareItem("sensor", sensor_body(finger), _SENSOR_COLOUR)
    joint = finger.dimensions.joint
    if joint is None:
        return (sensor,)

    return sensor, _place_joint_pin(finger, joint)


def _place_joint_pin(finger: Finger, joint: Joint) -> HardwareItem:
    """Place the pin on the axis of the joint, in the middle of its length."""
    is_printed = finger.hand.pin == "printed"
    half_length = finger.dimensions.pin_length / 2
    solid = cylinder(
        "x",
        centre=(joint.axis_y, joint.axis_z),
        low=-half_length,
        high=half_length,
        radius=joint.printed_pin_radius,
    )

    return HardwareItem("joint_pin", solid, PARTS["pin"].colour if is_printed else _STEEL_COLOUR)
