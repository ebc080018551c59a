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
from OCP.BRep import BRep_Builder
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepAlgoAPI import BRepAlgoAPI_Common, BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_Transform
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
from OCP.BRepTools import BRepTools
from OCP.GeomAbs import GeomAbs_Plane
from OCP.gp import gp, gp_Pln, gp_Pnt, gp_Trsf
from OCP.ShapeFix import ShapeFix_Solid
from OCP.TopAbs import TopAbs_COMPOUND, TopAbs_FACE
from OCP.TopExp import TopExp
from OCP.TopoDS import TopoDS, TopoDS_Iterator, TopoDS_Shape, TopoDS_Shell
from OCP.TopTools import TopTools_IndexedMapOfShape, TopTools_ListOfShape

from fingertip.models.solids import Point3

Point2 = tuple[float, float]
_IN_PLANE_MM = 1e-5
"""Distance within which a face lies in a plane [mm]."""
_PARALLEL_RAD = 1e-9
"""Angle within which two directions are parallel [rad]."""


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


def hollow(outer: TopoDS_Shape, inside: TopoDS_Shape) -> TopoDS_Shape:
    """Cut a shape out of one that ends in the plane z = 0, where alone both meet.

    All faces are taken over as they are but the end of the outer one, which gets holes.
    """
    (end,), walls = _part_faces(outer)
    openings, inner_walls = _part_faces(cut(inside, _half_space_below()))
    rim = BRepBuilderAPI_MakeFace(TopoDS.Face_s(end))

    for opening in openings:
        wire = BRepTools.OuterWire_s(TopoDS.Face_s(opening))
        is_same = opening.Orientation() == end.Orientation()
        rim.Add(TopoDS.Wire_s(wire.Reversed()) if is_same else wire)

    builder = BRep_Builder()
    shell = TopoDS_Shell()
    builder.MakeShell(shell)
    for face in (*walls, *(wall.Reversed() for wall in inner_walls), rim.Face()):
        builder.Add(shell, face)

    shell.Closed(True)
    return ShapeFix_Solid().SolidFromShell(shell)


def _part_faces(shape: TopoDS_Shape) -> tuple[list[TopoDS_Shape], list[TopoDS_Shape]]:
    """Part the faces of a shape into those in the plane z = 0, and all others."""
    in_plane: list[TopoDS_Shape] = []
    others: list[TopoDS_Shape] = []
    for face in list_shapes(shape, TopAbs_FACE):
        surface = BRepAdaptor_Surface(TopoDS.Face_s(face))
        is_flat = surface.GetType() == GeomAbs_Plane and _is_at_zero(surface.Plane())
        (in_plane if is_flat else others).append(face)

    return in_plane, others


def _is_at_zero(plane: gp_Pln) -> bool:
    is_across_z = plane.Axis().Direction().IsParallel(gp.DZ_s(), _PARALLEL_RAD)
    return bool(is_across_z and plane.Contains(gp.Origin_s(), _IN_PLANE_MM))


def _half_space_below() -> TopoDS_Shape:
    """Build what is below z = 0, larger than any part."""
    far = 1000.0
    return BRepPrimAPI_MakeBox(gp_Pnt(-far, -far, -far), gp_Pnt(far, far, 0.0)).Shape()


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
