"""Primitives of parts as Open CASCADE's shapes, from plain numbers [mm]: the calls of `primitive_calls.call_of`.

The scripts of `fingertip build --formats cq` make the same calls of cadquery (`cadquery_primitives`); a test compares.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakePolygon
from OCP.BRepPrimAPI import BRepPrimAPI_MakeCone, BRepPrimAPI_MakeCylinder, BRepPrimAPI_MakeRevol
from OCP.gp import gp_Ax1, gp_Circ, gp_Dir, gp_Pnt
from OCP.TopoDS import TopoDS_Shape

from fingertip.cad.kernel import occ
from fingertip.cad.kernel.bezier import bezier_edge, sew_superconic
from fingertip.cad.kernel.primitive_calls import ControlPoint
from fingertip.design.geometry.solids import Axis, Point3, axis_point

Point2 = tuple[float, float]

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


def superconic(*form: Any) -> TopoDS_Shape:
    *section, spans = form
    return sew_superconic(section, spans, lambda edges: occ.make_face(occ.make_wire(edges)))


def drafted_extrusion(outline: Sequence[Sequence[ControlPoint]], low: float, high: float) -> TopoDS_Shape:
    """Extrude the outline of a drafted section: arcs, and straight walls between them."""
    return occ.extrude(occ.make_face(occ.make_wire([bezier_edge(row, low) for row in outline])), (0.0, 0.0, high - low))
