"""Interface of the bone to the proximal phalanx: post, socket, flange or clevis."""

from __future__ import annotations

from fingertip.cad.shapes.clevis import clevis
from fingertip.cad.solids import Box, Solid, cylinder, intersection
from fingertip.design import Design

_MIN_FLAT_MM = 0.02
"""Depth of a post's flat below which it is left out [mm]: both kernels fail on slivers."""


def interface(design: Design) -> tuple[tuple[Solid, ...], tuple[Solid, ...]]:
    """Build the interface to the proximal phalanx.

    Returns
    -------
    added, removed
        Solids that the interface adds to the base, and solids that it removes.
    """
    dims, bone = design.dimensions, design.bone
    y = (dims.bone_outline.section.dorsal - dims.base_flat_depth) / 2
    end, across = -bone.base_length_mm, 2 * dims.bone_outline.section.half_width
    bolt = bone.cross_bolt_diameter_mm / 2
    if bone.interface == "socket":
        radius = bone.socket_diameter_mm / 2
        socket = cylinder("z", (0.0, y), end - radius, end + bone.socket_depth_mm, radius)
        hole = cylinder("x", (y, dims.cross_bolt_z), -across, across, bolt)
        return (), (socket, hole)
    if bone.interface == "flange":
        return (_flange(design, y),), _flange_holes(design, y)
    if bone.interface == "clevis":
        return clevis(design)
    foot = end - bone.post_length_mm
    return (_post(design, y, foot, end + bone.wall_mm / 2),), (
        cylinder("x", (y, dims.cross_bolt_z), -across, across, bolt),
    )


def _post(design: Design, y: float, low: float, high: float) -> Solid:
    """Build a round post with a dorsal and a palmar flat, or without them if it is as high as wide."""
    radius, half = design.bone.post_width_mm / 2, design.bone.post_height_mm / 2
    stem = cylinder("z", (0.0, y), low, high, radius)
    if half > radius - _MIN_FLAT_MM:
        return stem
    margin = radius  # past the round sides and the ends, by a length that scales with the design
    return intersection(
        stem, Box((-radius - margin, y - half, low - margin), (radius + margin, y + half, high + margin))
    )


def _flange(design: Design, y: float) -> Solid:
    """Build the plate at the proximal end of the base."""
    bone = design.bone
    end, x, half = -bone.base_length_mm, bone.flange_width_mm / 2, bone.flange_height_mm / 2
    return Box((-x, y - half, end), (x, y + half, end + bone.flange_thickness_mm))


def _flange_holes(design: Design, y: float) -> tuple[Solid, ...]:
    """Build the bolt holes of the flange."""
    bone = design.bone
    end, top = -bone.base_length_mm, -bone.base_length_mm + bone.flange_thickness_mm
    radius, x, rows = bone.flange_hole_diameter_mm / 2, bone.flange_spacing_x_mm / 2, bone.flange_spacing_y_mm / 2
    return tuple(
        cylinder("z", (side * x, y + row), end - radius, top + radius, radius)
        for row in ((-rows, rows) if rows else (0.0,))
        for side in (-1.0, 1.0)
    )


def interface_genus(design: Design) -> int:
    """Count the through holes of the interface.

    Post and socket have the hole of the cross bolt. A socket adds one more: it is blind, but it opens into that hole,
    which then has three mouths. A fork has a hole in each cheek. The anchor of a tendon has two holes, one on either
    side of the notch or window that it crosses.
    """
    dims = design.dimensions
    if design.bone.interface == "clevis":
        assert dims.joint
        return (2 if dims.joint.is_fork else 1) + (2 if dims.anchor else 0)
    return {"post": 1, "socket": 2, "flange": 4 if design.bone.flange_spacing_y_mm else 2}[design.bone.interface]
