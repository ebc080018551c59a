"""Primitives of parts as cadquery shapes, from plain numbers [mm].

The scripts that `fingertip build --formats cq` writes hold what follows as it stands here, so that a script gives the
same solid as the STEP file. That is why this module imports nothing of fingertip.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import cadquery as cq
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeFace, BRepBuilderAPI_Sewing
from OCP.BRepGProp import BRepGProp
from OCP.Geom import Geom_BezierCurve, Geom_BezierSurface
from OCP.gp import gp_Pnt
from OCP.GProp import GProp_GProps
from OCP.TColgp import TColgp_Array1OfPnt, TColgp_Array2OfPnt
from OCP.TColStd import TColStd_Array1OfReal, TColStd_Array2OfReal

# Functions

SEWING_MM = 1e-6
"""Distance within which edges of neighbouring faces are sewn together [mm]."""


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


def volume(shape: Any) -> float:
    """Compute the volume by adaptive Gauss-Kronrod quadrature.

    On a straight superconic prism with an arc of weight 4 the result is exact to 1e-10 mm3 of 4259 mm3. There the
    kernel's plain quadrature (`Shape.Volume()`) is off by 0.3 mm3, and its adaptive Gauss quadrature with a stated
    tolerance of 1e-6 by 11 mm3.
    """
    properties = GProp_GProps()
    BRepGProp.VolumePropertiesGK_s(shape.wrapped, properties, 1e-6, False, True, False, False, False)
    return float(properties.Mass())


def bezier_face(quadrant: Any, span: Any) -> cq.Face:
    """Make a rational Bezier face: the tensor product of an arc of the section with a span."""
    poles = TColgp_Array2OfPnt(1, len(quadrant), 1, len(span))
    weights = TColStd_Array2OfReal(1, len(quadrant), 1, len(span))
    for i, (x, y, w) in enumerate(quadrant, 1):
        for j, (z, scale, palmar_scale, v) in enumerate(span, 1):
            poles.SetValue(i, j, gp_Pnt(x * scale, y * (palmar_scale if y < 0 else scale), z))
            weights.SetValue(i, j, w * v)
    return cq.Face(BRepBuilderAPI_MakeFace(Geom_BezierSurface(poles, weights), SEWING_MM).Face())


def bezier_edge(row: Any, z: float) -> cq.Edge:
    """Make an edge in the plane at height z from control points (x, y, weight)."""
    poles, weights = TColgp_Array1OfPnt(1, len(row)), TColStd_Array1OfReal(1, len(row))
    for i, (x, y, w) in enumerate(row, 1):
        poles.SetValue(i, gp_Pnt(x, y, z))
        weights.SetValue(i, w)
    return cq.Edge(BRepBuilderAPI_MakeEdge(Geom_BezierCurve(poles, weights)).Edge())


def superconic(
    half_width: float, palmar: float, dorsal: float, palmar_weight: float, dorsal_weight: float, spans: Any
) -> Any:
    """Sew a section of four conic arcs, scaled along z: four faces for each span, and flat ends where it has a width.

    Each half of the section has a height and a weight of its arcs: 0.707 for an ellipse, more for a squarer one. A span
    is a list of control points (z, scale of the section, scale of its palmar height, weight), of a line or a conic.
    """
    quadrants = [
        ((half_width, 0, 1), (half_width, dorsal, dorsal_weight), (0, dorsal, 1)),
        ((0, dorsal, 1), (-half_width, dorsal, dorsal_weight), (-half_width, 0, 1)),
        ((-half_width, 0, 1), (-half_width, -palmar, palmar_weight), (0, -palmar, 1)),
        ((0, -palmar, 1), (half_width, -palmar, palmar_weight), (half_width, 0, 1)),
    ]
    sewing = BRepBuilderAPI_Sewing(SEWING_MM)
    for span in spans:
        for quadrant in quadrants:
            sewing.Add(bezier_face(quadrant, span).wrapped)
    for z, scale, palmar_scale, _ in (spans[0][0], spans[-1][-1]):
        if scale:
            rows = [[(x * scale, y * (palmar_scale if y < 0 else scale), w) for x, y, w in arc] for arc in quadrants]
            wire = cq.Wire.assembleEdges([bezier_edge(row, z) for row in rows])
            sewing.Add(cq.Face.makeFromWires(wire).wrapped)
    sewing.Perform()
    shell: Any = cq.Shape.cast(sewing.SewedShape())
    if volume(cq.Solid.makeSolid(shell)) < 0:  # it has been sewn with its faces pointing inwards
        shell = cq.Shape.cast(shell.wrapped.Reversed())
    return cq.Solid.makeSolid(shell)


def drafted_extrusion(outline: Any, low: float, high: float) -> Any:
    """Extrude an outline of lines and conic arcs along z; each is a list of control points (x, y, weight)."""
    edges = [
        bezier_edge(piece, low) if len(piece) > 2
        else cq.Edge.makeLine(*(cq.Vector(x, y, low) for x, y, _ in piece))
        for piece in outline
    ]  # fmt: skip
    return cq.Solid.extrudeLinear(cq.Wire.assembleEdges(edges), [], cq.Vector(0.0, 0.0, high - low))
