"""Every axis and output against every other: a scatter matrix."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from fingertip.plot_style import BLUE, TEXT_COLOUR, to_png, new_figure
from fingertip.sweep.report.statistics import Column, is_words, ranks
from fingertip.sweep.report.plot_scales import Scale, chosen, scale
from fingertip.sweep.report.variance import correlation

MAX_COLUMNS = 8
_MAX_POINTS = 2000
_HISTOGRAM_BINS = 24
_REFUSED_COLOUR = "#e2b6b1"


def draw(columns: dict[str, Column], ok: NDArray[np.bool_], left_out: Sequence[str] = ()) -> bytes:
    """Scatter below the diagonal, histograms on it, rank correlations above it.

    Parameters
    ----------
    columns
        Axes and outputs, name -> values of shape (points,); not finite where there is none. `MAX_COLUMNS` at most.
    ok
        Feasible points, shape (points,).
    left_out
        Names of columns for which there was no room, to be told.

    Returns
    -------
    bytes
        A PNG.
    """
    size = len(columns)
    each = 1.75 if size > 4 else 2.4
    width, height = each * size + 1.0, each * size + 1.1
    figure = new_figure(width, height, automatic_layout=False)
    figure.subplots_adjust(0.95 / width, 0.6 / height, 1 - 0.1 / width, 1 - 0.45 / height, 0.12, 0.12)
    panels = figure.subplots(size, size, squeeze=False)
    drawn = np.array(chosen(len(ok), _MAX_POINTS), dtype=np.intp)
    scales = [scale(name, _finite(column), _HISTOGRAM_BINS) for name, column in columns.items()]
    values = list(columns.values())
    for i, y in enumerate(scales):
        for j, x in enumerate(scales):
            plot = panels[i, j]
            plot.spines[["top", "right"]].set_visible(False)
            plot.tick_params(labelsize=7)
            if j > i:
                _correlation(plot, values[j][ok], values[i][ok])
                continue
            x.dress(plot, "x", size=8, margin=0.03, maximum=20)
            if i == j:
                _histogram(plot, x, values[j], ok)
            else:
                y.dress(plot, "y", size=8, margin=0.03, maximum=20)
                _scatter(plot, _spread(x, values[j][drawn]), _spread(y, values[i][drawn]), ok[drawn])
            for side, shown in (("x", x), ("y", y)):
                if not shown.words and not shown.log and (i != j or side == "x"):
                    plot.locator_params(side, nbins=3)
            if i < size - 1:
                plot.set_xlabel("")
                plot.tick_params(labelbottom=False)
            if j > 0 or i == j:
                plot.set_ylabel("")
                plot.tick_params(labelleft=False)
    panels[0, 0].set_ylabel("points", fontsize=8)
    for i in range(size):
        panels[i, 0].yaxis.set_label_coords(-0.58 / (each * 0.9), 0.5)
    how = f"{len(drawn)} of {len(ok)} points, drawn at random" if len(drawn) < len(ok) else f"all {len(ok)} points"
    said = f"{how}; blue: feasible, red: not. Above the diagonal: rank correlation of the feasible"
    if left_out:
        said += f"\nleft out for want of room: {', '.join(left_out)}"
    figure.suptitle(said, x=0.01, y=1 - 0.06 / height, ha="left", va="top", fontsize=9)
    return to_png(figure)


def _spread(scale: Scale, column: Column) -> NDArray[np.float64]:
    """Where points are drawn; those of one word side by side, for nothing lies between words."""
    places = scale.place(column)
    return places + np.random.default_rng(1).uniform(-0.3, 0.3, len(places)) if scale.words else places


def _finite(column: Column) -> Column:
    known = column[np.isfinite(column)] if column.dtype.kind == "f" else column
    return known if len(known) else np.zeros(1)


def _scatter(plot: Axes, x: NDArray[np.float64], y: NDArray[np.float64], ok: NDArray[np.bool_]) -> None:
    for kind, colour in ((~ok, _REFUSED_COLOUR), (ok, BLUE)):
        size = min(5.0, max(2.4, 90 / math.sqrt(len(x))))
        plot.plot(x[kind], y[kind], ".", color=colour, markersize=size, markeredgewidth=0)


def _histogram(plot: Axes, x: Scale, column: Column, ok: NDArray[np.bool_]) -> None:
    if x.words:
        edges = x.edges
    else:
        even = np.geomspace if x.log else np.linspace
        edges = even(x.edges[0], x.edges[-1], _HISTOGRAM_BINS + 1)
    places = x.place(column)
    feasible = np.histogram(places[ok], edges)[0]
    others = np.histogram(places[~ok], edges)[0]
    plot.bar(edges[:-1], feasible, np.diff(edges), align="edge", color=BLUE)
    plot.bar(edges[:-1], others, np.diff(edges), feasible, align="edge", color=_REFUSED_COLOUR)


def _correlation(plot: Axes, a: Column, b: Column) -> None:
    plot.set_axis_off()
    if is_words(a) or is_words(b):
        return
    known = np.isfinite(a.astype(float)) & np.isfinite(b.astype(float))
    a, b = a[known], b[known]
    if len(a) < 3 or np.ptp(a) == 0 or np.ptp(b) == 0:
        return
    value = correlation(ranks(a), ranks(b))
    plot.text(
        0.5, 0.5, f"{round(value, 2) + 0.0:+.2f}", ha="center", va="center", transform=plot.transAxes,
        fontsize=8 + 8 * abs(value), color=TEXT_COLOUR, alpha=0.35 + 0.65 * abs(value),
    )  # fmt: skip
