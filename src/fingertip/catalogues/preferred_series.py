"""Series of preferred values (IEC 60063): the mantissas of a decade, and the values next to a given one."""

from __future__ import annotations

import math

# E96 is 10^(i/96) to three digits; E12 and E24 follow no formula throughout.
_E24 = (10, 11, 12, 13, 15, 16, 18, 20, 22, 24, 27, 30, 33, 36, 39, 43, 47, 51, 56, 62, 68, 75, 82, 91)
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
    """Find the largest preferred value up to `value` and the smallest from it on; both are equal for a preferred one.

    Parameters
    ----------
    value
        Positive and finite, in any unit.
    series
        Key of `MANTISSAS`.
    """
    decade = MANTISSAS[series]
    exponent = math.floor(math.log10(value)) - len(str(decade[0])) + 1
    values = [_scale(mantissa, e) for e in (exponent - 1, exponent, exponent + 1) for mantissa in decade]
    return (
        max(v for v in values if v <= value * (1.0 + _TOLERANCE)),
        min(v for v in values if v >= value * (1.0 - _TOLERANCE)),
    )


def _scale(mantissa: int, exponent: int) -> float:
    """mantissa * 10^exponent, correctly rounded."""
    return float(mantissa * 10**exponent) if exponent >= 0 else mantissa / 10**-exponent
