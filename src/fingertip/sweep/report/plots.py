"""Plots of a sweep: scatter matrix, heat maps, sensitivities and Pareto front, and which are worth
drawing.

Choosing them does not need matplotlib.
"""

from __future__ import annotations

import math
import textwrap
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fingertip.foundation import display as style
from fingertip.sweep.report import feasibility_plot, statistics
from fingertip.sweep.report.best_design_file import Objective
from fingertip.sweep.report.statistics import Column, compute_cell_statistics
from fingertip.sweep.report.summary import SweepSummary, format_percent

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


MAX_COLUMNS = 8
_MAX_POINTS = 2000
_HISTOGRAM_BINS = 24
_CHARACTER_IN = 0.078
_LINE_IN = 0.15
"""Largest mean width of a character, and height of a line, in the heading [inch]."""


def draw_scatter_matrix(
    columns: dict[str, Column], feasible: NDArray[np.bool_], left_out: Sequence[str] = ()
) -> bytes:
    """Draw scatter plots below the diagonal, histograms on it, and rank correlations above it."""
    size = len(columns)
    panel = 1.75 if size > 4 else 2.4
    points = feasibility_plot.choose_points(len(feasible), _MAX_POINTS)
    marker = min(5.0, max(2.4, 90 / math.sqrt(len(points))))
    width = panel * size + 1.0
    heading = _write_heading(len(points), len(feasible), left_out, width)
    top = 0.15 + _LINE_IN * len(heading)
    height = panel * size + 0.65 + top
    # Automatic layout would take seconds for so many panels.
    figure = style.new_figure(width, height, automatic_layout=False)
    figure.subplots_adjust(
        0.95 / width, 0.6 / height, 1 - 0.1 / width, 1 - top / height, 0.12, 0.12
    )
    panels = figure.subplots(size, size, squeeze=False)
    finite = {name: _select_finite(column) for name, column in columns.items()}
    scales = [
        feasibility_plot.make_scale(name, column, _HISTOGRAM_BINS)
        for name, column in finite.items()
    ]
    values = list(columns.values())

    for i, y in enumerate(scales):
        for j, x in enumerate(scales):
            plot = panels[i, j]
            plot.spines[["top", "right"]].set_visible(False)
            plot.tick_params(labelsize=7)

            if j > i:
                _draw_correlation(plot, values[j][feasible], values[i][feasible])
                continue

            x.apply(plot, "x", size=8, margin=0.03, max_label=20)
            if i == j:
                _draw_histogram(plot, x, values[j], feasible)
            else:
                y.apply(plot, "y", size=8, margin=0.03, max_label=20)
                at_x = _locate_with_jitter(x, values[j][points])
                at_y = _locate_with_jitter(y, values[i][points])

                for drawn, colour in (
                    (~feasible[points], style.PALE_RED),
                    (feasible[points], style.BLUE),
                ):
                    plot.plot(
                        at_x[drawn],
                        at_y[drawn],
                        ".",
                        color=colour,
                        markersize=marker,
                        markeredgewidth=0,
                    )

            # Few ticks, and labels only on the outer panels
            for side, scale in (("x", x), ("y", y)):
                if not scale.categories and not scale.log and (i != j or side == "x"):
                    plot.locator_params(side, nbins=3)

            if i < size - 1:
                plot.set_xlabel("")
                plot.tick_params(labelbottom=False)

            if j > 0 or i == j:
                plot.set_ylabel("")
                plot.tick_params(labelleft=False)

    panels[0, 0].set_ylabel("points", fontsize=8)
    for i in range(size):
        panels[i, 0].yaxis.set_label_coords(-0.58 / (panel * 0.9), 0.5)

    figure.suptitle(
        "\n".join(heading),
        x=0.01,
        y=1 - 0.06 / height,
        ha="left",
        va="top",
        fontsize=9,
    )
    return style.to_png(figure)


def _write_heading(shown: int, count: int, left_out: Sequence[str], width_in: float) -> list[str]:
    """Write the lines of the heading, none wider than the figure."""
    points = (
        f"all {count} points" if shown == count else f"{shown} of {count} points, chosen at random"
    )
    colours = "blue: feasible, red: infeasible"
    sentences = [
        f"{points}; {colours}; above the diagonal: rank correlation of the feasible points"
    ]
    if left_out:
        sentences.append(f"not shown for lack of space: {', '.join(left_out)}")

    characters = int(width_in / _CHARACTER_IN)
    lines = []
    for sentence in sentences:
        lines += textwrap.wrap(sentence, characters, break_long_words=False)

    return lines


def _locate_with_jitter(scale: feasibility_plot.PlotScale, column: Column) -> NDArray[np.float64]:
    """Compute the positions of points.

    Those of a category are spread out, or they would cover each other.
    """
    positions = scale.locate(column)
    if not scale.categories:
        return positions

    return positions + np.random.default_rng(1).uniform(-0.3, 0.3, len(positions))


def _select_finite(column: Column) -> Column:
    finite = column[np.isfinite(column)] if column.dtype.kind == "f" else column
    return finite if len(finite) else np.zeros(1)


def _draw_histogram(
    plot: Axes, x: feasibility_plot.PlotScale, column: Column, feasible: NDArray[np.bool_]
) -> None:
    """Draw how many points there are at each value.

    Bars of unequal width show their number per mean width.
    """
    positions = x.locate(column)
    edges = (
        x.edges if x.categories else feasibility_plot.histogram_edges(positions, x, _HISTOGRAM_BINS)
    )
    widths = np.diff(np.log(edges) if x.log else edges)
    per_width = (
        widths.mean() / widths if len(widths) > 1 and not x.bins.is_exact else np.ones(len(widths))
    )
    feasible_heights = per_width * np.histogram(positions[feasible], edges)[0]
    infeasible_heights = per_width * np.histogram(positions[~feasible], edges)[0]
    plot.bar(edges[:-1], feasible_heights, np.diff(edges), align="edge", color=style.BLUE)
    plot.bar(
        edges[:-1],
        infeasible_heights,
        np.diff(edges),
        feasible_heights,
        align="edge",
        color=style.PALE_RED,
    )


def _draw_correlation(plot: Axes, a: Column, b: Column) -> None:
    plot.set_axis_off()
    if statistics.is_categorical(a) or statistics.is_categorical(b):
        return

    finite = np.isfinite(a.astype(float)) & np.isfinite(b.astype(float))
    a = a[finite]
    b = b[finite]
    if len(a) < 3 or np.ptp(a) == 0 or np.ptp(b) == 0:
        return

    value = statistics.compute_correlation(statistics.compute_ranks(a), statistics.compute_ranks(b))
    text = f"{round(value, 2) + 0.0:+.2f}"
    size = 8 + 8 * abs(value)
    alpha = 0.35 + 0.65 * abs(value)
    centre: dict[str, Any] = {"ha": "center", "va": "center", "transform": plot.transAxes}
    plot.text(0.5, 0.5, text, fontsize=size, color=style.TEXT_COLOUR, alpha=alpha, **centre)


_MAX_HEAT_MAPS = 3


def select_plots(summary: SweepSummary) -> Iterator[tuple[str, Callable[[], bytes]]]:
    """Select the plots that have something to show.

    Give the file name of each and the function that draws its PNG.
    """
    table, feasible = summary.table, statistics.find_feasible(summary.table)
    axes = {name: column for name, column in table.axes.items() if _varies(column)}
    if not axes:
        return

    if summary.limiting_rules:
        ranked = statistics.select_strongest_axes(
            summary.find_sensitivity(statistics.FEASIBLE), [*axes], len(axes)
        )
        yield (
            "feasibility.png",
            partial(feasibility_plot.draw_feasibility, axes, summary.classes, ranked),
        )

    if summary.sensitivities:
        yield "sensitivity.png", partial(draw_sensitivities, summary.sensitivities, [*axes])

    # Outputs that vary, objectives first
    outputs = {name: column for name, column in table.outputs.items() if _varies(column[feasible])}
    objectives = {o.output: o for o in summary.selection.objectives}
    names = [
        *(name for name in objectives if name in outputs),
        *(name for name in outputs if name not in objectives),
    ]
    heat_maps = names[: max(1, min(len(objectives), _MAX_HEAT_MAPS))] if len(axes) > 1 else []

    for output in heat_maps:
        strongest = statistics.select_strongest_axes(summary.find_sensitivity(output), [*axes], 2)
        x, y = sorted(strongest, key=list(axes).index)
        minimise = objectives[output].sign > 0 if output in objectives else None
        values = table.outputs[output]
        yield (
            f"heatmap_{output}.png",
            partial(draw_heat_map, axes, x, y, output, values, feasible, minimise),
        )

    yield (
        "scatter_matrix.png",
        partial(_draw_scatter_matrix, summary, axes, {name: outputs[name] for name in names}),
    )
    if len(objectives) >= 2 and summary.selection.best is not None:
        yield "pareto_front.png", partial(_draw_front, summary)


def _varies(column: Column) -> bool:
    finite = _select_finite(column)
    return bool(np.any(finite != finite[0]))


def _draw_scatter_matrix(
    summary: SweepSummary, axes: dict[str, Column], outputs: dict[str, Column]
) -> bytes:
    """Draw as many columns as fit. Outputs get half of them, or more if there are few axes."""
    shown_outputs = list(outputs)[: max(MAX_COLUMNS // 2, MAX_COLUMNS - len(axes))]
    # Of many axes, those with the highest indices over the shown outputs
    totals = dict.fromkeys(axes, 0.0)

    for sensitivity in summary.sensitivities:
        if sensitivity.output in shown_outputs:
            for axis in sensitivity.axes:
                if axis.axis in totals:
                    totals[axis.axis] += axis.first_order_index

    strongest = sorted(axes, key=lambda name: -totals[name])[: MAX_COLUMNS - len(shown_outputs)]
    shown_axes = [name for name in axes if name in strongest]
    columns = {name: axes[name] for name in shown_axes} | {
        name: outputs[name] for name in shown_outputs
    }
    left_out = [name for name in (*axes, *outputs) if name not in columns]

    return draw_scatter_matrix(columns, statistics.find_feasible(summary.table), left_out)


def _draw_front(summary: SweepSummary) -> bytes:
    selection = summary.selection
    table = summary.table
    assert selection.best is not None
    # Rows of the table to indices into the candidates
    front = np.searchsorted(selection.candidates, selection.front)
    best = int(np.searchsorted(selection.candidates, selection.best))
    first, second = selection.objectives[:2]
    values = (
        table.outputs[first.output][selection.candidates],
        table.outputs[second.output][selection.candidates],
    )

    return draw_pareto_front(selection.objectives, values, front, best)


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
    # One cell for each value of a grid while they can be told apart.
    counts = {name: len(np.unique(axes[name])) for name in axes}
    x, y = (
        feasibility_plot.make_scale(
            name, axes[name], counts[name] if counts[name] <= _MAX_CELLS else max_cells
        )
        for name in (x_name, y_name)
    )
    points, finite, best, mean = compute_cell_statistics(
        x.bins,
        y=y.bins,
        values=values,
        feasible=feasible,
        minimise=minimise is not False,
    )
    other_axes = [
        name for name, count in counts.items() if name not in (x_name, y_name) and count > 1
    ]

    if finite.max(initial=0) <= 1 and not other_axes:
        figure = style.new_figure(8.5, 6.5)
        _draw_cells(
            figure,
            plot=figure.subplots(),
            scales=(x, y),
            values=mean,
            points=points,
            title=output,
            unit=output,
        )
    else:
        figure = style.new_figure(13, 6.2)
        left, right = figure.subplots(1, 2)
        extreme = "maximum" if minimise is False else "minimum"
        title = f"{extreme} of {output} in each cell" + ("" if minimise is None else " (best)")
        _draw_cells(
            figure,
            plot=left,
            scales=(x, y),
            values=best,
            points=points,
            title=title,
            unit=output,
        )
        _draw_cells(
            figure,
            plot=right,
            scales=(x, y),
            values=mean,
            points=points,
            title=f"mean of {output} in each cell",
            unit=output,
        )
        right.set_ylabel("")

    condition = "" if np.isfinite(values[feasible]).all() else " with a finite value"
    caption = f"{finite.sum()} feasible designs{condition}; grey: no such design"
    if not points.all():
        caption += "; white: no point"
    if other_axes:
        caption += f"; over all values of {', '.join(other_axes)}"

    figure.suptitle(caption, x=0.01, ha="left", fontsize=9)
    return style.to_png(figure)


def draw_sensitivities(
    sensitivities: Sequence[statistics.OutputSensitivity], axes: Sequence[str]
) -> bytes:
    """Draw first-order indices as a table: a row per output, a column per axis, and one for the
    unexplained share.
    """
    columns = [*axes, "no single axis"]
    shares = np.zeros((len(sensitivities), len(columns)))
    figure = style.new_figure(max(9.0, 2.6 + 1.15 * len(columns)), 1.9 + 0.55 * len(sensitivities))
    plot = figure.subplots()

    for i, sensitivity in enumerate(sensitivities):
        correlations = {axis.axis: axis.rank_correlation for axis in sensitivity.axes}
        indices = {axis.axis: axis.first_order_index for axis in sensitivity.axes}
        tied = {axis.axis for axis in sensitivity.axes if axis.tied_to}
        indices[columns[-1]] = max(0.0, sensitivity.unexplained)

        for j, name in enumerate(columns):
            shares[i, j] = indices.get(name, 0.0)
            if name in tied:
                plot.text(j, i, "?", ha="center", va="center", fontsize=9)
            if shares[i, j] <= 0:
                continue

            correlation = correlations.get(name, math.nan)
            arrow = ""
            if abs(correlation) >= 0.1:  # false for NaN, the correlation of a categorical axis
                arrow = " \u2191" if correlation > 0 else " \u2193"

            colour = "white" if shares[i, j] > 0.55 else "black"
            text = f"{format_percent(shares[i, j])}{arrow}"
            plot.text(
                j,
                i,
                text,
                ha="center",
                va="center",
                fontsize=9,
                color=colour,
            )

    plot.imshow(
        shares,
        cmap="Blues",
        vmin=0,
        vmax=1,
        aspect="auto",
    )
    plot.set_xticks(
        range(len(columns)), [feasibility_plot.wrap_name(name, 16) for name in columns], fontsize=8
    )
    rows = [feasibility_plot.wrap_name(sensitivity.output, 30) for sensitivity in sensitivities]
    plot.set_yticks(range(len(rows)), rows, fontsize=9)
    plot.tick_params(
        length=0,
        top=True,
        labeltop=True,
        bottom=False,
        labelbottom=False,
    )
    plot.spines[:].set_visible(False)
    for gap in range(1, len(columns)):
        plot.axvline(gap - 0.5, color="white", linewidth=2)

    title = (
        "share of the output's variance that an axis explains alone (first-order Sobol index), "
        "over the feasible "
        "designs\narrow: the output rises or falls with the axis; empty: not significant; ?: "
        "cannot be told apart "
        "from another axis"
    )
    figure.suptitle(title, x=0.01, ha="left", fontsize=9)
    return style.to_png(figure)


def draw_pareto_front(
    objectives: Sequence[Objective],
    values: tuple[Column, Column],
    front: NDArray[np.intp],
    best: int,
) -> bytes:
    """Draw all candidates by the first two objectives, and their Pareto front."""
    figure = style.new_figure(10, 7)
    plot = figure.subplots()
    x, y = values
    points = feasibility_plot.choose_points(len(x), _MAX_CANDIDATES)
    size = 3.5 if len(points) > 2000 else 6.0
    plot.plot(x[points], y[points], ".", color=style.PALE_BLUE, markersize=size, markeredgewidth=0)
    order = front[np.lexsort((y[front], x[front]))]
    label = f"Pareto front, {len(front)} designs"

    if len(objectives) == 2:
        # Steps instead of straight lines: no design is known to exist between two designs of the
        # front.
        minimise = objectives[0].goal == "minimise"
        plot.step(
            x[order], y[order], where="post" if minimise else "pre", color=style.RED, linewidth=1
        )
    else:
        label += f" by all {len(objectives)} objectives"

    plot.plot(
        x[order],
        y[order],
        "o",
        color=style.RED,
        markersize=4.5,
        markeredgewidth=0,
        label=label,
    )
    plot.plot(
        x[best],
        y[best],
        "o",
        markersize=14,
        markerfacecolor="none",
        color=style.TEXT_COLOUR,
        label="best.toml",
    )
    plot.set_xlabel(f"{objectives[0].output} ({objectives[0].goal})")
    plot.set_ylabel(f"{objectives[1].output} ({objectives[1].goal})")
    shown = f"all {len(x)} feasible designs"
    if len(points) < len(x):
        shown = f"{len(points)} of {len(x)} feasible designs, chosen at random"

    plot.set_title(f"{shown}, and their Pareto front", loc="left", fontsize=10)
    plot.legend(frameon=False, fontsize=9)
    style.style_axes(plot, "both")
    return style.to_png(figure)


def _draw_cells(
    figure: Figure,
    plot: Axes,
    scales: tuple[feasibility_plot.PlotScale, feasibility_plot.PlotScale],
    values: Column,
    points: NDArray[np.intp],
    title: str,
    unit: str,
) -> None:
    from matplotlib.colors import ListedColormap  # noqa: PLC0415

    x, y = scales
    plot.pcolormesh(
        x.edges, y.edges, np.ma.masked_equal(points, 0), cmap=ListedColormap([style.PALE_GREY])
    )
    mesh = plot.pcolormesh(x.edges, y.edges, np.ma.masked_invalid(values), cmap="viridis")
    bar = figure.colorbar(mesh, ax=plot, pad=0.01)
    bar.set_label(unit, fontsize=9)
    bar.outline.set_visible(False)
    x.apply(plot, "x")
    y.apply(plot, "y")
    plot.set_title(title, loc="left", fontsize=10)
    plot.spines[["top", "right"]].set_visible(False)
