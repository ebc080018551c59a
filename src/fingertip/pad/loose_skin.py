"""Contact inside a skin that lies on the bone: its place, and what presses on the sensor, with a
gap or a bump there.

The skin is a plate as thick as over the sensor, free on both faces and held beyond a circle, where
it bends around the sides of the bone. Its waves are the exact ones of a layer: pressed from both
sides a face yields by s, pushed to one side by a, per unit of pressure on each face (K. L. Johnson,
Contact Mechanics, 1985, section 5.8). With w = k h

    s = (1 - nu^2) / (E k) (cosh w - 1) / (sinh w + w) 2,    a = (1 - nu^2) / (E k) (cosh w + 1) /
    (sinh w - w) 2

A pressure on one face moves it by (a + s) / 2 and the other face by (a - s) / 2. All is averaged
over rings around the sensor. For a skin that touches everywhere this changes nothing of what the
sensor feels; pressures and gaps of the rings solve a complementarity problem. The bone is taken as
a plane.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from fingertip.foundation.numerics import Array
from fingertip.pad.pad_geometry import PadForm

_RING_MM = 0.25
_HELD_RINGS = 12
_WAVES = 0.06 * (np.arange(500) + 0.5)
"""Wave numbers of the integral over them [1/mm]."""
_NEAR = (0.00001109, -0.00031761, 0.00443319, -0.03954289, 0.21093573, -0.56249985, 0.5)
_FAR = (-0.00020033, 0.00113653, -0.00249511, 0.00017105, 0.01659667, 0.00000156, 0.79788456)
_PHASE = (-0.00029166, 0.00079824, 0.00074348, -0.00637879, 0.0000565, 0.12499612, -2.35619449)
"""Bessel's function of order one below and above 3 (M. Abramowitz and I. A. Stegun, Handbook of
Mathematical Functions, 1964, 9.4.4 and 9.4.6), highest power first.
"""
_FLOOR = 1e-5
"""Springs under the plate [MPa/mm], so soft that they only keep its longest waves finite."""
_MAX_STEPS = 60


@dataclass(frozen=True, eq=False)
class Inside:
    """Rings on which the skin may touch the bone, with their compliance."""

    edges_mm: Array
    area_mm2: Array
    """Areas of all rings, those where it is held included."""
    compliance: Array
    """Gap of the rings under pressures on them, where the rest is held [mm/MPa]."""
    sink: Array
    """Approach of the rings to the bone under pressures on all rings of the outer face [mm/MPa]."""
    gap_mm: Array
    is_active: NDArray[np.bool_]
    rest_mpa: Array
    """Pressures when nothing touches the finger."""

    @property
    def rest_n(self) -> float:
        """Force on the active area when nothing touches the finger."""
        return self.on_sensor_n(self.rest_mpa)

    def on_sensor_n(self, pressure: Array) -> float:
        return float((self.area_mm2[: len(pressure)] * pressure)[self.is_active].sum())

    def compare(self, force_n: Array, distance_mm: Array) -> tuple[float, float]:
        """Compare with a skin that touches everywhere, under forces at distances from the sensor.

        Returns the change of the force on the active area, beyond that at rest [N], and what the
        skin sinks more times the force [N mm].
        """
        rings = np.clip(np.searchsorted(self.edges_mm, distance_mm) - 1, 0, len(self.area_mm2) - 1)
        sunk = self.sink @ (np.bincount(rings, force_n, len(self.area_mm2)) / self.area_mm2)
        flush = np.linalg.solve(self.compliance, sunk)
        change = find_pressures(self.compliance, self.gap_mm - sunk) - self.rest_mpa - flush

        return self.on_sensor_n(change), -float((self.area_mm2[: len(sunk)] * sunk * change).sum())


@lru_cache(maxsize=256)
def lay_rings(form: PadForm, young_mpa: float) -> Inside | None:
    """Lay rings under a skin; None where it touches everywhere, or is bonded."""
    if form.bonded or not (form.gap_mm or form.bump_height_mm):
        return None

    h = form.over_sensor_mm
    nu = form.poisson
    k = _WAVES
    line = np.arange(0.0, 60.0, 0.1)
    still = np.zeros_like(line)
    # It is held at the mean of the distances from the sensor to the bone's side and to its tip: as
    # by finite elements.
    sides = (
        form.bone_mm(line, still + form.sensor_z_mm),
        form.bone_mm(still, line + form.sensor_z_mm),
    )
    held_mm = 0.5 * sum(float(line[np.isfinite(side)].max()) for side in sides)
    marks = sorted({0.0, form.active_radius_mm, form.bump_radius_mm, held_mm})
    parts = [np.linspace(a, b, math.ceil((b - a) / _RING_MM) + 1)[1:] for a, b in pairwise(marks)]
    held = held_mm + 2.0 * h * np.arange(1, _HELD_RINGS + 1) / _HELD_RINGS
    edges = np.concatenate([[0.0], *parts, held])
    area = math.pi * np.diff(edges**2)
    mean = (
        np.diff(2.0 * math.pi * edges[:, None] * _bessel_one(edges[:, None] * k) / k, axis=0)
        / area[:, None]
    )
    w = k * h
    soft = 2.0 * (1.0 - nu * nu) / (young_mpa * k)
    s = soft * (np.cosh(w) - 1.0) / (np.sinh(w) + w)
    a = 1.0 / ((np.sinh(w) - w) / (soft * (np.cosh(w) + 1.0)) + 0.5 * _FLOOR)
    (
        own,
        other,
    ) = (  # einsum runs in one thread: those of `@` take ten times as long for so small a product
        np.einsum("ik,jk->ij", mean * (0.5 * part * k * (k[1] - k[0]) / (2.0 * math.pi)), mean)
        * area
        for part in (a + s, a - s)
    )
    n = len(edges) - 1 - _HELD_RINGS
    rigid = np.linalg.solve(own[n:, n:].T, own[:n, n:].T).T
    compliance = own[:n, :n] - rigid @ own[n:, :n]
    sink = other[:n] - rigid @ other[n:]
    middle = 0.5 * (edges[:n] + edges[1 : n + 1])
    gap = form.inner_gap_mm(middle, np.full_like(middle, form.sensor_z_mm))

    return Inside(
        edges_mm=edges,
        area_mm2=area,
        compliance=compliance,
        sink=sink,
        gap_mm=gap,
        is_active=middle < form.active_radius_mm,
        rest_mpa=find_pressures(compliance, gap),
    )


def _bessel_one(x: Array) -> Array:
    """Evaluate Bessel's function of order one at x >= 0."""
    near = np.minimum(x / 3.0, 1.0)
    far = 3.0 / np.maximum(x, 3.0)
    wave = np.polyval(_FAR, far) * np.cos(x + np.polyval(_PHASE, far)) * np.sqrt(far / 3.0)

    return np.where(x < 3.0, x * np.polyval(_NEAR, near * near), wave)


def find_pressures(compliance: Array, gap: Array) -> Array:
    """Find pressures >= 0 that leave gaps >= 0, one of both 0 everywhere.

    The method is the primal-dual active set of `fem_contact`.
    """
    active = gap < 0.0
    for step in range(_MAX_STEPS):
        pressure = np.zeros_like(gap)
        pressure[active] = np.linalg.solve(compliance[np.ix_(active, active)], -gap[active])
        wrong = np.where(
            active,
            -pressure / max(float(np.abs(pressure).max()), 1e-12),
            -(gap + compliance @ pressure),
        )
        if wrong.max() <= 1e-9:
            break

        active = active ^ ((wrong > 1e-9) if 2 * step < _MAX_STEPS else (wrong == wrong.max()))

    return np.maximum(pressure, 0.0)
