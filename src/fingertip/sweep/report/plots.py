"""Choice of the plots that are worth drawing for a sweep. Choosing them does not need matplotlib."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from fingertip.sweep.report.feasibility import FEASIBLE, find_feasible
from fingertip.sweep.report.feasibility_plot import draw_feasibility
from fingertip.sweep.report.output_plots import draw_heat_map, draw_pareto_front, draw_sensitivities
from fingertip.sweep.report.scatter_matrix import MAX_COLUMNS, draw_scatter_matrix
from fingertip.sweep.report.sensitivity import select_strongest_axes
from fingertip.sweep.report.statistics import Column
from fingertip.sweep.report.summary import SweepSummary

_MAX_HEAT_MAPS = 3


def select_plots(summary: SweepSummary) -> Iterator[tuple[str, Callable[[], bytes]]]:
    """Select the plots that have something to show; give the file name of each and the function that draws its PNG."""
    table, feasible = summary.table, find_feasible(summary.table)
    axes = {name: column for name, column in table.axes.items() if _varies(column)}
    if not axes:
        return
    if summary.limiting_rules:
        ranked = select_strongest_axes(summary.find_sensitivity(FEASIBLE), [*axes], len(axes))
        yield "feasibility.png", partial(draw_feasibility, axes, summary.classes, ranked)
    if summary.sensitivities:
        yield "sensitivity.png", partial(draw_sensitivities, summary.sensitivities, [*axes])
    # Outputs that vary, objectives first
    outputs = {name: column for name, column in table.outputs.items() if _varies(column[feasible])}
    objectives = {o.output: o for o in summary.selection.objectives}
    names = [*(name for name in objectives if name in outputs), *(name for name in outputs if name not in objectives)]
    heat_maps = names[: max(1, min(len(objectives), _MAX_HEAT_MAPS))] if len(axes) > 1 else []
    for output in heat_maps:
        strongest = select_strongest_axes(summary.find_sensitivity(output), [*axes], 2)
        x, y = sorted(strongest, key=list(axes).index)
        minimise = objectives[output].sign > 0 if output in objectives else None
        values = table.outputs[output]
        yield f"heatmap_{output}.png", partial(draw_heat_map, axes, x, y, output, values, feasible, minimise)
    yield "scatter_matrix.png", partial(_draw_scatter_matrix, summary, axes, {name: outputs[name] for name in names})
    if len(objectives) >= 2 and summary.selection.best is not None:
        yield "pareto_front.png", partial(_draw_front, summary)


def _varies(column: Column) -> bool:
    finite = column[np.isfinite(column)] if column.dtype.kind == "f" else column
    return len(finite) > 0 and bool(np.any(finite != finite[0]))


def _draw_scatter_matrix(summary: SweepSummary, axes: dict[str, Column], outputs: dict[str, Column]) -> bytes:
    """Draw as many columns as fit. Outputs get half of them, or more if there are few axes."""
    shown_outputs = list(outputs)[: max(MAX_COLUMNS // 2, MAX_COLUMNS - len(axes))]
    # Of many axes, those with the highest indices over the shown outputs
    totals = dict.fromkeys(axes, 0.0)
    for sensitivity in summary.sensitivities:
        for axis in sensitivity.axes:
            if sensitivity.output in shown_outputs and axis.axis in totals:
                totals[axis.axis] += axis.first_order_index
    strongest = sorted(axes, key=lambda name: -totals[name])[: MAX_COLUMNS - len(shown_outputs)]
    shown_axes = [name for name in axes if name in strongest]
    columns = {name: axes[name] for name in shown_axes} | {name: outputs[name] for name in shown_outputs}
    left_out = [name for name in (*axes, *outputs) if name not in columns]
    return draw_scatter_matrix(columns, find_feasible(summary.table), left_out)


def _draw_front(summary: SweepSummary) -> bytes:
    selection, table = summary.selection, summary.table
    assert selection.best is not None
    # Rows of the table to indices into the candidates
    front = np.searchsorted(selection.candidates, selection.front)
    best = int(np.searchsorted(selection.candidates, selection.best))
    first, second = selection.objectives[:2]
    values = (table.outputs[first.output][selection.candidates], table.outputs[second.output][selection.candidates])
    return draw_pareto_front(selection.objectives, values, front, best)
