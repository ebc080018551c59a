"""Plots of the outputs: heat maps over two axes, sensitivities, and the Pareto front of two objectives."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fingertip.foundation.plot_style import PALE_BLUE, PALE_GREY, RED, TEXT_COLOUR, new_figure, style_axes, to_png
from fingertip.sweep.report.best_design import Objective
from fingertip.sweep.report.feasibility import OutputSensitivity
from fingertip.sweep.report.plot_scales import PlotScale, choose_points, make_scale, wrap_name
from fingertip.sweep.report.statistics import Column, compute_cell_statistics

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_MAX_CELLS = 40
_MAX_CANDIDATES = 20000


def draw_heat_map(
    axes: dict[str, Column],
    x_name: str,
    y_name: str,
    output: str,
    values: Column,
    feasible: NDArray[np.bool_],
    minimise: bool | None,
) -> bytes:
    """Draw an output over two axes: its best value and its mean over all other axes."""
    max_cells = max(5, min(_MAX_CELLS, math.isqrt(len(feasible) // 12)))
    x, y = (make_scale(name, axes[name], _count_cells(axes[name], max_cells)) for name in (x_name, y_name))
    cells = compute_cell_statistics(x.bins, y.bins, values, feasible, minimise is not False)
    others = [name for name, column in axes.items() if name not in (x_name, y_name) and len(np.unique(column)) > 1]
    if cells.finite.max(initial=0) <= 1 and not others:
        figure = new_figure(8.5, 6.5)
        _draw_cells(figure, figure.subplots(), (x, y), cells.mean, cells.points, output, output)
    else:
        figure = new_figure(13, 6.2)
        left, right = figure.subplots(1, 2)
        extreme = "maximum" if minimise is False else "minimum"
        title = f"{extreme} of {output} in each cell" + ("" if minimise is None else " (best)")
        _draw_cells(figure, left, (x, y), cells.best, cells.points, title, output)
        _draw_cells(figure, right, (x, y), cells.mean, cells.points, f"mean of {output} in each cell", output)
        right.set_ylabel("")
    condition = "" if np.isfinite(values[feasible]).all() else " with a finite value"
    caption = f"{cells.finite.sum()} feasible designs{condition}; grey: no such design"
    if not cells.points.all():
        caption += "; white: no point"
    if others:
        caption += f"; over all values of {', '.join(others)}"
    figure.suptitle(caption, x=0.01, ha="left", fontsize=9)
    return to_png(figure)


def draw_sensitivities(sensitivities: Sequence[OutputSensitivity], axes: Sequence[str]) -> bytes:
    """Draw first-order indices as a table: a row per output, a column per axis, and one for the unexplained share."""
    columns = [*axes, "no single axis"]
    shares = np.zeros((len(sensitivities), len(columns)))
    figure = new_figure(max(9.0, 2.6 + 1.15 * len(columns)), 1.9 + 0.55 * len(sensitivities))
    plot = figure.subplots()
    for i, sensitivity in enumerate(sensitivities):
        correlations = {axis.axis: axis.rank_correlation for axis in sensitivity.axes}
        indices = {axis.axis: axis.first_order_index for axis in sensitivity.axes}
        indices[columns[-1]] = max(0.0, sensitivity.unexplained)
        for j, name in enumerate(columns):
            shares[i, j] = indices.get(name, 0.0)
            if shares[i, j] <= 0:
                continue
            correlation = correlations.get(name, math.nan)
            arrow = ""
            if abs(correlation) >= 0.1:  # false for NaN, the correlation of a categorical axis
                arrow = " \u2191" if correlation > 0 else " \u2193"
            colour = "white" if shares[i, j] > 0.55 else "black"
            text = f"{_format_percent(shares[i, j])}{arrow}"
            plot.text(j, i, text, ha="center", va="center", fontsize=9, color=colour)
    plot.imshow(shares, cmap="Blues", vmin=0, vmax=1, aspect="auto")
    plot.set_xticks(range(len(columns)), [wrap_name(name, 16) for name in columns], fontsize=8)
    plot.set_yticks(range(len(sensitivities)), [wrap_name(s.output, 30) for s in sensitivities], fontsize=9)
    plot.tick_params(length=0, top=True, labeltop=True, bottom=False, labelbottom=False)
    plot.spines[:].set_visible(False)
    for gap in range(1, len(columns)):
        plot.axvline(gap - 0.5, color="white", linewidth=2)
    title = (
        "share of the output's variance that an axis explains alone (first-order Sobol index), over the feasible "
        "designs\narrow: the output rises or falls with the axis; empty: not significant; shares may overlap where "
        "designs are infeasible"
    )
    figure.suptitle(title, x=0.01, ha="left", fontsize=9)
    return to_png(figure)


def draw_pareto_front(
    objectives: Sequence[Objective], values: tuple[Column, Column], front: NDArray[np.intp], best: int
) -> bytes:
    """Draw all candidates by the first two objectives, and their Pareto front."""
    figure = new_figure(10, 7)
    plot = figure.subplots()
    x, y = values
    points = choose_points(len(x), _MAX_CANDIDATES)
    size = 3.5 if len(points) > 2000 else 6.0
    plot.plot(x[points], y[points], ".", color=PALE_BLUE, markersize=size, markeredgewidth=0)
    order = front[np.lexsort((y[front], x[front]))]
    label = f"Pareto front, {len(front)} designs"
    if len(objectives) == 2:
        # Steps instead of straight lines: no design is known to exist between two designs of the front.
        minimise = objectives[0].goal == "minimise"
        plot.step(x[order], y[order], where="post" if minimise else "pre", color=RED, linewidth=1)
    else:
        label += f" by all {len(objectives)} objectives"
    plot.plot(x[order], y[order], "o", color=RED, markersize=4.5, markeredgewidth=0, label=label)
    plot.plot(x[best], y[best], "o", markersize=14, markerfacecolor="none", color=TEXT_COLOUR, label="best.toml")
    plot.set_xlabel(f"{objectives[0].output} ({objectives[0].goal})")
    plot.set_ylabel(f"{objectives[1].output} ({objectives[1].goal})")
    shown = f"all {len(x)} feasible designs"
    if len(points) < len(x):
        shown = f"{len(points)} of {len(x)} feasible designs, chosen at random"
    plot.set_title(f"{shown}, and their Pareto front", loc="left", fontsize=10)
    plot.legend(frameon=False, fontsize=9)
    style_axes(plot, "both")
    return to_png(figure)


def _count_cells(column: Column, max_cells: int) -> int:
    """Count the cells of an axis: one per value of a grid while they can be told apart, else `max_cells`."""
    count = len(np.unique(column))
    return count if count <= _MAX_CELLS else max_cells


def _draw_cells(
    figure: Figure,
    plot: Axes,
    scales: tuple[PlotScale, PlotScale],
    values: Column,
    points: NDArray[np.intp],
    title: str,
    unit: str,
) -> None:
    from matplotlib.colors import ListedColormap

    x, y = scales
    plot.pcolormesh(x.edges, y.edges, np.ma.masked_equal(points, 0), cmap=ListedColormap([PALE_GREY]))
    mesh = plot.pcolormesh(x.edges, y.edges, np.ma.masked_invalid(values), cmap="viridis")
    bar = figure.colorbar(mesh, ax=plot, pad=0.01)
    bar.set_label(unit, fontsize=9)
    bar.outline.set_visible(False)
    x.apply(plot, "x")
    y.apply(plot, "y")
    plot.set_title(title, loc="left", fontsize=10)
    plot.spines[["top", "right"]].set_visible(False)


def _format_percent(share: float) -> str:
    return f"{100 * share:.0f} %" if share >= 0.01 else "< 1 %"
