"""Frames of the finger, by which a robot or an assembly places it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .solids import Point3

if TYPE_CHECKING:
    from .program_types import Finger


def find_frames(finger: Finger) -> dict[str, Point3]:
    """Find the origin of each frame by its name (x, y, z) [mm].

    They are the interface to the hand (the axis of a joint, if there is one), the tip of the skin
    and the middle of the active area.
    """
    dims = finger.dimensions
    if dims.joint:
        interface_y = dims.joint.axis_y
        interface_z = dims.joint.axis_z
    else:
        interface_y = dims.base_middle_y
        interface_z = -finger.bone.base_length_mm

    return {
        "interface": (0.0, interface_y, interface_z),
        "tip": (0.0, 0.0, finger.skin.length_mm),
        "sensor": (0.0, -dims.platform_depth, dims.sensor_z),
    }
