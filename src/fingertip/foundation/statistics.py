"""Quantiles of Student's t and of the chi-square distribution, for whole degrees of freedom.

Finite sums: M. Abramowitz and I. A. Stegun, Handbook of Mathematical Functions, 26.7.3 and 26.7.4 (Student's t), 26.4.4
and 26.4.5 (chi-square).
"""

from __future__ import annotations

import math
from collections.abc import Callable

from fingertip.foundation.numerics import bisect

_LARGEST = 1e4
"""Upper end of the search for a quantile."""


def t_quantile(two_sided: float, degrees: int) -> float:
    """Return the t that |t| exceeds with probability 1 - `two_sided`, for some degrees of freedom."""
    return _invert(lambda t: t_probability(t, degrees) < two_sided)


def chi_square_quantile(below: float, degrees: int) -> float:
    """Return the chi-square below which the probability is `below`, for some degrees of freedom."""
    return _invert(lambda x: chi_square_probability(x, degrees) < below)


def t_probability(t: float, degrees: int) -> float:
    """Return the probability that |T| <= t."""
    angle = math.atan2(t, math.sqrt(degrees))
    cos2 = math.cos(angle) ** 2
    if degrees % 2:
        term, total = math.cos(angle), 0.0
        for i in range(1, (degrees - 1) // 2 + 1):
            total += term
            term *= 2 * i / (2 * i + 1) * cos2
        return 2.0 / math.pi * (angle + math.sin(angle) * total)
    term, total = 1.0, 0.0
    for i in range(1, degrees // 2 + 1):
        total += term
        term *= (2 * i - 1) / (2 * i) * cos2
    return math.sin(angle) * total


def chi_square_probability(x: float, degrees: int) -> float:
    """Return the probability that chi-square <= x."""
    half = x / 2
    if degrees % 2:
        term = math.sqrt(2.0 * x / math.pi) * math.exp(-half)
        above = math.erfc(math.sqrt(half))
        for i in range(1, (degrees - 1) // 2 + 1):
            above += term
            term *= x / (2 * i + 1)
        return 1.0 - above
    term, above = math.exp(-half), 0.0
    for i in range(1, degrees // 2 + 1):
        above += term
        term *= half / i
    return 1.0 - above


def _invert(is_below: Callable[[float], bool]) -> float:
    return bisect(is_below, 0.0, _LARGEST)[0]


# Confidence interval of a rate, from a count of independent events.


CONFIDENCE = 0.95
"""Probability with which an interval contains the rate."""


def poisson_interval(count: int, confidence: float = CONFIDENCE) -> tuple[float, float]:
    """Compute the exact interval of the mean of a Poisson variable that was drawn once.

    Reference: F. Garwood, Biometrika 28, 1936, 437.
    """
    tail = (1 - confidence) / 2
    top = count + 10 * math.sqrt(count + 1) + 10
    low = 0.0 if count == 0 else bisect(lambda mean: 1 - _cumulative(count - 1, mean) < tail, 0.0, top, halvings=80)[0]
    high = bisect(lambda mean: _cumulative(count, mean) > tail, 0.0, top, halvings=80)[0]
    return low, high


def _cumulative(count: int, mean: float) -> float:
    """Probability of at most `count` events."""
    if mean <= 0.0:
        return 1.0
    return math.fsum(math.exp(k * math.log(mean) - mean - math.lgamma(k + 1)) for k in range(count + 1))
