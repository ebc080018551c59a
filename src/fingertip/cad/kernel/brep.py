"""Boundary-representation (B-rep) kernel: evaluates solids exactly with cadquery (Open CASCADE).

A B-rep describes a solid by its faces, each a piece of an exact surface, and by the edges where they meet; STEP files
hold the same description. Superconic bodies become rational Bezier faces, sewn into a solid. All other faces are
planes, cylinders, cones and tori. Lofts and fillets are not used, because the kernel sometimes returns wrong solids for
them without an error.

Only this module, `cad.files.step_writer` and `drawing.hidden_lines` import cadquery at the top. Import them only where
exact solids are needed.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from fingertip.cad.kernel.primitive_calls import call_of
from fingertip.design.geometry.solids import Difference, Intersection, Placed, Scaled, Solid, Union
from fingertip.foundation import extras
from fingertip.foundation.errors import GeometryError, Issue, MissingLibraryError

try:
    import cadquery as cq
    from OCP.BinTools import BinTools
    from OCP.BRep import BRep_Tool
    from OCP.TopoDS import TopoDS_Shape

    from fingertip.cad.kernel import cadquery_primitives
    from fingertip.cad.kernel.cadquery_primitives import volume as volume
except ImportError as error:
    extras.require("STEP", "cadquery", alternative="leave STEP out with --formats stl,3mf")
    message = (
        f"cadquery cannot be loaded ({error}); on Debian or Ubuntu: apt-get install libgl1 libx11-6 libexpat1, or "
        "leave STEP out with --formats stl,3mf."
    )
    raise MissingLibraryError(Issue("STEP", message)) from error


class BrepEvaluator:
    """Evaluates solids as exact shapes; equal solids are evaluated once."""

    def __init__(self) -> None:
        self._evaluated: dict[Solid, Any] = {}

    def shape(self, solid: Solid) -> Any:
        """Evaluate a solid as a `cadquery.Shape`."""
        if solid not in self._evaluated:
            self._evaluated[solid] = self._evaluate(solid)
        return self._evaluated[solid]

    def solid(self, solid: Solid) -> cq.Solid:
        """Evaluate a solid as one valid `cadquery.Solid`. Raises GeometryError."""
        shape = self.shape(solid)
        bodies = shape.Solids()
        if len(bodies) != 1 or not shape.isValid():
            found = f"{len(bodies)} solids, {'valid' if shape.isValid() else 'invalid'}"
            message = f"the B-rep kernel returned {found}; one valid solid was expected; use --formats stl,3mf."
            raise GeometryError(Issue("", message))
        return bodies[0]

    def _evaluate(self, solid: Solid) -> Any:
        match solid:
            case Union(solids):
                first, *others = (self.shape(s) for s in solids)
                return first.fuse(*others)
            case Intersection(solids):
                first, *others = (self.shape(s) for s in solids)
                for other in others:
                    first = first.intersect(other)
                return first
            case Difference(first, subtracted):
                return self.shape(first).cut(*(self.shape(s) for s in subtracted))
            case Scaled(inner, factor):
                return self.shape(inner).scale(factor)
            case Placed(inner, turns, shift):
                turned = self.shape(inner).rotate(cq.Vector(), cq.Vector(1, 0, 0), 90.0 * turns)
                return turned.translate(cq.Vector(*shift))
            case _:
                name, arguments = call_of(solid)
                return getattr(cadquery_primitives, name)(*arguments)


def assemble(title: str, parts: Iterable[tuple[str, cq.Solid, tuple[float, float, float]]]) -> cq.Assembly:
    assembly = cq.Assembly(name=title)
    for name, solid, colour in parts:
        assembly.add(solid, name=name, color=cq.Color(*colour))
    return assembly


def genus(solid: Any) -> int:
    """Count the through holes G of a solid by the Euler-Poincare formula V - E + F - (L - F) = 2 (1 - G).

    V, E, F and L are the numbers of vertices, edges, faces and loops (edge cycles that bound faces). Cycles that touch
    in a vertex, such as a bore tangent to the seam between two faces, bound a simply connected face and count as one.
    Degenerate edges, which have no length and occur at the tip's apex, are not counted.
    """
    edges = sum(not BRep_Tool.Degenerated_s(edge.wrapped) for edge in solid.Edges())
    faces = solid.Faces()
    loops = sum(_count_loops(face) for face in faces)
    return 1 - (len(solid.Vertices()) - edges + 2 * len(faces) - loops) // 2


def _count_loops(face: Any) -> int:
    """Count the connected pieces of a face's boundary."""
    pieces: list[set[Any]] = []
    for wire in face.Wires():
        vertices = set(wire.Vertices())
        touched = [piece for piece in pieces if piece & vertices]
        pieces = [piece for piece in pieces if piece not in touched] + [vertices.union(*touched)]
    return len(pieces)


def save(shape: Any, path: Path) -> None:
    """Write a shape to a file in Open CASCADE's binary format, without loss."""
    BinTools.Write_s(shape.wrapped, str(path))


def load(path: Path) -> Any:
    shape = TopoDS_Shape()
    BinTools.Read_s(shape, str(path))
    return cq.Shape.cast(shape)
