"""Plots of work-precision diagrams, and of the error of whole
trials over the step and over the CPU time.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np

from benchmarks.peers.native import NATIVE
from benchmarks.peers.options import SOLVE_IVP
from benchmarks.peers.trial import QUANTITIES, TARGETS, VARIANTS, TrialAccuracy
from benchmarks.peers.work_precision import Cost, WorkPrecision
from fingertip.foundation.display import (
    BLUE,
    BROWN,
    ORANGE,
    PINK,
    PURPLE,
    RED,
    REFERENCE,
    SKY,
    TEAL,
    TEXT_COLOUR,
    new_figure,
    style_axes,
    to_png,
)

_COLOURS = (RED, BLUE, TEAL, ORANGE, PURPLE, BROWN, SKY, REFERENCE, PINK, TEXT_COLOUR)
_STYLES = tuple(zip(_COLOURS, "os^DvPX<>*", strict=True))
_SOLVERS = (
    "fingertip",
    *(f"scipy {method}" for method in (*SOLVE_IVP, "odeint")),
    *NATIVE,
    *(f"{name}, sine" for name in NATIVE),
    "ngspice",
    "ngspice, sine",
)
"""Curves, so that each has the same colour whatever is compared."""
_COSTS: dict[Cost, str] = {
    "cpu_s": "CPU time of the integration [s]",
    "evaluations": "evaluations of the right-hand side",
}
_VARIANT_STYLES = {"article": (RED, "o"), "precision": (BLUE, "s"), "comparator": (TEAL, "x")}
_LABELS = {
    "force_n": "normal force [N]",
    "tactile_v": "tactile voltage [V]",
    "envelope_v": "envelope [V]",
}


def draw(diagrams: Sequence[WorkPrecision], footnote: str) -> bytes:
    """Draw two panels per problem: CPU time, and evaluations of the right-hand side, over the
    error; logarithmic.

    A line joins the points between which costs are interpolated; a solver's other points are pale.
    """
    figure = new_figure(12, 11)
    panels = figure.subplots(len(_COSTS), len(diagrams), squeeze=False)
    styles = {
        name: (*_STYLES[i % len(_STYLES)], "-:"[i // len(_STYLES)])
        for i, name in enumerate(_SOLVERS)
    }

    for (row, cost), (column, diagram) in itertools.product(enumerate(_COSTS), enumerate(diagrams)):
        axes = panels[row, column]
        for solver in dict.fromkeys(
            point.solver for point in diagram.points if getattr(point, cost)
        ):
            colour, marker, line = styles[solver]
            every = [(p.error, getattr(p, cost)) for p in diagram.points if p.solver == solver]
            best = diagram.best_points(solver, cost)
            axes.loglog(
                *zip(*every, strict=True),
                color=colour,
                marker=marker,
                markersize=4,
                linestyle="",
                alpha=0.3,
            )
            width = 2.2 if solver == next(iter(diagram.solvers)) else 1.2
            axes.loglog(
                *zip(*best, strict=True),
                color=colour,
                marker=marker,
                markersize=5,
                linestyle=line,
                linewidth=width,
                label=solver,
            )

        for level in diagram.levels:
            axes.axvline(level, color=REFERENCE, linestyle="--", linewidth=0.8)

        levels = ", ".join(f"{level:g}" for level in diagram.levels)
        axes.set_ylabel(_COSTS[cost])
        style_axes(axes, "both")

        if row == 0:
            axes.set_title(diagram.problem, loc="left", fontweight="bold")
            continue

        axes.set_xlabel(
            f"largest error [{diagram.unit}]; dashed: compared at {levels} {diagram.unit}"
        )
        handles = panels[0, column].get_legend_handles_labels()
        axes.legend(
            *handles,
            frameon=False,
            fontsize=9,
            loc="upper center",
            bbox_to_anchor=(0.5, -0.1),
            ncols=3,
        )

    figure.supxlabel(
        footnote,
        x=0.01,
        ha="left",
        fontsize=8,
        color=TEXT_COLOUR,
    )
    return to_png(figure)


def draw_trials(found: TrialAccuracy, footnote: str) -> bytes:
    """Draw two rows of panels, one column for each quantity: largest
    error over the step, and over the CPU time.
    """
    figure = new_figure(13, 8)
    panels = figure.subplots(2, len(QUANTITIES), squeeze=False)

    for column, name in enumerate(QUANTITIES):
        over_step, over_time = panels[:, column]
        for variant in VARIANTS:
            points = [p for p in found.points if p.variant == variant]
            errors = [p.errors[name] for p in points]
            colour, marker = _VARIANT_STYLES[variant]
            label = f"{variant}: order {found.order(variant, name):.1f}"
            over_step.loglog(
                [1e6 * p.step_s for p in points], errors, color=colour, marker=marker, label=label
            )
            over_time.loglog(
                [1e3 * p.cpu_s for p in points], errors, color=colour, marker=marker, label=variant
            )

        steps = np.array(sorted(1e6 * p.step_s for p in found.points if p.variant == VARIANTS[0]))
        largest = max(p.errors[name] for p in found.points)
        slope = largest * (steps / steps[-1]) ** 2
        over_step.loglog(
            steps,
            2 * slope,
            color=REFERENCE,
            linestyle="--",
            linewidth=1,
            label="order 2",
        )

        for axes in (over_step, over_time):
            if name in TARGETS:
                axes.axhline(TARGETS[name], color=REFERENCE, linestyle=":", linewidth=1.2)
                axes.annotate(
                    f"target {TARGETS[name]:g}",
                    (0.02, TARGETS[name]),
                    xycoords=("axes fraction", "data"),
                    xytext=(0, 3),
                    textcoords="offset points",
                    fontsize=8,
                    color=TEXT_COLOUR,
                )

            axes.set_ylabel("largest error at a sample")
            style_axes(axes, "both")
            axes.xaxis.set_minor_formatter("")
            axes.legend(frameon=False, fontsize=8)

        over_step.set_xticks(steps, [f"{step:g}" for step in steps])
        over_time.set_xticks([20, 50, 100, 200], ["20", "50", "100", "200"])
        over_step.set_title(_LABELS[name], loc="left", fontweight="bold")
        over_step.set_xlabel("step [us]")
        over_time.set_xlabel("CPU time of the whole trial [ms]")

    figure.supxlabel(
        footnote,
        x=0.01,
        ha="left",
        fontsize=8,
        color=TEXT_COLOUR,
    )
    return to_png(figure)
