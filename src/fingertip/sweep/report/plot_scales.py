"""One column of a sweep as an axis of a picture: cells, their edges, numbers or words, linear or logarithmic."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter
from numpy.typing import NDArray

from fingertip.sweep.report.statistics import Bins, Column, by_value, is_spread_by_ratio, is_words, plain


@dataclass(frozen=True)
class Scale:
    """How a column lies along an axis."""

    name: str
    bins: Bins
    edges: NDArray[np.float64]
    """Of the cells, ascending, shape (bins + 1,)."""
    log: bool
    words: tuple[str, ...]
    """Of a column of words (or of yes and no): one for each cell, which then lie at 0, 1, 2 ..."""

    def place(self, column: Column) -> NDArray[np.float64]:
        """Where values of this column are drawn."""
        return np.searchsorted(self.bins.low, plain(column)).astype(float) if self.words else column.astype(float)

    def dress(
        self, axes: Axes, side: Literal["x", "y"], *, size: float = 9.0, margin: float = 0.0, maximum: int = 34
    ) -> None:
        """Give a side of a plot this scale, its limits (and that share of them beyond each) and its name in lines of at
        most that many characters."""
        getattr(axes, f"set_{side}label")(wrapped(self.name, maximum), fontsize=size)
        if self.words:
            getattr(axes, f"set_{side}ticks")(range(len(self.words)), self.words)
        elif self.log:
            getattr(axes, f"set_{side}scale")("log")
            marks = getattr(axes, f"{side}axis")
            marks.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            marks.set_major_formatter(FuncFormatter(lambda value, place: f"{value:g}"))
            marks.set_minor_formatter(NullFormatter())
        low, high = self.edges[0], self.edges[-1]
        if self.log:
            beyond = (high / low) ** margin
            low, high = low / beyond, high * beyond
        else:
            low, high = low - margin * (high - low), high + margin * (high - low)
        getattr(axes, f"set_{side}lim")(low, high)


def scale(name: str, column: Column, maximum: int) -> Scale:
    """The scale of a column in at most `most` cells (words: as many as there are)."""
    bins = by_value(column, maximum)
    if is_words(column) or column.dtype.kind == "b":
        words = tuple(str(word) for word in bins.low)
        return Scale(name, bins, np.arange(len(words) + 1, dtype=float) - 0.5, False, words)
    log = is_spread_by_ratio(column)
    return Scale(name, bins, _edges(bins, log), log, ())


def _edges(bins: Bins, log: bool) -> NDArray[np.float64]:
    """Half way between neighbours; beyond the ends as far as inwards where each cell is one value."""
    low, high = bins.low.astype(float), bins.high.astype(float)
    if log:
        low, high = np.log(low), np.log(high)
    inner = (high[:-1] + low[1:]) / 2
    first, last = low[0], high[-1]
    if bins.each_value:
        reach = (0.5, 0.5) if len(low) == 1 else (inner[0] - low[0], high[-1] - inner[-1])
        first, last = first - reach[0], last + reach[1]
    edges = np.concatenate([[first], inner, [last]])
    return np.asarray(np.exp(edges) if log else edges, dtype=np.float64)


def wrapped(name: str, maximum: int) -> str:
    """A parameter's name, in two lines if it is longer: parted near the middle, at a dot or underscore."""
    ends = [found.end() for found in re.finditer(r"[._]+", name)]
    if len(name) <= maximum or not ends:
        return name
    cut = min(ends, key=lambda end: abs(2 * end - len(name)))
    return f"{name[:cut]}\n{name[cut:]}"


def chosen(count: int, maximum: int) -> Sequence[int] | NDArray[np.intp]:
    """All of `count` points, or `most` of them at random, always the same: a stride might keep step with a grid."""
    if count <= maximum:
        return range(count)
    return np.sort(np.random.default_rng(0).choice(count, maximum, replace=False))
