"""Primitives of parts as cadquery workplanes, from plain numbers [mm].

The B-rep kernel makes the STEP files of them; the scripts of `fingertip build --formats cq` hold the same functions.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import cadquery as cq

from fingertip.cad.kernel.bezier import sew_superconic


def point(axis: str, across: Sequence[float], along: float) -> cq.Vector:
    """Place a point by a number along an axis and two across it: (y, z) for x, (z, x) for y, (x, y) for z."""
    u, v = across
    return cq.Vector(*{"x": (along, u, v), "y": (v, along, u), "z": (u, v, along)}[axis])


def box(low: Sequence[float], high: Sequence[float]) -> cq.Workplane:
    """Make a box between two opposite corners (x, y, z)."""
    return cq.Workplane(cq.Solid.makeBox(*(b - a for a, b in zip(low, high, strict=True)), cq.Vector(*low)))


def cylinder(axis: str, centre: Sequence[float], low: float, high: float, radius: float) -> cq.Workplane:
    """Make a cylinder about an axis through `centre`, from `low` to `high` along it."""
    base, direction = point(axis, centre, low), point(axis, (0.0, 0.0), 1.0)
    return cq.Workplane(cq.Solid.makeCylinder(radius, high - low, base, direction))


def cone(
    axis: str, centre: Sequence[float], low: float, high: float, low_radius: float, high_radius: float
) -> cq.Workplane:
    """Make the frustum of a cone with different radii at `low` and `high`."""
    base, direction = point(axis, centre, low), point(axis, (0.0, 0.0), 1.0)
    return cq.Workplane(cq.Solid.makeCone(low_radius, high_radius, high - low, base, direction))


def prism(axis: str, corners: Any, low: float, high: float, holes: Any = ()) -> cq.Workplane:
    """Extrude a polygon, with holes, along an axis; its corners are in the order of `point`."""
    rings = [[point(axis, corner, low) for corner in ring] for ring in (corners, *holes)]
    outline, *inner = (cq.Wire.makePolygon(ring, close=True) for ring in rings)
    return cq.Workplane(cq.Solid.extrudeLinear(outline, inner, point(axis, (0.0, 0.0), high - low)))


def elbow_tube(
    start_y: float, start_z: float, exit_z: float, end_y: float, bend_radius: float, radius: float
) -> cq.Workplane:
    """Make a round tube at x = 0 from (start_y, start_z) along -z, a bend, then along +y to (end_y, exit_z)."""
    turn_y, turn_z, down = start_y + bend_radius, exit_z + bend_radius, cq.Vector(0, 0, -1)
    first = cq.Solid.makeCylinder(radius, start_z - turn_z, cq.Vector(0, start_y, start_z), down)
    circle = cq.Wire.makeCircle(radius, cq.Vector(0, start_y, turn_z), down)
    ends = cq.Vector(-1, turn_y, turn_z), cq.Vector(1, turn_y, turn_z)
    bend = cq.Solid.revolve(circle, [], 90, *ends)
    if bend.Center().z > turn_z:  # it turned to the wrong side
        bend = cq.Solid.revolve(circle, [], 90, *ends[::-1])
    last = cq.Solid.makeCylinder(radius, end_y - turn_y, cq.Vector(0, turn_y, exit_z), cq.Vector(0, 1, 0))
    return cq.Workplane(first.fuse(bend, last))


def superconic(section: Sequence[float], spans: Any) -> cq.Workplane:
    """Sew a body whose section is scaled along z by spans.

    The section holds its half width, its palmar and dorsal height, and the weights of the arcs of both halves: 0.707
    for an ellipse, more for a squarer one.
    """

    return cq.Workplane(cq.Solid(sew_superconic(section, spans)))


def scaled(part: cq.Workplane, factor: float) -> cq.Workplane:
    """Scale a part about the origin."""
    return cq.Workplane(part.val().scale(factor))


def stack(*parts: cq.Workplane) -> cq.Workplane:
    """Put several parts on the stack of one workplane, so that a boolean takes them at once."""
    return cq.Workplane().newObject([part.val() for part in parts])


def union(first: cq.Workplane, *others: cq.Workplane) -> cq.Workplane:
    return first.union(stack(*others), clean=False)


def in_plane(y: float) -> cq.Selector:
    """Select the faces whose middle lies in the plane at a height y."""
    return cq.selectors.BoxSelector((-999, y - 0.01, -999), (999, y + 0.01, 999))
