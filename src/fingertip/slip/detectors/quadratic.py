"""How often noise alone lifts an energy over a bar: the tail of a weighted sum of squares of Gaussian variables."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from fingertip.arrays import Array

ALARMS_PER_HOUR = 1.0
"""False alarms from noise alone that a threshold's rule allows: a sixth of the 0.1 per minute that a detector may
have in all, so that noise is never what counts."""


def tail(weights: Array, bar: float) -> float:
    """Probability that ``sum w_i x_i^2`` exceeds `bar`, x_i independent of unit variance, for a bar above its mean.

    Saddle point approximation of R. Lugannani and S. Rice (Adv. Appl. Prob. 12(2), 1980, doi:10.2307/1426607) as
    applied to quadratic forms by D. Kuonen (Biometrika 86(4), 1999, doi:10.1093/biomet/86.4.929); its relative error
    is a tenth at most, however small the probability.
    """
    w = weights / float(weights.max())
    x = bar / float(weights.max())
    if x <= float(w.sum()):
        return 1.0
    low, high = 0.0, 0.5
    for _ in range(200):  # the slope of the cumulant function grows from the mean to infinity within these
        z = 0.5 * (low + high)
        low, high = (z, high) if float(np.sum(w / (1 - 2 * z * w))) < x else (low, z)
    K = -0.5 * float(np.sum(np.log1p(-2 * z * w)))
    second = 2 * float(np.sum((w / (1 - 2 * z * w)) ** 2))
    r = math.sqrt(max(2 * (z * x - K), 1e-300))
    v = z * math.sqrt(second)
    return 0.5 * math.erfc((r + math.log(v / r) / r) / math.sqrt(2))


def bar_for(weights: Array, excursion_s: float, alarms_per_hour: float = ALARMS_PER_HOUR) -> float:
    """The bar that an energy crosses so many times per hour.

    Parameters
    ----------
    weights
        Of the energy, as for `tail`.
    excursion_s
        How long one stay above the bar lasts [s].
    alarms_per_hour
        Stays per hour.
    """
    wanted = alarms_per_hour * excursion_s / 3600
    mean = float(weights.sum())
    return _falling(lambda bar: tail(weights, bar) - wanted, mean, mean + 200 * float(weights.max()))


def _falling(function: Callable[[float], float], low: float, high: float) -> float:
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if function(middle) > 0.0 else (low, middle)
    return high
