"""Force of a knock.

A mass that hits something hard is stopped by the pad and by the bone behind it, two springs in series. At a force F
they have taken the energy F d / 3 + F^2 / (2 k), which is m v^2 / 2 at the largest force (W. C. Young, R. G. Budynas,
A. M. Sadegh, Roark's Formulas for Stress and Strain, 8th ed., 2012, chapter 16). The bone has the stiffness k; the
pad's force grows with the square of its indentation d, as the layer model finds from 5 to 100 N. Nothing else gives way
and nothing is damped, so the force is an upper bound.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

PRESSED_N = 50.0
"""Force at which the pad's indentation is taken [N]."""
_GRAVITY_M_S2 = 9.80665
_STEPS = 60


@dataclass(frozen=True)
class Springs:
    """Pad and bone in series under a force at one place."""

    pad_mm: float
    """Indentation of the pad at `PRESSED_N`."""
    bone_n_per_mm: float

    def energy_j(self, force_n: float) -> float:
        """Return the energy that both have taken at a force."""
        indentation_mm = self.pad_mm * math.sqrt(force_n / PRESSED_N)
        return 1e-3 * (force_n * indentation_mm / 3 + force_n**2 / (2 * self.bone_n_per_mm))

    def force_n(self, mass_kg: float, speed_m_s: float) -> float:
        """Find the largest force of a knock by Newton's method, from that without a pad, which is larger."""
        energy_j = mass_kg * speed_m_s**2 / 2
        force = speed_m_s * math.sqrt(1e3 * self.bone_n_per_mm * mass_kg)
        for _ in range(_STEPS):
            slope = 1e-3 * (self.pad_mm * math.sqrt(force / PRESSED_N) / 2 + force / self.bone_n_per_mm)
            force -= (self.energy_j(force) - energy_j) / slope
        return force

    def speed_m_s(self, mass_kg: float, force_n: float) -> float:
        """Return the speed of a knock with this largest force."""
        return math.sqrt(2 * self.energy_j(force_n) / mass_kg)

    def drop_mm(self, mass_kg: float, force_n: float) -> float:
        """Return the height from which a mass drops to a knock with this largest force."""
        return 1e3 * self.energy_j(force_n) / (mass_kg * _GRAVITY_M_S2)
