"""Preferred values (IEC 60063): the values of a series, and those nearest to a computed one.

Nearest means nearest by ratio.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from functools import lru_cache

from fingertip.design.formulas.filter import MANTISSAS, MAX_OHM, MIN_OHM
from fingertip.foundation.errors import BoardError, Issue


def mantissas(series: str) -> tuple[int, ...]:
    """Integer mantissas of one decade: 10 to 68 (E6), 10 to 82 (E12), 10 to 91 (E24), 100 to 976 (E96).

    Raises BoardError.
    """
    if series not in MANTISSAS:
        raise BoardError(Issue("board.series", f"{series!r} is not known; choose {', '.join(MANTISSAS)}."))
    return MANTISSAS[series]


def neighbouring_values(
    value: float, series: str, minimum: float = MIN_OHM, maximum: float = MAX_OHM
) -> tuple[float, ...]:
    """Find the preferred values next below and next above `value`.

    Only one is returned if `value` is itself preferred or lies beyond the range.

    Raises BoardError.
    """
    decade = mantissas(series)
    if not (value > 0 and math.isfinite(value)):
        raise BoardError(f"{value!r} has no preferred value; give a positive finite number.")
    value = min(max(value, minimum), maximum)
    exponent = math.floor(math.log10(value)) - (len(str(decade[0])) - 1)
    values = _values_of_decade(series, exponent)
    above = bisect_left(values, value)
    return (values[above],) if values[above] == value else (values[above - 1], values[above])


def nearest_value(value: float, series: str, minimum: float = MIN_OHM, maximum: float = MAX_OHM) -> float:
    """Find the preferred value nearest to `value` by ratio; of two, the lower. Raises as `neighbouring_values` does."""
    return min(neighbouring_values(value, series, minimum, maximum), key=lambda v: abs(math.log(v / value)))


def values_around(value: float, series: str) -> tuple[float, ...]:
    """List the preferred resistances from half of `value` to twice `value`. Raises as `neighbouring_values` does."""
    decade = mantissas(series)
    exponent = math.floor(math.log10(value)) - (len(str(decade[0])) - 1)
    values = (_scaled(m, e) for e in (exponent - 1, exponent, exponent + 1) for m in decade)
    return tuple(v for v in values if value / 2 <= v <= 2 * value and MIN_OHM <= v <= MAX_OHM)


def values_in_range(low: float, high: float, series: str) -> tuple[float, ...]:
    """List the preferred values from `low` to `high`, or the one nearest to `low` where there is none between."""
    decade = mantissas(series)
    digits = len(str(decade[0])) - 1
    exponents = range(math.floor(math.log10(low)) - digits, math.floor(math.log10(high)) - digits + 1)
    values = (_scaled(m, e) for e in exponents for m in decade)
    # The ends are computed, so rounding must not exclude a value that lies exactly on one of them.
    found = tuple(v for v in values if low * (1 - 1e-9) <= v <= high * (1 + 1e-9))
    return found or (nearest_value(low, series, 1e-12, 1e-3),)


@lru_cache(maxsize=256)
def _values_of_decade(series: str, exponent: int) -> tuple[float, ...]:
    """List the preferred values of a decade in ascending order, with one more below it and two above.

    With these, rounding of the logarithm that selects the decade does not matter. The values are cached, because a
    sweep computes thousands of boards.
    """
    decade = mantissas(series)
    above = (_scaled(mantissa, exponent + 1) for mantissa in decade[:2])
    return (_scaled(decade[-1], exponent - 1), *(_scaled(mantissa, exponent) for mantissa in decade), *above)


def _scaled(mantissa: int, exponent: int) -> float:
    """mantissa * 10^exponent, correctly rounded."""
    return float(mantissa * 10**exponent) if exponent >= 0 else mantissa / 10**-exponent
