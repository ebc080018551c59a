"""What variant comparator's LMV331 asks for (its data sheet), and the mean ahead of it: for rules and the board."""

from __future__ import annotations

MAX_COMPARATOR_V = 5.5
"""Highest supply."""
MIN_COMPARATOR_V = 0.011
"""Least threshold: below it the hysteresis would ask for more than 10 Mohm, and offsets of 7 mV would be most of it."""
BIAS_A, MAX_BIAS_A = 25e-9, 250e-9
"""Current out of an input, typical and at most at 25 degrees Celsius: it lifts the mean by what R18 makes of it."""
COMPARATOR_OFFSET_V, MAX_COMPARATOR_OFFSET_V = 1.7e-3, 7e-3
"""Between its inputs, typical and at most."""
BIAS_SHARE = 0.5
"""Most that the current may make of the threshold."""

MEAN_OHM = 15e3
"""R18, about: more lifts the mean, less asks for a larger capacitor."""
MAX_MEAN_F = 1e-6
"""The largest C17: what an X7R holds in its place (0603)."""


def longest_window_s(threshold_v: float) -> float:
    """The longest window [s] whose mean R18 and C17 can make at a threshold [V]: tau is half of it."""
    max_ohm = BIAS_SHARE * threshold_v / MAX_BIAS_A
    return 2.0 * max_ohm * MAX_MEAN_F
