"""Primitives of parts as Open CASCADE's shapes, from plain numbers [mm]: the calls of `primitive_calls.call_of`.

The scripts of `fingertip build --formats cq` make the same calls of cadquery (`cadquery_primitives`); a test compares.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeEdge,
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakePolygon,
    BRepBuilderAPI_Sewing,
)
from OCP.BRepGProp import BRepGProp
from OCP.BRepPrimAPI import BRepPrimAPI_MakeCone, BRepPrimAPI_MakeCylinder, BRepPrimAPI_MakeRevol
from OCP.Geom import Geom_BezierCurve, Geom_BezierSurface
from OCP.gp import gp_Ax1, gp_Circ, gp_Dir, gp_Pnt
from OCP.GProp import GProp_GProps
from OCP.ShapeFix import ShapeFix_Solid
from OCP.TColgp import TColgp_Array1OfPnt, TColgp_Array2OfPnt
from OCP.TColStd import TColStd_Array1OfReal, TColStd_Array2OfReal
from OCP.TopoDS import TopoDS, TopoDS_Shape

from fingertip.cad.kernel import occ
from fingertip.cad.kernel.primitive_calls import ControlPoint
from fingertip.design.geometry.solids import Axis, Point3, axis_point

Point2 = tuple[float, float]
_SEWING_MM = 1e-6
"""Distance within which edges of neighbouring faces are sewn together [mm]."""

box = occ.make_box


def cylinder(axis: Axis, centre: Point2, low: float, high: float, radius: float) -> TopoDS_Shape:
    base = occ.axes(axis_point(axis, *centre, low), axis_point(axis, 0.0, 0.0, 1.0))
    return BRepPrimAPI_MakeCylinder(base, radius, high - low).Shape()


def cone(axis: Axis, centre: Point2, low: float, high: float, low_radius: float, high_radius: float) -> TopoDS_Shape:
    base = occ.axes(axis_point(axis, *centre, low), axis_point(axis, 0.0, 0.0, 1.0))
    return BRepPrimAPI_MakeCone(base, low_radius, high_radius, high - low).Shape()


def prism(axis: Axis, corners: Sequence[Point2], low: float, high: float, holes: Any = ()) -> TopoDS_Shape:
    outline, *inner = (_polygon([axis_point(axis, u, v, low) for u, v in ring]) for ring in (corners, *holes))
    return occ.extrude(occ.make_face(outline, inner), axis_point(axis, 0.0, 0.0, high - low))


def _polygon(corners: list[Point3]) -> Any:
    builder = BRepBuilderAPI_MakePolygon()
    for corner in corners:
        builder.Add(gp_Pnt(*corner))
    builder.Close()
    return builder.Wire()


def elbow_tube(
    start_y: float, start_z: float, exit_z: float, end_y: float, bend_radius: float, radius: float
) -> TopoDS_Shape:
    turn_y, turn_z = start_y + bend_radius, exit_z + bend_radius
    start = occ.axes((0.0, start_y, start_z), (0.0, 0.0, -1.0))
    circle = gp_Circ(occ.axes((0.0, start_y, turn_z), (0.0, 0.0, -1.0)), radius)
    section = occ.make_face(occ.make_wire([BRepBuilderAPI_MakeEdge(circle).Edge()]))
    axis = gp_Ax1(gp_Pnt(-1.0, turn_y, turn_z), gp_Dir(1.0, 0.0, 0.0))
    up = occ.axes((0.0, turn_y, exit_z), (0.0, 1.0, 0.0))
    return occ.fuse(
        BRepPrimAPI_MakeCylinder(start, radius, start_z - exit_z - bend_radius).Shape(),
        BRepPrimAPI_MakeRevol(section, axis, math.pi / 2, True).Shape(),
        BRepPrimAPI_MakeCylinder(up, radius, end_y - turn_y).Shape(),
    )


def superconic(
    half_width: float, palmar: float, dorsal: float, palmar_weight: float, dorsal_weight: float, spans: Any
) -> TopoDS_Shape:
    """Sew a superconic body from four faces for each span and flat end faces."""
    quadrants: list[tuple[ControlPoint, ...]] = [  # counter-clockwise
        ((half_width, 0, 1), (half_width, dorsal, dorsal_weight), (0, dorsal, 1)),
        ((0, dorsal, 1), (-half_width, dorsal, dorsal_weight), (-half_width, 0, 1)),
        ((-half_width, 0, 1), (-half_width, -palmar, palmar_weight), (0, -palmar, 1)),
        ((0, -palmar, 1), (half_width, -palmar, palmar_weight), (half_width, 0, 1)),
    ]
    faces = [_patch(quadrant, span) for quadrant in quadrants for span in spans]
    faces += [_end(quadrants, *end[:3]) for end in (spans[0][0], spans[-1][-1]) if end[1] > 0.0]
    sewing = BRepBuilderAPI_Sewing(_SEWING_MM)
    for face in faces:
        sewing.Add(face)
    sewing.Perform()
    shell = TopoDS.Shell_s(sewing.SewedShape())
    solid = ShapeFix_Solid().SolidFromShell(shell)
    # The shell may have been sewn with its faces pointing inwards.
    return solid if volume(solid) > 0 else ShapeFix_Solid().SolidFromShell(TopoDS.Shell_s(shell.Reversed()))


def _patch(quadrant: Sequence[ControlPoint], span: Any) -> Any:
    """Create a rational Bezier face: the tensor product of an arc of the section with a span."""
    poles = TColgp_Array2OfPnt(1, len(quadrant), 1, len(span))
    weights = TColStd_Array2OfReal(1, len(quadrant), 1, len(span))
    for i, (x, y, w) in enumerate(quadrant, 1):
        for j, (z, scale, palmar, v) in enumerate(span, 1):
            poles.SetValue(i, j, gp_Pnt(x * scale, y * (palmar if y < 0 else scale), z))
            weights.SetValue(i, j, w * v)
    return BRepBuilderAPI_MakeFace(Geom_BezierSurface(poles, weights), _SEWING_MM).Face()


def _end(quadrants: Any, z: float, scale: float, palmar: float) -> Any:
    """Create the flat end face at height `z` [mm], bounded by the section's four arcs."""
    rows = ([(x * scale, y * (palmar if y < 0 else scale), w) for x, y, w in quadrant] for quadrant in quadrants)
    return occ.make_face(occ.make_wire([_edge(row, z) for row in rows]))


def drafted_extrusion(outline: Sequence[Sequence[ControlPoint]], low: float, high: float) -> TopoDS_Shape:
    """Extrude the outline of a drafted section: arcs, and straight walls between them."""
    return occ.extrude(occ.make_face(occ.make_wire([_edge(row, low) for row in outline])), (0.0, 0.0, high - low))


def _edge(row: Sequence[ControlPoint], z: float) -> Any:
    """Create an edge in the plane at height `z` [mm] from control points (x, y, weight); two are a straight line."""
    if len(row) == 2:
        return BRepBuilderAPI_MakeEdge(*(gp_Pnt(x, y, z) for x, y, _ in row)).Edge()
    poles, weights = TColgp_Array1OfPnt(1, len(row)), TColStd_Array1OfReal(1, len(row))
    for i, (x, y, w) in enumerate(row, 1):
        poles.SetValue(i, gp_Pnt(x, y, z))
        weights.SetValue(i, w)
    return BRepBuilderAPI_MakeEdge(Geom_BezierCurve(poles, weights)).Edge()


def volume(shape: TopoDS_Shape) -> float:
    """Compute the volume [mm3] of a shape by adaptive Gauss-Kronrod quadrature.

    On a straight superconic prism with an arc of weight 4 the result is exact to 1e-10 mm3 of 4259 mm3. There the
    kernel's plain quadrature (cadquery's `Volume()`) is off by 0.3 mm3, and its adaptive Gauss quadrature with a stated
    tolerance of 1e-6 by 11 mm3.
    """
    properties = GProp_GProps()
    BRepGProp.VolumePropertiesGK_s(shape, properties, 1e-6, False, True, False, False, False)
    return float(properties.Mass())
