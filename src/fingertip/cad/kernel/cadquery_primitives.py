"""Primitives of parts as cadquery workplanes, from plain numbers [mm].

The B-rep kernel makes the STEP files of them; the scripts of `fingertip build --formats cq` hold
this file.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import cadquery as cq
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeEdge,
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_Sewing,
)
from OCP.BRepGProp import BRepGProp
from OCP.Geom import Geom_BezierCurve, Geom_BezierSurface
from OCP.gp import gp_Pnt
from OCP.GProp import GProp_GProps
from OCP.ShapeFix import ShapeFix_Solid
from OCP.TColgp import TColgp_Array1OfPnt, TColgp_Array2OfPnt
from OCP.TColStd import TColStd_Array1OfReal, TColStd_Array2OfReal
from OCP.TopoDS import TopoDS

SEWING_MM = 1e-6
"""Distance within which edges of neighbouring faces are sewn together [mm]."""


def volume(shape: Any) -> float:
    """Compute the volume [mm3] of a shape by adaptive Gauss-Kronrod quadrature.

    On a straight superconic prism with an arc of weight 4 the result is exact to 1e-10 mm3 of 4259
    mm3. There the kernel's plain quadrature (cadquery's `Volume()`) is off by 0.3 mm3, and its
    adaptive Gauss quadrature with a stated tolerance of 1e-6 by 11 mm3.
    """
    properties = GProp_GProps()
    shape = getattr(shape, "wrapped", shape)
    BRepGProp.VolumePropertiesGK_s(shape, properties, 1e-6, False, True, False, False, False)

    return float(properties.Mass())


def bezier_face(quadrant: Any, span: Any) -> Any:
    """Make a rational Bezier face: the tensor product of an arc of the section with a span."""
    rows = list(zip(span.z, span.scale, span.palmar, (1.0, span.weight, 1.0), strict=True))
    rows = rows[::2] if span.is_straight else rows
    poles = TColgp_Array2OfPnt(1, len(quadrant), 1, len(rows))
    weights = TColStd_Array2OfReal(1, len(quadrant), 1, len(rows))

    for i, (x, y, w) in enumerate(quadrant, 1):
        for j, (z, scale, palmar_scale, v) in enumerate(rows, 1):
            poles.SetValue(i, j, gp_Pnt(x * scale, y * (palmar_scale if y < 0 else scale), z))
            weights.SetValue(i, j, w * v)

    return BRepBuilderAPI_MakeFace(Geom_BezierSurface(poles, weights), SEWING_MM).Face()


def bezier_edge(row: Sequence[tuple[float, float, float]], z: float) -> Any:
    """Make an edge in the plane at height z from control points (x, y, weight)."""
    poles = TColgp_Array1OfPnt(1, len(row))
    weights = TColStd_Array1OfReal(1, len(row))

    for i, (x, y, w) in enumerate(row, 1):
        poles.SetValue(i, gp_Pnt(x, y, z))
        weights.SetValue(i, w)

    return BRepBuilderAPI_MakeEdge(Geom_BezierCurve(poles, weights)).Edge()


def superconic(section: Sequence[float], spans: Any) -> cq.Workplane:
    """Sew four faces for each span along z, and flat ends where it has a width, from a section of
    four conic arcs.

    The section holds its half width, the heights of its palmar and dorsal half, and the weights of
    their arcs: 0.707 for an ellipse, more for a squarer one.
    """
    a, palmar, dorsal, palmar_weight, dorsal_weight = section
    quadrants = [  # counter-clockwise
        ((a, 0, 1), (a, dorsal, dorsal_weight), (0, dorsal, 1)),
        ((0, dorsal, 1), (-a, dorsal, dorsal_weight), (-a, 0, 1)),
        ((-a, 0, 1), (-a, -palmar, palmar_weight), (0, -palmar, 1)),
        ((0, -palmar, 1), (a, -palmar, palmar_weight), (a, 0, 1)),
    ]
    faces = [bezier_face(quadrant, span) for quadrant in quadrants for span in spans]

    for span, end in ((spans[0], 0), (spans[-1], 2)):
        z = span.z[end]
        scale = span.scale[end]
        palmar_scale = span.palmar[end]

        if scale:
            rows = [
                [(x * scale, y * (palmar_scale if y < 0 else scale), w) for x, y, w in arc]
                for arc in quadrants
            ]
            outline = cq.Wire.assembleEdges([cq.Edge(bezier_edge(row, z)) for row in rows])
            faces.append(cq.Face.makeFromWires(outline).wrapped)

    sewing = BRepBuilderAPI_Sewing(SEWING_MM)
    for face in faces:
        sewing.Add(face)

    sewing.Perform()
    shell = TopoDS.Shell_s(sewing.SewedShape())
    solid = ShapeFix_Solid().SolidFromShell(shell)
    # The shell may have been sewn with its faces pointing inwards.
    solid = (
        solid
        if volume(solid) > 0
        else ShapeFix_Solid().SolidFromShell(TopoDS.Shell_s(shell.Reversed()))
    )

    return cq.Workplane(cq.Solid(solid))


def point(axis: str, across: Sequence[float], along: float) -> cq.Vector:
    """Place a point by a number along an axis and two across it:
    (y, z) for x, (z, x) for y, (x, y) for z.
    """
    u, v = across
    return cq.Vector(*{"x": (along, u, v), "y": (v, along, u), "z": (u, v, along)}[axis])


def box(low: Sequence[float], high: Sequence[float]) -> cq.Workplane:
    """Make a box between two opposite corners (x, y, z)."""
    return cq.Workplane(
        cq.Solid.makeBox(*(b - a for a, b in zip(low, high, strict=True)), cq.Vector(*low))
    )


def cylinder(
    axis: str,
    centre: Sequence[float],
    low: float,
    high: float,
    radius: float,
) -> cq.Workplane:
    """Make a cylinder about an axis through `centre`, from `low` to `high` along it."""
    base = point(axis, centre, low)
    direction = point(axis, (0.0, 0.0), 1.0)
    return cq.Workplane(cq.Solid.makeCylinder(radius, high - low, base, direction))


def cone(
    axis: str,
    centre: Sequence[float],
    low: float,
    high: float,
    low_radius: float,
    high_radius: float,
) -> cq.Workplane:
    """Make the frustum of a cone with different radii at `low` and `high`."""
    base = point(axis, centre, low)
    direction = point(axis, (0.0, 0.0), 1.0)
    return cq.Workplane(cq.Solid.makeCone(low_radius, high_radius, high - low, base, direction))


def prism(
    axis: str,
    corners: Any,
    low: float,
    high: float,
    holes: Any = (),
) -> cq.Workplane:
    """Extrude a polygon, with holes, along an axis; its corners are in the order of `point`."""
    rings = [[point(axis, corner, low) for corner in ring] for ring in (corners, *holes)]
    outline, *inner = (cq.Wire.makePolygon(ring, close=True) for ring in rings)
    return cq.Workplane(cq.Solid.extrudeLinear(outline, inner, point(axis, (0.0, 0.0), high - low)))


def elbow_tube(
    start_y: float,
    start_z: float,
    exit_z: float,
    end_y: float,
    bend_radius: float,
    radius: float,
) -> cq.Workplane:
    """Make a round tube at x = 0 from (start_y, start_z) along -z,
    a bend, then along +y to (end_y, exit_z).
    """
    turn_y = start_y + bend_radius
    turn_z = exit_z + bend_radius
    down = cq.Vector(0, 0, -1)
    first = cq.Solid.makeCylinder(radius, start_z - turn_z, cq.Vector(0, start_y, start_z), down)
    circle = cq.Wire.makeCircle(radius, cq.Vector(0, start_y, turn_z), down)
    bend = cq.Solid.revolve(
        circle, [], 90, cq.Vector(-1, turn_y, turn_z), cq.Vector(1, turn_y, turn_z)
    )
    last = cq.Solid.makeCylinder(
        radius, end_y - turn_y, cq.Vector(0, turn_y, exit_z), cq.Vector(0, 1, 0)
    )

    return cq.Workplane(first.fuse(bend, last))


def scaled(part: cq.Workplane, factor: float) -> cq.Workplane:
    """Scale a part about the origin."""
    return cq.Workplane(part.val().scale(factor))


def stack(*parts: cq.Workplane) -> cq.Workplane:
    """Put several parts on the stack of one workplane, so that a boolean takes them at once."""
    return cq.Workplane().newObject([part.val() for part in parts])


def union(first: cq.Workplane, *others: cq.Workplane) -> cq.Workplane:
    return first.union(stack(*others), clean=False)


def in_plane(y: float) -> cq.Selector:
    """Select the flat faces in the plane at a height y."""
    box_of_plane = cq.selectors.BoxSelector((-999, y - 0.01, -999), (999, y + 0.01, 999))
    return cq.selectors.ParallelDirSelector(cq.Vector(0, 1, 0)) & box_of_plane
