"""Mesh kernel: evaluates solids as closed triangle meshes.

Primitives are tessellated by `cad.kernel.tessellate`; manifold3d computes the booleans. A mesh
approximates curved surfaces within a stated tolerance. STL and 3MF files, the checks and the sweeps
are made from these meshes.
"""

from __future__ import annotations

import importlib
import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fingertip.cad.kernel.tessellate import Triangles, tessellate
from fingertip.foundation.errors import DesignError, GeometryError, Issue
from fingertip.foundation.interruption import hold_interruptions
from fingertip.foundation.numerics import Array
from fingertip.models.solids import Difference, Intersection, Scaled, Shell, Solid, Union

if TYPE_CHECKING:
    import manifold3d

Manifold: TypeAlias = "manifold3d.Manifold"
MIN_TOLERANCE_MM = 0.0005
MAX_TOLERANCE_MM = 1.0
GRID_MM = 2.0**-17
"""Spacing of the grid to which vertices are rounded [mm]. Binary32 numbers, as in STL, hold
multiples of it exactly up to 128 mm. An STL file therefore holds the mesh itself, and rounding
errors of floating-point arithmetic do not reach the files.
"""
_SHORT_EDGE_MM = 8 * GRID_MM
MIN_TRIANGLE_HEIGHT_MM = 1e-6
"""Height below which a triangle counts as degenerate:
single-precision files cannot represent its area [mm].
"""


@dataclass(frozen=True)
class Mesh:
    """Closed triangle mesh in canonical order, so that the same solid always gives the
    same bytes.
    """

    vertices: Array
    """Coordinates, shape (n, 3) [mm]."""
    triangles: Triangles
    """Vertex indices, shape (m, 3), counter-clockwise seen from outside."""

    def volume(self) -> float:
        """Compute the volume [mm3], by the divergence theorem; negative if the mesh is
        inside out.
        """
        a, b, c = (self.vertices[self.triangles[:, i]] for i in range(3))
        return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)

    def area(self) -> float:
        a, b, c = (self.vertices[self.triangles[:, i]] for i in range(3))
        return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0)


class MeshEvaluator:
    """Evaluates solids as meshes at one tolerance; equal solids are evaluated once."""

    def __init__(self, tolerance_mm: float) -> None:
        """Raise a `DesignError` unless meshes can be made at this tolerance [mm]."""
        if not MIN_TOLERANCE_MM <= tolerance_mm <= MAX_TOLERANCE_MM:
            bounds = f"choose {MIN_TOLERANCE_MM:g} to {MAX_TOLERANCE_MM:g} mm"
            message = (
                f"{tolerance_mm:g} mm is out of bounds; {bounds}; 0.01 is finer than the "
                "resolution of a printer."
            )
            raise DesignError(Issue("--tolerance-mm", message))

        self.tolerance_mm = tolerance_mm
        self._evaluated: dict[Solid, Manifold] = {}
        self._canonical: dict[Solid, Mesh] = {}

    def manifold(self, solid: Solid) -> Manifold:
        """Evaluate a solid as a `manifold3d.Manifold`. Raises GeometryError."""
        found = self._evaluated.get(solid)
        if found is None:
            found = self._evaluated[solid] = self._evaluate(solid)

        return found

    def mesh(self, solid: Solid) -> Mesh:
        """Evaluate a solid as a mesh on the vertex grid, in canonical order.

        Raises GeometryError.
        """
        manifold = self.manifold(solid)
        if solid not in self._canonical:
            self._canonical[solid] = to_canonical_mesh(manifold)

        return self._canonical[solid]

    def _evaluate(self, solid: Solid) -> Manifold:
        load_manifold()
        from manifold3d import Manifold, OpType  # noqa: PLC0415

        match solid:
            case Union(solids):
                result = Manifold.batch_boolean([self.manifold(s) for s in solids], OpType.Add)
            case Intersection(solids):
                result = Manifold.batch_boolean(
                    [self.manifold(s) for s in solids], OpType.Intersect
                )
            case Difference(Difference(first, before), subtracted):
                return self.manifold(Difference(first, (*before, *subtracted)))
            case Difference(first, subtracted):
                result = Manifold.batch_boolean(
                    [self.manifold(s) for s in (first, *subtracted)], OpType.Subtract
                )
            case Shell(outer, inside):
                result = self.manifold(outer) - self.manifold(inside)
            case Scaled(inner, factor):
                result = self.manifold(inner).scale((factor, factor, factor))
            case primitive:
                result = to_manifold(*tessellate(primitive, self.tolerance_mm))
                if result.volume() <= 0.0:  # manifold3d accepts an inverted mesh silently
                    raise GeometryError(
                        Issue("", f"{primitive} has an inverted mesh; this is a bug in fingertip.")
                    )

        _raise_unless_valid(result)
        return result


def load_manifold() -> None:
    """Import manifold3d.

    An exception of a signal handler within its import would abort the process.
    """
    if "manifold3d" not in sys.modules:
        with hold_interruptions():
            importlib.import_module("manifold3d")


def to_manifold(vertices: Array, triangles: Triangles) -> Manifold:
    """Create a `manifold3d.Manifold` from arrays, in double precision."""
    load_manifold()
    from manifold3d import Manifold, Mesh64  # noqa: PLC0415

    return Manifold(
        Mesh64(np.ascontiguousarray(vertices), np.ascontiguousarray(triangles, dtype=np.uint64))
    )


def to_arrays(manifold: Manifold) -> tuple[Array, Triangles]:
    """Return vertices and triangles of a `manifold3d.Manifold`, as it numbers them."""
    raw: Any = manifold.to_mesh64()
    return np.asarray(raw.vert_properties, dtype=np.float64)[:, :3], np.asarray(
        raw.tri_verts, dtype=np.int64
    )


def to_canonical_mesh(manifold: Manifold) -> Mesh:
    """Convert a `manifold3d.Manifold` to a mesh on the vertex grid, in canonical order.

    Vertices are rounded to the grid and sorted. Triangles start at their smallest index and are
    sorted.

    Booleans leave very short edges, which are collapsed first. Where manifold3d does not collapse
    one, both its ends may round to the same grid point, or span a triangle without area. Readers of
    the file would merge these two vertices or drop the triangle, so they are merged here, and the
    triangles between them are removed.
    """
    simplified = manifold.simplify(_SHORT_EDGE_MM)
    _raise_unless_valid(simplified)
    vertices, corners = to_arrays(simplified)
    vertices = np.round(vertices / GRID_MM) * GRID_MM + 0.0
    _join_slivers(vertices, corners)
    vertices, rank = join_equal(vertices)
    # Renumber the triangles, drop those that have become degenerate, and bring them into canonical
    # order.
    triangles = rank[corners]
    triangles = triangles[(triangles != np.roll(triangles, 1, axis=1)).all(axis=1)]
    smallest = triangles.argmin(axis=1)
    triangles = np.take_along_axis(triangles, (smallest[:, None] + np.arange(3)) % 3, axis=1)
    triangles = triangles[~_find_flaps(triangles)]

    return Mesh(vertices, triangles[np.argsort(_number_triples(triangles))])


def join_equal(points: Array) -> tuple[Array, NDArray[np.int64]]:
    """Sort points and join equal ones; return them, and the number of each point among them."""
    order = np.lexsort(points.T[::-1])  # np.unique of rows takes four times as long
    ordered = points[order]
    is_first = np.ones(len(order), dtype=bool)
    is_first[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    number = np.empty(len(order), dtype=np.int64)
    number[order] = np.cumsum(is_first) - 1

    return ordered[is_first], number


def _find_flaps(triangles: Triangles) -> NDArray[np.bool_]:
    """Find pairs of triangles on the same vertices, one the
    reverse of the other: sheets without volume.
    """
    return np.isin(_number_triples(triangles), _number_triples(triangles[:, [0, 2, 1]]))


def _number_triples(triangles: Triangles) -> NDArray[np.int64]:
    """Number triples of indices, such that numbers are in the order of the triples."""
    size = int(triangles.max(initial=0)) + 1
    return np.asarray((triangles[:, 0] * size + triangles[:, 1]) * size + triangles[:, 2])


def find_degenerate_triangles(vertices: Array, triangles: Triangles) -> Triangles:
    """Find triangles without area, as a vertex on an edge leaves them; return their numbers."""
    corners = vertices[triangles]
    sides = np.roll(corners, -1, axis=1) - corners
    twice_area = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    longest = np.sqrt(np.max(np.einsum("ijk,ijk->ij", sides, sides), axis=1))

    return np.flatnonzero(twice_area <= MIN_TRIANGLE_HEIGHT_MM * longest)


def _join_slivers(vertices: Array, triangles: Triangles) -> None:
    """Move both ends of the short edge of each triangle without area to one point, in place."""
    for number in find_degenerate_triangles(vertices, triangles):
        a, b, c = triangles[number]
        length, i, j = min(
            (float(np.linalg.norm(vertices[i] - vertices[j])), i, j)
            for i, j in ((a, b), (b, c), (c, a))
        )
        if length <= _SHORT_EDGE_MM:
            vertices[j] = vertices[i]


def _raise_unless_valid(manifold: Manifold) -> None:
    from manifold3d import Error  # noqa: PLC0415

    status = manifold.status()
    if status != Error.NoError:
        raise GeometryError(
            Issue("", f"the mesh kernel rejected a solid ({status}); this is a bug in fingertip.")
        )
