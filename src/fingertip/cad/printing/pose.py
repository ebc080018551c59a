"""Poses of parts on the printer's bed: turned by quarter turns, lowest point on z = 0, lowest corner at the origin."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fingertip.arrays import Array
from fingertip.cad.kernel.mesh import Mesh


@dataclass(frozen=True)
class Pose:
    """Rigid motion of a part from its file to the bed: v -> rotation v + shift."""

    rotation: Array
    """Rotation, shape (3, 3); its entries are 0, 1 and -1, so that vertices keep their exact values."""
    shift: tuple[float, float, float]
    """Translation after the rotation [mm]."""

    def apply(self, mesh: Mesh) -> Mesh:
        """Move a mesh."""
        return Mesh(mesh.vertices @ self.rotation.T + np.array(self.shift) + 0.0, mesh.triangles)

    def size(self, mesh: Mesh) -> tuple[float, float, float]:
        """Measure the extents of a part in this pose [mm]."""
        moved = mesh.vertices @ self.rotation.T
        x, y, z = (moved.max(axis=0) - moved.min(axis=0)).tolist()
        return x, y, z

    def turned(self) -> Pose:
        """Turn the pose by a quarter turn about the vertical; it lies at the corner again once `on_bed` places it."""
        return Pose(np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]) @ self.rotation, self.shift)

    def on_bed(self, mesh: Mesh, x: float = 0.0, y: float = 0.0) -> Pose:
        """Move the lowest corner of a part to (`x`, `y`, 0) [mm]."""
        low = (mesh.vertices @ self.rotation.T).min(axis=0).tolist()
        return Pose(self.rotation, (x - low[0], y - low[1], -low[2]))


def bed_pose(mesh: Mesh, rotate_x_deg: float) -> Pose:
    """Find the pose of a part that is turned about x, with its lowest corner at the origin.

    Raises
    ------
    ValueError
        If the angle is no quarter turn: other angles would round the vertices.
    """
    quarters = rotate_x_deg / 90.0
    if quarters != round(quarters):
        raise ValueError(f"{rotate_x_deg:g} degrees are no quarter turns")
    angle = math.radians(rotate_x_deg)
    c, s = float(round(math.cos(angle))), float(round(math.sin(angle)))
    return Pose(np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]]), (0.0, 0.0, 0.0)).on_bed(mesh)
