"""Air that a rising surface of silicone shuts in around a core.

Air gets out if it can go on sideways and upwards, never downwards, until it reaches the rim. Where
it stays, the space has a summit: a place above which it has a roof, and from which it nowhere
rises. Core and cup have the same summits while the core goes down. Where there is one, the volume
of air below it is found on voxels, layer by layer.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from fingertip.cad.kernel.mesh import Manifold, to_arrays
from fingertip.foundation.numerics import Array

Mask = NDArray[np.bool_]
VOXEL_MM = (0.25, 0.1, 0.2)
"""Size of the voxels along x, y and up: along y the recess of a bump is two of them deep."""
LEANS_DEG = ((0.0, 0.0), (10.0, 0.0), (-10.0, 0.0), (0.0, 10.0))
"""Rotations of the standing cup about x and y, in which it may stand while the core is lowered."""
_AT_RIM_MM = 0.4
"""Depth below the rim up to which air leaves through the gap under the plate."""
_LEVEL_MM = 1e-6


def trapped_mm3(free: Manifold, lean_deg: tuple[float, float]) -> float:
    """Compute the volume of air that stays in the free space of a cup with its rim at z = 0."""
    return _flood_mm3(free, lean_deg) if _has_summit(free, lean_deg) else 0.0


def _has_summit(free: Manifold, lean_deg: tuple[float, float]) -> bool:
    vertices, triangles = to_arrays(free)
    about_x, about_y = (math.radians(angle) for angle in lean_deg)
    upwards = -np.array(
        [
            math.sin(about_y),
            math.cos(about_y) * math.sin(about_x),
            math.cos(about_y) * math.cos(about_x),
        ]
    )
    heights = vertices @ upwards
    corners = vertices[triangles]
    beside = np.full(len(vertices), -np.inf)
    roof = np.zeros(len(vertices))
    facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) @ upwards
    np.maximum.at(beside, triangles, heights[triangles].max(axis=1, keepdims=True))
    np.add.at(roof, triangles, facing[:, None])
    is_summit = (beside <= heights + _LEVEL_MM) & (roof > 0.0) & (vertices[:, 2] > _AT_RIM_MM)

    return bool(is_summit.any())


def _flood_mm3(free: Manifold, lean_deg: tuple[float, float]) -> float:
    turned = free.rotate((180.0, 0.0, 0.0)).rotate((*lean_deg, 0.0))  # the tip points down
    low, high = np.split(np.array(turned.bounding_box()), 2)
    x, y, up = (
        np.arange(a + size / 2, b, size) for a, b, size in zip(low, high, VOXEL_MM, strict=True)
    )
    about_x, about_y = (math.radians(angle) for angle in lean_deg)
    # Component of each place along the axis of the cup, which is turned about x first.
    tilted = math.sin(about_y) * x[:, None] * math.cos(about_x) - math.sin(about_x) * y[None, :]
    tilted = np.pad(tilted, 1)
    along = math.cos(about_x) * math.cos(about_y)
    reached = np.zeros(tilted.shape, dtype=bool)
    trapped = 0

    for height in up[::-1]:
        layer = _fill(turned.slice(height).to_polygons(), x, y)
        is_open = along * height + tilted > -_AT_RIM_MM
        reached = _spread(layer & (is_open | reached), layer)
        trapped += int(layer.sum() - reached.sum())

    return trapped * math.prod(VOXEL_MM)


def _fill(outlines: list[Array], x: Array, y: Array) -> Mask:
    """Find the places inside outlines by the even-odd rule, within a border of places outside."""
    flips = np.zeros((len(x) + 2, len(y) + 2), dtype=np.int64)
    for ring in outlines:
        ax, ay = np.asarray(ring).T
        bx, by = np.roll(ring, -1, axis=0).T
        edge, row = np.nonzero((ax[:, None] <= x) != (bx[:, None] <= x))
        at = ay[edge] + (x[row] - ax[edge]) / (bx - ax)[edge] * (by - ay)[edge]
        np.add.at(flips, (row + 1, np.searchsorted(y, at) + 1), 1)

    return np.asarray(np.cumsum(flips, axis=1) % 2 == 1)


def _spread(seeds: Mask, free: Mask) -> Mask:
    """Find the places of a layer that are connected with a seed."""
    while True:
        reached = _along_rows(_along_rows(seeds, free).T, free.T).T
        if np.array_equal(reached, seeds):
            return reached

        seeds = reached


def _along_rows(seeds: Mask, free: Mask) -> Mask:
    """Extend seeds to all of the runs of free places along rows in which they lie."""
    run = np.cumsum(~free).reshape(free.shape)  # borders keep the runs of two rows apart
    is_hit = np.zeros(run[-1, -1] + 1, dtype=bool)
    is_hit[run[seeds]] = True

    return np.asarray(free & is_hit[run])
