"""Mesh on the skin over the sensor, at whose vertices MuJoCo's sensor `tactile` reads depth and speed of slip."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fingertip.foundation.numerics import Array
from fingertip.pad.form import PadForm

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
