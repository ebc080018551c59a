"""Pad in one pose, as a simulation meets it: stiffness, the mass that moves behind it, and what
reaches the sensor.

Force over indentation follows Hertz' power, F proportional to d^(3/2), with the layer model's
stiffness at 1 N. The layer itself stiffens more: on fsr400 its stiffness is 0.75 times this at 0.2
N and 1.4 times at 5 N. Along the surface the stiffness is Mindlin's (K. L. Johnson, Contact
Mechanics, 1985, section 7.2).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from fingertip.design import Design
from fingertip.foundation.numerics import Array
from fingertip.pad.layer import find_contacts, find_rest_n
from fingertip.pad.pad_geometry import PadForm
from fingertip.pad.touch import Pose

REFERENCE_POSE = Pose(tilt_deg=2.0)
"""Pose of the article's protocol, and of a finger on which weights are put. An assumption: where a
straight pad feels most. The article does not state it.
"""
_MINDLIN = 2.0 / 3.0
"""Stiffness along the surface over that across it, ``2 (1 - nu) / (2 - nu)``, of incompressible
rubber.
"""
FORCES_N = (0.05, 0.1, 0.25, 0.5, 0.9, 1.1, 2.0, 4.0, 8.0)
"""Forces of the contacts from which the share is fitted. The two about 1 N give the stiffness."""
_DEGREE = 3
_DIGITS = 6
"""Significant digits of what is fitted, and decimals of its coefficients: processors differ in
digits far beyond.
"""
_LEAST_REFERENCE = 0.02
"""Least share in the reference pose to which a share is related."""


@dataclass(frozen=True)
class Backing:
    """Hand or arm that holds the finger: a mass that moves with it, on a spring, and the damping of
    the pad between.
    """

    mass_kg: float = 0.035
    """Mass of hand or robot arm that moves with the finger. Assumption: on the pad of fsr400 it
    resonates at some 90 Hz at 1 N, below the 100 Hz of the article's figure 2.
    """
    stiffness_n_per_m: float = 90.0
    """Stiffness of the hand: 2 cm of target positions gave 0.2 to 2 N (article, III.C)."""
    damping_ratio: float = 0.15
    """Damping ratio of the mass on the pad, in both directions. Assumption: soft silicone has a
    loss factor of 0.1 to 0.4.
    """

    @property
    def resonance_hz(self) -> float:
        """Resonance of the mass on this stiffness alone [Hz].

        The hand follows slower motion of a surface.
        """
        return math.sqrt(self.stiffness_n_per_m / self.mass_kg) / (2 * math.pi)


@dataclass(frozen=True)
class Pad:
    """Linear stiffness at a holding force, the quasi-static force at any depth, and the sensor's
    part of it.
    """

    stiffness_1n_n_per_m: float
    """Stiffness at 1 N across the surface."""
    area_1n_m2: float
    """Area of the contact at 1 N."""
    share: tuple[float, ...]
    """Polynomial of the sensor's share over the fourth root of the force [N], lowest power first.
    """
    shear_share: tuple[float, ...]
    """The same of the part of a force along the surface, towards the tip, that presses on the
    sensor.
    """
    reference_share: float
    """Share of 1 N in the reference pose."""
    rest_n: float = 0.0
    """Force on the sensor when nothing touches the finger, from a bump inside the skin."""
    backing: Backing = Backing()

    @classmethod
    def from_design(
        cls, design: Design, pose: Pose = REFERENCE_POSE, backing: Backing = Backing()
    ) -> Pad:
        """Build the pad of a design in a pose. Raises TraceError."""
        return replace(_respond(PadForm.of_design(design), pose), backing=backing)

    def normal_stiffness_n_per_m(self, force_n: float) -> float:
        """Normal stiffness [N/m]; it grows with the cube root of the force."""
        return self.stiffness_1n_n_per_m * math.cbrt(force_n)

    def tangential_stiffness_n_per_m(self, force_n: float) -> float:
        return _MINDLIN * self.normal_stiffness_n_per_m(force_n)

    def resonance_hz(self, force_n: float) -> float:
        """Normal resonance at a holding force [Hz]: that of the mass between pad and backing."""
        stiffness = self.normal_stiffness_n_per_m(force_n) + self.backing.stiffness_n_per_m
        return math.sqrt(stiffness / self.backing.mass_kg) / (2 * math.pi)

    @property
    def follow_share(self) -> float:
        """Part of a slow height of a surface that moves the hand.

        The rest presses the pad: two springs in series.
        """
        return self.stiffness_1n_n_per_m / (
            self.stiffness_1n_n_per_m + self.backing.stiffness_n_per_m
        )

    def depth_m(self, force_n: float) -> float:
        """Travel of the hand beyond the touch for a force [m]: deflection of the hand plus
        indentation.
        """
        return (
            force_n / self.backing.stiffness_n_per_m
            + self.hertz_m_per_n23 * math.cbrt(force_n) ** 2
        )

    def force_n(self, depth_m: Array) -> Array:
        """Quasi-static normal force [N]: the inverse of the method `depth_m`, exactly 0 where the
        depth is not above 0.

        Newton's method solves ``n^3/k + c n^2 = depth`` for n, the cube root of the force. It
        starts above the root of a convex function, so it decreases monotonically. A depth mostly
        stays for long, and each is solved once.
        """
        changes = np.flatnonzero(np.diff(depth_m, prepend=np.nan) != 0.0)
        k = self.backing.stiffness_n_per_m
        c = self.hertz_m_per_n23
        force = np.zeros(len(changes))
        touches = depth_m[changes] > 0.0
        depth = depth_m[changes][touches]
        # both above the root: without the hand, without the pad
        n = np.sqrt(depth / c)
        bound = np.cbrt(depth * k)
        n = np.where(n > 16.0 * bound, bound, n)  # steps from farther away would not arrive
        for _ in range(12):
            n = n - (n * n * (n / k + c) - depth) / (n * (3 * n / k + 2 * c))

        force[touches] = n * n * n
        return np.repeat(force, np.diff(changes, append=len(depth_m)))

    def patch_radius_m(self, force_n: float) -> float:
        """Radius of a disc as large as the contact patch [m].

        It grows with the cube root of the force.
        """
        return math.sqrt(self.area_1n_m2 / math.pi) * math.cbrt(force_n)

    @property
    def hertz_m_per_n23(self) -> float:
        """Indentation under 1 N by Hertz' power [m]. It grows with the force to the power 2/3."""
        return 1.5 / self.stiffness_1n_n_per_m

    def sensed_n(
        self, contact_n: Array, shear_n: Array | None = None, is_relative: bool = False
    ) -> Array:
        """Return the force on the sensor [N], from the contact's force and a force along the
        surface, towards the tip.

        A force curve that was measured on a finger holds the share of its own pose: what it is read
        at is the force of the contact, times the share in relation to that pose.
        """
        root = np.sqrt(np.sqrt(np.clip(contact_n, FORCES_N[0], FORCES_N[-1])))
        sensed = contact_n * _evaluate(self.share, root)
        if shear_n is not None:
            sensed = sensed + shear_n * _evaluate(self.shear_share, root)

        return np.maximum(
            sensed / self.reference_share if is_relative else sensed + self.rest_n, 0.0
        )


def _evaluate(coefficients: Sequence[float], x: Array) -> Array:
    """Evaluate a polynomial by Horner's rule, which every processor rounds alike."""
    value = np.full_like(x, coefficients[-1])
    for coefficient in coefficients[-2::-1]:
        value = value * x + coefficient

    return value


@lru_cache(maxsize=1024)
def _respond(form: PadForm, pose: Pose) -> Pad:
    contacts = find_contacts(form, pose, FORCES_N, math.inf)
    root = np.sqrt(np.sqrt(np.array(FORCES_N)))

    def fit(values: list[float]) -> tuple[float, ...]:
        coefficients = np.polynomial.polynomial.polyfit(root, np.array(values), _DEGREE)
        return tuple(round(float(value), _DIGITS) for value in coefficients)

    low, high = (contact for contact in contacts if 0.8 < contact.force_n < 1.2)
    stiffness = 1e3 * (high.force_n - low.force_n) / (high.depth_mm - low.depth_mm)
    area_m2 = 0.5e-6 * (low.area_mm2 + high.area_mm2)
    share = fit([contact.share for contact in contacts])
    reference = (
        sum(share) if pose == REFERENCE_POSE else _respond(form, REFERENCE_POSE).reference_share
    )

    return Pad(
        stiffness_1n_n_per_m=float(f"{stiffness:.{_DIGITS}g}"),
        area_1n_m2=float(f"{area_m2:.{_DIGITS}g}"),
        share=share,
        shear_share=fit([contact.shear_share for contact in contacts]),
        reference_share=max(_LEAST_REFERENCE, reference),
        rest_n=round(find_rest_n(form), _DIGITS),
    )
