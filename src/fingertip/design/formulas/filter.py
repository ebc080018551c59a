"""Formulas for the filter's component values and its supply, which the rules and the board share.

The filter is a third-order Butterworth high-pass: a first-order stage (R1, C1) and a unity-gain
Sallen-Key stage (C2, C3, R2, R3), with all three capacitors equal to C (article, eqs. 2, 5, 6, 7,
11) and omega_c = 2 pi f_c.

On a board for a controller its signals swing around the signal ground, in the middle of the supply.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from fingertip.design.parameters.board_and_detector import Board

# Third-order Butterworth polynomial (s + 1)(s^2 + s + 1), from the article's reference 30.
A1 = 1.0
A2 = 1.0
B2 = 1.0
SECTION_QUALITY = math.sqrt(B2) / A2
"""Quality factor Q of the second-order section, eq. (8)."""

MIN_OHM = 10.0
"""Minimum resistance [ohm].
Below it the amplifier's output resistance and the tracks are no longer negligible.
"""
MAX_OHM = 10e6
"""Maximum resistance [ohm].
Above it leakage and the amplifier's input resistance are no longer negligible.
"""


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
    """R1 = 1 / (a1 C omega_c) [ohm], eq. (5); infinite where the product underflows."""
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
    """Compute the values by the formulas, with the design's capacitors and R5.

    The function never raises.
    """
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
"""Largest capacitor of filter and envelope [F]: the largest X7R for 16 V in size 1206."""
MIN_SELECTABLE_F = 100e-12
MAX_SELECTABLE_F = MAX_1206_F
"""Range of the capacitors that the board selects itself [F].
The tracks' capacitance is not negligible below it.
"""
SELECTABLE_R1_OHM = (2e3, 20e3)
"""Range of R1 for a selected capacitor: low for bias and noise, high enough for an amplifier."""
SELECTABLE_R_LP_OHM = (1e3, 10e3)
"""Range of R_LP for a capacitor that the board selects. The diode or the rectifier drives it."""


def to_farads(microfarads: float) -> float:
    """Convert a capacitance from [uF] to [F]. Division makes 2.2 uF the float nearest to 2.2e-6."""
    return microfarads / 1e6


def _ratio(numerator: float, denominator: float) -> float:
    return numerator / denominator if denominator else math.inf


MIN_LIMITING_CAPACITOR_F = 10e-12
MAX_LIMITING_CAPACITOR_F = 1e-6
"""Range of the capacitor across R5 [F]. Below it the resistor's own capacitance is not negligible,
and above it there is no capacitor of its size.
"""


def compute_limiting_capacitor_f(r5_ohm: float, band_limit_hz: float) -> float:
    """C = 1 / (omega R5) [F] across R5.

    Above the band limit [Hz] the first stage's gain falls towards 1.
    """
    return 1.0 / (math.tau * r5_ohm * band_limit_hz)


SERIES_CAPACITORS_UF = (1.0, 2.2, 4.7, 10.0, 22.0, 47.0, 100.0)
"""Ceramic capacitors in size 1206 [uF]; those above 10 uF are for 6.3 V, without direct voltage."""
MIN_CUTOFF_RATIO = 10.0
"""Minimum ratio of the cutoff to the corner frequency of R4 and its series capacitor. The gain at
the cutoff is then reduced by at most 0.5 %.
"""

VMID_TOP_OHM = 51e3
VMID_BOTTOM_OHM = 51e3
"""Divider of VMID [ohm]. With its capacitor it filters the supply's ripple above 0.6 Hz."""


def signal_ground_ratio(board: Board) -> float:
    """Voltage of the signal ground above ground over the supply voltage; 0 on a split supply."""
    return VMID_BOTTOM_OHM / (VMID_TOP_OHM + VMID_BOTTOM_OHM) if board.is_for_controller else 0.0


def upper_headroom_v(board: Board) -> float:
    """Voltage from the signal ground to the upper rail [V]."""
    return board.supply_v * (1.0 - signal_ground_ratio(board))


def smaller_headroom_v(board: Board) -> float:
    """Voltage from the signal ground to the nearer rail [V]."""
    ratio = signal_ground_ratio(board)
    return board.supply_v * min(ratio, 1.0 - ratio) if ratio else board.supply_v


def filtered_range_v(board: Board, adc_range_v: float) -> float | None:
    """Largest deviation of the filtered signal from its rest that board and converter pass [V]."""
    if not board.is_for_controller:
        return None

    rest_v = signal_ground_ratio(board) * board.supply_v
    return min(rest_v, min(board.supply_v, adc_range_v) - rest_v)


# Data-sheet figures of variant comparator's LMV331 and limits of the low-pass ahead of it, for
# rules and the board.

MIN_COMPARATOR_V = 0.011
"""Minimum threshold [V]. Lower thresholds would need a hysteresis resistor above 10 Mohm, and an
offset of 7 mV would be most of the threshold.
"""
BIAS_A = 25e-9
MAX_BIAS_A = 250e-9
"""Input bias current out of the comparator [A], typical and maximum at 25 degrees Celsius. It
raises the averaged envelope by the voltage across R18.
"""
COMPARATOR_OFFSET_V = 1.7e-3
MAX_COMPARATOR_OFFSET_V = 7e-3
"""Input offset voltage of the comparator [V], typical and maximum."""
MAX_BIAS_RATIO = 0.5
"""Maximum ratio of the voltage that the bias current causes to the threshold."""

AVERAGING_OHM = 15e3
"""Approximate R18 [ohm] of the averaging low-pass. A larger one raises the bias error, a smaller
one needs a larger capacitor.
"""
MAX_AVERAGING_F = 1e-6
"""Largest C17 of the averaging low-pass [F]: the largest X7R of size 0603."""


def max_window_s(threshold_v: float) -> float:
    """Longest window [s] that R18 and C17 can average: twice their largest time constant."""
    max_ohm = MAX_BIAS_RATIO * threshold_v / MAX_BIAS_A
    return 2.0 * max_ohm * MAX_AVERAGING_F


HOT_BIAS_A = 400e-9
"""Maximum input bias current of the comparator over temperature [A]."""
COMPARATOR_DRIFT_V_PER_K = 5e-6
"""Average drift of the comparator's offset [V/K]."""
TRIMMER_TOLERANCE = 0.2
"""Tolerance of the trimmer's resistance (a usual figure; unverified)."""
MIN_TEMPERATURE_C = 0.0
MAX_TEMPERATURE_C = 50.0
"""Range of temperatures for which worst cases are stated [C]."""
DATA_SHEET_C = 25.0
"""Temperature of data-sheet figures [C]."""

# E96 is 10^(i/96) to three digits; E12 and E24 follow no formula throughout.
_E24 = (
    10, 11, 12, 13, 15, 16, 18, 20, 22, 24, 27, 30,
    33, 36, 39, 43, 47, 51, 56, 62, 68, 75, 82, 91,
)  # fmt: skip
MANTISSAS: dict[str, tuple[int, ...]] = {
    "E6": _E24[::4],
    "E12": _E24[::2],
    "E24": _E24,
    "E96": tuple(round(100 * 10 ** (i / 96)) for i in range(96)),
}
"""Integer mantissas of one decade by series."""

CAPACITOR_SERIES = "E12"
"""Series that capacitors are made in. It contains E6."""
_TOLERANCE = 1e-9
"""Relative distance from a preferred value that rounding may cause."""


def find_preferred_neighbours(value: float, series: str = CAPACITOR_SERIES) -> tuple[float, float]:
    """Find the preferred values below and above a positive one (any unit), itself included."""
    decade = MANTISSAS[series]
    exponent = math.floor(math.log10(value)) - len(str(decade[0])) + 1
    preferred = [_scale(mantissa, exponent - 1) for mantissa in decade]
    preferred += [_scale(mantissa, exponent) for mantissa in decade]
    preferred += [_scale(mantissa, exponent + 1) for mantissa in decade]

    return (
        max(number for number in preferred if number <= value * (1.0 + _TOLERANCE)),
        min(number for number in preferred if number >= value * (1.0 - _TOLERANCE)),
    )


def _scale(mantissa: int, exponent: int) -> float:
    """Return mantissa * 10^exponent, correctly rounded."""
    return float(mantissa * 10**exponent) if exponent >= 0 else mantissa / 10**-exponent
