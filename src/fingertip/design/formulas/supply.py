"""Signal ground of a board on a single supply: the divider that sets it, and the headroom on both sides.

The filter's signals swing around the signal ground, and the bridge stands on it. On 5 V it lies in the middle. On 3.3 V
it lies somewhat lower: the inputs of the bridge's amplifier (AD623), a few tenths of a volt above it, must stay 1.5 V
below the supply (its data sheet, input voltage range; recalled, unverified).
"""

from __future__ import annotations

from fingertip.design.parameters import Board

DIVIDERS_OHM = {"split": None, "single": (10e3, 10e3), "single_3v3": (54.9e3, 44.2e3)}
"""Upper and lower resistor of the divider [ohm], by the supply's name.

With its capacitor the divider filters the supply's ripple above 3 Hz, or above 0.7 Hz as that of the bridge's supply
does: both then follow the supply alike, and their ratio stays.
"""

CONTROLLER_SUPPLIES = frozenset({"single_3v3"})
"""Supplies of boards for a controller, which give it their filtered signal beside the tactile voltage."""


def signal_ground_ratio(supply: str) -> float:
    """Voltage of the signal ground above ground as a ratio of the supply voltage: 0 on a split supply."""
    divider = DIVIDERS_OHM[supply]
    return divider[1] / (divider[0] + divider[1]) if divider else 0.0


def upper_headroom_v(board: Board) -> float:
    """Voltage from the signal ground to the upper rail [V]."""
    return board.supply_v * (1.0 - signal_ground_ratio(board.supply))


def smaller_headroom_v(board: Board) -> float:
    """Voltage from the signal ground to the nearer rail [V]."""
    ratio = signal_ground_ratio(board.supply)
    return board.supply_v * min(ratio, 1.0 - ratio) if ratio else board.supply_v


def filtered_range_v(board: Board, adc_range_v: float) -> float | None:
    """Largest deviation of the filtered signal from its rest that board and converter pass [V]."""
    if board.supply not in CONTROLLER_SUPPLIES:
        return None
    rest_v = signal_ground_ratio(board.supply) * board.supply_v
    return min(rest_v, min(board.supply_v, adc_range_v) - rest_v)


# Data-sheet figures of variant comparator's LMV331 and limits of the low-pass ahead of it, for rules and the board.


MAX_COMPARATOR_V = 5.5
"""Maximum supply of the comparator [V]."""
MIN_COMPARATOR_V = 0.011
"""Minimum threshold [V].

Lower thresholds would need a hysteresis resistor above 10 Mohm, and an offset of 7 mV would be most of the threshold.
"""
BIAS_A, MAX_BIAS_A = 25e-9, 250e-9
"""Input bias current out of the comparator [A], typical and maximum at 25 degrees Celsius.

It raises the averaged envelope by the voltage across R18.
"""
COMPARATOR_OFFSET_V, MAX_COMPARATOR_OFFSET_V = 1.7e-3, 7e-3
"""Input offset voltage of the comparator [V], typical and maximum."""
MAX_BIAS_RATIO = 0.5
"""Maximum ratio of the voltage that the bias current causes to the threshold."""

AVERAGING_OHM = 15e3
"""Approximate R18 [ohm] of the averaging low-pass.

A larger one raises the bias error, a smaller one needs a larger capacitor.
"""
MAX_AVERAGING_F = 1e-6
"""Largest C17 of the averaging low-pass [F]: the largest X7R of size 0603."""


def max_window_s(threshold_v: float) -> float:
    """Longest window [s] that R18 and C17 can average at a threshold [V]: twice their largest time constant."""
    max_ohm = MAX_BIAS_RATIO * threshold_v / MAX_BIAS_A
    return 2.0 * max_ohm * MAX_AVERAGING_F


HOT_BIAS_A, COMPARATOR_DRIFT_V_PER_K = 400e-9, 5e-6
"""Maximum input bias current over temperature [A], and drift of the comparator's offset [V/K], average."""
TRIMMER_TOLERANCE = 0.2
"""Tolerance of the trimmer's resistance (a usual figure; unverified)."""
MIN_TEMPERATURE_C, MAX_TEMPERATURE_C, DATA_SHEET_C = 0.0, 50.0, 25.0
"""Range of temperatures for which worst cases are stated, and the temperature of data-sheet figures [C]."""
