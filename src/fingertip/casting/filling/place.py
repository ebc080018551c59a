"""Place of a gate or vent on a layer: the nodes around it with their weights, and the gate's own resistance.

Inflow at a point is shared between the four nodes of its quad (bilinear weights), so that a gate may lie anywhere. Near
it the pressure rises as ln(1/r): the grid resolves that only down to its spacing. What the pressure still rises
between there and the mouth's rim follows in closed form from the Green's function of the square lattice.

References: D. W. Peaceman, SPE J. 23 (1983) 531 (equivalent radius of a node); J. Cserti, Am. J. Phys. 68 (2000) 896
(resistances between neighbouring and diagonal nodes of a rectangular lattice).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.arrays import Array
from fingertip.casting.filling.surface_links import Layer

_EQUIVALENT_RADIUS = math.exp(-0.5772156649015329) / 4.0
"""Radius at which the exact pressure around a source equals that of its node, divided by the quad's diagonal."""


@dataclass(frozen=True, eq=False)
class Place:
    """Point on a layer."""

    nodes: NDArray[np.intp]
    """Corners (i, j), (i + 1, j), (i, j + 1) and (i + 1, j + 1) of its quad."""
    along: float
    """Position in the quad, 0 at row i and 1 at row i + 1."""
    around: float
    along_mm: float
    """Length of the quad along its columns."""
    around_mm: float
    thickness_mm: float
    distance_mm: float
    """Distance of the point from the middle of the layer."""

    @property
    def weights(self) -> Array:
        """Bilinear weights of the corners."""
        a, b = self.along, self.around
        return np.array([(1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b])

    def shares(self, count: int) -> Array:
        """Share of a unit inflow that enters each of `count` nodes."""
        return np.bincount(self.nodes, self.weights, count)

    def interpolate(self, values: Array) -> float:
        """Interpolate values at the nodes."""
        return float(self.weights @ values[self.nodes])

    def slope(self, values: Array) -> float:
        """Compute the gradient of values at the nodes [1/mm]."""
        v, a, b = values[self.nodes], self.along, self.around
        along = (1 - b) * (v[1] - v[0]) + b * (v[3] - v[2])
        around = (1 - a) * (v[2] - v[0]) + a * (v[3] - v[1])
        return math.hypot(along / self.along_mm, around / self.around_mm)

    def mouth_resistance(self, diameter_mm: float) -> float:
        """Compute the resistance between a mouth's rim and the pressure that the nodes show [1/mm3].

        Negative where the mouth is wider than the nodes' equivalent circle.
        """
        m, n = self.along_mm, self.around_mm
        mobility = self.thickness_mm**3 / 12.0
        k_along, k_around = mobility * n / m, mobility * m / n
        # Half the resistance between two nodes of the infinite lattice.
        next_along = math.atan(math.sqrt(k_along / k_around)) / (math.pi * k_along)
        next_around = math.atan(math.sqrt(k_around / k_along)) / (math.pi * k_around)
        diagonal = 1.0 / (math.pi * mobility)
        w = self.weights
        shared = (
            (w[0] * w[1] + w[2] * w[3]) * next_along
            + (w[0] * w[2] + w[1] * w[3]) * next_around
            + (w[0] * w[3] + w[1] * w[2]) * diagonal
        )
        single = math.log(_EQUIVALENT_RADIUS * math.hypot(m, n) / (diameter_mm / 2)) / (2.0 * math.pi * mobility)
        return single + 2.0 * float(shared)


def locate(layer: Layer, point_mm: tuple[float, float, float]) -> Place:
    """Find the place on a layer nearest to a point [mm], among the quads around the nearest open node."""
    rows, columns = layer.network.shape
    is_open, target = layer.network.is_open, np.array(point_mm)
    squared = ((layer.points_mm - target) ** 2).sum(axis=1)
    nearest = int(np.argmin(np.where(is_open, squared, np.inf)))
    row, column = min(nearest // columns, rows), nearest % columns if nearest < rows * columns else 0

    def node(i: int, j: int) -> int:
        return min(i * columns + j % columns, rows * columns)

    around = range(columns) if row == rows else (column - 1, column)
    last = rows if is_open[-1] else rows - 1
    quads = [
        np.array([node(i, j), node(i + 1, j), node(i, j + 1), node(i + 1, j + 1)])
        for i in (row - 1, row) for j in around if 0 <= i < last
    ]  # fmt: skip
    places = [_project(layer, quad, target) for quad in quads if is_open[quad].all()]
    if not places:
        spacing = math.sqrt(layer.network.volume_mm3[nearest] / layer.thickness_mm[nearest])
        same = np.full(4, nearest)
        return Place(same, 0.0, 0.0, spacing, spacing, float(layer.thickness_mm[nearest]), math.sqrt(squared[nearest]))
    return min(places, key=lambda place: place.distance_mm)


def _project(layer: Layer, quad: NDArray[np.intp], target: Array) -> Place:
    """Find the point of a bilinear quad nearest to a target, by Gauss-Newton steps kept within the quad."""
    p00, p10, p01, p11 = layer.points_mm[quad]
    s, t = 0.5, 0.5
    for _ in range(4):
        along, around = (1 - t) * (p10 - p00) + t * (p11 - p01), (1 - s) * (p01 - p00) + s * (p11 - p10)
        point = (1 - s) * ((1 - t) * p00 + t * p01) + s * ((1 - t) * p10 + t * p11)
        jacobian = np.stack((along, around), axis=1)
        step = np.linalg.lstsq(jacobian, target - point, rcond=None)[0]
        s, t = min(max(s + float(step[0]), 0.0), 1.0), min(max(t + float(step[1]), 0.0), 1.0)
    point = (1 - s) * ((1 - t) * p00 + t * p01) + s * ((1 - t) * p10 + t * p11)
    weights = np.array([(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t])
    return Place(
        quad, s, t,
        0.5 * float(np.linalg.norm(p10 - p00) + np.linalg.norm(p11 - p01)),
        0.5 * float(np.linalg.norm(p01 - p00) + np.linalg.norm(p11 - p10)),
        float(weights @ layer.thickness_mm[quad]), float(np.linalg.norm(point - target)),
    )  # fmt: skip
