"""Primitives of parts as cadquery shapes, from plain numbers [mm].

The scripts that `fingertip build --formats cq` writes hold what follows as it stands here, so that a script gives the
same solid as the STEP file, together with `bezier.py`. It imports nothing else of fingertip.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import cadquery as cq

from fingertip.cad.kernel.bezier import sew_superconic

# Functions


def point(axis: str, across: Sequence[float], along: float) -> cq.Vector:
    """Place a point by a number along an axis and two across it: (y, z) for x, (z, x) for y, (x, y) for z."""
    u, v = across
    return cq.Vector(*{"x": (along, u, v), "y": (v, along, u), "z": (u, v, along)}[axis])


def box(low: Sequence[float], high: Sequence[float]) -> Any:
    """Make a box between two opposite corners (x, y, z)."""
    return cq.Solid.makeBox(*(b - a for a, b in zip(low, high, strict=True)), cq.Vector(*low))


def cylinder(axis: str, centre: Sequence[float], low: float, high: float, radius: float) -> Any:
    """Make a cylinder about an axis through `centre`, from `low` to `high` along it."""
    return cq.Solid.makeCylinder(radius, high - low, point(axis, centre, low), point(axis, (0.0, 0.0), 1.0))


def cone(axis: str, centre: Sequence[float], low: float, high: float, low_radius: float, high_radius: float) -> Any:
    """Make the frustum of a cone with different radii at `low` and `high`."""
    direction = point(axis, (0.0, 0.0), 1.0)
    return cq.Solid.makeCone(low_radius, high_radius, high - low, point(axis, centre, low), direction)


def prism(axis: str, corners: Any, low: float, high: float, holes: Any = ()) -> Any:
    """Extrude a polygon, with holes, along an axis."""
    outline, *inner = (
        cq.Wire.makePolygon([point(axis, corner, low) for corner in ring], close=True) for ring in (corners, *holes)
    )
    return cq.Solid.extrudeLinear(outline, inner, point(axis, (0.0, 0.0), high - low))


def elbow_tube(start_y: float, start_z: float, exit_z: float, end_y: float, bend_radius: float, radius: float) -> Any:
    """Make a round tube at x = 0 from (start_y, start_z) along -z, a bend, then along +y to (end_y, exit_z)."""
    down = cq.Solid.makeCylinder(
        radius, start_z - exit_z - bend_radius, cq.Vector(0, start_y, start_z), cq.Vector(0, 0, -1)
    )
    turn_y, turn_z = start_y + bend_radius, exit_z + bend_radius
    circle = cq.Wire.makeCircle(radius, cq.Vector(0, start_y, turn_z), cq.Vector(0, 0, -1))
    bend = cq.Solid.revolve(circle, [], 90, cq.Vector(-1, turn_y, turn_z), cq.Vector(1, turn_y, turn_z))
    if bend.Center().z > turn_z:  # revolved to the wrong side: reverse the axis
        bend = cq.Solid.revolve(circle, [], 90, cq.Vector(1, turn_y, turn_z), cq.Vector(-1, turn_y, turn_z))
    up = cq.Solid.makeCylinder(radius, end_y - turn_y, cq.Vector(0, turn_y, exit_z), cq.Vector(0, 1, 0))
    return down.fuse(bend, up)


def superconic(
    half_width: float, palmar: float, dorsal: float, palmar_weight: float, dorsal_weight: float, spans: Any
) -> Any:
    """Sew a section of four conic arcs, scaled along z: four faces for each span, and flat ends where it has a width.

    Each half of the section has a height and a weight of its arcs: 0.707 for an ellipse, more for a squarer one. A span
    is a list of control points (z, scale of the section, scale of its palmar height, weight), of a line or a conic.
    """

    def make_face(edges: list[Any]) -> Any:
        return cq.Face.makeFromWires(cq.Wire.assembleEdges([cq.Edge(edge) for edge in edges])).wrapped

    return cq.Solid(sew_superconic((half_width, palmar, dorsal, palmar_weight, dorsal_weight), spans, make_face))
