"""Which rule limits where, as a picture: a map for two axes; for more, shares along each axis."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from numpy.typing import NDArray

from fingertip.plot_style import TEXT_COLOUR, style_axes, to_png, new_figure
from fingertip.sweep.report.statistics import Column
from fingertip.sweep.report.feasibility import FEASIBLE, Verdicts
from fingertip.sweep.report.plot_scales import Scale, scale

_OK_COLOUR, _REST_COLOUR, _NO_COLOUR = "#cfe3d8", "#b9bec4", "#f4f5f6"
_COLOURS = ("#b03a2e", "#d98c2b", "#1f4e79", "#8e6bb0", "#d9c32b", "#4fa3c7", "#7a4b26", "#d67fa8")
_MAX_CELLS = 80
_MAX_MARKERS = 3000
_MAX_BARS = 40
_NOT_RULES = {"failed": "#20252a", "timeout": "#8a9199"}


def draw(axes: dict[str, Column], found: Verdicts, telling: list[str]) -> bytes:
    """The feasibility map of a sweep.

    Parameters
    ----------
    axes
        Name -> values, each of shape (points,); those of a single value are left out.
    found
        The verdict on each point.
    telling
        Names of axes, those that decide most first.

    Returns
    -------
    bytes
        A PNG.
    """
    varied = {name: axes[name] for name in telling if len(np.unique(axes[name])) > 1}
    colours, code, legend = _coloured(found)
    if len(varied) == 2:
        figure = new_figure(10, 7)
        plot = figure.subplots()
        (x_name, x), (y_name, y) = sorted(varied.items(), key=lambda item: list(axes).index(item[0]))
        said = _map(plot, scale(x_name, x, _MAX_CELLS), scale(y_name, y, _MAX_CELLS), (x, y), code, colours)
        _heading(figure, found, said, legend)
        return to_png(figure)
    columns = 2 if len(varied) == 4 else min(3, max(1, len(varied)))
    rows = max(1, math.ceil(len(varied) / columns))
    figure = new_figure(max(10.0, 4.2 * columns), 1.6 + 3.0 * rows)
    panels = figure.subplots(rows, columns, squeeze=False).ravel()
    for plot, (name, column) in zip(panels, varied.items(), strict=False):
        bars = min(_MAX_BARS, max(4, math.isqrt(len(column)) // 2))
        _shares(plot, scale(name, column, bars), code, colours)
    for plot in panels[len(varied) :]:
        plot.set_visible(False)
    for plot in panels[::columns]:
        plot.set_ylabel("share of points [%]")
    said = "share of each verdict along each axis, over all values of the others"
    _heading(figure, found, said, legend)
    return to_png(figure)


def _coloured(found: Verdicts) -> tuple[list[str], NDArray[np.intp], list[Patch]]:
    """Colours, the colour of each point, and the legend; what is rarest shares one colour if there are too many."""
    counts, total = found.counts(), max(1, len(found.code))
    names = list(found.names)
    colours = [_OK_COLOUR]
    palette = iter(_COLOURS)
    for name in names[1 : len(_COLOURS) + 1]:
        colours.append(_NOT_RULES.get(name) or next(palette))
    code = found.code
    labels = [f"{name}  {_percent(counts[i] / total)}" for i, name in enumerate(names[: len(colours)])]
    if len(names) > len(colours):
        rest = len(names) - len(colours)
        code = np.minimum(code, len(colours))
        labels.append(f"others ({rest})  {_percent(counts[len(colours) :].sum() / total)}")
        colours.append(_REST_COLOUR)
    return colours, code, [Patch(color=c, label=label) for c, label in zip(colours, labels, strict=True)]


def _percent(share: float) -> str:
    return f"{100 * share:.1f} %" if share >= 0.001 or share == 0 else "< 0.1 %"


def _heading(figure: Figure, found: Verdicts, said: str, legend: list[Patch]) -> None:
    ok = int(found.counts()[found.names.index(FEASIBLE)])
    words = f"{ok} of {len(found.code)} designs are feasible; a colour names the parameter that a rule blames"
    figure.suptitle(f"{words}\n{said}", x=0.01, ha="left", fontsize=10)
    figure.legend(handles=legend, loc="outside lower left", ncols=3, frameon=False, fontsize=9)


def _map(
    plot: Axes, x: Scale, y: Scale, columns: tuple[Column, Column], code: NDArray[np.intp], colours: list[str]
) -> str:
    """Draw cells or markers; what one of them stands for."""
    exact = x.bins.each_value and y.bins.each_value
    markers = not exact and len(code) <= _MAX_MARKERS
    margin = 0.02 if markers else 0.0
    x.dress(plot, "x", margin=margin)
    y.dress(plot, "y", margin=margin)
    plot.spines[["top", "right"]].set_visible(False)
    if markers:
        plot.grid(True, color="#e5e8eb", linewidth=0.7)
        plot.set_axisbelow(True)
        edge = [TEXT_COLOUR if c == 0 else "none" for c in code]
        size = 36.0 if len(code) <= 600 else 14.0
        plot.scatter(
            x.place(columns[0]), y.place(columns[1]), c=[colours[c] for c in code], s=size, linewidths=0.4,
            edgecolors=edge,
        )  # fmt: skip
        return "each marker is one design"
    shape = (y.bins.count, x.bins.count, len(colours))
    flat = (y.bins.code * shape[1] + x.bins.code) * shape[2] + code
    counts = np.bincount(flat, minlength=math.prod(shape)).reshape(shape)
    maximum = np.where(counts.sum(axis=2) > 0, counts.argmax(axis=2), -1).astype(float)
    plot.set_facecolor(_NO_COLOUR)
    plot.pcolormesh(
        x.edges,
        y.edges,
        np.ma.masked_less(maximum, 0),
        cmap=ListedColormap(colours),
        vmin=-0.5,
        vmax=len(colours) - 0.5,
    )
    if counts.sum(axis=2).max() <= 1:
        return "each cell is one design"
    return f"each cell has its most frequent verdict, of {np.median(counts.sum(axis=2)):.0f} designs in the median"


def _shares(plot: Axes, x: Scale, code: NDArray[np.intp], colours: list[str]) -> None:
    size = len(colours)
    counts = np.bincount(x.bins.code * size + code, minlength=x.bins.count * size).reshape(-1, size)
    shares = 100 * counts / counts.sum(axis=1, keepdims=True)
    bottom = np.zeros(len(shares))
    for i, colour in enumerate(colours):
        plot.bar(
            x.edges[:-1], shares[:, i], np.diff(x.edges), bottom, align="edge", color=colour, edgecolor=colour,
            linewidth=0.3,
        )  # fmt: skip
        bottom += shares[:, i]
    style_axes(plot)
    x.dress(plot, "x")
    plot.set_ylim(0, 100)
