"""The soft pad between bone and surface: stiffness from the design's form, moving mass from its resonance.

Hertz's contact of a sphere on a flat and Mindlin's tangential stiffness (K. L. Johnson, Contact Mechanics,
1985, sections 4.2 and 7.2). The pad is treated as half space, though the bone lies only a skin's thickness
below: real pads are stiffer. Assumption.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fingertip.arrays import Array
from fingertip.design import Design

YOUNG_PA = 1.0e6
"""Silicone of 40 shore A; published figures run from 0.7 to 2.0 MPa."""
POISSON = 0.5
"""Rubber keeps its volume."""
HAND_N_PER_M = 90.0
"""Compliance of the hand behind the finger, from the article's III.C: targets spread over 2 cm gave 0.2 to
2 N."""
RESONANCE_HZ = 90.0
"""Of the embedded fingertip at 1 N: its spectrum rarely exceeds 100 Hz (article, figure 2). Assumption
within that."""
DAMPING_RATIO = 0.15
"""Of the pad's motion in both directions. Assumption (loss factor of soft silicone 0.1 to 0.4)."""


@dataclass(frozen=True)
class Pad:
    """A pad on a flat, linear around a holding force, quasi-static at every force."""

    radius_m: float
    """Radius of curvature across the finger [m], taken in both directions (assumption)."""
    resonance_at_1n_hz: float = RESONANCE_HZ

    @classmethod
    def of(cls, design: Design, resonance_hz: float = RESONANCE_HZ) -> Pad:
        """The pad of a design: curvature of its palmar conic arc, ``R = 2 w^2 a^2 / b``."""
        a, b = design.skin.width_mm / 2, design.skin.semi_axis_palmar_mm
        return cls(2 * design.skin.squareness_palmar**2 * a * a / b * 1e-3, resonance_hz)

    @property
    def _modulus_pa(self) -> float:
        return YOUNG_PA / (1 - POISSON**2)

    def normal_stiffness_n_per_m(self, force_n: float) -> float:
        """``dN/d(indentation) = (6 E*^2 R N)^(1/3)`` [N/m]."""
        return math.cbrt(6 * self._modulus_pa**2 * self.radius_m * force_n)

    def tangential_stiffness_n_per_m(self, force_n: float) -> float:
        """Mindlin: the normal stiffness times ``2 (1 - nu) / (2 - nu)`` [N/m]."""
        return self.normal_stiffness_n_per_m(force_n) * 2 * (1 - POISSON) / (2 - POISSON)

    @property
    def mass_kg(self) -> float:
        """Mass that moves with the pad [kg]: the one with its resonance under 1 N."""
        return self.normal_stiffness_n_per_m(1.0) / (2 * math.pi * self.resonance_at_1n_hz) ** 2

    def resonance_hz(self, force_n: float) -> float:
        """Normal resonance at a holding force [Hz]; it grows with the sixth root of the force."""
        return math.sqrt(self.normal_stiffness_n_per_m(force_n) / self.mass_kg) / (2 * math.pi)

    @property
    def hand_hz(self) -> float:
        """Frequency [Hz] at which that mass swings on the compliant hand; slower motion the hand follows."""
        return math.sqrt(HAND_N_PER_M / self.mass_kg) / (2 * math.pi)

    def depth_m(self, force_n: float) -> float:
        """How far the hand has to be pressed on for a force [m]: the hand's give plus Hertz's indentation."""
        return force_n / HAND_N_PER_M + self.hertz_m_per_n23 * math.cbrt(force_n) ** 2

    def force_n(self, depth_m: Array) -> Array:
        """Quasi-static normal force [N], the inverse of `depth_m`; exactly 0 where `depth_m` is not above 0.

        Newton's method on ``n^3/k + c n^2 = depth`` for n, the cube root of the force. It starts above the
        root of a convex function and so falls monotonically.
        """
        k, c = HAND_N_PER_M, self.hertz_m_per_n23
        depth = np.maximum(depth_m, 0.0)
        n = np.sqrt(depth / c)
        for _ in range(12):
            n = n - (n * n * (n / k + c) - depth) / np.where(n > 0.0, n * (3 * n / k + 2 * c), 1.0)
        return np.where(depth > 0.0, n * n * n, 0.0)

    @property
    def hertz_m_per_n23(self) -> float:
        """Hertz's indentation under 1 N [m]; it grows with the force to the power 2/3."""
        return math.cbrt(9 / (16 * self.radius_m * self._modulus_pa**2))
