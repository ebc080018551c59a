"""Hole of the cross bolt through a post or a socket."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .solids import Solid, cylinder

if TYPE_CHECKING:
    from .program_types import Finger


def bolt_hole(finger: Finger, z: float) -> Solid:
    """Build the hole across the base or the post, at a height z [mm]."""
    dims = finger.dimensions
    across = 2 * dims.bone_outline.section.half_width
    return cylinder(
        "x",
        centre=(dims.base_middle_y, z),
        low=-across,
        high=across,
        radius=finger.bone.cross_bolt_diameter_mm / 2,
    )
