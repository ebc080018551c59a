"""Post: a round post with two flats at the end of the base, and a cross bolt near its end."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING

from .allowances import LEDGE_MM, TANGENT_STEP_MM
from .conic import ConicBody, offset_section
from .cross_bolt import bolt_hole
from .feet import Foot, arc_foot, flat_foot, sloping_foot
from .profile import farthest_corner
from .solids import (
    Box,
    Cone,
    Prism,
    Shapes,
    Solid,
    SuperconicSolid,
    cylinder,
    intersection,
    union,
)

if TYPE_CHECKING:
    from .program_types import Finger

_OUTLINE_POINTS = 16
_CHAMFER_MM = 0.6
_MIN_FLAT_MM = 0.02
"""Depth of a post's flat below which it is left out [mm]: both kernels fail on slivers."""
_CONE_OVERLAP_MM = 0.05
"""Length by which the cones of a round foot reach into each other [mm]."""


def shapes(finger: Finger) -> Shapes:
    """Build the post with its foot, and what is removed: the hole of the cross bolt.

    Section at x = 0, tip to the right:           Seen from its end:

                           |  base                      ______
            ______________.'                          .'______'.
           |                                          |        |   post_height_mm
           |   (o)                                    |________|   over both flats
           |______________                             '.____.'
          low_z            '.  foot_radius_mm         post_width_mm, its diameter
           |<------------->|
            post_length_mm
    """
    bone = finger.bone
    post = post_body(finger, bone.post_width_mm, bone.post_height_mm, bone.post_length_mm)
    return (post, _foot(finger)), (bolt_hole(finger, cross_bolt_z(finger)),)


def cross_bolt_z(finger: Finger) -> float:
    """Axis of the cross bolt: near the end of the post, where bending is least."""
    bone = finger.bone
    hole = bone.cross_bolt_diameter_mm
    beside = hole / 2 + max(bone.wall_mm, hole / 2)
    return low_z(finger) + min(beside, bone.post_length_mm / 2)


def low_z(finger: Finger) -> float:
    return -finger.bone.base_length_mm - finger.bone.post_length_mm


def post_body(finger: Finger, width: float, height: float, length: float) -> Solid:
    """Build a round post with a dorsal and a palmar flat, or without if it is as high as wide."""
    y = finger.dimensions.base_middle_y
    low = -finger.bone.base_length_mm - length
    high = finger.bone.wall_mm / 2
    high -= finger.bone.base_length_mm
    radius = width / 2
    half = height / 2
    post: Solid = cylinder(
        "z",
        centre=(0.0, y),
        low=low,
        high=high,
        radius=radius,
    )

    if half <= radius - _MIN_FLAT_MM:
        margin = radius  # past the round sides and the ends, by a length that scales with the post
        post = post.intersect(
            Box(
                (-radius - margin, y - half, low - margin),
                (radius + margin, y + half, high + margin),
            )
        )

    if finger.dimensions.prints_without_supports:
        post = post.intersect(
            *_chamfer(
                y,
                low=low,
                up=high - low,
                radius=radius,
                half=min(half, radius),
            )
        )

    return post


def _chamfer(
    y: float,
    low: float,
    up: float,
    radius: float,
    half: float,
) -> tuple[Solid, Solid]:
    """Build what is left of the post by a chamfer of its end, on which it prints: the first layers
    spread.
    """
    least = radius - _CHAMFER_MM
    flat = half - _CHAMFER_MM
    sides = (
        (y - flat, low),
        (y + flat, low),
        (y + flat + up, low + up),
        (y - flat - up, low + up),
    )

    return Cone(
        axis="z",
        centre=(0.0, y),
        low=low,
        high=low + up,
        low_radius=least,
        high_radius=least + up,
    ), Prism("x", sides, -2 * radius, 2 * radius)


def _foot(finger: Finger) -> Solid:
    """Build the fillet at the post's root, within the outline of the base."""
    dims = finger.dimensions
    end = -finger.bone.base_length_mm
    bone = finger.bone
    y = dims.base_middle_y
    top = end + bone.wall_mm / 2
    half = bone.post_height_mm / 2
    margin = dims.bone_outline.section.half_width
    foot = _foot_section(finger)
    low = end - foot.length - margin
    # A step inside the outline, because both run along z and would share a face.
    section = offset_section(dims.bone_outline.section, -TANGENT_STEP_MM)
    flat = dims.base_flat_depth
    outline = SuperconicSolid(ConicBody(section, ((low, 1.0), (top + margin, 1.0)))).cut(
        Box(
            (-2 * margin, -section.palmar - margin, low - margin),
            (2 * margin, TANGENT_STEP_MM - flat, top + 2 * margin),
        )
    )
    solids = [outline, _round_foot(finger, foot, top)]

    if half <= bone.post_width_mm / 2 - _MIN_FLAT_MM:
        solids.append(
            flat_foot(
                "x",
                low_side=y - half,
                high_side=y + half,
                foot=foot,
                end=top + margin,
                reach=2 * margin,
            )
        )

    return intersection(*solids)


def _round_foot(finger: Finger, foot: Foot, top: float) -> Solid:
    """Build the foot all around the post without its flats; it ends at z = `top` [mm]."""
    radius = finger.bone.post_width_mm / 2
    cones = []
    for (low, inner), (high, outer) in pairwise(foot.line):
        slope = (outer - inner) / (high - low)
        begin = low - _CONE_OVERLAP_MM
        low_radius, high_radius = (radius + inner + slope * (z - low) for z in (begin, top))
        cones.append(
            Cone(
                axis="z",
                centre=(0.0, finger.dimensions.base_middle_y),
                low=begin,
                high=top,
                low_radius=low_radius,
                high_radius=high_radius,
            )
        )

    return union(*cones)


def _foot_section(finger: Finger) -> Foot:
    """Make the section of the fillet at the post's root: an arc, or the slope on which the base
    prints.
    """
    radius = finger.bone.foot_radius_mm
    end = -finger.bone.base_length_mm
    reach = _foot_reach(finger) if finger.dimensions.prints_without_supports else 0.0
    if reach:
        return sloping_foot(radius, root_z=end, way=1.0, reach=reach)

    return arc_foot(radius, root_z=end, way=1.0)


def _foot_reach(finger: Finger) -> float:
    """Return how far a foot without supports stands out: to the base's corners, but for a short
    ledge [mm].
    """
    dims = finger.dimensions
    middle = dims.base_middle_y
    section = dims.bone_outline.section
    flat = -dims.base_flat_depth
    corner = farthest_corner(
        section.half_width,
        height=section.dorsal,
        weight=section.dorsal_weight,
        count=_OUTLINE_POINTS,
        middle=middle,
    )
    corner = max(corner, math.hypot(section.half_width_at(flat), flat - middle))

    return max(0.0, corner - finger.bone.post_width_mm / 2 - LEDGE_MM)


def post_foot_length(finger: Finger) -> float:
    """Return the length of the fillet at the post's root [mm], with the slope on which the base
    prints.
    """
    return _foot_section(finger).length
