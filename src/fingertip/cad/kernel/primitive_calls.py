"""Primitives of a tree as calls of `cad.kernel.cadquery_primitives`: the B-rep kernel makes them, scripts hold them."""

from __future__ import annotations

from typing import Any

from fingertip.design.geometry.conic import ConicBody
from fingertip.design.geometry.solids import Box, Cone, DraftedExtrusion, ElbowTube, Primitive, Prism, SuperconicSolid

ControlPoint = tuple[float, float, float]
"""Control point of a plane rational Bezier curve: (x, y, weight)."""


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
        case DraftedExtrusion(_, low, high):
            return "drafted_extrusion", (_drafted_outline(primitive), low, high)


def _spans(body: ConicBody) -> tuple[tuple[tuple[float, ...], ...], ...]:
    """List the control points (z, scale, palmar scale, weight) of each span; straight ones have two."""
    spans = []
    for span in body.spans:
        rows = (*zip(span.z, span.scale, span.palmar, (1.0, span.weight, 1.0), strict=True),)
        spans.append(rows[::2] if span.is_straight else rows)
    return tuple(spans)


def _drafted_outline(extrusion: DraftedExtrusion) -> tuple[tuple[ControlPoint, ...], ...]:
    """List the pieces of a drafted section, counter-clockwise: the straight walls, and the arcs between them."""
    section, half_width = extrusion.section.section, extrusion.section.half_width
    pieces: list[tuple[ControlPoint, ...]] = []
    for side, start, height, weight in (
        (1.0, extrusion.section.dorsal_start, section.dorsal, section.dorsal_weight),
        (-1.0, extrusion.section.palmar_start, section.palmar, section.palmar_weight),
    ):
        arc = _split_arc(section.half_width, height, weight, start)
        for mirror in (1.0, -1.0):
            row = tuple((mirror * x, side * y, w) for x, y, w in arc)
            pieces += [((mirror * half_width, 0.0, 1.0), (row[0][0], row[0][1], 1.0)), row]
    # Arrange the eight pieces counter-clockwise, from the right side on (d dorsal, p palmar).
    (right_d, d_right, left_d, d_left, right_p, p_right, left_p, p_left) = pieces
    return right_d, d_right, d_left, left_d, left_p, p_left, p_right, right_p


def _split_arc(a: float, b: float, weight: float, start: float) -> list[ControlPoint]:
    """Compute the control points (x, y, weight) of the part of an arc from parameter `start` to its end.

    De Casteljau's algorithm in homogeneous coordinates (G. Farin, Curves and Surfaces for CAGD). The whole arc runs
    from (`a`, 0) over the control point (`a`, `b`) with `weight` to (0, `b`).
    """
    first, middle, last = ((a, 0.0, 1.0), (weight * a, weight * b, weight), (0.0, b, 1.0))

    def between(p: ControlPoint, q: ControlPoint) -> ControlPoint:
        return (p[0] + start * (q[0] - p[0]), p[1] + start * (q[1] - p[1]), p[2] + start * (q[2] - p[2]))

    later = between(middle, last)
    controls = (between(between(first, middle), later), later, last)
    return [(x / w, y / w, w) for x, y, w in controls]
