"""Component values that follow from the board's parameters: computed here, read by the rules and the board.

Third-order Butterworth high-pass of a first-order stage (R1, C1) and a unity-gain Sallen-Key stage (C2, C3,
R2, R3), all three capacitors equal to C (article, eqs. 2, 5, 6, 7, 11), omega_c = 2 pi f_c.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from fingertip.design.parameters import Board

# Third-order Butterworth: (s + 1)(s^2 + s + 1), from the article's reference 30.
A1 = 1.0
A2 = 1.0
B2 = 1.0

MIN_OHM = 10.0
"""Below this the amplifier's output and the tracks are part of the value."""
MAX_OHM = 10e6
"""Above this leakage and the amplifier's input are part of the value."""


@dataclass(frozen=True)
class FilterComponents:
    """Resistances [ohm] and capacitances [F] of the filter network and the envelope."""

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
    """R1 = 1 / (a1 C omega_c) [ohm], eq. (5), for f_c [Hz], C [F]; infinite where the product underflows."""
    return _ratio(1.0, A1 * c_f * math.tau * cutoff_hz)


def r2_ohm(cutoff_hz: float, c_f: float) -> float:
    """R2 = a2 / (2 b2 C omega_c) [ohm], eq. (6): from the middle of C2 and C3 to the output."""
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
    """The values the formulas give; the capacitors and R5 are those of the design. Never raises."""
    c_f = farad(board.capacitor_uf)
    c_lp_f = farad(board.envelope_capacitor_uf)
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


MAX_FOOTPRINT_F = 10e-6
"""The largest capacitor of filter or envelope: X7R for 16 V, as can be bought for its place (1206)."""
MIN_CHOSEN_F, MAX_CHOSEN_F = 100e-12, MAX_FOOTPRINT_F
"""Capacitors the board chooses itself lie within: smaller ones drown in tracks."""
CHOSEN_OHM = (2e3, 20e3)
"""R1 of a capacitor the board chooses: low enough for bias and noise, high enough for an amplifier to drive."""
CHOSEN_ENVELOPE_OHM = (1e3, 10e3)
"""R_LP likewise: the diode or rectifier drives it."""


def chosen_range_f(cutoff_hz: float, ohm: tuple[float, float]) -> tuple[float, float]:
    """The capacitances [F] whose 1 / (C omega) lies within `ohm` at a cutoff [Hz], as far as such are chosen."""
    low, high = (_ratio(1.0, math.tau * cutoff_hz * bound) for bound in (ohm[1], ohm[0]))
    return tuple(min(max(c_f, MIN_CHOSEN_F), MAX_CHOSEN_F) for c_f in (low, high))  # type: ignore[return-value]


def farad(microfarad: float) -> float:
    """Capacitance [F] from [uF]; the division keeps 2.2 uF the number nearest to 2.2e-6."""
    return microfarad / 1e6


def _ratio(numerator: float, denominator: float) -> float:
    return numerator / denominator if denominator else math.inf


MIN_LIMIT_F, MAX_LIMIT_F = 10e-12, 1e-6
"""Capacitor across R5: below, the resistor's own capacitance is part of it; above, it does not fit its place."""


def limit_capacitor_f(r5_ohm: float, band_limit_hz: float) -> float:
    """C = 1 / (omega R5) [F] across R5: from the band limit [Hz] on the first stage's gain falls towards 1."""
    return 1.0 / (math.tau * r5_ohm * band_limit_hz)


SERIES_CAPACITORS_UF = (1.0, 2.2, 4.7, 10.0, 22.0, 47.0, 100.0)
"""Ceramic capacitors of these values fit the board (1206); those above 10 uF for 6.3 V, across which there is none."""
SERIES_DECADE = 10.0
"""Least cutoff in corners of R4 and its series capacitor: the gain at the cutoff then loses 0.5 % at most."""


def series_capacitor_f(r4_ohm: float, cutoff_hz: float) -> float:
    """C in series with R4 [F]: the least whose corner with R4 lies a decade or more below the cutoff [Hz].

    At the article's 1.5k and 67 Hz that is 16 uF, 22 uF as bought. The largest there is where none is enough.
    """
    min_uf = 1e6 * SERIES_DECADE / (math.tau * r4_ohm * cutoff_hz)
    return farad(next((c for c in SERIES_CAPACITORS_UF if c >= min_uf), SERIES_CAPACITORS_UF[-1]))
