"""Joint choice of R1, R2 and R3: the preferred values whose response together deviates least from a Butterworth one.

With w = f / f_c and x = w^2 the ideal magnitude is x^3 / (1 + x^3), squared. The first stage with p = R1 C omega_c has
p^2 x / (1 + p^2 x), and the Sallen-Key section with q = 2 R2 C omega_c and r = R2 R3 (C omega_c)^2 has
r^2 x^2 / ((1 - r x)^2 + q^2 x). The deviation is the largest difference of the magnitudes [dB] at any frequency of
`DEVIATION_BAND`. Errors of the three values that cancel in the product count little, which a choice of each value alone
does not see.
"""

from __future__ import annotations

import functools
import math
from typing import TYPE_CHECKING

from fingertip.board.components.preferred_values import mantissas, nearest_value
from fingertip.design.filter_components import MAX_OHM, MIN_OHM

if TYPE_CHECKING:
    from fingertip.arrays import Array

DEVIATION_BAND = 0.5, 4.0
"""Band in which the deviation counts [cutoffs]: from 18 dB below the passband to beyond the vibrations."""
SEARCH_RATIOS = {"E12": 1.8, "E24": 1.5, "E96": 1.15}
"""Largest ratio of a candidate to its ideal value by series. A wider search finds nothing better; a test shows it."""
_DIGITS, _ROUNDING_DB = 9, 1e-8
"""Decimals of a deviation [dB]; differences below them are rounding."""
_COARSE, _FINE = 7, 6
"""Number of frequencies at which every combination is compared, and of intervals between two of them for those left."""


@functools.lru_cache(maxsize=256)
def choose_jointly(ideal_ohm: tuple[float, float, float], series: str) -> tuple[tuple[float, float, float], float]:
    """Choose R1, R2 and R3 [ohm] from a series, and return them with their deviation [dB].

    Of equal deviations the smaller resistors are chosen. Every combination is compared at a few frequencies of the
    band. What is worse there than a known combination is in the whole band cannot be the best, and is left out.

    Parameters
    ----------
    ideal_ohm
        Values by the formulas: exactly a Butterworth response.
    series
        Series of the resistors.
    """
    import numpy as np

    candidates = [_list_candidates(ohm, series) for ohm in ideal_ohm]
    first, second, third = (np.array(values) / ohm for values, ohm in zip(candidates, ideal_ohm, strict=True))
    x = _squared_frequencies()
    coarse = x[::_FINE]
    stage, section = _stage_db(first, coarse), _section_db(second[:, None], third[None, :], coarse)
    lower_bound = np.abs(stage[:, None, None, :] + section).max(axis=-1)

    likely = np.unravel_index(lower_bound.argmin(), lower_bound.shape)
    known_db = _deviations_db(*(values[[i]] for values, i in zip((first, second, third), likely, strict=True)))
    i, j, k = np.nonzero(lower_bound <= known_db + _ROUNDING_DB)
    deviations = np.round(_deviations_db(first[i], second[j], third[k]), _DIGITS)
    best = int(deviations.argmin())  # the first of equal ones has the smallest resistors
    return (candidates[0][i[best]], candidates[1][j[best]], candidates[2][k[best]]), float(deviations[best])


def compute_deviation_db(ohm: tuple[float, float, float], ideal_ohm: tuple[float, float, float]) -> float:
    """Compute the largest deviation of R1, R2 and R3 [ohm] from the Butterworth response of the ideal ones [dB]."""
    import numpy as np

    ratios = (np.array([value / ideal]) for value, ideal in zip(ohm, ideal_ohm, strict=True))
    return float(_deviations_db(*ratios)[0])


def _deviations_db(first: Array, second: Array, third: Array) -> Array:
    """Deviations [dB] of combinations of R1, R2 and R3 over their ideal values."""
    import numpy as np

    x = _squared_frequencies()
    return np.asarray(np.abs(_stage_db(first, x) + _section_db(second, third, x)).max(axis=-1))


def _list_candidates(ideal_ohm: float, series: str) -> list[float]:
    """List the preferred values around an ideal one within the search ratio, or the nearest if there is none."""
    decade, ratio = mantissas(series), SEARCH_RATIOS[series]
    low, high = max(ideal_ohm / ratio, MIN_OHM), min(ideal_ohm * ratio, MAX_OHM)
    digits = len(str(decade[0])) - 1
    exponents = range(math.floor(math.log10(low)) - digits, math.floor(math.log10(high)) - digits + 1)
    # Division by a power of ten rounds correctly; multiplication by a negative one would not.
    values = (m * 10.0**e if e >= 0 else m / 10.0**-e for e in exponents for m in decade)
    found = [value for value in values if low * (1 - 1e-9) <= value <= high * (1 + 1e-9)]
    return found or [nearest_value(ideal_ohm, series)]


@functools.cache
def _squared_frequencies() -> Array:
    """Frequencies of the band over the cutoff, squared, evenly spaced by ratio."""
    import numpy as np

    low, high = DEVIATION_BAND
    return np.asarray(np.geomspace(low * low, high * high, (_COARSE - 1) * _FINE + 1))


def _stage_db(first: Array, x: Array) -> Array:
    """Magnitude of the first stage over that of the ideal filter [dB], for R1 over its ideal value."""
    import numpy as np

    p2x = first[..., None] ** 2 * x
    return np.asarray(10.0 * np.log10(p2x / (1.0 + p2x) * (1.0 + x**3) / x**3))


def _section_db(second: Array, third: Array, x: Array) -> Array:
    """Magnitude of the Sallen-Key section [dB], for R2 and R3 over their ideal values."""
    import numpy as np

    q2x, rx = second[..., None] ** 2 * x, (second * third)[..., None] * x
    return np.asarray(10.0 * np.log10(rx**2 / ((1.0 - rx) ** 2 + q2x)))
