"""Statistics of many points: bins, ranks and cells; limiting rules; sensitivities to the axes."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fingertip.sweep.database import SweepTable

Column = NDArray[Any]
"""Values of one axis or output over all points, shape (points,): numbers, or words of a categorical
parameter.
"""

MIN_POINTS = 20
"""Minimum number of points for an estimate of explained variance."""


TIED = 0.3
"""Rank correlation beyond which two axes vary with each other: the one explains 9 % of the other.
"""


@dataclass(frozen=True)
class Bins:
    """Division of a column into bins in ascending order, each with at least one point."""

    indices: NDArray[np.intp]
    """Bin of each point, shape (points,)."""
    low: Column
    """Minimum value in each bin, shape (bins,)."""
    high: Column
    """Maximum value in each bin, shape (bins,)."""

    @property
    def count(self) -> int:
        return len(self.low)

    @property
    def is_exact(self) -> bool:
        """True if every bin holds a single value."""
        return bool(np.all(self.low == self.high))


def is_categorical(column: Column) -> bool:
    """Return whether a column holds words, which have no order and no distances."""
    return column.dtype.kind in "OUS"


def to_sortable(column: Column) -> Column:
    """Make a column sortable: in a column of words and numbers, the numbers become words."""
    return column.astype(str) if column.dtype == object else column


def bin_by_count(column: Column, max_bins: int) -> Bins:
    """Divide a column into bins with about equally many points, or one for each of few distinct
    values.
    """
    return _divide(
        column,
        max_bins,
        lambda _, counts: max_bins * (np.cumsum(counts) - counts / 2) / counts.sum(),
    )


def bin_by_value(column: Column, max_bins: int) -> Bins:
    """Divide a column into bins of equal width or ratio, or one for each of few distinct values."""

    def locate(values: Column, _: NDArray[np.intp]) -> NDArray[np.float64]:
        scale = np.log(values) if suits_log_scale(values) else values.astype(float)
        return np.asarray(max_bins * (scale - scale[0]) / (scale[-1] - scale[0]))

    return _divide(column, max_bins, locate)


def suits_log_scale(column: Column) -> bool:
    """Return whether a logarithmic scale suits a column.

    It does if all values are positive, the maximum is at least five times the minimum, and the
    median is nearer to the geometric than to the arithmetic mean of the two.
    """
    if is_categorical(column) or not len(column) or not np.min(column) > 0:
        return False

    minimum = float(np.min(column))
    maximum = float(np.max(column))
    median = float(np.median(column))
    to_geometric = abs(np.log(median**2 / (minimum * maximum)))
    to_arithmetic = abs(np.log(2 * median / (minimum + maximum)))

    return maximum >= 5 * minimum and bool(to_geometric < to_arithmetic)


def compute_ranks(column: Column) -> NDArray[np.float64]:
    """Rank the values from 1; equal values share their mean rank (fractional ranking)."""
    _, index, counts = np.unique(column, return_inverse=True, return_counts=True)
    return np.asarray((np.cumsum(counts) - (counts - 1) / 2)[index])


def compute_correlation(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    """Compute Pearson's correlation; of ranks it is Spearman's. NaN if one column is constant."""
    a = a - a.mean()
    b = b - b.mean()
    scale = math.sqrt(float(np.sum(a**2)) * float(np.sum(b**2)))

    return float(np.sum(a * b)) / scale if scale else math.nan


def estimate_explained_variance(y: NDArray[np.float64], bins: Bins) -> float:
    """Estimate the share of the variance of `y` that the binned variable explains alone.

    This share is the correlation ratio, and Sobol's first-order index if the axes are independent.
    The estimator is Kelley's epsilon squared (Kelley 1935, An unbiased correlation ratio measure,
    PNAS 21, 554-559): the variance between bins, less what chance contributes. Its mean is 0 if the
    variable has no effect, so an estimate may be slightly negative; it is 1 if the variable
    explains everything. Points of a grid or of a Sobol sequence are more even than random ones.
    Their estimate is too low, by (bins - 1) / points at most.
    """
    centred = y - y.mean()
    counts = np.bincount(bins.indices, minlength=bins.count)
    means = np.bincount(bins.indices, centred, minlength=bins.count) / counts
    between = float(np.sum(counts * means**2))
    total = float(np.sum(centred**2))

    return 1.0 - (1.0 - between / total) * (len(y) - 1) / (len(y) - bins.count)


def compute_null_deviation(bins: int, points: int) -> float:
    """Compute the standard deviation of that share by chance: chi-squared with bins - 1 degrees of
    freedom.
    """
    return math.sqrt(2.0 * (bins - 1)) / (points - bins)


def compute_cell_statistics(
    x: Bins,
    y: Bins,
    values: Column,
    feasible: NDArray[np.bool_],
    minimise: bool,
) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.float64], NDArray[np.float64]]:
    """Compute statistics of an output in the cells of two binned axes, of shape (bins of y, bins of
    x).

    Returns the number of points, feasible or not, the number of feasible points with a finite
    output, and the best and the mean of these outputs, NaN in a cell without any.
    """
    shape = (y.count, x.count)
    size = y.count * x.count
    cell_of_point = y.indices * x.count + x.indices
    finite = feasible & np.isfinite(values)
    cell = cell_of_point[finite]
    finite_values = values[finite]
    count = np.bincount(cell, minlength=size)
    mean = np.bincount(cell, finite_values, minlength=size) / np.where(count > 0, count, np.nan)
    best = np.full(size, np.inf if minimise else -np.inf)
    (np.minimum if minimise else np.maximum).at(best, cell, finite_values)
    best[count == 0] = np.nan
    points = np.bincount(cell_of_point, minlength=size)

    return points.reshape(shape), count.reshape(shape), best.reshape(shape), mean.reshape(shape)


def _divide(
    column: Column, max_bins: int, locate: Callable[[Column, NDArray[np.intp]], NDArray[np.float64]]
) -> Bins:
    """Divide a column by its distinct values.

    `locate` maps these and their counts to [0, max_bins].
    """
    values, index, counts = np.unique(to_sortable(column), return_inverse=True, return_counts=True)
    if len(values) <= max_bins or is_categorical(column):
        return Bins(index, values, values)

    bin_numbers = np.clip(np.floor(locate(values, counts)).astype(int), 0, max_bins - 1)
    first = np.flatnonzero(np.diff(bin_numbers, prepend=-1))  # empty bins are left out
    last = np.append(first[1:], len(values)) - 1
    bin_of_value = np.repeat(np.arange(len(first)), last - first + 1)

    return Bins(bin_of_value[index], values[first], values[last])


FEASIBLE = "feasible"
CHECKS_FAILED = "checks_failed"
_COUNTS_OF_FAILED = (CHECKS_FAILED, "set_checks_failed")
"""Output that counts failed checks; a design with a failed check is not feasible."""
_BINS = 12


@dataclass(frozen=True)
class PointClasses:
    """Class of every point: feasible, the parameter that a broken rule names, the failed check, or
    the status.
    """

    names: tuple[str, ...]
    """Names of the classes: `feasible` first, then by falling number of points."""
    indices: NDArray[np.intp]
    """Class of each point as an index into `names`, shape (points,)."""

    def count(self) -> NDArray[np.intp]:
        return np.bincount(self.indices, minlength=len(self.names))

    def count_by_bin(self, bins: Bins) -> NDArray[np.intp]:
        size = len(self.names)
        return np.bincount(bins.indices * size + self.indices, minlength=bins.count * size).reshape(
            bins.count, size
        )


@dataclass(frozen=True)
class AxisInfluence:
    """Influence of one axis on how often a rule is broken."""

    axis: str
    explained_variance: float
    """Share of the variance of "the rule is broken" that the axis explains alone.
    0 if it is not significant.
    """
    limiting_ranges: tuple[tuple[Any, Any], ...]
    """Ranges of the axis, minimum and maximum, in which no other rule refuses more points."""


@dataclass(frozen=True)
class LimitingRule:
    """Rule, check or failure that makes points infeasible."""

    rule: str
    points: int
    share: float
    """Share of these among all points, 0 to 1."""
    axes: tuple[AxisInfluence, ...]
    example: str
    """Message of its first point."""


def find_feasible(table: SweepTable) -> NDArray[np.bool_]:
    """Find the feasible points: those that were computed and failed no check (if any were run),
    shape (points,).
    """
    feasible = np.asarray(table.status == "ok")
    for column in list_failed(table):
        feasible = feasible & ~(column > 0)

    return feasible


def list_failed(table: SweepTable) -> list[Column]:
    """List the outputs that count failed checks, of a design or of a set."""
    return [table.outputs[name] for name in _COUNTS_OF_FAILED if name in table.outputs]


def classify_points(table: SweepTable) -> PointClasses:
    refused = (table.status == "refused") & (table.field != "")
    words = np.where(refused, table.field, table.status)
    check = np.where(
        table.field == "", CHECKS_FAILED, np.char.add("check ", table.field.astype(str))
    )
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
        axes.sort(key=lambda axis: -axis.explained_variance)
        example = str(table.reason[int(np.argmax(broken))])
        rules.append(
            LimitingRule(
                rule=rule,
                points=int(counts[i]),
                share=float(counts[i] / total),
                axes=tuple(axes),
                example=example,
            )
        )

    return tuple(rules)


def _estimate_significant_share(broken: NDArray[np.bool_], bins: Bins) -> float:
    """Estimate the explained variance; 0 if it is below two standard deviations of chance."""
    points = len(broken)
    if bins.count < 2 or points < max(MIN_POINTS, 2 * bins.count) or broken.all():
        return 0.0

    share = estimate_explained_variance(broken.astype(float), bins)
    return share if share > 2 * compute_null_deviation(bins.count, points) else 0.0


def _find_limiting_ranges(
    bins: Bins, counts: NDArray[np.intp], rule: int
) -> tuple[tuple[Any, Any], ...]:
    """Find the bins in which this rule refuses points and no other rule refuses more.

    Neighbours are joined.
    """
    own = counts[:, rule]
    limiting = np.flatnonzero((own > 0) & (own == counts[:, 1:].max(axis=1)))
    low = bins.low.tolist()
    high = bins.high.tolist()
    runs = np.split(limiting, np.flatnonzero(np.diff(limiting) > 1) + 1) if len(limiting) else []

    return tuple((low[run[0]], high[run[-1]]) for run in runs)


@dataclass(frozen=True)
class AxisSensitivity:
    axis: str
    first_order_index: float
    """Share of the output's variance that the axis explains alone; 0 if it is not significant."""
    rank_correlation: float
    """Spearman's rank correlation, from -1 (falling) to 1 (rising).
    NaN if the axis is categorical.
    """
    tied_to: tuple[str, ...] = ()
    """Axes that vary with this one over the points that count: what it explains alone cannot be
    told from what they do, and its index is 0.
    """


@dataclass(frozen=True)
class OutputSensitivity:
    """Sensitivity of one output to all axes: Sobol's first-order indices.

    An index (Saltelli et al., *Global Sensitivity Analysis*, 2008, section 1.2.8) is the variance
    of the output's mean in bins of the axis, divided by the output's variance, corrected for
    chance. It holds for axes that vary independently, and only they have one: points that a rule
    refuses leave gaps, which tie axes to each other.
    """

    output: str
    points: int
    null_deviation: float
    """Standard deviation of the index of an axis without effect (maximum over the axes)."""
    axes: tuple[AxisSensitivity, ...]

    @property
    def unexplained(self) -> float:
        """Share of the variance that no axis explains alone: interactions and noise."""
        return 1.0 - sum(axis.first_order_index for axis in self.axes)


def compute_sensitivities(table: SweepTable) -> Iterator[OutputSensitivity]:
    """Compute the sensitivity of feasibility, then of every output that varies over the feasible
    points.
    """
    feasible = find_feasible(table)
    columns = {name: np.where(feasible, column, np.nan) for name, column in table.outputs.items()}

    for name, column in {FEASIBLE: feasible.astype(float), **columns}.items():
        sensitivity = compute_sensitivity(name, column, table.axes)
        if sensitivity is not None:
            yield sensitivity


def compute_sensitivity(
    output: str, column: Column, axes: dict[str, Column]
) -> OutputSensitivity | None:
    finite = np.isfinite(column)
    y = column[finite]
    if len(y) < MIN_POINTS or np.ptp(y) <= 1e-12 * np.max(np.abs(y)):
        return None

    max_bins = min(32, max(2, math.isqrt(len(y)) // 2))
    y_ranks = compute_ranks(y)
    tied = find_tied({name: axis[finite] for name, axis in axes.items()})
    sensitivities = []
    max_deviation = 0.0

    for name, axis in axes.items():
        x = axis[finite]
        # Each of some listed values is a bin of its own where four points share it.
        distinct = len(set(x.tolist()))
        bins = bin_by_count(x, distinct if max_bins < distinct <= len(y) // 4 else max_bins)
        if bins.count < 2 or len(y) <= bins.count:
            continue

        deviation = compute_null_deviation(bins.count, len(y))
        max_deviation = max(max_deviation, deviation)
        index = estimate_explained_variance(y, bins)
        rank_correlation = (
            math.nan if is_categorical(x) else compute_correlation(compute_ranks(x), y_ranks)
        )
        # Two standard deviations: about the 95th percentile for an axis without effect
        index = index if index > 2 * deviation else 0.0
        ties = tied[name] if index else ()
        sensitivities.append(
            (index, AxisSensitivity(name, 0.0 if ties else index, rank_correlation, ties))
        )

    sensitivities.sort(key=lambda entry: -entry[0])
    return OutputSensitivity(
        output, len(y), max_deviation, tuple(axis for _, axis in sensitivities)
    )


def find_tied(axes: Mapping[str, Column]) -> dict[str, tuple[str, ...]]:
    """Find the axes that vary with each one by more than chance.

    Words have their alphabetical ranks.
    """
    ranks = {name: compute_ranks(to_sortable(column)) for name, column in axes.items()}
    least = max([TIED, *(3.0 / math.sqrt(len(own)) for own in ranks.values())])
    return {
        name: tuple(
            axis
            for axis in ranks
            if axis != name and abs(compute_correlation(own, ranks[axis])) > least
        )
        for name, own in ranks.items()
    }


def select_strongest_axes(
    sensitivity: OutputSensitivity | None, axes: Sequence[str], count: int
) -> list[str]:
    """Select the axes to which an output is most sensitive; the first ones if that is not known."""
    ranked = [axis.axis for axis in sensitivity.axes] if sensitivity else []
    return [*ranked, *(name for name in axes if name not in ranked)][:count]
