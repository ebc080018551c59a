"""Operations of Open CASCADE on shapes.

The primitives of parts are made by cadquery, in `models.workplanes`.

The order of what a boolean combines decides the order of the faces in STEP files.
"""

from __future__ import annotations

import io
from collections.abc import Iterable, Sequence
from typing import Any

from OCP.BinTools import BinTools
from OCP.Bnd import Bnd_Box
from OCP.BRepAlgoAPI import BRepAlgoAPI_Common, BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepBuilderAPI import BRepBuilderAPI_Transform
from OCP.gp import gp_Trsf
from OCP.TopAbs import TopAbs_COMPOUND
from OCP.TopExp import TopExp
from OCP.TopoDS import TopoDS_Iterator, TopoDS_Shape
from OCP.TopTools import TopTools_IndexedMapOfShape, TopTools_ListOfShape

from fingertip.models.solids import Point3

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

    members = []
    iterator = TopoDS_Iterator(shape)
    while iterator.More():
        members.append(iterator.Value())
        iterator.Next()

    return members


def _combine(
    operation: Any, arguments: Iterable[TopoDS_Shape], tools: Iterable[TopoDS_Shape]
) -> TopoDS_Shape:
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


def placed(brep: bytes, rows: Sequence[Sequence[float]]) -> TopoDS_Shape:
    shape = TopoDS_Shape()
    motion = gp_Trsf()
    BinTools.Read_s(shape, io.BytesIO(brep))
    motion.SetValues(*(number for row in rows for number in row))

    return transform(shape, motion)
