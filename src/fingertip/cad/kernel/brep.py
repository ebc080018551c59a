"""Boundary-representation (B-rep) kernel: evaluates solids exactly with Open CASCADE.

A B-rep describes a solid by its faces, each a piece of an exact surface, and by the edges where
they meet; STEP files hold the same description. Superconic bodies become rational Bezier faces,
sewn into a solid. All other faces are planes, cylinders, cones and tori. Lofts and fillets are not
used, because the kernel sometimes returns wrong solids for them without an error.

The primitives are cadquery's, made by `models.workplanes`, which the scripts of `fingertip build
--formats cq` carry too. Booleans are Open CASCADE's own
(`kernel.occ`), with several operands at once and in one thread. This module, these two,
`cad.files.step_writer` and `drawing.hidden_lines` import cadquery or its bindings (OCP) at the top.
Import them only where exact solids are needed, and this module first.
"""

from __future__ import annotations

from functools import reduce
from pathlib import Path

from fingertip.foundation import extras
from fingertip.foundation.errors import GeometryError, Issue, MissingLibraryError
from fingertip.models.solids import (
    Difference,
    Intersection,
    Placed,
    Scaled,
    Shell,
    Solid,
    Union,
    union,
)

try:
    from OCP.BinTools import BinTools
    from OCP.BRep import BRep_Tool
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.gp import gp_Pnt, gp_Trsf
    from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_SOLID, TopAbs_VERTEX, TopAbs_WIRE
    from OCP.TopoDS import TopoDS, TopoDS_Shape
    from OCP.TopTools import TopTools_IndexedMapOfShape

    from fingertip.cad.kernel import occ
    from fingertip.models.workplanes import make_primitive
    from fingertip.models.workplanes import volume as volume
except ImportError as error:
    extras.require("STEP", "cadquery", alternative="leave STEP out with --formats stl,3mf")
    message = (
        f"Open CASCADE cannot be loaded ({error}); on Debian or Ubuntu: "
        "apt-get install libgl1 libx11-6 libexpat1, or leave STEP out with --formats stl,3mf."
    )
    raise MissingLibraryError(Issue("STEP", message)) from error


class BrepEvaluator:
    """Evaluates solids as exact shapes; equal solids are evaluated once."""

    def __init__(self) -> None:
        self._evaluated: dict[Solid, TopoDS_Shape] = {}

    def shape(self, solid: Solid) -> TopoDS_Shape:
        if solid not in self._evaluated:
            self._evaluated[solid] = self._evaluate(solid)

        return self._evaluated[solid]

    def solid(self, solid: Solid) -> TopoDS_Shape:
        """Evaluate a solid as one valid solid. Raises GeometryError."""
        shape = self.shape(solid)
        bodies = occ.list_shapes(shape, TopAbs_SOLID)
        is_valid = BRepCheck_Analyzer(shape).IsValid()

        if len(bodies) != 1 or not is_valid:
            found = f"{len(bodies)} solids, {'valid' if is_valid else 'invalid'}"
            message = (
                f"the B-rep kernel returned {found}; one valid solid was expected; use "
                "--formats stl,3mf."
            )
            raise GeometryError(Issue("", message))

        return bodies[0]

    def _evaluate(self, solid: Solid) -> TopoDS_Shape:
        match solid:
            case Union((Difference(body, removed), Intersection((same, kept)), *others)) if (
                same == body
            ):
                # (A - B) + (A & C) = A - (B - C), which intersects the surface of A once.
                cut = body.cut(union(*removed).cut(kept))
                return self.shape(cut.union(*others))
            case Union(solids):
                return occ.fuse(*(self.shape(s) for s in solids))
            case Intersection(solids):
                return reduce(occ.intersect, [self.shape(s) for s in solids])
            case Difference(first, subtracted):
                return occ.cut(self.shape(first), *(self.shape(s) for s in subtracted))
            case Shell(outer, inside):
                return occ.hollow(self.shape(outer), self.shape(inside))
            case Scaled(inner, factor):
                scaling = gp_Trsf()
                scaling.SetScale(gp_Pnt(), factor)
                return occ.transform(self.shape(inner), scaling)
            case Placed(body, rows):
                return occ.placed(body.brep, rows)
            case _:
                return make_primitive(solid).val().wrapped


def genus(solid: TopoDS_Shape) -> int:
    """Count the through holes G of a solid by the Euler-Poincare formula V - E + F - (L - F) = 2 (1
    - G).

    V, E, F and L are the numbers of vertices, edges, faces and loops (edge cycles that bound
    faces). Cycles that touch in a vertex, such as a bore tangent to the seam between two faces,
    bound a simply connected face and count as one. Degenerate edges, which have no length and occur
    at the tip's apex, are not counted.
    """
    edges = [TopoDS.Edge_s(edge) for edge in occ.list_shapes(solid, TopAbs_EDGE)]
    real_edges = sum(not BRep_Tool.Degenerated_s(edge) for edge in edges)
    faces = occ.list_shapes(solid, TopAbs_FACE)
    loops = sum(_count_loops(face) for face in faces)

    return (
        1 - (len(occ.list_shapes(solid, TopAbs_VERTEX)) - real_edges + 2 * len(faces) - loops) // 2
    )


def _count_loops(face: TopoDS_Shape) -> int:
    """Count the connected pieces of a face's boundary."""
    wires = occ.list_shapes(face, TopAbs_WIRE)
    if len(wires) == 1:
        return 1

    numbers = TopTools_IndexedMapOfShape()
    pieces: list[set[int]] = []

    for wire in wires:
        vertices = {numbers.Add(vertex) for vertex in occ.list_shapes(wire, TopAbs_VERTEX)}
        touched = [piece for piece in pieces if piece & vertices]
        pieces = [piece for piece in pieces if piece not in touched] + [vertices.union(*touched)]

    return len(pieces)


def save(shape: TopoDS_Shape, path: Path) -> None:
    """Write a shape to a file in Open CASCADE's binary format, without loss."""
    BinTools.Write_s(shape, str(path))


def load(path: Path) -> TopoDS_Shape:
    shape = TopoDS_Shape()
    BinTools.Read_s(shape, str(path))
    return shape
