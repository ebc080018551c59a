"""Axes of the plots: cells and their edges for one column, which is numeric or categorical, linear or logarithmic."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from fingertip.sweep.report.statistics import (
    Bins,
    Column,
    bin_by_value,
    is_categorical,
    suits_log_scale,
    to_sortable,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes


_VALUES_PER_BIN = 10
"""Number of distinct values in a bin above which no comb can be seen."""


@dataclass(frozen=True)
class PlotScale:
    """Scale of one column along an axis of a plot."""

    name: str
    bins: Bins
    edges: NDArray[np.float64]
    """Edges of the cells, ascending, shape (bins + 1,)."""
    log: bool
    """True if the scale is logarithmic."""
    categories: tuple[str, ...]
    """Words of a categorical or boolean column, which are drawn at 0, 1, 2 ...; empty for a numeric column."""

    def locate(self, column: Column) -> NDArray[np.float64]:
        """Compute the positions at which values of this column are drawn."""
        if self.categories:
            return np.searchsorted(self.bins.low, to_sortable(column)).astype(float)
        return column.astype(float)

    def apply(
        self, axes: Axes, side: Literal["x", "y"], *, size: float = 9.0, margin: float = 0.0, max_label: int = 34
    ) -> None:
        """Apply the scale to one side of a plot. Units: `size` [points]."""
        getattr(axes, f"set_{side}label")(wrap_name(self.name, max_label), fontsize=size)
        if self.categories:
            getattr(axes, f"set_{side}ticks")(range(len(self.categories)), self.categories)
        elif self.log:
            from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

            getattr(axes, f"set_{side}scale")("log")
            axis = getattr(axes, f"{side}axis")
            axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
            axis.set_minor_formatter(NullFormatter())
        low, high = self.edges[0], self.edges[-1]
        if self.log:
            factor = (high / low) ** margin
            low, high = low / factor, high * factor
        else:
            low, high = low - margin * (high - low), high + margin * (high - low)
        getattr(axes, f"set_{side}lim")(low, high)


def make_scale(name: str, column: Column, max_cells: int) -> PlotScale:
    """Make the scale of a column, with at most `max_cells` cells unless the column is categorical."""
    bins = bin_by_value(column, max_cells)
    if is_categorical(column) or column.dtype.kind == "b":
        categories = tuple(str(value) for value in bins.low)
        return PlotScale(name, bins, np.arange(len(categories) + 1, dtype=float) - 0.5, False, categories)
    log = suits_log_scale(column)
    return PlotScale(name, bins, _compute_edges(bins, log), log, ())


def histogram_edges(positions: NDArray[np.float64], scale: PlotScale, max_bins: int) -> NDArray[np.float64]:
    """Compute the edges of a histogram's bins on a numeric scale, ascending.

    Bins of equal width show a comb where the values have a grid of their own, such as whole numbers or preferred
    values: some hold more values than others. Where there are few distinct values, each bin therefore holds equally
    many of them, and ends halfway between two.
    """
    if scale.bins.is_exact:
        return scale.edges
    distinct = np.unique(positions[np.isfinite(positions)])
    spaced = np.geomspace if scale.log else np.linspace
    if len(distinct) > _VALUES_PER_BIN * max_bins:
        return np.asarray(spaced(scale.edges[0], scale.edges[-1], max_bins + 1), dtype=np.float64)
    group = -(-len(distinct) // max_bins)
    if scale.log:
        distinct = np.log(distinct)
    cuts = np.arange(group, len(distinct) - group // 2, group)  # a short last group joins the one before
    inner = (distinct[cuts - 1] + distinct[cuts]) / 2
    ends = np.array([1.5 * distinct[0] - 0.5 * distinct[1], 1.5 * distinct[-1] - 0.5 * distinct[-2]])
    edges = np.concatenate([ends[:1], inner, ends[1:]])
    return np.asarray(np.exp(edges) if scale.log else edges, dtype=np.float64)


def wrap_name(name: str, max_length: int) -> str:
    """Break a long parameter name into two lines at the dot or underscore nearest to its middle."""
    ends = [match.end() for match in re.finditer(r"[._]+", name)]
    if len(name) <= max_length or not ends:
        return name
    cut = min(ends, key=lambda end: abs(2 * end - len(name)))
    return f"{name[:cut]}\n{name[cut:]}"


def choose_points(count: int, max_points: int) -> NDArray[np.intp]:
    """Choose the points to draw: all, or a fixed random sample. A regular stride could hide the pattern of a grid."""
    if count <= max_points:
        return np.arange(count)
    return np.sort(np.random.default_rng(0).choice(count, max_points, replace=False))


def _compute_edges(bins: Bins, log: bool) -> NDArray[np.float64]:
    """Compute the edges of the cells, halfway between neighbours.

    If each cell is one value, the outer edges are as far out as the inner ones are in.
    """
    low, high = bins.low.astype(float), bins.high.astype(float)
    if log:
        low, high = np.log(low), np.log(high)
    inner = (high[:-1] + low[1:]) / 2
    first, last = low[0], high[-1]
    if bins.is_exact:
        widths = (0.5, 0.5) if len(low) == 1 else (inner[0] - low[0], high[-1] - inner[-1])
        first, last = first - widths[0], last + widths[1]
    edges = np.concatenate([[first], inner, [last]])
    return np.asarray(np.exp(edges) if log else edges, dtype=np.float64)
