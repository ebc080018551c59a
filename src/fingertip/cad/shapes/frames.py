"""Frames of a finger, in the axes of its design: x across, y to the back, z to the tip."""

from __future__ import annotations

from fingertip.design import Design
from fingertip.design.geometry.solids import Point3
from fingertip.design.interfaces.interface import middle_y


def find_frames(design: Design) -> dict[str, Point3]:
    """Find the origins [mm] of the interface to the hand, the tip of the skin and the middle of the active area."""
    dims, joint = design.dimensions, design.dimensions.joint
    y, z = (joint.axis_y, joint.axis_z) if joint else (middle_y(dims), -design.bone.base_length_mm)
    return {
        "interface": (0.0, y, z),
        "tip": (0.0, 0.0, design.skin.length_mm),
        "sensor": (0.0, -dims.platform_depth, dims.sensor_z),
    }
