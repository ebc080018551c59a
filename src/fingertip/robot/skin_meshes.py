"""Meshes of the skin for simulators: convex pieces for collisions, and the points of a tactile sensor.

The pieces are slices along the finger, each its convex hull. The skin is cut where its hull is farthest from it, until
the pieces are near enough. A plate that lies on two of them meets two contacts, and so twice the stiffness: pieces are
few, and none ends where a plate touches the pad.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator, to_arrays, to_canonical_mesh
from fingertip.cad.shapes.skin import skin_outline
from fingertip.design import Design
from fingertip.foundation.numerics import Array
from fingertip.pad.form import PadForm

if TYPE_CHECKING:
    from manifold3d import Manifold

WANTED_MM = 0.15
"""Distance to the skin at which no further cut is made."""
MAX_PIECES = 4
FACET_MM, _EXACT_MM = 0.03, 0.005
"""Tolerances of the mesh that is cut, and of the one that stands for the skin's true surface."""
_MIN_MM = 1.0
"""Least length of a piece."""
_GRID_MM = 2.0**-10
_SLIVER_MM = 0.005
"""Height of a triangle below which its plane says nothing; its neighbours lie as near."""
_FLAT = 0.99
"""Component along the finger from which on the normal of a facet is that of a cut or of the skin's end."""


def cut_skin(design: Design) -> tuple[tuple[Mesh, ...], float]:
    """Cut the skin, filled with what lies in it, into convex pieces; with the greatest distance to its surface [mm]."""
    outline, evaluator = skin_outline(design), MeshEvaluator(FACET_MM)
    body, surface = evaluator.manifold(outline), MeshEvaluator(_EXACT_MM).mesh(outline).vertices
    cuts, dims = [0.0, design.skin.length_mm], design.dimensions
    last_cut_mm = dims.sensor_z - dims.sensor.active_diameter_mm / 2
    while True:
        pieces = []
        for low, high in itertools.pairwise(cuts):
            slab = body.trim_by_plane((0.0, 0.0, 1.0), low).trim_by_plane((0.0, 0.0, -1.0), -high)
            pieces.append(_hull(slab))
        distance = _measure(pieces, cuts, surface)
        worst = int(distance.argmax())
        cut = min(round(float(surface[worst, 2]), 3), last_cut_mm)
        is_short = min(abs(cut - other) for other in cuts) < _MIN_MM
        if distance[worst] <= WANTED_MM or len(pieces) == MAX_PIECES or is_short:
            return tuple(pieces), float(distance[worst])
        cuts = sorted([*cuts, cut])


def _hull(body: Manifold) -> Mesh:
    """Build the convex hull of points that are rounded first: that of manifold3d folds where they are not."""
    from manifold3d import Manifold  # noqa: PLC0415

    points = np.unique(np.round(to_arrays(body)[0] / _GRID_MM), axis=0) * _GRID_MM
    return to_canonical_mesh(Manifold.hull_points(points))


def _measure(pieces: list[Mesh], cuts: list[float], points: Array) -> Array:
    """Measure how far points of the true surface lie from the outside of the piece around them [mm].

    Distances are those to the planes of the facets: exact for a point inside a piece, and for one outside that lies
    before a facet, as those of a smooth surface do.
    """
    found = np.zeros(len(points))
    for piece, (low, high) in zip(pieces, itertools.pairwise(cuts), strict=True):
        a, b, c = (piece.vertices[piece.triangles[:, i]] for i in range(3))
        normals = np.cross(b - a, c - a)
        twice_area = np.linalg.norm(normals, axis=1)
        normals /= twice_area[:, None]
        longest = np.max([np.linalg.norm(one - other, axis=1) for one, other in ((a, b), (b, c), (c, a))], axis=0)
        ends_in_cut = normals[:, 2] <= -_FLAT if high == cuts[-1] else np.abs(normals[:, 2]) >= _FLAT
        sides = ~ends_in_cut & (twice_area > _SLIVER_MM * longest)
        near = np.flatnonzero((points[:, 2] > low) & (points[:, 2] <= high))
        planes = np.einsum("ij,ij->i", normals, a)[sides]
        for block in np.array_split(near, 1 + len(near) // 2000):
            found[block] = np.abs((points[block] @ normals[sides].T - planes).max(axis=1))
    return found


# Mesh on the skin over the sensor, at whose vertices MuJoCo's sensor `tactile` reads depth and speed of slip.

SPACING_MM = 0.5
"""Distance of the vertices. At 1 mm the deepest point of a light press lies between them."""
_STEP_MM = 1e-4


@dataclass(frozen=True, eq=False)
class TactileMesh:
    points_mm: Array
    normals: Array
    """Outward normal of each point, and the two directions along the skin in which slip is read: across, to the tip."""
    triangles: Array


def mesh_active_area(form: PadForm) -> TactileMesh:
    """Mesh the square around the active area, in the axes of the design."""
    radius, count = form.active_radius_mm, 2 * round(form.active_radius_mm / SPACING_MM) + 1
    line = np.linspace(-radius, radius, count)
    x, z = (part.ravel() for part in np.meshgrid(line, form.sensor_z_mm + line, indexing="ij"))
    slope_x = (form.skin_mm(x + _STEP_MM, z) - form.skin_mm(x - _STEP_MM, z)) / (2 * _STEP_MM)
    slope_z = (form.skin_mm(x, z + _STEP_MM) - form.skin_mm(x, z - _STEP_MM)) / (2 * _STEP_MM)
    out = _unit(np.stack([-slope_x, -np.ones_like(x), -slope_z], axis=1))
    across = _unit(np.array([1.0, 0.0, 0.0]) - out[:, :1] * out)
    corner = np.arange(count * count).reshape(count, count)
    a, b, c, d = (part.ravel() for part in (corner[:-1, :-1], corner[1:, :-1], corner[:-1, 1:], corner[1:, 1:]))
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([b, d, c], axis=1)])
    points = np.stack([x, -form.skin_mm(x, z), z], axis=1)
    normals: Array = np.concatenate([out, across, np.cross(out, across)], axis=1)
    return TactileMesh(points.round(6), normals.round(9), triangles)  # processors differ in digits beyond these


def _unit(vectors: Array) -> Array:
    lengths: Array = np.linalg.norm(vectors, axis=1)
    return vectors / lengths[:, None]
