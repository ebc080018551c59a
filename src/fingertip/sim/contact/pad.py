"""Soft pad between bone and surface: stiffness from the shape of the design, moving mass from its resonance.

The normal stiffness is that of a Hertzian contact between a sphere and a flat, the tangential stiffness is Mindlin's
(K. L. Johnson, Contact Mechanics, 1985, sections 4.2 and 7.2). The pad is treated as a half-space, although the bone
lies only the thickness of the skin below. Real pads are stiffer. Assumption.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fingertip.design import Design
from fingertip.design.geometry.conic import weight_of_fullness
from fingertip.foundation.numerics import Array

YOUNG_PA = 1.0e6
"""Young's modulus of silicone of Shore hardness 40 A [Pa]. Published values range from 0.7 to 2.0 MPa."""
POISSON = 0.5
"""Poisson's ratio: rubber is incompressible."""
HAND_N_PER_M = 90.0
"""Stiffness of the hand behind the finger [N/m]. In the article (III.C), target positions spread over 2 cm gave forces
of 0.2 to 2 N."""
RESONANCE_HZ = 90.0
"""Normal resonance of the embedded fingertip at 1 N [Hz]. Its spectrum rarely exceeds 100 Hz (article, figure 2); the
value below that is an assumption."""
DAMPING_RATIO = 0.15
"""Damping ratio of the pad in both directions. Assumption: soft silicone has a loss factor of 0.1 to 0.4."""


@dataclass(frozen=True)
class Pad:
    """Pad on a flat surface: linear stiffness at a holding force, and the quasi-static force at any depth."""

    radius_m: float
    """Radius of curvature across the finger [m], used in both directions (assumption)."""
    resonance_at_1n_hz: float = RESONANCE_HZ
    """Normal resonance at a holding force of 1 N [Hz]."""

    @classmethod
    def from_design(cls, design: Design, resonance_hz: float = RESONANCE_HZ) -> Pad:
        """Build the pad of a design, with the curvature of its palmar conic arc: ``R = 2 w^2 a^2 / b``."""
        a, b = design.skin.width_mm / 2, design.skin.semi_axis_palmar_mm
        return cls(2 * weight_of_fullness(design.skin.pulp_fullness) ** 2 * a * a / b * 1e-3, resonance_hz)

    @property
    def _modulus_pa(self) -> float:
        return YOUNG_PA / (1 - POISSON**2)

    def normal_stiffness_n_per_m(self, force_n: float) -> float:
        """Normal stiffness ``dN/d(indentation) = (6 E*^2 R N)^(1/3)`` [N/m] (Hertz; Johnson 1985, section 4.2)."""
        return math.cbrt(6 * self._modulus_pa**2 * self.radius_m * force_n)

    def tangential_stiffness_n_per_m(self, force_n: float) -> float:
        """Tangential stiffness [N/m]: the normal one times ``2 (1 - nu) / (2 - nu)`` (Mindlin; Johnson 1985, 7.2)."""
        return self.normal_stiffness_n_per_m(force_n) * 2 * (1 - POISSON) / (2 - POISSON)

    @property
    def mass_kg(self) -> float:
        """Mass that moves with the pad [kg], from its stiffness and resonance at 1 N."""
        return self.normal_stiffness_n_per_m(1.0) / (2 * math.pi * self.resonance_at_1n_hz) ** 2

    def resonance_hz(self, force_n: float) -> float:
        """Normal resonance at a holding force [Hz]. It grows with the sixth root of the force."""
        return math.sqrt(self.normal_stiffness_n_per_m(force_n) / self.mass_kg) / (2 * math.pi)

    @property
    def hand_hz(self) -> float:
        """Resonance of the pad's mass on the compliant hand [Hz]. The hand follows slower motion."""
        return math.sqrt(HAND_N_PER_M / self.mass_kg) / (2 * math.pi)

    def depth_m(self, force_n: float) -> float:
        """Travel of the hand beyond the touch for a force [m]: deflection of the hand plus Hertzian indentation."""
        return force_n / HAND_N_PER_M + self.hertz_m_per_n23 * math.cbrt(force_n) ** 2

    def force_n(self, depth_m: Array) -> Array:
        """Quasi-static normal force [N]: the inverse of the method `depth_m`, exactly 0 where the depth is not above 0.

        Newton's method solves ``n^3/k + c n^2 = depth`` for n, the cube root of the force. It starts above the root of
        a convex function, so it decreases monotonically. A depth mostly stays for long, and each is solved once.
        """
        changes = np.flatnonzero(np.diff(depth_m, prepend=np.nan) != 0.0)
        k, c = HAND_N_PER_M, self.hertz_m_per_n23
        depth = np.maximum(depth_m[changes], 0.0)
        n = np.sqrt(depth / c)
        for _ in range(12):
            n = n - (n * n * (n / k + c) - depth) / np.where(n > 0.0, n * (3 * n / k + 2 * c), 1.0)
        force = np.where(depth > 0.0, n * n * n, 0.0)
        return np.repeat(force, np.diff(changes, append=len(depth_m)))

    def patch_radius_m(self, force_n: float) -> float:
        """Radius of the contact patch [m]: ``(3 N R / (4 E*))^(1/3)`` (Hertz; Johnson 1985, section 4.2)."""
        return math.cbrt(3 * force_n * self.radius_m / (4 * self._modulus_pa))

    @property
    def hertz_m_per_n23(self) -> float:
        """Hertzian indentation under 1 N [m]. It grows with the force to the power 2/3."""
        return math.cbrt(9 / (16 * self.radius_m * self._modulus_pa**2))


def cube_root(values: Array) -> Array:
    """Cube root of values of at least 0, with operations that every processor rounds alike.

    Newton's method for ``y^3 = x`` from the fourth root, for values from 1e-12 to 1e4; smaller ones count as 0.
    """
    x = np.where(values > 1e-12, values, 1.0)
    y = np.sqrt(np.sqrt(x))
    for _ in range(9):
        y = (2 * y + x / (y * y)) / 3
    return np.where(values > 1e-12, y, 0.0)
