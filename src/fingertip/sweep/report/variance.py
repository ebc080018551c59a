"""Shares of a variance: how much of a column's variance lies between the bins of another."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from fingertip.sweep.report.statistics import Bins

MIN_POINTS = 20
"""Fewer points say nothing about shares of a variance."""


def explained(y: NDArray[np.float64], bins: Bins) -> float:
    """Share of the variance of `y` between bins, less what chance gives (Kelley's epsilon squared).

    Its mean is 0 where the bins say nothing, so it may be slightly negative; 1 where they say all. Points of a grid or
    of a Sobol sequence are more even than chance: theirs is too low, by (bins - 1) / points at most.
    """
    centred = y - y.mean()
    counts = np.bincount(bins.code, minlength=bins.count)
    means = np.bincount(bins.code, centred, minlength=bins.count) / counts
    between, total = float(np.sum(counts * means**2)), float(np.sum(centred**2))
    return 1.0 - (1.0 - between / total) * (len(y) - 1) / (len(y) - bins.count)


def chance(bins: int, points: int) -> float:
    """Standard deviation of `explained` where the bins say nothing (chi-squared with bins - 1 degrees of freedom)."""
    return math.sqrt(2.0 * (bins - 1)) / (points - bins)


def correlation(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    """Pearson's; of ranks it is Spearman's. NaN where one does not vary."""
    a, b = a - a.mean(), b - b.mean()
    scale = math.sqrt(float(np.sum(a**2)) * float(np.sum(b**2)))
    return float(np.sum(a * b)) / scale if scale else math.nan
