"""Formulas of strength: stress concentrations at a shoulder with a fillet and at a hole, and the
force of a knock.

From W. C. Young, R. G. Budynas, A. M. Sadegh, Roark's Formulas for Stress and Strain, 8th ed.,
2012: table 17.1 for shoulder and hole, chapter 16 for the knock. A mass that hits something hard is
stopped by the pad and by the bone behind it, two springs in series. At a force F they have taken
the energy F d / 3 + F^2 / (2 k), which is m v^2 / 2 at the largest force. The bone has the
stiffness k; the pad's force grows with the square of its indentation d, as the layer model finds
from 5 to 100 N. Nothing else gives way and nothing is damped, so the force is an upper bound.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

MIN_RATIO = 0.25
MAX_RATIO = 20.0
"""Range of the step's height over the fillet's radius in which the formula holds."""
VON_MISES_SHEAR = math.sqrt(3.0)
"""Tensile stress that is equivalent to a shear stress of 1 (von Mises)."""


def shoulder_in_bending(large_mm: float, small_mm: float, fillet_mm: float) -> float:
    """Factor at a shoulder between two round shafts, on the stress of the thinner one."""
    h = (large_mm - small_mm) / 2
    if h <= 0.0:
        return 1.0

    q = min(max(h / fillet_mm if fillet_mm > 0.0 else math.inf, MIN_RATIO), MAX_RATIO)
    root = math.sqrt(q)
    if q <= 2.0:
        c1 = 0.927 + 1.149 * root - 0.086 * q
        c2 = 0.015 - 3.281 * root + 0.837 * q
        c3 = 0.847 + 1.716 * root - 0.506 * q
        c4 = -0.790 + 0.417 * root - 0.246 * q
    else:
        c1 = 1.225 + 0.831 * root - 0.010 * q
        c2 = -3.790 + 0.958 * root - 0.257 * q
        c3 = 7.374 - 4.834 * root + 0.862 * q
        c4 = -3.809 + 3.046 * root - 0.595 * q

    s = 2 * h / large_mm
    return max(1.0, c1 + s * (c2 + s * (c3 + s * c4)))


def hole_in_tension(hole_mm: float, width_mm: float) -> float:
    """Factor at a hole in the middle of a flat bar, on the stress of the section beside it.

    In bending it is smaller.
    """
    s = min(hole_mm / width_mm, 1.0)
    return 3.0 - 3.13 * s + 3.66 * s * s - 1.53 * s**3


PIN = "pin of the joint"
"""Name of the place."""
# The next two are factors at the bore of an eye on which a pin pulls. They multiply the stress of
# the section beside it at the end where the pin presses most. Own finite elements with contact
# (tests/cad/test_bone_elements.py) found 2.7 at bores of 0.29 to 0.31 times the height, and with
# steel 2.7 to 3.6 at those of 0.27 to 0.31.
PIN_IN_EYE = 2.8
"""Factor of a pin of the eye's own material."""
STEEL_IN_EYE = 3.65
"""Factor of a pin of steel."""
STEEL_MPA = 200e3
"""Modulus of steel [MPa]."""


def pin_peak(thickness_mm: float, pin_mm: float, stiffness: float = 1.0) -> float:
    """Largest pressure of a pin along a cheek that it pulls at one end, over the mean one.

    The pin is a beam on an elastic bed, whose end stays straight in the part between the cheeks (M.
    Hetenyi, Beams on elastic foundation, 1946, chapter 3). The bed is as stiff as the cheek's
    material; `stiffness` is the modulus of the pin over that of the cheek.
    """
    x: float = 2 * thickness_mm / pin_mm * (16 / math.pi / stiffness) ** 0.25
    return x / 2 * (math.cosh(x) + math.cos(x) + 2) / (math.sinh(x) + math.sin(x))


@dataclass(frozen=True)
class StressFactors:
    """Stress concentration factors of a section that is bent in its width and in its height."""

    width: float = 1.0
    height: float = 1.0

    def combined_with(self, factors: StressFactors) -> StressFactors:
        return StressFactors(max(self.width, factors.width), max(self.height, factors.height))


AT_CORNER = StressFactors(1.6, 1.6)
"""Stress concentration beside a corner that is not rounded.

Own finite elements (tests/cad/test_bone_elements.py) found 1.4 to 1.6 at collars of 2 and 6 mm.
Formulas of shoulders would give 2 to 2.5: they hold for shafts that stay thick.
"""
CORNER_REACH_MM = 1.0
"""Distance from such a corner up to which it acts [mm]."""
FOOT_REACH = 2.0
"""Length along which a fillet raises the stress, in radii from the root."""
OF_CHORDS = 1.15
"""Factor by which the chords of a fillet raise the stress more than the arc would.
Finite elements of posts found 1.07 to 1.12.
"""


def at_foot(
    large_mm: tuple[float, float],
    small_mm: tuple[float, float],
    fillet_mm: float,
    from_root_mm: float,
) -> StressFactors:
    """Find the factors at a distance from the root of a drawn fillet, in its thin part.

    Each is that of a shoulder with the sizes in the direction in which the shaft bends.
    """
    if not 0.0 <= from_root_mm <= FOOT_REACH * fillet_mm:
        return StressFactors()

    factors = (
        shoulder_in_bending(large, small, fillet_mm)
        for large, small in zip(large_mm, small_mm, strict=True)
    )
    return StressFactors(*(OF_CHORDS * factor if factor > 1.0 else 1.0 for factor in factors))


@dataclass(frozen=True)
class LocalStress:
    """Stress at one place per newton of load on the fingertip, other than bending of a section."""

    place: str
    z_mm: float
    stress_per_n: float
    """Stress with its concentration [MPa/N]."""
    concentration: float = 1.0
    at_knock: bool = True
    """False for what a knock does not load."""
    direction: tuple[float, float, float] = (0.0, 1.0, 0.0)


PRESSED_N = 50.0
"""Force at which the pad's indentation is taken [N]."""
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
        """Find the largest force of a knock by Newton's method.

        It begins with the force without a pad, which is larger.
        """
        energy_j = mass_kg * speed_m_s**2 / 2
        force = speed_m_s * math.sqrt(1e3 * self.bone_n_per_mm * mass_kg)

        for _ in range(_STEPS):
            slope = 1e-3 * (
                self.pad_mm * math.sqrt(force / PRESSED_N) / 2 + force / self.bone_n_per_mm
            )
            force -= (self.energy_j(force) - energy_j) / slope

        return force

    def speed_m_s(self, mass_kg: float, force_n: float) -> float:
        """Return the speed of a knock with this largest force."""
        return math.sqrt(2 * self.energy_j(force_n) / mass_kg)
