"""Thresholds for an energy detector in Gaussian noise, from a permitted false alarm rate.

The energy in noise is a weighted sum of squares of independent Gaussian variables.
"""

from __future__ import annotations

import math

import numpy as np

from fingertip.arrays import Array
from fingertip.numerics import bisect

ALARMS_PER_HOUR = 1.0
"""False alarms from noise alone that the rule for a threshold permits.

It is a sixth of the 0.1 per minute that a detector may have in all, so noise never dominates the count."""


def tail_probability(weights: Array, threshold: float) -> float:
    """Compute the probability that ``sum w_i x_i^2`` exceeds a threshold, for independent x_i of unit variance.

    Saddle point approximation of R. Lugannani and S. Rice (Adv. Appl. Prob. 12(2), 1980, doi:10.2307/1426607) as
    applied to quadratic forms by D. Kuonen (Biometrika 86(4), 1999, doi:10.1093/biomet/86.4.929). Its relative error
    is at most 10 %, however small the probability. The approximation holds for thresholds above the mean; for others
    the result is 1.
    """
    w = weights / float(weights.max())
    x = threshold / float(weights.max())
    if x <= float(w.sum()):
        return 1.0
    # The derivative of the cumulant generating function grows from the mean to infinity between these bounds.
    low, high = bisect(lambda z: float(np.sum(w / (1 - 2 * z * w))) < x, 0.0, 0.5, halvings=200)
    z = 0.5 * (low + high)
    K = -0.5 * float(np.sum(np.log1p(-2 * z * w)))
    second = 2 * float(np.sum((w / (1 - 2 * z * w)) ** 2))
    r = math.sqrt(max(2 * (z * x - K), 1e-300))
    v = z * math.sqrt(second)
    return 0.5 * math.erfc((r + math.log(v / r) / r) / math.sqrt(2))


def solve_threshold(weights: Array, excursion_s: float, alarms_per_hour: float = ALARMS_PER_HOUR) -> float:
    """Find the energy threshold that noise crosses at a given rate.

    Parameters
    ----------
    weights
        Weights of the energy, as for `tail_probability`.
    excursion_s
        Mean duration of one excursion above the threshold [s].
    alarms_per_hour
        Excursions per hour.
    """
    probability = alarms_per_hour * excursion_s / 3600
    mean = float(weights.sum())
    _, threshold = bisect(
        lambda energy: tail_probability(weights, energy) > probability,
        mean,
        mean + 200 * float(weights.max()),
        halvings=80,
    )
    return threshold
