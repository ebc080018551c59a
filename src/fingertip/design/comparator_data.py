"""Data-sheet figures of variant comparator's LMV331 and limits of the low-pass ahead of it, for rules and the board."""

from __future__ import annotations

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
