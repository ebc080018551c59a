"""Distance of a body from the surface of a convex one around it, such as the thickness of the skin over the bone.

The distance of a point inside a convex polyhedron from its surface is the distance from the nearest of the facets'
planes. Each of these is linear in the point, so the smallest distance of a body is that of one of its corners. Were the
surface not convex, the planes would cut into it, and the result would be too small, never too large.
"""

from __future__ import annotations

import numpy as np

from fingertip.arrays import Array
from fingertip.cad.kernel.tessellate import Triangles

_BLOCK = 2**15
"""Number of distances that are computed at once. They fit into the cache of a processor, and the linear algebra library
starts no threads for so few."""

_PLANE_DIGITS = 9
"""Decimals to which planes agree that are the same."""


class EnclosingSurface:
    """Planes of the facets of a convex surface.

    Parameters
    ----------
    vertices
        Coordinates, shape (n, 3) [mm].
    triangles
        Vertex indices, shape (m, 3), counter-clockwise seen from outside. None of them is degenerate. Sides on which
        the body may leave the surface are left out.
    """

    def __init__(self, vertices: Array, triangles: Triangles) -> None:
        a, b, c = (vertices[triangles[:, i]] for i in range(3))
        normals = np.cross(b - a, c - a)
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        planes = np.column_stack((normals, -np.einsum("ij,ij->i", normals, a)))
        # Two triangles share a plane wherever a ring of the mesh is a scaled copy of the next one.
        _, distinct = np.unique(np.round(planes, _PLANE_DIGITS), axis=0, return_index=True)
        self._planes = np.ascontiguousarray(planes[distinct].T)

    def distance_to(self, points: Array) -> float:
        """Measure the smallest distance [mm] of points inside from the surface; negative if one lies outside."""
        homogeneous = np.column_stack((points, np.ones(len(points))))
        size = max(1, _BLOCK // self._planes.shape[1])
        blocks = (homogeneous[i : i + size] for i in range(0, len(points), size))
        return -max(float((block @ self._planes).max()) for block in blocks)
