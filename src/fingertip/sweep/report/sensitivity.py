"""What weighs how much: the share of an output's variance that each axis explains alone.

The first-order index of Sobol (Saltelli et al., *Global Sensitivity Analysis*, 2008, section 1.2.8): the variance of
the output's mean in bins of the axis over the output's variance, corrected for the variance that bins of noise have
(Kelley's epsilon squared). It holds for axes that were sampled independently; points that a rule refuses leave holes,
and then shares may overlap. What axes do only together is in the rest, 1 - sum.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fingertip.sweep.report.statistics import Column, by_count, is_words, ranks
from fingertip.sweep.report.feasibility import FEASIBLE, feasible
from fingertip.sweep.report.variance import MIN_POINTS, chance, correlation, explained

if TYPE_CHECKING:
    from fingertip.sweep.rows import Table

MAX_BINS = 32


@dataclass(frozen=True)
class Weight:
    """How one axis moves one output."""

    axis: str
    share: float
    """Of the output's variance that the axis explains alone; 0 where it explains no more than chance would."""
    rank_correlation: float
    """Spearman's, from -1 (falls) to 1 (rises); NaN where the axis holds words."""


@dataclass(frozen=True)
class Sensitivity:
    """How all axes move one output."""

    output: str
    points: int
    noise: float
    """Standard deviation of a share that is 0 (of the largest number of bins)."""
    weights: tuple[Weight, ...]
    """Strongest first."""

    @property
    def together(self) -> float:
        """Share that no axis explains alone: interactions and noise."""
        return 1.0 - sum(weight.share for weight in self.weights)


def sensitivities(table: Table) -> Iterator[Sensitivity]:
    """Of being feasible, over all points, then of every output that varies, over the feasible points that have it."""
    ok = feasible(table)
    columns = {name: np.where(ok, column, np.nan) for name, column in table.outputs.items()}
    for name, column in {FEASIBLE: ok.astype(float), **columns}.items():
        found = sensitivity(name, column, table.axes)
        if found is not None:
            yield found


def sensitivity(output: str, column: Column, axes: dict[str, Column]) -> Sensitivity | None:
    """Of one output.

    Parameters
    ----------
    output
        Its name.
    column
        Its values, shape (points,); NaN where there is none.
    axes
        Name -> values, each of shape (points,).

    Returns
    -------
    Sensitivity or None
        None where fewer than `MIN_POINTS` points have the output, or all have the same.
    """
    known = np.isfinite(column)
    y = column[known]
    if len(y) < MIN_POINTS or np.ptp(y) <= 1e-12 * np.max(np.abs(y)):
        return None
    maximum = min(MAX_BINS, max(2, math.isqrt(len(y)) // 2))
    y_ranks = ranks(y)
    weights, noise = [], 0.0
    for name, axis in axes.items():
        x = axis[known]
        bins = by_count(x, maximum)
        if bins.count < 2 or len(y) <= bins.count:
            continue
        own = chance(bins.count, len(y))
        noise = max(noise, own)
        share = explained(y, bins)
        with_rank = math.nan if is_words(x) else correlation(ranks(x), y_ranks)
        weights.append(Weight(name, share if share > 2 * own else 0.0, with_rank))
    weights.sort(key=lambda w: -w.share)
    return Sensitivity(output, len(y), noise, tuple(weights))


def strongest(found: Sensitivity | None, axes: Sequence[str], count: int) -> list[str]:
    """The axes that weigh most on an output; where that is not known, the first ones."""
    ranked = [weight.axis for weight in found.weights] if found else []
    return [*ranked, *(name for name in axes if name not in ranked)][:count]
