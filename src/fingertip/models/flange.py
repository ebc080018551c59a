"""Flange: a plate with bolt holes at the end of the base."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .conic import ConicBody, CrossSection
from .feet import Foot, arc_foot, flat_foot
from .solids import Box, Shapes, Solid, SuperconicSolid, cylinder

if TYPE_CHECKING:
    from .program_types import Finger


def shapes(finger: Finger) -> Shapes:
    """Build the plate with its foot, and what is removed: the holes of the bolts.

    Section at x = 0, tip to the right:           Seen from its end:

            __                                      ___________________
           |  |                                    |    .---------.    |
           |  |'.____________                      | o  |  base   |  o |   flange_height_mm
           |  |     base                           |    |_________|    |
           |  |.'____________                      |___________________|
           |__|                                      |<-------------->|    flange_spacing_x_mm
        flange_thickness_mm, foot_radius_mm        |<- flange_width_mm >|
    """
    bone = finger.bone
    y = finger.dimensions.base_middle_y
    end = -bone.base_length_mm
    x = bone.flange_width_mm / 2
    half = bone.flange_height_mm / 2
    top = end + bone.flange_thickness_mm
    radius = bone.flange_hole_diameter_mm / 2
    hole_x = bone.flange_spacing_x_mm / 2
    rows = bone.flange_spacing_y_mm / 2
    holes = tuple(
        cylinder(
            "z",
            centre=(side * hole_x, y + row),
            low=end - radius,
            high=top + radius,
            radius=radius,
        )
        for row in ((-rows, rows) if rows else (0.0,))
        for side in (-1.0, 1.0)
    )
    plate = Box((-x, y - half, end), (x, y + half, top))
    section = finger.dimensions.bone_outline.section
    flat = finger.dimensions.base_flat_depth
    into = top - radius
    foot = arc_foot(bone.foot_radius_mm, top, -1.0)
    reach = 2 * x
    sides = flat_foot(
        "x",
        low_side=-flat,
        high_side=reach,
        foot=foot,
        end=into - radius,
        reach=reach,
    )
    above = Box((-x, y - half, end), (x, y + half, top + reach))

    return (plate, _conic_foot(section, foot, into).intersect(sides, above)), holes


def _conic_foot(section: CrossSection, foot: Foot, end: float) -> Solid:
    """Build the foot of a superconic section; it ends at z = `end` [mm]."""
    line = [*foot.line, (end, foot.line[-1][1])]
    stations = [(z, 1.0 + out / section.half_width) for z, out in line]
    return SuperconicSolid(ConicBody(section, tuple(stations[::-1])))
