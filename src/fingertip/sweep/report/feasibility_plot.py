"""Feasibility plot: which rule limits where, as a map of two axes, or as shares along each of
several axes.

The scales of all plots stand here too: cells and their edges for one column, numeric or
categorical.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from fingertip.foundation import display as style
from fingertip.sweep.report import statistics
from fingertip.sweep.report.statistics import Column
from fingertip.sweep.report.summary import format_percent

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

_VALUES_PER_BIN = 10
"""Number of distinct values in a bin above which no comb can be seen."""

_SIDE_BY_SIDE = 45
"""Letters of all words below a plot from which on they are turned: they would lie on each other."""


@dataclass(frozen=True)
class PlotScale:
    name: str
    bins: statistics.Bins
    edges: NDArray[np.float64]
    """Edges of the cells, ascending, shape (bins + 1,)."""
    log: bool
    categories: tuple[str, ...]
    """Words of a categorical or boolean column, which are drawn at 0, 1, 2 ....
    Empty for a numeric column.
    """

    def locate(self, column: Column) -> NDArray[np.float64]:
        if self.categories:
            return np.searchsorted(self.bins.low, statistics.to_sortable(column)).astype(float)

        return column.astype(float)

    def apply(
        self,
        axes: Axes,
        side: Literal["x", "y"],
        *,
        size: float = 9.0,
        margin: float = 0.0,
        max_label: int = 34,
    ) -> None:
        getattr(axes, f"set_{side}label")(wrap_name(self.name, max_label), fontsize=size)
        if self.categories:
            is_long = side == "x" and sum(map(len, self.categories)) > _SIDE_BY_SIDE
            turned = {"rotation": 30, "ha": "right", "rotation_mode": "anchor"} if is_long else {}
            getattr(axes, f"set_{side}ticks")(
                range(len(self.categories)), self.categories, **turned
            )
        elif self.log:
            from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter  # noqa: PLC0415

            getattr(axes, f"set_{side}scale")("log")
            axis = getattr(axes, f"{side}axis")
            axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
            axis.set_minor_formatter(NullFormatter())

        low = self.edges[0]
        high = self.edges[-1]
        if self.log:
            factor = (high / low) ** margin
            low = low / factor
            high = high * factor
        else:
            low, high = low - margin * (high - low), high + margin * (high - low)

        getattr(axes, f"set_{side}lim")(low, high)


def make_scale(name: str, column: Column, max_cells: int) -> PlotScale:
    """Make the scale of a column, with at most `max_cells` cells unless it is categorical."""
    bins = statistics.bin_by_value(column, max_cells)
    if statistics.is_categorical(column) or column.dtype.kind == "b":
        categories = tuple(str(value) for value in bins.low)
        return PlotScale(
            name=name,
            bins=bins,
            edges=np.arange(len(categories) + 1, dtype=float) - 0.5,
            log=False,
            categories=categories,
        )

    log = statistics.suits_log_scale(column)
    return PlotScale(
        name=name,
        bins=bins,
        edges=_compute_edges(bins, log),
        log=log,
        categories=(),
    )


def histogram_edges(
    positions: NDArray[np.float64], scale: PlotScale, max_bins: int
) -> NDArray[np.float64]:
    """Compute the edges of a histogram's bins on a numeric scale, ascending.

    Bins of equal width show a comb where the values have a grid of their own, such as whole numbers
    or preferred values: some hold more values than others. Where there are few distinct values,
    each bin therefore holds equally many of them, and ends halfway between two.
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

    # A short last group joins the one before.
    cuts = np.arange(group, len(distinct) - group // 2, group)
    inner = (distinct[cuts - 1] + distinct[cuts]) / 2
    ends = np.array(
        [1.5 * distinct[0] - 0.5 * distinct[1], 1.5 * distinct[-1] - 0.5 * distinct[-2]]
    )
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
    """Choose the points to draw: all, or a fixed random sample.

    A regular stride could hide the pattern of a grid.
    """
    if count <= max_points:
        return np.arange(count)

    return np.sort(np.random.default_rng(0).choice(count, max_points, replace=False))


def _compute_edges(bins: statistics.Bins, log: bool) -> NDArray[np.float64]:
    """Compute the edges of the cells, halfway between neighbours.

    Outer ones are as far from single values.
    """
    low = bins.low.astype(float)
    high = bins.high.astype(float)

    if log:
        low = np.log(low)
        high = np.log(high)

    inner = (high[:-1] + low[1:]) / 2
    first = low[0]
    last = high[-1]

    if bins.is_exact:
        widths = (0.5, 0.5) if len(low) == 1 else (inner[0] - low[0], high[-1] - inner[-1])
        first = first - widths[0]
        last = last + widths[1]

    edges = np.concatenate([[first], inner, [last]])
    return np.asarray(np.exp(edges) if log else edges, dtype=np.float64)


_STATUS_COLOURS = {"failed": "black", "timeout": style.TEXT_COLOUR}
_MAX_CELLS = 80
_MAX_MARKERS = 3000
_MAX_BARS = 40


def draw_feasibility(
    axes: dict[str, Column], classes: statistics.PointClasses, ranked_axes: list[str]
) -> bytes:
    varied = {name: axes[name] for name in ranked_axes if len(np.unique(axes[name])) > 1}
    colours, codes, legend = _choose_colours(classes)
    if len(varied) == 2:
        figure = style.new_figure(10, 7)
        plot = figure.subplots()
        (x_name, x), (y_name, y) = sorted(
            varied.items(), key=lambda item: list(axes).index(item[0])
        )
        scales = make_scale(x_name, x, _MAX_CELLS), make_scale(y_name, y, _MAX_CELLS)
        caption = _draw_map(plot, *scales, (x, y), codes, colours)
        _add_heading(figure, classes, caption, legend)
        return style.to_png(figure)

    # One panel per axis
    columns = 2 if len(varied) == 4 else min(3, max(1, len(varied)))
    rows = max(1, math.ceil(len(varied) / columns))
    figure = style.new_figure(max(10.0, 4.2 * columns), 1.6 + 3.0 * rows)
    panels = figure.subplots(rows, columns, squeeze=False).ravel()

    for plot, (name, column) in zip(panels, varied.items(), strict=False):
        bars = min(_MAX_BARS, max(4, math.isqrt(len(column)) // 2))
        _draw_shares(plot, make_scale(name, column, bars), codes, colours)

    for plot in panels[len(varied) :]:
        plot.set_visible(False)

    for plot in panels[::columns]:
        plot.set_ylabel("share of points [%]")

    _add_heading(
        figure,
        classes,
        "share of points along each axis, over all values of the other axes",
        legend,
    )
    return style.to_png(figure)


def _choose_colours(
    classes: statistics.PointClasses,
) -> tuple[list[str], NDArray[np.intp], list[Patch]]:
    """Choose colours, the colour index of each point, and the legend.

    The rarest of many classes share a colour.
    """
    from matplotlib.patches import Patch  # noqa: PLC0415

    counts = classes.count()
    total = max(1, len(classes.indices))
    names = list(classes.names)
    colours = [style.PALE_TEAL]
    palette = iter(style.AREAS)
    for name in names[1 : len(style.AREAS) + 1]:
        colours.append(_STATUS_COLOURS.get(name) or next(palette))

    codes = classes.indices
    labels = [
        f"{name}  {format_percent(counts[i] / total, 1)}"
        for i, name in enumerate(names[: len(colours)])
    ]
    if len(names) > len(colours):
        other_count = len(names) - len(colours)
        codes = np.minimum(codes, len(colours))
        labels.append(
            f"others ({other_count})  {format_percent(counts[len(colours) :].sum() / total, 1)}"
        )
        colours.append(style.REFERENCE)

    return (
        colours,
        codes,
        [Patch(color=c, label=label) for c, label in zip(colours, labels, strict=True)],
    )


def _add_heading(
    figure: Figure, classes: statistics.PointClasses, caption: str, legend: list[Patch]
) -> None:
    feasible = int(classes.count()[classes.names.index(statistics.FEASIBLE)])
    title = (
        f"{feasible} of {len(classes.indices)} designs are feasible; colour: parameter named "
        "by the broken rule"
    )
    figure.suptitle(f"{title}\n{caption}", x=0.01, ha="left", fontsize=10)
    figure.legend(
        handles=legend,
        loc="outside lower left",
        ncols=3,
        frameon=False,
        fontsize=9,
    )


def _draw_map(
    plot: Axes,
    x: PlotScale,
    y: PlotScale,
    columns: tuple[Column, Column],
    codes: NDArray[np.intp],
    colours: list[str],
) -> str:
    from matplotlib.colors import ListedColormap  # noqa: PLC0415

    exact = x.bins.is_exact and y.bins.is_exact
    as_markers = not exact and len(codes) <= _MAX_MARKERS
    margin = 0.02 if as_markers else 0.0
    x.apply(plot, "x", margin=margin)
    y.apply(plot, "y", margin=margin)
    plot.spines[["top", "right"]].set_visible(False)

    if as_markers:
        plot.grid(True, color=style.GRID_COLOUR, linewidth=0.7)
        plot.set_axisbelow(True)
        edges = [style.TEXT_COLOUR if code == 0 else "none" for code in codes]
        fill = [colours[code] for code in codes]
        area = 36.0 if len(codes) <= 600 else 14.0
        plot.scatter(
            x.locate(columns[0]), y.locate(columns[1]), area, fill, linewidths=0.4, edgecolors=edges
        )
        return "each marker is one design"

    # Number of points of each class in each cell
    shape = (y.bins.count, x.bins.count, len(colours))
    flat = (y.bins.indices * shape[1] + x.bins.indices) * shape[2] + codes
    counts = np.bincount(flat, minlength=math.prod(shape)).reshape(shape)
    points = counts.sum(axis=2)
    most_frequent = np.where(points > 0, counts.argmax(axis=2), -1).astype(float)
    plot.set_facecolor(style.PALE_GREY)
    drawn = np.ma.masked_less(most_frequent, 0)
    plot.pcolormesh(
        x.edges, y.edges, drawn, cmap=ListedColormap(colours), vmin=-0.5, vmax=len(colours) - 0.5
    )
    if points.max() <= 1:
        return "each cell is one design"

    return (
        f"each cell shows its most frequent class; median of {np.median(points):.0f} designs "
        "per cell"
    )


def _draw_shares(plot: Axes, x: PlotScale, codes: NDArray[np.intp], colours: list[str]) -> None:
    size = len(colours)
    counts = np.bincount(x.bins.indices * size + codes, minlength=x.bins.count * size).reshape(
        -1, size
    )
    shares = 100 * counts / counts.sum(axis=1, keepdims=True)
    bottom = np.zeros(len(shares))

    for i, colour in enumerate(colours):
        look: dict[str, Any] = {
            "align": "edge",
            "color": colour,
            "edgecolor": colour,
            "linewidth": 0.3,
        }
        plot.bar(x.edges[:-1], shares[:, i], np.diff(x.edges), bottom, **look)
        bottom += shares[:, i]

    style.style_axes(plot)
    x.apply(plot, "x")
    plot.set_ylim(0, 100)
