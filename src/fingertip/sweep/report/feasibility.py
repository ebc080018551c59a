"""Feasibility of the points: which rule limits the designs, how often, and in which ranges of the axes."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fingertip.sweep.report.statistics import (
    MIN_POINTS,
    Bins,
    Column,
    bin_by_count,
    bin_by_value,
    compute_correlation,
    compute_null_deviation,
    compute_ranks,
    estimate_explained_variance,
    is_categorical,
)

if TYPE_CHECKING:
    from fingertip.sweep.rows import SweepTable


FEASIBLE = "feasible"
"""Class of the feasible points."""
CHECKS_FAILED = "checks_failed"
"""Output that counts failed checks; a design with a failed check is not feasible."""
_BINS = 12


@dataclass(frozen=True)
class PointClasses:
    """Class of every point: feasible, the parameter that a broken rule names, the failed check, or the status."""

    names: tuple[str, ...]
    """Names of the classes: `feasible` first, then by falling number of points."""
    indices: NDArray[np.intp]
    """Class of each point as an index into `names`, shape (points,)."""

    def count(self) -> NDArray[np.intp]:
        """Count the points of each class, shape (classes,)."""
        return np.bincount(self.indices, minlength=len(self.names))

    def count_by_bin(self, bins: Bins) -> NDArray[np.intp]:
        """Count the points of each class in each bin, shape (bins, classes)."""
        size = len(self.names)
        return np.bincount(bins.indices * size + self.indices, minlength=bins.count * size).reshape(bins.count, size)


@dataclass(frozen=True)
class AxisInfluence:
    """Influence of one axis on how often a rule is broken."""

    axis: str
    explained: float
    """Share of the variance of "the rule is broken" that the axis explains alone; 0 if it is not significant."""
    limiting_ranges: tuple[tuple[Any, Any], ...]
    """Ranges of the axis, minimum and maximum, in which no other rule refuses more points."""


@dataclass(frozen=True)
class LimitingRule:
    """Rule, check or failure that makes points infeasible."""

    rule: str
    points: int
    """Number of points that it makes infeasible."""
    share: float
    """Share of these among all points, 0 to 1."""
    axes: tuple[AxisInfluence, ...]
    """Influence of each axis, the strongest first."""
    example: str
    """Message of its first point."""


def find_feasible(table: SweepTable) -> NDArray[np.bool_]:
    """Find the feasible points: those that were computed and failed no check (if any were run), shape (points,)."""
    ok = np.asarray(table.status == "ok")
    return ok & ~(table.outputs[CHECKS_FAILED] > 0) if CHECKS_FAILED in table.outputs else ok


def classify_points(table: SweepTable) -> PointClasses:
    """Classify every point of a sweep."""
    refused = (table.status == "refused") & (table.field != "")
    words = np.where(refused, table.field, table.status)
    check = np.where(table.field == "", CHECKS_FAILED, np.char.add("check ", table.field.astype(str)))
    words = np.where(find_feasible(table), FEASIBLE, np.where(words == "ok", check, words))
    names, indices = np.unique(words, return_inverse=True)
    # Order: feasible, then by falling number of points, then by name
    counts = np.bincount(indices)
    order = sorted(range(len(names)), key=lambda i: (names[i] != FEASIBLE, -counts[i], names[i]))
    if FEASIBLE not in names:
        names, order = np.append(names, FEASIBLE), [len(names), *order]
    position = np.empty(len(names), dtype=np.intp)
    position[order] = np.arange(len(order))
    return PointClasses(tuple(str(names[i]) for i in order), position[indices])


def find_limiting_rules(table: SweepTable, classes: PointClasses) -> tuple[LimitingRule, ...]:
    """Find all rules, checks and failures that occurred, the most frequent first."""
    counts = classes.count()
    total = len(table.point)
    by_value = {name: bin_by_value(column, _BINS) for name, column in table.axes.items()}
    by_count = {name: bin_by_count(column, _BINS) for name, column in table.axes.items()}
    class_counts = {name: classes.count_by_bin(bins) for name, bins in by_value.items()}
    rules = []
    for i, rule in enumerate(classes.names):
        if rule == FEASIBLE or not counts[i]:
            continue
        broken = classes.indices == i
        axes = [
            AxisInfluence(
                name,
                _estimate_significant_share(broken, by_count[name]),
                _find_limiting_ranges(by_value[name], class_counts[name], i),
            )
            for name in table.axes
        ]
        axes.sort(key=lambda axis: -axis.explained)
        example = str(table.reason[int(np.argmax(broken))])
        rules.append(LimitingRule(rule, int(counts[i]), float(counts[i] / total), tuple(axes), example))
    return tuple(rules)


def _estimate_significant_share(broken: NDArray[np.bool_], bins: Bins) -> float:
    """Estimate the explained variance; 0 if it is below two standard deviations of chance."""
    points = len(broken)
    if bins.count < 2 or points < max(MIN_POINTS, 2 * bins.count) or broken.all():
        return 0.0
    share = estimate_explained_variance(broken.astype(float), bins)
    return share if share > 2 * compute_null_deviation(bins.count, points) else 0.0


def _find_limiting_ranges(bins: Bins, counts: NDArray[np.intp], rule: int) -> tuple[tuple[Any, Any], ...]:
    """Find the bins in which this rule refuses points and no other rule refuses more; neighbours are joined."""
    own = counts[:, rule]
    limiting = np.flatnonzero((own > 0) & (own == counts[:, 1:].max(axis=1)))
    low, high = bins.low.tolist(), bins.high.tolist()
    runs = np.split(limiting, np.flatnonzero(np.diff(limiting) > 1) + 1) if len(limiting) else []
    return tuple((low[run[0]], high[run[-1]]) for run in runs)


# Sensitivity analysis: the share of an output's variance that each axis explains alone.
#
# This is Sobol's first-order index (Saltelli et al., *Global Sensitivity Analysis*, 2008, section 1.2.8): the variance
# of the output's mean in bins of the axis, divided by the output's variance. The estimator is corrected for chance
# (see `statistics.estimate_explained_variance`). The index holds for axes that are sampled independently. Points that
# a rule refuses leave gaps, and then the shares of different axes may overlap. What axes explain only together
# (interactions) is in the remainder, 1 - sum.


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
    """Compute the sensitivity of one output."""
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
