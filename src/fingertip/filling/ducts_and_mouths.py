"""Mouth of a gate or vent on a layer: the nodes that it covers, and the resistance that the grid does not show.

The inflow of a gate is spread evenly over its mouth, and from each point to the corners of the quad around it. Near a
source the pressure rises as ln(1/r), but that of a node ends at the node's equivalent radius. The difference between
the mouth's rim and what the nodes show follows in closed form.

The laminar resistance of the ducts between syringe and cavity is dp / (mu Q) [1/mm3]: pressure drop of unit flow at
unit viscosity. Entrance losses are left out: the Reynolds number of silicone in a mold is far below 1. The cone is
locally a round duct (lubrication approximation), good for slopes below 0.2.

References: D. W. Peaceman, SPE J. 23 (1983) 531 (equivalent radius of a node); F. M. White, Viscous Fluid Flow, 3rd
ed., eqs. 3-38 (round duct) and 3-48 (rectangle); H. Bruus, Theoretical Microfluidics, section 3.4.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fingertip.filling.surface_links import Layer
from fingertip.foundation.numerics import Array

_EQUIVALENT_RADIUS = math.exp(-0.5772156649015329) / 4.0
"""Radius at which the exact pressure around a source equals that of its node, divided by the quad's diagonal."""
_PARTS = 6
"""Parts of a quad's side, whose centres sample it."""


@dataclass(frozen=True, eq=False)
class Mouth:
    """Round mouth on a layer, sampled at many points."""

    nodes: NDArray[np.intp]
    """Corners of each sample's quad, shape (samples, 4)."""
    weights: Array
    """Bilinear weights of the corners, shape (samples, 4)."""
    areas: Array
    """Share of the mouth's area that each sample stands for, with the sum 1."""

    def shares(self, count: int) -> Array:
        weights = (self.weights * self.areas[:, None]).ravel()
        return np.asarray(np.bincount(self.nodes.ravel(), weights, count), dtype=float)


def open_mouth(layer: Layer, point_mm: tuple[float, float, float], diameter_mm: float) -> Mouth:
    """Open a mouth in a layer, centred at the point of the layer nearest to a point [mm]."""
    quads = _open_quads(layer)
    corners = layer.points_mm[quads]
    centres = corners.mean(axis=1)
    reach = np.linalg.norm(corners - centres[:, None], axis=2).max(axis=1)
    target = np.array(point_mm)
    distance = np.linalg.norm(centres - target, axis=1)
    near = distance - reach <= distance.min() + reach.max()
    candidates = (_project(quad, at, target) for quad, at in zip(quads[near], corners[near], strict=True))
    centre, nodes, weights = min(candidates, key=lambda found: float(np.linalg.norm(found[0] - target)))

    chosen = np.linalg.norm(centres - centre, axis=1) <= reach + diameter_mm / 2
    at = (np.arange(_PARTS) + 0.5) / _PARTS
    s, t = (part.ravel() for part in np.meshgrid(at, at, indexing="ij"))
    bilinear = np.stack(((1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t), axis=1)
    samples = np.einsum("sk,qkx->qsx", bilinear, corners[chosen])
    inside = np.linalg.norm(samples - centre, axis=2) <= diameter_mm / 2
    if not inside.any():  # the mouth is smaller than the distance of the samples
        return Mouth(nodes[None], weights[None], np.ones(1))
    quad, sample = np.nonzero(inside)
    diagonals = corners[chosen][:, [3, 2]] - corners[chosen][:, [0, 1]]
    areas = 0.5 * np.linalg.norm(np.cross(diagonals[:, 0], diagonals[:, 1]), axis=1)[quad]
    return Mouth(quads[chosen][quad], bilinear[sample], areas / areas.sum())


def mouth_resistance(layer: Layer, mouth: Mouth, diameter_mm: float) -> float:
    """Compute the resistance between the rim of a mouth and the mean pressure that the nodes show in it [1/mm3].

    It is negative where the nodes show more than the rim's pressure. The pressure around a source in a layer of
    mobility T = h^3 / 12 is G = -ln(r) / (2 pi T).
    """
    share = mouth.shares(len(layer.network.volume_mm3))
    nodes = np.flatnonzero(share)
    w, points = share[nodes], layer.points_mm[nodes]
    p = layer.points_mm[mouth.nodes[int(np.argmax(mouth.areas))]]
    diagonal = 0.5 * float(np.linalg.norm(p[3] - p[0]) + np.linalg.norm(p[2] - p[1]))
    distance = np.linalg.norm(points[:, None] - points[None], axis=2)
    radius = np.maximum(distance, _EQUIVALENT_RADIUS * diagonal)
    mobility = float(w @ layer.thickness_mm[nodes] ** 3) / 12.0
    shown = -float(w @ np.log(radius) @ w)
    return (-math.log(diameter_mm / 2.0) - shown) / (2.0 * math.pi * mobility)


def _open_quads(layer: Layer) -> NDArray[np.intp]:
    """List the corners of all quads between open nodes: (i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)."""
    rows, columns = layer.network.shape
    number = np.arange(rows * columns).reshape(rows, columns)
    if layer.network.is_open[-1]:
        number = np.concatenate((number, np.full((1, columns), rows * columns)))
    right = np.roll(number, -1, axis=1)
    if not layer.network.around_mm3[:, -1].any():  # columns are not periodic
        number, right = number[:, :-1], right[:, :-1]
    quads = np.stack((number[:-1], number[1:], right[:-1], right[1:]), axis=2).reshape(-1, 4)
    return quads[layer.network.is_open[quads].all(axis=1)]


def _project(quad: NDArray[np.intp], corners: Array, target: Array) -> tuple[Array, NDArray[np.intp], Array]:
    """Find the point of a bilinear quad nearest to a target, by Gauss-Newton steps within it: point, quad, weights."""
    p00, p10, p01, p11 = corners
    s, t = 0.5, 0.5
    for _ in range(4):
        along, around = (1 - t) * (p10 - p00) + t * (p11 - p01), (1 - s) * (p01 - p00) + s * (p11 - p10)
        rest = target - ((1 - s) * ((1 - t) * p00 + t * p01) + s * ((1 - t) * p10 + t * p11))
        aa, ab, bb = float(along @ along), float(along @ around), float(around @ around)
        ra, rb = float(rest @ along), float(rest @ around)
        determinant = aa * bb - ab * ab
        if determinant <= 1e-12 * aa * bb:
            break
        s = min(max(s + (ra * bb - rb * ab) / determinant, 0.0), 1.0)
        t = min(max(t + (rb * aa - ra * ab) / determinant, 0.0), 1.0)
    weights = np.array([(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t])
    return weights @ corners, quad, weights


_TERMS = 12
"""Terms of the rectangle's series, whose terms fall with the fifth power of odd numbers."""


class Duct(NamedTuple):
    volume_mm3: float
    resistance: float
    """Resistance of the full duct [1/mm3]."""
    resistance_integral: float
    """Integral of the resistance over the volume that has entered the duct, until it is full [1]."""


def round_duct(diameter_mm: float, length_mm: float) -> Duct:
    """Measure a duct of circular section: its resistance is 128 L / (pi d^4) (Hagen-Poiseuille)."""
    volume, resistance = math.pi / 4.0 * diameter_mm**2 * length_mm, 128.0 * length_mm / (math.pi * diameter_mm**4)
    return Duct(volume, resistance, 0.5 * resistance * volume)


def conical_duct(inlet_diameter_mm: float, outlet_diameter_mm: float, length_mm: float) -> Duct:
    """Measure a duct of circular section whose diameter changes linearly from inlet to outlet.

    Its resistance is the integral of 128 / (pi d^4) along the cone. With q = ln(b / a), the integral while it fills is
    32 L^2 / (3 a^2) ((e^3q - 1) / 3 - q) / (e^q - 1)^2, where the last factor tends to 3/2.
    """
    a, b = inlet_diameter_mm, outlet_diameter_mm
    volume = math.pi / 12.0 * (a * a + a * b + b * b) * length_mm
    resistance = 128.0 * length_mm * (a * a + a * b + b * b) / (3.0 * math.pi * a**3 * b**3)
    q = math.log(b / a)
    factor = 1.5 if abs(q) < 1e-5 else (math.expm1(3.0 * q) / 3.0 - q) / math.expm1(q) ** 2
    return Duct(volume, resistance, 32.0 * length_mm**2 / (3.0 * a * a) * factor)


def rectangular_duct(width_mm: float, height_mm: float, length_mm: float) -> Duct:
    """Measure a duct: its resistance is 12 L / (w h^3), divided by the series for walls at a finite distance."""
    w, h = max(width_mm, height_mm), min(width_mm, height_mm)
    series = sum(math.tanh(n * math.pi * w / (2.0 * h)) / n**5 for n in range(1, 2 * _TERMS, 2))
    resistance = 12.0 * length_mm / (w * h**3 * (1.0 - 192.0 * h / (math.pi**5 * w) * series))
    volume = width_mm * height_mm * length_mm
    return Duct(volume, resistance, 0.5 * resistance * volume)


def fill_in_series(ducts: Iterable[Duct]) -> Duct:
    """Join ducts that fill in turn to one."""
    resistance = volume = integral = 0.0
    for duct in ducts:
        integral += resistance * duct.volume_mm3 + duct.resistance_integral
        resistance += duct.resistance
        volume += duct.volume_mm3
    return Duct(volume, resistance, integral)
