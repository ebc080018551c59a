"""Mesh of points on a finger's skin, at which simulators read a tactile sensor."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fingertip.foundation.numerics import Array
from fingertip.pad.pad_geometry import PadForm

SPACING_MM = 0.5
"""Distance of the vertices. At 1 mm the deepest point of a light press lies between them."""
_STEP_MM = 1e-4
"""Step of the differences that give the slope of the surface."""


@dataclass(frozen=True, eq=False)
class TactileMesh:
    """Mesh on the skin over the sensor.

    MuJoCo's sensor `tactile` reads depth and speed of slip at its vertices.
    """

    points_mm: Array
    normals: Array
    """Outward normal of each point, and the two directions along the skin in which slip is read:
    across the finger, and to its tip.
    """
    triangles: Array


def mesh_active_area(form: PadForm) -> TactileMesh:
    """Mesh the square around the active area, in the axes of the design."""
    radius = form.active_radius_mm
    count = 2 * round(radius / SPACING_MM) + 1
    line = np.linspace(-radius, radius, count)
    grid_x, grid_z = np.meshgrid(line, form.sensor_z_mm + line, indexing="ij")
    x = grid_x.ravel()
    z = grid_z.ravel()

    points = np.stack([x, -form.skin_mm(x, z), z], axis=1)
    # Processors differ in digits beyond these.
    return TactileMesh(
        points_mm=points.round(6),
        normals=_find_directions(form, x, z).round(9),
        triangles=_triangulate_square(count),
    )


def _find_directions(form: PadForm, x: Array, z: Array) -> Array:
    """Find the outward normal, and the directions across the finger and to its tip."""
    rise_x = form.skin_mm(x + _STEP_MM, z) - form.skin_mm(x - _STEP_MM, z)
    rise_z = form.skin_mm(x, z + _STEP_MM) - form.skin_mm(x, z - _STEP_MM)
    slope_x = rise_x / (2 * _STEP_MM)
    slope_z = rise_z / (2 * _STEP_MM)

    outward = _scale_to_unit(np.stack([-slope_x, -np.ones_like(x), -slope_z], axis=1))
    across = _scale_to_unit(np.array([1.0, 0.0, 0.0]) - outward[:, :1] * outward)
    directions: Array = np.concatenate([outward, across, np.cross(outward, across)], axis=1)
    return directions


def _triangulate_square(count: int) -> Array:
    """Triangulate a square grid of points: two triangles for each cell."""
    index = np.arange(count * count).reshape(count, count)
    a = index[:-1, :-1].ravel()
    b = index[1:, :-1].ravel()
    c = index[:-1, 1:].ravel()
    d = index[1:, 1:].ravel()
    return np.concatenate([np.stack([a, b, c], axis=1), np.stack([b, d, c], axis=1)])


def _scale_to_unit(vectors: Array) -> Array:
    lengths: Array = np.linalg.norm(vectors, axis=1)
    return vectors / lengths[:, None]
