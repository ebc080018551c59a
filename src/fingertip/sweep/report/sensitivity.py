"""Sensitivity analysis: the share of an output's variance that each axis explains alone.

This is Sobol's first-order index (Saltelli et al., *Global Sensitivity Analysis*, 2008, section 1.2.8): the variance of
the output's mean in bins of the axis, divided by the output's variance. The estimator is corrected for chance (see
`statistics.estimate_explained_variance`). The index holds for axes that are sampled independently. Points that a rule
refuses leave gaps, and then the shares of different axes may overlap. What axes explain only together (interactions)
is in the remainder, 1 - sum.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fingertip.sweep.report.feasibility import FEASIBLE, find_feasible
from fingertip.sweep.report.statistics import (
    MIN_POINTS,
    Column,
    bin_by_count,
    compute_correlation,
    compute_null_deviation,
    compute_ranks,
    estimate_explained_variance,
    is_categorical,
)

if TYPE_CHECKING:
    from fingertip.sweep.rows import SweepTable

MAX_BINS = 32


@dataclass(frozen=True)
class AxisSensitivity:
    """Sensitivity of one output to one axis."""

    axis: str
    first_order_index: float
    """Share of the output's variance that the axis explains alone; 0 if it is not significant."""
    rank_correlation: float
    """Spearman's rank correlation, from -1 (falling) to 1 (rising); NaN if the axis is categorical."""


@dataclass(frozen=True)
class OutputSensitivity:
    """Sensitivity of one output to all axes."""

    output: str
    points: int
    """Number of points that have the output."""
    null_deviation: float
    """Standard deviation of the index of an axis without effect (maximum over the axes)."""
    axes: tuple[AxisSensitivity, ...]
    """Sensitivity to each axis, the strongest first."""

    @property
    def unexplained(self) -> float:
        """Share of the variance that no axis explains alone: interactions and noise."""
        return 1.0 - sum(axis.first_order_index for axis in self.axes)


def compute_sensitivities(table: SweepTable) -> Iterator[OutputSensitivity]:
    """Compute the sensitivity of feasibility over all points, then of every output over the feasible points.

    Outputs that do not vary are left out.
    """
    feasible = find_feasible(table)
    columns = {name: np.where(feasible, column, np.nan) for name, column in table.outputs.items()}
    for name, column in {FEASIBLE: feasible.astype(float), **columns}.items():
        sensitivity = compute_sensitivity(name, column, table.axes)
        if sensitivity is not None:
            yield sensitivity


def compute_sensitivity(output: str, column: Column, axes: dict[str, Column]) -> OutputSensitivity | None:
    """Compute the sensitivity of one output.

    Parameters
    ----------
    output
        Its name.
    column
        Its values, shape (points,); NaN where it was not computed.
    axes
        Name -> values, each of shape (points,).

    Returns
    -------
    OutputSensitivity or None
        None if fewer than `MIN_POINTS` points have a finite value, or all values are equal.
    """
    finite = np.isfinite(column)
    y = column[finite]
    if len(y) < MIN_POINTS or np.ptp(y) <= 1e-12 * np.max(np.abs(y)):
        return None
    max_bins = min(MAX_BINS, max(2, math.isqrt(len(y)) // 2))
    y_ranks = compute_ranks(y)
    sensitivities, max_deviation = [], 0.0
    for name, axis in axes.items():
        x = axis[finite]
        bins = bin_by_count(x, max_bins)
        if bins.count < 2 or len(y) <= bins.count:
            continue
        deviation = compute_null_deviation(bins.count, len(y))
        max_deviation = max(max_deviation, deviation)
        index = estimate_explained_variance(y, bins)
        rank_correlation = math.nan if is_categorical(x) else compute_correlation(compute_ranks(x), y_ranks)
        # Two standard deviations: about the 95th percentile for an axis without effect
        sensitivities.append(AxisSensitivity(name, index if index > 2 * deviation else 0.0, rank_correlation))
    sensitivities.sort(key=lambda axis: -axis.first_order_index)
    return OutputSensitivity(output, len(y), max_deviation, tuple(sensitivities))


def select_strongest_axes(sensitivity: OutputSensitivity | None, axes: Sequence[str], count: int) -> list[str]:
    """Select the axes to which an output is most sensitive; the first ones if that is not known."""
    ranked = [axis.axis for axis in sensitivity.axes] if sensitivity else []
    return [*ranked, *(name for name in axes if name not in ranked)][:count]
