"""Capacitors to choose from: values of a preferred series, or only those that the parts table has."""

from __future__ import annotations

import math

from fingertip.board.components.preferred_values import nearest_value, values_in_range
from fingertip.board.parts.capacitors import list_capacitances

SOLD = "preferred"
"""Name of the series of values that are sold."""
USUAL_SERIES = "E6"
"""Series of capacitors that every board selects itself."""
FILTER_PACKAGE, SMALL_PACKAGE = "1206", "0603"
"""Sizes of the filter's capacitors and of all others of the signal path."""


def nearest_capacitance(farad: float, series: str, package: str = SMALL_PACKAGE) -> float:
    """Find the capacitance [F] nearest by ratio: of those that are sold, or else of the usual series."""
    if series == SOLD:
        return min(list_capacitances(package), key=lambda f: abs(math.log(f / farad)))
    return nearest_value(farad, USUAL_SERIES, 1e-12, 1e-3)


def capacitances_in_range(low_f: float, high_f: float, series: str, package: str) -> tuple[float, ...]:
    """List the capacitances [F] of a series from `low_f` to `high_f`, or the one nearest to the range if none is."""
    if series != SOLD:
        return values_in_range(low_f, high_f, series)
    sold = list_capacitances(package)
    # The ends are computed, so rounding must not exclude a value that lies exactly on one of them.
    found = tuple(f for f in sold if low_f * (1 - 1e-9) <= f <= high_f * (1 + 1e-9))
    return found or (nearest_capacitance(math.sqrt(low_f * high_f), series, package),)
