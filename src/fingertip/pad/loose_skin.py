"""Contact between a bone and the skin that lies on it, with a gap or a bump at the sensor.

The skin is a plate as thick as over the sensor. It is free on both faces, and held beyond a circle,
where it bends around the sides of the bone. Its waves are the exact ones of a layer: under a unit
of pressure on each face, a face yields by s if both faces are pressed towards each other, and by a
if both are pushed to one side (K. L. Johnson, Contact Mechanics, 1985, section 5.8). With w = k h

    s = 2 (1 - nu^2) / (E k) (cosh w - 1) / (sinh w + w)
    a = 2 (1 - nu^2) / (E k) (cosh w + 1) / (sinh w - w)

A pressure on one face moves it by (a + s) / 2, and the other face by (a - s) / 2. Pressures and
displacements are averaged over rings around the sensor. Pressures and gaps of the rings solve a
complementarity problem. Where the skin touches everywhere, this model changes nothing of what the
sensor feels. The bone is taken as a plane.
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
"""Largest width of a ring that may touch [mm]."""
_HELD_RINGS = 12
"""Rings outside, on which the skin is held."""
_WAVES = 0.06 * (np.arange(500) + 0.5)
"""Wave numbers k over which is integrated [1/mm]."""
_NEAR = (0.00001109, -0.00031761, 0.00443319, -0.03954289, 0.21093573, -0.56249985, 0.5)
_FAR = (-0.00020033, 0.00113653, -0.00249511, 0.00017105, 0.01659667, 0.00000156, 0.79788456)
_PHASE = (-0.00029166, 0.00079824, 0.00074348, -0.00637879, 0.0000565, 0.12499612, -2.35619449)
"""Polynomials of Bessel's function of order one, highest power first: below 3, and amplitude and
phase above 3 (M. Abramowitz and I. A. Stegun, Handbook of Mathematical Functions, 1964, 9.4.4 and
9.4.6).
"""
_FLOOR = 1e-5
"""Stiffness of springs under the plate [MPa/mm]: so soft that they only keep long waves finite."""
_MAX_STEPS = 60
"""Largest number of exchanges of the active set."""


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

    def on_sensor_n(self, pressure_mpa: Array) -> float:
        """Return the force of pressures under the rings on the active area [N]."""
        force_n = self.area_mm2[: len(pressure_mpa)] * pressure_mpa
        return float(force_n[self.is_active].sum())

    def compare(self, force_n: Array, distance_mm: Array) -> tuple[float, float]:
        """Compare with a skin that touches everywhere, under forces at distances from the sensor.

        Returns the change of the force on the active area, beyond that at rest [N], and how much
        deeper the skin sinks, times the force [N mm].
        """
        count = len(self.area_mm2)
        ring = np.clip(np.searchsorted(self.edges_mm, distance_mm) - 1, 0, count - 1)
        outer_mpa = np.bincount(ring, force_n, count) / self.area_mm2
        sunk_mm = self.sink @ outer_mpa

        touching_mpa = np.linalg.solve(self.compliance, sunk_mm)
        pressed_mpa = find_pressures(self.compliance, self.gap_mm - sunk_mm)
        change_mpa = pressed_mpa - self.rest_mpa - touching_mpa

        free_mm2 = self.area_mm2[: len(sunk_mm)]
        work = -float((free_mm2 * sunk_mm * change_mpa).sum())
        return self.on_sensor_n(change_mpa), work


@lru_cache(maxsize=256)
def lay_rings(form: PadForm, young_mpa: float) -> Inside | None:
    """Lay rings under a skin; None where it touches everywhere, or is bonded."""
    if form.bonded or not (form.gap_mm or form.bump_height_mm):
        return None

    edges = _place_edges(form)
    area = math.pi * np.diff(edges**2)
    compliance, sink = _hold_outer_rings(*_compute_compliances(form, young_mpa, edges, area))

    free = len(compliance)
    middle = 0.5 * (edges[:free] + edges[1 : free + 1])
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


def _place_edges(form: PadForm) -> Array:
    """Place the edges of the rings [mm]: of those that may touch, then of those that are held."""
    held_mm = _find_held_radius_mm(form)
    marks = sorted({0.0, form.active_radius_mm, form.bump_radius_mm, held_mm})
    edges = [np.array([0.0])]

    for low, high in pairwise(marks):
        count = math.ceil((high - low) / _RING_MM)
        edges.append(np.linspace(low, high, count + 1)[1:])

    width_mm = 2.0 * form.over_sensor_mm
    edges.append(held_mm + width_mm * np.arange(1, _HELD_RINGS + 1) / _HELD_RINGS)
    return np.concatenate(edges)


def _find_held_radius_mm(form: PadForm) -> float:
    """Find the radius from which on the skin is held [mm].

    It is the mean of the distances from the sensor to the side of the bone and to its tip, which
    agrees with finite elements.
    """
    distance = np.arange(0.0, 60.0, 0.1)
    zero = np.zeros_like(distance)
    across = form.bone_mm(distance, zero + form.sensor_z_mm)
    along = form.bone_mm(zero, distance + form.sensor_z_mm)

    to_side_mm = float(distance[np.isfinite(across)].max())
    to_tip_mm = float(distance[np.isfinite(along)].max())
    return 0.5 * (to_side_mm + to_tip_mm)


def _compute_compliances(
    form: PadForm, young_mpa: float, edges: Array, area: Array
) -> tuple[Array, Array]:
    """Compute how far pressures on the rings of one face move it, and the other face [mm/MPa]."""
    k = _WAVES
    w = k * form.over_sensor_mm
    softness = 2.0 * (1.0 - form.poisson * form.poisson) / (young_mpa * k)
    s = softness * (np.cosh(w) - 1.0) / (np.sinh(w) + w)
    a = 1.0 / ((np.sinh(w) - w) / (softness * (np.cosh(w) + 1.0)) + 0.5 * _FLOOR)

    # Integral of each wave over the disc inside an edge, and its mean over each ring.
    radius = edges[:, None]
    integral = 2.0 * math.pi * radius * _bessel_one(radius * k) / k
    mean = np.diff(integral, axis=0) / area[:, None]

    own_face = _sum_waves(mean, a + s) * area
    other_face = _sum_waves(mean, a - s) * area
    return own_face, other_face


def _sum_waves(mean: Array, twice_yield: Array) -> Array:
    """Integrate over all waves what pressure on one ring moves another, by twice a wave's yield."""
    step = _WAVES[1] - _WAVES[0]
    weight = 0.5 * twice_yield * _WAVES * step / (2.0 * math.pi)
    # For so small a product, the threads of `@` take ten times as long as `einsum` in one thread.
    total: Array = np.einsum("ik,jk->ij", mean * weight, mean)
    return total


def _hold_outer_rings(own_face: Array, other_face: Array) -> tuple[Array, Array]:
    """Eliminate the outer rings, which do not move; return `compliance` and `sink` of `Inside`."""
    free = len(own_face) - _HELD_RINGS
    held = slice(free, None)
    transfer = np.linalg.solve(own_face[held, held].T, own_face[:free, held].T).T
    compliance = own_face[:free, :free] - transfer @ own_face[held, :free]
    sink = other_face[:free] - transfer @ other_face[held]
    return compliance, sink


def _bessel_one(x: Array) -> Array:
    """Evaluate Bessel's function of order one at x >= 0."""
    near = np.minimum(x / 3.0, 1.0)
    far = 3.0 / np.maximum(x, 3.0)
    wave = np.polyval(_FAR, far) * np.cos(x + np.polyval(_PHASE, far)) * np.sqrt(far / 3.0)

    return np.where(x < 3.0, x * np.polyval(_NEAR, near * near), wave)


def find_pressures(compliance: Array, gap: Array) -> Array:
    """Find pressures >= 0 that leave gaps >= 0, where each ring has a pressure or a gap, not both.

    A primal-dual active set: rings in contact are exchanged until none pulls and none overlaps.
    """
    in_contact = gap < 0.0
    for step in range(_MAX_STEPS):
        pressure = np.zeros_like(gap)
        pressure[in_contact] = np.linalg.solve(
            compliance[np.ix_(in_contact, in_contact)], -gap[in_contact]
        )

        pull = -pressure / max(float(np.abs(pressure).max()), 1e-12)
        overlap = -(gap + compliance @ pressure)
        fault = np.where(in_contact, pull, overlap)
        if fault.max() <= 1e-9:
            break

        # Exchanging all faulty rings may go round in circles, exchanging the worst alone does not.
        exchanged = fault > 1e-9
        if 2 * step >= _MAX_STEPS:
            exchanged = fault == fault.max()

        in_contact = in_contact ^ exchanged

    return np.maximum(pressure, 0.0)
