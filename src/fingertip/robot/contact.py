"""Contact of the pad in MuJoCo's terms: solref and solimp that follow the force of the pad over its depth.

A contact of depth r and impedance d(r) holds the force F = s r d^2 / (dmax^2 (1 - d) w) in MuJoCo, where s is the
stiffness in solref, and w the sum of the inverse masses of both bodies, as `body_invweight0` has them: s holds for one
w. An impedance near 1 would hold back the masses too; a small one is a spring. Here it grows with the depth, so that
the contact stiffens as the pad does: d = dmin + (dmax - dmin) (1 - (1 - r / width)^power), by a midpoint near 0.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from fingertip.design import Design
from fingertip.pad.form import PadForm
from fingertip.pad.layer import find_contacts
from fingertip.pad.response import REFERENCE_POSE, Pad
from fingertip.sim.contact.materials import SURFACES

FORCES_N = (0.2, 0.35, 0.6, 1.0, 1.7, 2.8, 4.0, 6.0, 10.0)
"""Forces at which the contact is compared with the pad."""
_WIDTH = 1.6
"""Depth from which on the contact stiffens no more, over that at the largest force."""
REFERENCE_N = 1.0
"""Force at which the damping is linearised."""
_MAX_IMPEDANCE = 0.1
"""Impedance from that depth on: the part of other forces on the masses that the contact takes away there."""
_POWERS = tuple(1.0 + 0.1 * step for step in range(21))
_MIDPOINT = 1e-4
"""Midpoint of solimp: the least that MuJoCo takes."""
_SLIPPERIEST = "smooth"
"""Surface that gives the friction of the pad: simulators take the greater one of two that touch."""


@dataclass(frozen=True)
class ContactLaw:
    """Contact of a rigid plate with the pad, and its greatest relative error over `FORCES_N`."""

    min_impedance: float
    power: float
    depth_m: float
    """Depth from which on the contact is linear."""
    stiffness_n_per_m: float
    """Stiffness of solref for a sum of inverse masses of 1/kg."""
    damping_n_s_per_m: float
    """Damping of solref for the same."""
    error: float
    depths_mm: tuple[float, ...]
    """Depths of the pad at `FORCES_N`."""
    forces_n: tuple[float, ...]
    """Forces of the contact at these depths."""
    inverse_mass_per_kg: float
    """Inverse of the mass that the simulation of a finger moves on the pad."""
    pad_stiffness_n_per_m: float
    """Stiffness of the pad at `REFERENCE_N`."""
    friction: float
    torsion_m: float
    """Moment over force at which the contact turns."""

    @property
    def solimp(self) -> tuple[float, ...]:
        return self.min_impedance, _MAX_IMPEDANCE, self.depth_m, _MIDPOINT, self.power

    def solref(self, inverse_mass_per_kg: float) -> tuple[float, float]:
        """Return stiffness and damping for a sum of inverse masses of finger and object [1/kg]."""
        return -self.stiffness_n_per_m * inverse_mass_per_kg, -self.damping_n_s_per_m * math.sqrt(inverse_mass_per_kg)


def fit_contact(design: Design) -> ContactLaw:
    """Fit the contact to the pad in its reference pose. Raises TraceError."""
    contacts = find_contacts(PadForm.of_design(design), REFERENCE_POSE, FORCES_N, math.inf)
    depth_m, force_n = 1e-3 * np.array([contact.depth_mm for contact in contacts]), np.array(FORCES_N)
    pad, friction, fits = Pad.from_design(design), SURFACES[_SLIPPERIEST].friction.mu_c, []
    width_m = _WIDTH * float(depth_m[-1])
    for least, power in itertools.product(np.linspace(0.02 * _MAX_IMPEDANCE, _MAX_IMPEDANCE, 200), _POWERS):
        impedance = _MAX_IMPEDANCE - (_MAX_IMPEDANCE - least) * (1.0 - depth_m / width_m) ** power
        ratio = force_n * (1.0 - impedance) / (depth_m * impedance**2)
        stiffness = math.sqrt(ratio.max() * ratio.min())
        fits.append((math.sqrt(ratio.max() / ratio.min()), stiffness, float(least), power, impedance, ratio))
    spread, stiffness, least, power, impedance, ratio = min(fits, key=lambda fit: fit[0])
    slope = pad.normal_stiffness_n_per_m(REFERENCE_N)
    # 2 zeta sqrt(slope w) = impedance damping / dmax, with the damping ratio of the simulation of a finger.
    damping = 2 * pad.backing.damping_ratio * math.sqrt(slope) * _MAX_IMPEDANCE
    return ContactLaw(
        least, power, width_m, stiffness * _MAX_IMPEDANCE**2,
        damping / float(np.interp(REFERENCE_N, force_n, impedance)), spread - 1.0, tuple((1e3 * depth_m).tolist()),
        tuple((force_n * stiffness / ratio).tolist()), 1 / pad.backing.mass_kg, slope,
        friction, 2 / 3 * friction * pad.patch_radius_m(REFERENCE_N),
    )  # fmt: skip
