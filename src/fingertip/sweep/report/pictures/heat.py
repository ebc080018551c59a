"""An output over two axes: the best and the mean over all others."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from numpy.typing import NDArray

from fingertip.drawing import png, sheet
from fingertip.sweep.report.bins import Column
from fingertip.sweep.report.pictures.scales import Scale, scale

_NONE_COLOUR = "#e9ebed"
_MOST_CELLS = 40


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
    known = ok & np.isfinite(values)
    cells = max(5, min(_MOST_CELLS, math.isqrt(len(ok) // 12)))
    x, y = (scale(name, axes[name], _cells(axes[name], cells)) for name in (x_name, y_name))
    size = y.bins.count * x.bins.count
    code = (y.bins.code * x.bins.count + x.bins.code)[known]
    counts = np.bincount(code, minlength=size)
    mean = np.bincount(code, values[known], minlength=size) / np.where(counts > 0, counts, np.nan)
    best = np.full(size, -np.inf if lower_is_better is False else np.inf)
    (np.maximum if lower_is_better is False else np.minimum).at(best, code, values[known])
    best[counts == 0] = np.nan
    asked = np.bincount(y.bins.code * x.bins.count + x.bins.code, minlength=size) > 0
    others = [name for name, column in axes.items() if name not in (x_name, y_name) and len(np.unique(column)) > 1]
    if counts.max(initial=0) <= 1 and not others:
        figure = sheet(8.5, 6.5)
        _panel(figure, figure.subplots(), (x, y), mean, asked, output, output)
    else:
        figure = sheet(13, 6.2)
        left, right = figure.subplots(1, 2)
        end = "greatest" if lower_is_better is False else "least"
        word = end if lower_is_better is None else f"best ({end})"
        _panel(figure, left, (x, y), best, asked, f"{word} {output} in each cell", output)
        _panel(figure, right, (x, y), mean, asked, f"mean {output} in each cell", output)
        right.set_ylabel("")
    said = f"{int(known.sum())} feasible designs; grey: none is feasible"
    if not asked.all():
        said += "; white: no point there"
    if others:
        said += f". Over all values of {', '.join(others)}"
    figure.suptitle(said, x=0.01, ha="left", fontsize=9)
    return png(figure)


def _cells(column: Column, most: int) -> int:
    """A grid's own values are kept while they can be told apart."""
    count = len(np.unique(column))
    return count if count <= _MOST_CELLS else most


def _panel(
    figure: Figure,
    plot: Axes,
    scales: tuple[Scale, Scale],
    flat: Column,
    asked: NDArray[np.bool_],
    title: str,
    unit: str,
) -> None:
    x, y = scales
    shape = (y.bins.count, x.bins.count)
    none = np.ma.masked_equal(asked.reshape(shape), False)
    plot.pcolormesh(x.edges, y.edges, none, cmap=ListedColormap([_NONE_COLOUR]))
    shown = np.ma.masked_invalid(flat.reshape(shape))
    mesh = plot.pcolormesh(x.edges, y.edges, shown, cmap="viridis")
    bar = figure.colorbar(mesh, ax=plot, pad=0.01)
    bar.set_label(unit, fontsize=9)
    bar.outline.set_visible(False)
    x.dress(plot, "x")
    y.dress(plot, "y")
    plot.set_title(title, loc="left", fontsize=10)
    plot.spines[["top", "right"]].set_visible(False)
