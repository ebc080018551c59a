"""The mesh kernel: evaluates an expression with numpy grids and manifold3d's booleans. STL, 3MF, checks and sweeps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fingertip.cad.kernel.tessellate import Triangles, Vertices, tessellate
from fingertip.cad.solids import Difference, Intersection, Scaled, Solid, Union
from fingertip.errors import GeometryError, Issue

if TYPE_CHECKING:
    from manifold3d import Manifold

GRID_MM = 2.0**-17
"""Vertices are rounded to this grid [mm], which binary32 holds exactly up to 128 mm: the STL is the mesh, not an
approximation of it, and two kernels' last bits never reach the files."""


@dataclass(frozen=True)
class Mesh:
    """A closed triangle mesh, in canonical order: equal shapes of one evaluation have equal bytes."""

    vertices: Vertices
    """(n, 3) [mm]"""
    triangles: Triangles
    """(m, 3), counter-clockwise seen from outside"""

    def volume(self) -> float:
        """Signed volume [mm3]."""
        a, b, c = (self.vertices[self.triangles[:, i]] for i in range(3))
        return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)

    def area(self) -> float:
        """Surface area [mm2]."""
        a, b, c = (self.vertices[self.triangles[:, i]] for i in range(3))
        return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0)


class Evaluator:
    """Evaluates expressions at one tolerance; solids that occur more than once are evaluated once."""

    def __init__(self, tolerance_mm: float) -> None:
        self.tolerance_mm = tolerance_mm
        self._done: dict[Solid, Manifold] = {}

    def manifold(self, solid: Solid) -> Manifold:
        """The solid as a manifold3d object.

        Raises
        ------
        GeometryError
            If the kernel refuses a primitive or a boolean.
        """
        if solid not in self._done:
            self._done[solid] = self._evaluate(solid)
        return self._done[solid]

    def mesh(self, solid: Solid) -> Mesh:
        """The solid as a mesh on the grid, in canonical order."""
        return canonical(self.manifold(solid))

    def _evaluate(self, solid: Solid) -> Manifold:
        from manifold3d import Manifold, OpType

        match solid:
            case Union(solids):
                result = Manifold.batch_boolean([self.manifold(s) for s in solids], OpType.Add)
            case Intersection(solids):
                result = Manifold.batch_boolean([self.manifold(s) for s in solids], OpType.Intersect)
            case Difference(first, without):
                result = Manifold.batch_boolean([self.manifold(s) for s in (first, *without)], OpType.Subtract)
            case Scaled(inner, factor):
                result = self.manifold(inner).scale((factor, factor, factor))
            case primitive:
                result = to_manifold(*tessellate(primitive, self.tolerance_mm))
                if result.volume() <= 0.0:  # the kernel itself takes a mesh turned inside out without a word
                    raise GeometryError(Issue("", f"{primitive} is inside out; this is a bug in fingertip."))
        _raise_unless_valid(result)
        return result


def to_manifold(vertices: Vertices, triangles: Triangles) -> Manifold:
    """A manifold3d object from arrays, in double precision."""
    from manifold3d import Manifold, Mesh64

    return Manifold(Mesh64(np.ascontiguousarray(vertices), np.ascontiguousarray(triangles, dtype=np.uint64)))


def canonical(manifold: Manifold) -> Mesh:
    """Vertices on the grid and sorted, triangles turned to their smallest index first and sorted.

    Short edges left by booleans are collapsed first. Those the kernel would not collapse may end on one grid point: a
    reader takes both ends for one, so they are one here, and the triangles between them are gone.
    """
    smooth = manifold.simplify(8 * GRID_MM)
    _raise_unless_valid(smooth)
    raw: Any = smooth.to_mesh64()
    vertices = np.round(np.asarray(raw.vert_properties, dtype=np.float64)[:, :3] / GRID_MM) * GRID_MM + 0.0
    order = np.lexsort(vertices.T[::-1])
    vertices = vertices[order]
    distinct = np.ones(len(order), dtype=bool)
    distinct[1:] = (vertices[1:] != vertices[:-1]).any(axis=1)
    rank = np.empty(len(order), dtype=np.int64)
    rank[order] = np.cumsum(distinct) - 1
    triangles = rank[np.asarray(raw.tri_verts, dtype=np.int64)]
    triangles = triangles[(triangles != np.roll(triangles, 1, axis=1)).all(axis=1)]
    first = triangles.argmin(axis=1)
    triangles = np.take_along_axis(triangles, (first[:, None] + np.arange(3)) % 3, axis=1)
    return Mesh(vertices[distinct], triangles[np.lexsort(triangles.T[::-1])])


def _raise_unless_valid(manifold: Manifold) -> None:
    from manifold3d import Error

    status = manifold.status()
    if status != Error.NoError:
        raise GeometryError(Issue("", f"the mesh kernel refused a solid ({status}); this is a bug in fingertip."))
