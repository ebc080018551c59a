"""Feasibility plot: which rule limits where, as a map of two axes, or as shares along each of several axes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fingertip.foundation.plot_style import (
    AREAS,
    GRID_COLOUR,
    PALE_GREY,
    PALE_TEAL,
    REFERENCE,
    TEXT_COLOUR,
    new_figure,
    style_axes,
    to_png,
)
from fingertip.sweep.report.feasibility import FEASIBLE, PointClasses
from fingertip.sweep.report.plot_scales import PlotScale, make_scale
from fingertip.sweep.report.statistics import Column

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

_STATUS_COLOURS = {"failed": "black", "timeout": TEXT_COLOUR}
_MAX_CELLS = 80
_MAX_MARKERS = 3000
_MAX_BARS = 40


def draw_feasibility(axes: dict[str, Column], classes: PointClasses, ranked_axes: list[str]) -> bytes:
    """Draw the feasibility plot of a sweep."""
    varied = {name: axes[name] for name in ranked_axes if len(np.unique(axes[name])) > 1}
    colours, codes, legend = _choose_colours(classes)
    if len(varied) == 2:
        figure = new_figure(10, 7)
        plot = figure.subplots()
        (x_name, x), (y_name, y) = sorted(varied.items(), key=lambda item: list(axes).index(item[0]))
        scales = make_scale(x_name, x, _MAX_CELLS), make_scale(y_name, y, _MAX_CELLS)
        caption = _draw_map(plot, *scales, (x, y), codes, colours)
        _add_heading(figure, classes, caption, legend)
        return to_png(figure)
    # One panel per axis
    columns = 2 if len(varied) == 4 else min(3, max(1, len(varied)))
    rows = max(1, math.ceil(len(varied) / columns))
    figure = new_figure(max(10.0, 4.2 * columns), 1.6 + 3.0 * rows)
    panels = figure.subplots(rows, columns, squeeze=False).ravel()
    for plot, (name, column) in zip(panels, varied.items(), strict=False):
        bars = min(_MAX_BARS, max(4, math.isqrt(len(column)) // 2))
        _draw_shares(plot, make_scale(name, column, bars), codes, colours)
    for plot in panels[len(varied) :]:
        plot.set_visible(False)
    for plot in panels[::columns]:
        plot.set_ylabel("share of points [%]")
    _add_heading(figure, classes, "share of points along each axis, over all values of the other axes", legend)
    return to_png(figure)


def _choose_colours(classes: PointClasses) -> tuple[list[str], NDArray[np.intp], list[Patch]]:
    """Choose colours, the colour index of each point, and the legend; the rarest of many classes share a colour."""
    from matplotlib.patches import Patch

    counts, total = classes.count(), max(1, len(classes.indices))
    names = list(classes.names)
    colours = [PALE_TEAL]
    palette = iter(AREAS)
    for name in names[1 : len(AREAS) + 1]:
        colours.append(_STATUS_COLOURS.get(name) or next(palette))
    codes = classes.indices
    labels = [f"{name}  {_format_percent(counts[i] / total)}" for i, name in enumerate(names[: len(colours)])]
    if len(names) > len(colours):
        others = len(names) - len(colours)
        codes = np.minimum(codes, len(colours))
        labels.append(f"others ({others})  {_format_percent(counts[len(colours) :].sum() / total)}")
        colours.append(REFERENCE)
    return colours, codes, [Patch(color=c, label=label) for c, label in zip(colours, labels, strict=True)]


def _format_percent(share: float) -> str:
    return f"{100 * share:.1f} %" if share >= 0.001 or share == 0 else "< 0.1 %"


def _add_heading(figure: Figure, classes: PointClasses, caption: str, legend: list[Patch]) -> None:
    feasible = int(classes.count()[classes.names.index(FEASIBLE)])
    title = f"{feasible} of {len(classes.indices)} designs are feasible; colour: parameter named by the broken rule"
    figure.suptitle(f"{title}\n{caption}", x=0.01, ha="left", fontsize=10)
    figure.legend(handles=legend, loc="outside lower left", ncols=3, frameon=False, fontsize=9)


def _draw_map(
    plot: Axes,
    x: PlotScale,
    y: PlotScale,
    columns: tuple[Column, Column],
    codes: NDArray[np.intp],
    colours: list[str],
) -> str:
    """Draw markers or cells, and describe them."""
    from matplotlib.colors import ListedColormap

    exact = x.bins.is_exact and y.bins.is_exact
    as_markers = not exact and len(codes) <= _MAX_MARKERS
    margin = 0.02 if as_markers else 0.0
    x.apply(plot, "x", margin=margin)
    y.apply(plot, "y", margin=margin)
    plot.spines[["top", "right"]].set_visible(False)
    if as_markers:
        plot.grid(True, color=GRID_COLOUR, linewidth=0.7)
        plot.set_axisbelow(True)
        edges = [TEXT_COLOUR if code == 0 else "none" for code in codes]
        plot.scatter(
            x.locate(columns[0]),
            y.locate(columns[1]),
            c=[colours[code] for code in codes],
            s=36.0 if len(codes) <= 600 else 14.0,
            linewidths=0.4,
            edgecolors=edges,
        )
        return "each marker is one design"
    # Number of points of each class in each cell
    shape = (y.bins.count, x.bins.count, len(colours))
    flat = (y.bins.indices * shape[1] + x.bins.indices) * shape[2] + codes
    counts = np.bincount(flat, minlength=math.prod(shape)).reshape(shape)
    points = counts.sum(axis=2)
    most_frequent = np.where(points > 0, counts.argmax(axis=2), -1).astype(float)
    plot.set_facecolor(PALE_GREY)
    plot.pcolormesh(
        x.edges,
        y.edges,
        np.ma.masked_less(most_frequent, 0),
        cmap=ListedColormap(colours),
        vmin=-0.5,
        vmax=len(colours) - 0.5,
    )
    if points.max() <= 1:
        return "each cell is one design"
    return f"each cell shows its most frequent class; median of {np.median(points):.0f} designs per cell"


def _draw_shares(plot: Axes, x: PlotScale, codes: NDArray[np.intp], colours: list[str]) -> None:
    """Draw stacked bars with the share of each class along one axis."""
    size = len(colours)
    counts = np.bincount(x.bins.indices * size + codes, minlength=x.bins.count * size).reshape(-1, size)
    shares = 100 * counts / counts.sum(axis=1, keepdims=True)
    bottom = np.zeros(len(shares))
    for i, colour in enumerate(colours):
        plot.bar(
            x.edges[:-1],
            shares[:, i],
            np.diff(x.edges),
            bottom,
            align="edge",
            color=colour,
            edgecolor=colour,
            linewidth=0.3,
        )
        bottom += shares[:, i]
    style_axes(plot)
    x.apply(plot, "x")
    plot.set_ylim(0, 100)
