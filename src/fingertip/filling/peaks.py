"""Location of a maximum between the nodes of a grid, by a parabola along its row and one along its column."""

from __future__ import annotations

import numpy as np

from fingertip.arrays import Array
from fingertip.filling.surface_links import Layer


def refine_peak(layer: Layer, values: Array, node: int) -> tuple[float, float, float]:
    """Return the point [mm] of a layer at which values have their maximum near a node."""
    rows, columns = layer.network.shape
    points = layer.points_mm
    point = points[node].copy()
    if node < rows * columns:
        i, j = divmod(node, columns)
        for low, high in (
            (i * columns + (j - 1) % columns, i * columns + (j + 1) % columns),
            (node - columns if i else -1, node + columns if i + 1 < rows else -1),
        ):
            if low >= 0 and high >= 0:
                point += _offset(values, low, node, high, points)
    return float(point[0]), float(point[1]), float(point[2])


def _offset(values: Array, low: int, middle: int, high: int, points: Array) -> Array:
    """Move from the middle one of three nodes to the vertex of the parabola through their values."""
    curvature = values[low] - 2.0 * values[middle] + values[high]
    nothing: Array = np.zeros(3)
    if not np.isfinite(curvature) or curvature >= 0.0:
        return nothing
    shift = float(np.clip(0.5 * (values[low] - values[high]) / curvature, -0.5, 0.5))
    neighbour = points[high] if shift > 0.0 else points[low]
    moved: Array = abs(shift) * (neighbour - points[middle])
    return moved
