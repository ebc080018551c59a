"""Primitives of a tree as calls of `cad.kernel.cadquery_primitives`: the B-rep kernel makes them, scripts hold them."""

from __future__ import annotations

from typing import Any

from fingertip.design.geometry.conic import ConicBody
from fingertip.design.geometry.solids import Box, Cone, ElbowTube, Primitive, Prism, SuperconicSolid


def call_of(primitive: Primitive) -> tuple[str, tuple[Any, ...]]:
    """Return name and arguments of the function that makes a primitive."""
    match primitive:
        case Box(low, high):
            return "box", (low, high)
        case Cone(axis, centre, low, high, low_radius, high_radius):
            if low_radius == high_radius:  # the kernel's cones reject equal radii
                return "cylinder", (axis, centre, low, high, low_radius)
            return "cone", (axis, centre, low, high, low_radius, high_radius)
        case Prism(axis, corners, low, high, holes):
            return "prism", (axis, corners, low, high, *([holes] if holes else []))
        case ElbowTube(start_y, start_z, exit_z, end_y, bend_radius, radius):
            return "elbow_tube", (start_y, start_z, exit_z, end_y, bend_radius, radius)
        case SuperconicSolid(body):
            section = body.section
            form = (section.half_width, section.palmar, section.dorsal, section.palmar_weight, section.dorsal_weight)
            return "superconic", (*form, _spans(body))


def _spans(body: ConicBody) -> tuple[tuple[tuple[float, ...], ...], ...]:
    """List the control points (z, scale, palmar scale, weight) of each span; straight ones have two."""
    spans = []
    for span in body.spans:
        rows = (*zip(span.z, span.scale, span.palmar, (1.0, span.weight, 1.0), strict=True),)
        spans.append(rows[::2] if span.is_straight else rows)
    return tuple(spans)
