"""Which pictures of a sweep are worth drawing, and of what. The only module beside `pictures` that loads matplotlib."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fingertip.sweep.report.statistics import Column
from fingertip.sweep.report.feasibility import FEASIBLE, feasible
from fingertip.sweep.report.pictures import front, weights
from fingertip.sweep.report import scatter_matrix
from fingertip.sweep.report import output_plots
from fingertip.sweep.report import feasibility_plot
from fingertip.sweep.report.sensitivity import strongest
from fingertip.sweep.report.summary import Findings

_MAX_HEATED = 3
"""Objectives that get a heat map."""


def pictures(found: Findings) -> Iterator[tuple[str, bytes]]:
    """File name and PNG of each picture that has something to show."""
    table, ok = found.table, feasible(found.table)
    varied = {name: column for name, column in table.axes.items() if _varies(column)}
    if not varied:
        return
    if found.limits:
        telling = strongest(found.sensitivity(FEASIBLE), [*varied], len(varied))
        yield "feasibility_plot.png", feasibility_plot.draw(varied, found.verdicts, telling)
    if found.sensitivities:
        yield "weights.png", weights.draw(found.sensitivities, [*varied])
    outputs = {name: column for name, column in table.outputs.items() if _varies(column[ok])}
    wanted = [one.output for one in found.choice.objectives]
    ranked = [*(name for name in wanted if name in outputs), *(name for name in outputs if name not in wanted)]
    for output in ranked[: max(1, min(len(wanted), _MAX_HEATED))] if len(varied) > 1 else []:
        two = strongest(found.sensitivity(output), [*varied], 2)
        x, y = sorted(two, key=list(varied).index)
        goal = next((one.sign > 0 for one in found.choice.objectives if one.output == output), None)
        yield f"heat_{output}.png", output_plots.draw(varied, x, y, output, table.outputs[output], ok, goal)
    yield "scatter_matrix.png", _pairs(found, varied, {name: outputs[name] for name in ranked})
    if len(wanted) >= 2 and found.choice.best is not None:
        yield "front.png", _front(found)


def _varies(column: Column) -> bool:
    known = column[np.isfinite(column)] if column.dtype.kind == "f" else column
    return len(known) > 0 and bool(np.any(known != known[0]))


def _pairs(found: Findings, axes: dict[str, Column], outputs: dict[str, Column]) -> bytes:
    """At most as many columns as can be read; half of the room is for outputs, more if axes leave it."""
    maximum = scatter_matrix.MAX_COLUMNS
    room = max(maximum // 2, maximum - len(axes))
    told = list(outputs)[:room]
    weight = dict.fromkeys(axes, 0.0)
    for one in found.sensitivities:
        for w in one.weights:
            if one.output in told and w.axis in weight:
                weight[w.axis] += w.share
    heaviest = sorted(axes, key=lambda name: -weight[name])[: maximum - len(told)]
    shown = [name for name in axes if name in heaviest]
    columns = {name: axes[name] for name in shown} | {name: outputs[name] for name in told}
    left_out = [name for name in (*axes, *outputs) if name not in columns]
    return scatter_matrix.draw(columns, feasible(found.table), left_out)


def _front(found: Findings) -> bytes:
    choice, table = found.choice, found.table
    first, second = choice.objectives[:2]
    place = np.searchsorted(choice.candidates, choice.front)
    assert choice.best is not None
    best = int(np.searchsorted(choice.candidates, choice.best))
    values = (table.outputs[first.output][choice.candidates], table.outputs[second.output][choice.candidates])
    names, words = (first.output, second.output), (first.word, second.word)
    return front.draw(names, words, values, place, best, len(choice.objectives))
