"""Operations of Open CASCADE on shapes, and the primitives of parts from plain numbers [mm].

The order of what a boolean combines decides the order of the faces in STEP files. The primitives are the calls of
`solids.call_of`; scripts of `fingertip build --formats cq` make the same calls of cadquery
(`cadquery_primitives`), and a test compares.
"""

from __future__ import annotations

import io
import math
from collections.abc import Iterable, Sequence
from typing import Any

from OCP.BinTools import BinTools
from OCP.Bnd import Bnd_Box
from OCP.BRepAlgoAPI import BRepAlgoAPI_Common, BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeEdge,
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakePolygon,
    BRepBuilderAPI_MakeWire,
    BRepBuilderAPI_Transform,
)
from OCP.BRepPrimAPI import (
    BRepPrimAPI_MakeBox,
    BRepPrimAPI_MakeCone,
    BRepPrimAPI_MakeCylinder,
    BRepPrimAPI_MakePrism,
    BRepPrimAPI_MakeRevol,
)
from OCP.gp import gp_Ax1, gp_Ax2, gp_Circ, gp_Dir, gp_Pnt, gp_Trsf, gp_Vec
from OCP.ShapeFix import ShapeFix_Face, ShapeFix_Shape
from OCP.TopAbs import TopAbs_COMPOUND
from OCP.TopExp import TopExp
from OCP.TopoDS import TopoDS, TopoDS_Face, TopoDS_Iterator, TopoDS_Shape, TopoDS_Wire
from OCP.TopTools import TopTools_IndexedMapOfShape, TopTools_ListOfShape

from fingertip.cad.kernel.bezier import sew_superconic
from fingertip.design.geometry.solids import Axis, Point3, axis_point

Point2 = tuple[float, float]


def list_shapes(shape: TopoDS_Shape, kind: Any) -> list[TopoDS_Shape]:
    """List the subshapes of one kind, such as `TopAbs_FACE`, each once."""
    found = TopTools_IndexedMapOfShape()
    TopExp.MapShapes_s(shape, kind, found)
    return list(found)


def bounds(shape: TopoDS_Shape) -> tuple[Point3, Point3]:
    """Find the lowest and the highest corner of a shape's bounding box [mm]."""
    box = Bnd_Box()
    BRepBndLib.AddOptimal_s(shape, box)
    x, y, z, *high = box.Get()
    return (x, y, z), (high[0], high[1], high[2])


def fuse(*shapes: TopoDS_Shape) -> TopoDS_Shape:
    first, *others = [*_members(shapes[0]), *shapes[1:]]
    return _combine(BRepAlgoAPI_Fuse(), [first], others)


def intersect(shape: TopoDS_Shape, other: TopoDS_Shape) -> TopoDS_Shape:
    return _combine(BRepAlgoAPI_Common(), _members(shape), [other])


def cut(shape: TopoDS_Shape, *others: TopoDS_Shape) -> TopoDS_Shape:
    return _combine(BRepAlgoAPI_Cut(), _members(shape), others)


def _members(shape: TopoDS_Shape) -> list[TopoDS_Shape]:
    """List what a boolean has returned, which is a compound."""
    if shape.ShapeType() != TopAbs_COMPOUND:
        return [shape]
    members, iterator = [], TopoDS_Iterator(shape)
    while iterator.More():
        members.append(iterator.Value())
        iterator.Next()
    return members


def _combine(operation: Any, arguments: Iterable[TopoDS_Shape], tools: Iterable[TopoDS_Shape]) -> TopoDS_Shape:
    operation.SetArguments(_list_of_shapes(arguments))
    operation.SetTools(_list_of_shapes(tools))
    operation.Build()
    return operation.Shape()


def _list_of_shapes(shapes: Iterable[TopoDS_Shape]) -> TopTools_ListOfShape:
    listed = TopTools_ListOfShape()
    for shape in shapes:
        listed.Append(shape)
    return listed


def transform(shape: TopoDS_Shape, transformation: gp_Trsf) -> TopoDS_Shape:
    return BRepBuilderAPI_Transform(shape, transformation, True).Shape()


def box(low: Point3, high: Point3) -> TopoDS_Shape:
    sides = (b - a for a, b in zip(low, high, strict=True))
    return BRepPrimAPI_MakeBox(axes(low, (0.0, 0.0, 1.0)), *sides).Shape()


def axes(origin: Point3, direction: Point3) -> gp_Ax2:
    return gp_Ax2(gp_Pnt(*origin), gp_Dir(*direction))


def make_wire(edges: Iterable[TopoDS_Shape]) -> TopoDS_Wire:
    builder = BRepBuilderAPI_MakeWire()
    builder.Add(_list_of_shapes(edges))
    return builder.Wire()


def make_face(outline: TopoDS_Wire, holes: Sequence[TopoDS_Wire] = ()) -> TopoDS_Face:
    """Make the face in the plane of an outline."""
    fixed = ShapeFix_Shape(outline)  # as cadquery does: it decides the last bits of the plane
    fixed.Perform()
    builder = BRepBuilderAPI_MakeFace(TopoDS.Wire_s(fixed.Shape()), True)
    for hole in holes:
        builder.Add(hole)
    fix = ShapeFix_Face(builder.Face())
    fix.FixOrientation()
    fix.Perform()
    return fix.Result()


def extrude(face: TopoDS_Face, along: Point3) -> TopoDS_Shape:
    return BRepPrimAPI_MakePrism(face, gp_Vec(*along), True).Shape()


def cylinder(axis: Axis, centre: Point2, low: float, high: float, radius: float) -> TopoDS_Shape:
    base = axes(axis_point(axis, *centre, low), axis_point(axis, 0.0, 0.0, 1.0))
    return BRepPrimAPI_MakeCylinder(base, radius, high - low).Shape()


def cone(axis: Axis, centre: Point2, low: float, high: float, low_radius: float, high_radius: float) -> TopoDS_Shape:
    base = axes(axis_point(axis, *centre, low), axis_point(axis, 0.0, 0.0, 1.0))
    return BRepPrimAPI_MakeCone(base, low_radius, high_radius, high - low).Shape()


def prism(axis: Axis, corners: Sequence[Point2], low: float, high: float, holes: Any = ()) -> TopoDS_Shape:
    outline, *inner = (_polygon([axis_point(axis, u, v, low) for u, v in ring]) for ring in (corners, *holes))
    return extrude(make_face(outline, inner), axis_point(axis, 0.0, 0.0, high - low))


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
    start = axes((0.0, start_y, start_z), (0.0, 0.0, -1.0))
    circle = gp_Circ(axes((0.0, start_y, turn_z), (0.0, 0.0, -1.0)), radius)
    section = make_face(make_wire([BRepBuilderAPI_MakeEdge(circle).Edge()]))
    axis = gp_Ax1(gp_Pnt(-1.0, turn_y, turn_z), gp_Dir(1.0, 0.0, 0.0))
    up = axes((0.0, turn_y, exit_z), (0.0, 1.0, 0.0))
    return fuse(
        BRepPrimAPI_MakeCylinder(start, radius, start_z - exit_z - bend_radius).Shape(),
        BRepPrimAPI_MakeRevol(section, axis, math.pi / 2, True).Shape(),
        BRepPrimAPI_MakeCylinder(up, radius, end_y - turn_y).Shape(),
    )


def placed(brep: bytes, rows: Sequence[Sequence[float]]) -> TopoDS_Shape:
    shape, motion = TopoDS_Shape(), gp_Trsf()
    BinTools.Read_s(shape, io.BytesIO(brep))
    motion.SetValues(*(number for row in rows for number in row))
    return transform(shape, motion)


def superconic(section: Sequence[float], spans: Any) -> TopoDS_Shape:
    return sew_superconic(section, spans, lambda edges: make_face(make_wire(edges)))
