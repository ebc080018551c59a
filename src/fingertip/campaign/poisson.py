"""Confidence interval of a rate, from a count of independent events."""

from __future__ import annotations

import math

from fingertip.numerics import bisect

CONFIDENCE = 0.95
"""Probability with which an interval contains the rate."""


def poisson_interval(count: int, confidence: float = CONFIDENCE) -> tuple[float, float]:
    """Compute the exact interval of the mean of a Poisson variable that was drawn once.

    Reference: F. Garwood, Biometrika 28, 1936, 437.

    Parameters
    ----------
    count
        The number that was drawn.
    confidence
        Probability with which the interval contains the mean; half of the rest lies on either side.
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
