"""Walls measured by rays: from points all over a part's surface into it, to the face on the other
side.

The distance checks of the bone know which hollows they measure. Rays find what nobody thought of.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fingertip.cad.kernel.mesh import Manifold, Mesh, MeshEvaluator, to_canonical_mesh
from fingertip.design import Design
from fingertip.foundation.numerics import Array
from fingertip.models.parts import PARTS

SPACING_MM = 0.35
"""Distance between the points from which rays start, on average [mm]."""
_ABOVE_MM = 0.03
"""Height of the squares of a picture above the surface [mm]."""
_OPPOSITE = -0.7
"""Largest product of both faces' normals that makes a wall; others meet in an edge."""
_INSIDE_MM = 1e-4
"""Depth at which a ray starts [mm], so that it does not meet the face that it leaves."""
_R2 = (0.7548776662466927, 0.5698402909980532)
"""Steps of the R2 sequence, which spreads points evenly (M. Roberts, 2018)."""
NEGLIGIBLE_MM2 = 0.5
"""Area of thin walls that is not worth a mark [mm2]: four points."""


@dataclass(frozen=True, eq=False)
class ThinWalls:
    """Points at which a body is thinner than its minimum, each for the same area of its surface."""

    points: Array
    normals: Array
    thickness_mm: Array
    area_mm2: float
    """Area of the surface at all points together."""

    @property
    def matters(self) -> bool:
        return self.area_mm2 > NEGLIGIBLE_MM2

    def patches(self) -> Mesh:
        """Build a small square at each point, for pictures."""
        away = np.eye(3)[np.argmin(np.abs(self.normals), axis=1)]
        u = np.cross(self.normals, away)
        u *= 0.5 * SPACING_MM / np.linalg.norm(u, axis=1, keepdims=True)
        v = np.cross(self.normals, u)
        centre = self.points + _ABOVE_MM * self.normals
        corners = np.stack(
            [centre - u - v, centre + u - v, centre + u + v, centre - u + v], axis=1
        ).reshape(-1, 3)
        squares = 4 * np.arange(len(centre))[:, None, None] + np.array([[0, 1, 2], [0, 2, 3]])

        return Mesh(corners, squares.reshape(-1, 3))


def find_thin_walls(design: Design, evaluator: MeshEvaluator, part: str) -> ThinWalls:
    """Find where a part is thinner than its minimum.

    The rim beside the sensor's head has a minimum of its own.
    """
    minimum = design.skin.min_thickness_mm if part == "skin" else design.printer.min_wall_mm
    slack = 2 * evaluator.tolerance_mm  # both faces are off by the tolerance
    walls = measure_walls(evaluator.manifold(PARTS[part].solid(design)), minimum - slack)
    if part != "bone":
        return walls

    dims = design.dimensions
    _, y, z = walls.points.T
    beside_sensor = (z > 0.0) & (y < dims.pocket_depth - dims.flat_depth)
    is_rim = beside_sensor & (walls.thickness_mm > 0.95 * design.bone.rim_mm - slack)
    is_shown = ~is_rim
    area = walls.area_mm2 * float(is_shown.sum()) / max(1, len(is_shown))

    return ThinWalls(
        walls.points[is_shown], walls.normals[is_shown], walls.thickness_mm[is_shown], area
    )


def measure_walls(solid: Manifold, limit_mm: float) -> ThinWalls:
    """Cast rays into a solid from points spread over its surface, and keep those with a wall below
    a limit.
    """
    mesh = to_canonical_mesh(solid)  # in the same order, however the solid was made
    corners = mesh.vertices[mesh.triangles]
    edges = corners[:, 1:] - corners[:, :1]
    across = np.cross(edges[:, 0], edges[:, 1])
    sums = np.cumsum(0.5 * np.linalg.norm(across, axis=1))
    count = int(sums[-1] / SPACING_MM**2) + 1
    face = np.searchsorted(sums, sums[-1] * (np.arange(count) + 0.5) / count)
    s, t = (np.arange(count) * step % 1.0 for step in _R2)
    s, t = np.where(s + t > 1.0, (1.0 - s, 1.0 - t), (s, t))
    points = corners[face, 0] + s[:, None] * edges[face, 0] + t[:, None] * edges[face, 1]
    normals = across[face] / np.linalg.norm(across[face], axis=1, keepdims=True)
    thickness = np.full(count, np.inf)
    rays = zip(
        (points - _INSIDE_MM * normals).tolist(),
        (points - limit_mm * normals).tolist(),
        strict=True,
    )

    for i, (start, end) in enumerate(rays):
        for hit in solid.ray_cast(start, end)[:1]:
            if np.dot(hit.normal, normals[i]) < _OPPOSITE:
                thickness[i] = np.linalg.norm(points[i] - hit.position)

    thin = np.isfinite(thickness)
    return ThinWalls(
        points[thin], normals[thin], thickness[thin], float(sums[-1] / count * thin.sum())
    )
