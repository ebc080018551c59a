"""An output over two axes: the best and the mean over all others."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from numpy.typing import NDArray

from fingertip.plot_style import to_png, new_figure
from fingertip.sweep.report.statistics import Column
from fingertip.sweep.report.cells import cells
from fingertip.sweep.report.plot_scales import Scale, scale

_NONE_COLOUR = "#e9ebed"
_MAX_CELLS = 40


def draw(
    axes: dict[str, Column], x_name: str, y_name: str, output: str, values: Column, ok: NDArray[np.bool_],
    lower_is_better: bool | None,
) -> bytes:  # fmt: skip
    """Heat map of one output.

    Parameters
    ----------
    axes
        All axes, name -> values of shape (points,).
    x_name, y_name
        The two of them that are drawn.
    output, values
        Name and values, shape (points,).
    ok
        Feasible points, shape (points,).
    lower_is_better
        Which end of the output is best; None where no objective says so: then least and mean are drawn.

    Returns
    -------
    bytes
        A PNG with one panel where each cell is one design, else with two.
    """
    maximum = max(5, min(_MAX_CELLS, math.isqrt(len(ok) // 12)))
    x, y = (scale(name, axes[name], _cells(axes[name], maximum)) for name in (x_name, y_name))
    found = cells(x.bins, y.bins, values, ok, lower_is_better is not False)
    others = [name for name, column in axes.items() if name not in (x_name, y_name) and len(np.unique(column)) > 1]
    if found.count.max(initial=0) <= 1 and not others:
        figure = new_figure(8.5, 6.5)
        _panel(figure, figure.subplots(), (x, y), found.mean, found.asked, output, output)
    else:
        figure = new_figure(13, 6.2)
        left, right = figure.subplots(1, 2)
        end = "greatest" if lower_is_better is False else "least"
        word = end if lower_is_better is None else f"best ({end})"
        _panel(figure, left, (x, y), found.best, found.asked, f"{word} {output} in each cell", output)
        _panel(figure, right, (x, y), found.mean, found.asked, f"mean {output} in each cell", output)
        right.set_ylabel("")
    unbounded = "" if np.isfinite(values[ok]).all() else " of which it is a finite number"
    said = f"{found.count.sum()} feasible designs{unbounded}; grey: none there"
    if not found.asked.all():
        said += "; white: no point there"
    if others:
        said += f". Over all values of {', '.join(others)}"
    figure.suptitle(said, x=0.01, ha="left", fontsize=9)
    return to_png(figure)


def _cells(column: Column, maximum: int) -> int:
    """A grid's own values are kept while they can be told apart."""
    count = len(np.unique(column))
    return count if count <= _MAX_CELLS else maximum


def _panel(
    figure: Figure,
    plot: Axes,
    scales: tuple[Scale, Scale],
    shown: Column,
    asked: NDArray[np.intp],
    title: str,
    unit: str,
) -> None:
    x, y = scales
    none = np.ma.masked_equal(asked, 0)
    plot.pcolormesh(x.edges, y.edges, none, cmap=ListedColormap([_NONE_COLOUR]))
    mesh = plot.pcolormesh(x.edges, y.edges, np.ma.masked_invalid(shown), cmap="viridis")
    bar = figure.colorbar(mesh, ax=plot, pad=0.01)
    bar.set_label(unit, fontsize=9)
    bar.outline.set_visible(False)
    x.dress(plot, "x")
    y.dress(plot, "y")
    plot.set_title(title, loc="left", fontsize=10)
    plot.spines[["top", "right"]].set_visible(False)
