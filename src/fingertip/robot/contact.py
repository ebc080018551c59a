"""Law of the contact of a finger's skin in simulators, fitted to its pad.

In MuJoCo, a contact of depth r and impedance d(r) holds the force

    F = s r d^2 / (dmax^2 (1 - d) w)

where s is the stiffness in solref, and w the sum of the inverse masses of both bodies, as
`body_invweight0` has them: s holds for one w. An impedance near 1 would hold back the masses too; a
small one acts as a spring. Here it grows with the depth, so that the contact stiffens as the pad
does:

    d = dmin + (dmax - dmin) (1 - (1 - r / width)^power)

for a midpoint near 0.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from fingertip.design import Design
from fingertip.foundation.numerics import Array
from fingertip.pad.layer import find_contacts
from fingertip.pad.pad_geometry import PadForm
from fingertip.pad.response import REFERENCE_POSE, Pad
from fingertip.sim.contact.surface_files import SURFACES

FORCES_N = (0.2, 0.35, 0.6, 1.0, 1.7, 2.8, 4.0, 6.0, 10.0)
"""Forces at which the contact is compared with the pad."""
REFERENCE_N = 1.0
"""Force at which the damping is linearised."""
_WIDTH = 1.6
"""Depth from which on the contact stiffens no more, over that at the largest force."""
_MAX_IMPEDANCE = 0.1
"""Impedance from that depth on: share of other forces on the masses that the contact cancels."""
_MIN_IMPEDANCES = np.linspace(0.02 * _MAX_IMPEDANCE, _MAX_IMPEDANCE, 200)
"""Impedances at depth 0 that are tried."""
_POWERS = tuple(1.0 + 0.1 * step for step in range(21))
"""Powers that are tried."""
_MIDPOINT = 1e-4
"""Midpoint of solimp: the least that MuJoCo takes."""
_SLIPPERIEST = "smooth"
"""Surface that gives the friction of the pad: of two bodies that touch, simulators take the greater
friction.
"""


@dataclass(frozen=True)
class ContactLaw:
    """Contact of a rigid plate with the pad."""

    min_impedance: float
    power: float
    depth_m: float
    """Depth from which on the contact is linear."""
    stiffness_n_per_m: float
    """Stiffness of solref for a sum of inverse masses of 1/kg."""
    damping_n_s_per_m: float
    """Damping of solref for the same."""
    error: float
    """Greatest relative error of the force over `FORCES_N`."""
    depths_mm: tuple[float, ...]
    """Depths of the pad at `FORCES_N`."""
    forces_n: tuple[float, ...]
    """Forces of the contact at these depths."""
    inverse_mass_per_kg: float
    """Inverse of the mass that moves on the pad in the simulation of a finger."""
    pad_stiffness_n_per_m: float
    """Stiffness of the pad at `REFERENCE_N`."""
    friction: float
    torsion_m: float
    """Moment at which the contact begins to turn, over its normal force."""

    @property
    def solimp(self) -> tuple[float, ...]:
        """Impedance of MuJoCo: least and largest one, width, midpoint and power."""
        return self.min_impedance, _MAX_IMPEDANCE, self.depth_m, _MIDPOINT, self.power

    def solref(self, inverse_mass_per_kg: float) -> tuple[float, float]:
        """Return stiffness and damping for a sum of inverse masses of finger and object [1/kg]."""
        stiffness = -self.stiffness_n_per_m * inverse_mass_per_kg
        damping = -self.damping_n_s_per_m * math.sqrt(inverse_mass_per_kg)
        return stiffness, damping


def fit_contact(design: Design) -> ContactLaw:
    """Fit the contact to the pad in its reference pose. Raises TraceError."""
    force_n = np.array(FORCES_N)
    contacts = find_contacts(PadForm.of_design(design), REFERENCE_POSE, FORCES_N, math.inf)
    depth_m = 1e-3 * np.array([contact.depth_mm for contact in contacts])
    curve = _fit_curve(depth_m, force_n)

    pad = Pad.from_design(design)
    pad_stiffness = pad.normal_stiffness_n_per_m(REFERENCE_N)
    impedance = float(np.interp(REFERENCE_N, force_n, curve.impedance))
    friction = SURFACES[_SLIPPERIEST].friction.mu_c

    return ContactLaw(
        min_impedance=curve.min_impedance,
        power=curve.power,
        depth_m=curve.width_m,
        stiffness_n_per_m=curve.stiffness * _MAX_IMPEDANCE**2,
        damping_n_s_per_m=_find_damping(pad.backing.damping_ratio, pad_stiffness, impedance),
        error=curve.spread - 1.0,
        depths_mm=tuple((1e3 * depth_m).tolist()),
        forces_n=tuple((force_n * curve.stiffness / curve.needed_stiffness).tolist()),
        inverse_mass_per_kg=1 / pad.backing.mass_kg,
        pad_stiffness_n_per_m=pad_stiffness,
        friction=friction,
        torsion_m=2 / 3 * friction * pad.patch_radius_m(REFERENCE_N),
    )


@dataclass(frozen=True, eq=False)
class _Curve:
    """Force of the contact over depth, for one choice of impedance and power."""

    min_impedance: float
    power: float
    width_m: float
    impedance: Array
    """Impedance at each depth of the pad."""
    needed_stiffness: Array
    """Stiffness over dmax^2 with which the force at each depth is that of the pad."""

    @property
    def stiffness(self) -> float:
        """One stiffness for all depths, with equal errors upwards and downwards."""
        return math.sqrt(self.needed_stiffness.max() * self.needed_stiffness.min())

    @property
    def spread(self) -> float:
        """Ratio of forces at that stiffness, where it differs most from the pad."""
        return math.sqrt(self.needed_stiffness.max() / self.needed_stiffness.min())


def _fit_curve(depth_m: Array, force_n: Array) -> _Curve:
    """Find the curve that differs least from forces at these depths."""
    curves = (
        _compute_curve(depth_m, force_n, float(min_impedance), power)
        for min_impedance, power in itertools.product(_MIN_IMPEDANCES, _POWERS)
    )
    return min(curves, key=lambda curve: curve.spread)


def _compute_curve(depth_m: Array, force_n: Array, min_impedance: float, power: float) -> _Curve:
    width_m = _WIDTH * float(depth_m[-1])
    missing = (_MAX_IMPEDANCE - min_impedance) * (1.0 - depth_m / width_m) ** power
    impedance = _MAX_IMPEDANCE - missing
    needed_stiffness = force_n * (1.0 - impedance) / (depth_m * impedance**2)

    return _Curve(
        min_impedance=min_impedance,
        power=power,
        width_m=width_m,
        impedance=impedance,
        needed_stiffness=needed_stiffness,
    )


def _find_damping(ratio: float, pad_stiffness: float, impedance: float) -> float:
    """Find the damping of solref [N s/m] with the damping ratio of the simulation of a finger.

    It solves 2 ratio sqrt(pad_stiffness w) = impedance damping / dmax for w = 1/kg.
    """
    return 2 * ratio * math.sqrt(pad_stiffness) * _MAX_IMPEDANCE / impedance
