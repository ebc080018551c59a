"""Formulas for the filter's component values, which the rules and the board share.

The filter is a third-order Butterworth high-pass: a first-order stage (R1, C1) and a unity-gain Sallen-Key stage (C2,
C3, R2, R3), with all three capacitors equal to C (article, eqs. 2, 5, 6, 7, 11) and omega_c = 2 pi f_c.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from fingertip.design.parameters import Board

# Third-order Butterworth polynomial (s + 1)(s^2 + s + 1), from the article's reference 30.
A1 = 1.0
A2 = 1.0
B2 = 1.0
SECTION_QUALITY = math.sqrt(B2) / A2
"""Quality factor Q of the second-order section, eq. (8)."""

MIN_OHM = 10.0
"""Minimum resistance [ohm]. Below it the amplifier's output resistance and the tracks are no longer negligible."""
MAX_OHM = 10e6
"""Maximum resistance [ohm]. Above it leakage and the amplifier's input resistance are no longer negligible."""


@dataclass(frozen=True)
class FilterComponents:
    """Resistances [ohm] and capacitances [F] of the filter and the envelope."""

    r1_ohm: float
    r2_ohm: float
    r3_ohm: float
    r4_ohm: float
    r5_ohm: float
    r_lp_ohm: float
    c_f: float
    """C1 = C2 = C3."""
    c_lp_f: float


def r1_ohm(cutoff_hz: float, c_f: float) -> float:
    """R1 = 1 / (a1 C omega_c) [ohm], eq. (5), for f_c [Hz] and C [F]; infinite where the product underflows."""
    return _ratio(1.0, A1 * c_f * math.tau * cutoff_hz)


def r2_ohm(cutoff_hz: float, c_f: float) -> float:
    """R2 = a2 / (2 b2 C omega_c) [ohm], eq. (6): from the node between C2 and C3 to the output."""
    return _ratio(A2, 2 * B2 * c_f * math.tau * cutoff_hz)


def r3_ohm(cutoff_hz: float, c_f: float) -> float:
    """R3 = 2 / (a2 C omega_c) [ohm], eq. (7): from the amplifier's input to ground."""
    return _ratio(2.0, A2 * c_f * math.tau * cutoff_hz)


def r4_ohm(passband_gain: float, r5_ohm: float) -> float:
    """R4 = R5 / (G - 1) [ohm], eq. (2) solved for R4; G > 1."""
    return r5_ohm / (passband_gain - 1.0)


def r_lp_ohm(envelope_cutoff_hz: float, c_lp_f: float) -> float:
    """R_LP = 1 / (omega_LP C_LP) [ohm], below eq. (11)."""
    return _ratio(1.0, c_lp_f * math.tau * envelope_cutoff_hz)


def ideal_components(board: Board) -> FilterComponents:
    """Compute the values by the formulas, with the design's capacitors and R5. The function never raises."""
    c_f = to_farads(board.capacitor_uf)
    c_lp_f = to_farads(board.envelope_capacitor_uf)
    return FilterComponents(
        r1_ohm=r1_ohm(board.cutoff_hz, c_f),
        r2_ohm=r2_ohm(board.cutoff_hz, c_f),
        r3_ohm=r3_ohm(board.cutoff_hz, c_f),
        r4_ohm=r4_ohm(board.passband_gain, board.r5_ohm),
        r5_ohm=float(board.r5_ohm),
        r_lp_ohm=r_lp_ohm(board.envelope_cutoff_hz, c_lp_f),
        c_f=c_f,
        c_lp_f=c_lp_f,
    )


MAX_1206_F = 10e-6
"""Largest capacitor of the filter and the envelope [F]: the largest X7R for 16 V that is available in size 1206."""
MIN_SELECTABLE_F, MAX_SELECTABLE_F = 100e-12, MAX_1206_F
"""Range of the capacitors that the board selects itself [F]. The tracks' capacitance is not negligible below it."""
SELECTABLE_R1_OHM = (2e3, 20e3)
"""Range of R1 for a capacitor that the board selects: low for bias and noise, high enough for an amplifier to drive."""
SELECTABLE_R_LP_OHM = (1e3, 10e3)
"""Range of R_LP for a capacitor that the board selects. The diode or the rectifier drives it."""


def selectable_range_f(cutoff_hz: float, range_ohm: tuple[float, float]) -> tuple[float, float]:
    """Range of the selectable capacitances [F] for which 1 / (C omega) lies in a range [ohm] at a cutoff [Hz]."""
    low, high = (_ratio(1.0, math.tau * cutoff_hz * ohm) for ohm in (range_ohm[1], range_ohm[0]))
    return _clamp(low), _clamp(high)


def _clamp(c_f: float) -> float:
    return min(max(c_f, MIN_SELECTABLE_F), MAX_SELECTABLE_F)


def to_farads(microfarads: float) -> float:
    """Convert a capacitance from [uF] to [F]. Division makes 2.2 uF the float nearest to 2.2e-6."""
    return microfarads / 1e6


def _ratio(numerator: float, denominator: float) -> float:
    return numerator / denominator if denominator else math.inf


MIN_LIMITING_CAPACITOR_F, MAX_LIMITING_CAPACITOR_F = 10e-12, 1e-6
"""Range of the capacitor across R5 [F].

Below it the resistor's own capacitance is not negligible, and above it there is no capacitor of its size.
"""


def compute_limiting_capacitor_f(r5_ohm: float, band_limit_hz: float) -> float:
    """C = 1 / (omega R5) [F] across R5: above the band limit [Hz] the first stage's gain falls towards 1."""
    return 1.0 / (math.tau * r5_ohm * band_limit_hz)


SERIES_CAPACITORS_UF = (1.0, 2.2, 4.7, 10.0, 22.0, 47.0, 100.0)
"""Ceramic capacitors available in size 1206 [uF]; those above 10 uF for 6.3 V, with no direct voltage across them."""
MIN_CUTOFF_RATIO = 10.0
"""Minimum ratio of the cutoff to the corner frequency of R4 and its series capacitor.

The gain at the cutoff is then reduced by at most 0.5 %.
"""
