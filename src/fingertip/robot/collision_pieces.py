"""Convex pieces of a finger's skin, by which simulators find collisions.

The pieces are slices along the finger, each its convex hull. The skin is cut where its hull is
farthest from it, until the pieces are near enough. A plate that lies on two of them meets two
contacts, and so twice the stiffness: pieces are few, and none ends where a plate touches the pad.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator, to_arrays, to_canonical_mesh
from fingertip.design import Design
from fingertip.foundation.numerics import Array
from fingertip.models.outline import skin_outline

if TYPE_CHECKING:
    from manifold3d import Manifold

WANTED_MM = 0.15
"""Distance to the skin at which no further cut is made."""
MAX_PIECES = 4
FACET_MM = 0.03
"""Tolerance of the mesh that is cut."""
_EXACT_MM = 0.005
"""Tolerance of the mesh that stands for the skin's true surface."""
_MIN_LENGTH_MM = 1.0
"""Least length of a piece."""
_GRID_MM = 2.0**-10
"""Grid on which points of a hull lie."""
_SLIVER_MM = 0.005
"""Height of a triangle below which its plane says nothing; its neighbours lie as near."""
_FLAT = 0.99
"""A facet whose normal has at least this component along the finger is a cut, or the skin's end."""
_BLOCK = 2000
"""Points that are measured at once: a table of all points by all planes would not fit the memory.
"""


def cut_skin(design: Design) -> tuple[tuple[Mesh, ...], float]:
    """Cut the skin, filled with what lies in it, into convex pieces.

    Returns the pieces, and the greatest distance of their outside to the skin's surface [mm].
    """
    outline = skin_outline(design)
    body = MeshEvaluator(FACET_MM).manifold(outline)
    surface = MeshEvaluator(_EXACT_MM).mesh(outline).vertices
    dims = design.dimensions
    last_cut_mm = dims.sensor_z - dims.sensor.active_diameter_mm / 2
    cuts = [0.0, design.skin.length_mm]

    while True:
        pieces = [_slice(body, low, high) for low, high in itertools.pairwise(cuts)]
        distances = _measure_distances(pieces, cuts, surface)
        worst = int(distances.argmax())
        largest = float(distances[worst])

        cut = min(round(float(surface[worst, 2]), 3), last_cut_mm)
        is_short = min(abs(cut - end) for end in cuts) < _MIN_LENGTH_MM
        if largest <= WANTED_MM or len(pieces) == MAX_PIECES or is_short:
            return tuple(pieces), largest

        cuts = sorted([*cuts, cut])


def _slice(body: Manifold, low: float, high: float) -> Mesh:
    """Make the convex hull of a body between two heights."""
    above = body.trim_by_plane((0.0, 0.0, 1.0), low)
    slab = above.trim_by_plane((0.0, 0.0, -1.0), -high)
    # The hull of manifold3d folds where points are not rounded first.
    vertices, *_ = to_arrays(slab)
    points = np.unique(np.round(vertices / _GRID_MM), axis=0) * _GRID_MM
    return to_canonical_mesh(slab.hull_points(points))


def _measure_distances(pieces: Sequence[Mesh], cuts: Sequence[float], points: Array) -> Array:
    """Measure how far points of the true surface lie from the outside of their pieces [mm].

    Distances are those to the planes of the facets. They are exact for a point inside a piece, and
    for one outside that lies before a facet, as those of a smooth surface do.
    """
    distances = np.zeros(len(points))
    z = points[:, 2]

    for piece, (low, high) in zip(pieces, itertools.pairwise(cuts), strict=True):
        normals, offsets = _list_side_planes(piece, is_last=high == cuts[-1])
        within = np.flatnonzero((z > low) & (z <= high))

        for block in np.array_split(within, 1 + len(within) // _BLOCK):
            distances[block] = np.abs((points[block] @ normals.T - offsets).max(axis=1))

    return distances


def _list_side_planes(piece: Mesh, is_last: bool) -> tuple[Array, Array]:
    """List the planes of the facets that stand for the skin: normals, and offsets.

    Slivers are left out, and so are the facets of cuts; the last piece ends in the skin's own tip.
    """
    a, b, c = (piece.vertices[piece.triangles[:, i]] for i in range(3))
    normals = np.cross(b - a, c - a)
    twice_area = np.linalg.norm(normals, axis=1)
    normals /= twice_area[:, None]
    lengths = [np.linalg.norm(edge, axis=1) for edge in (a - b, b - c, c - a)]
    is_sliver = twice_area <= _SLIVER_MM * np.max(lengths, axis=0)

    is_cut = normals[:, 2] <= -_FLAT
    if not is_last:
        is_cut = np.abs(normals[:, 2]) >= _FLAT

    sides = ~is_cut & ~is_sliver
    return normals[sides], np.einsum("ij,ij->i", normals, a)[sides]
