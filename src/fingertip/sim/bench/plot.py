"""Plot of work-precision diagrams."""

from __future__ import annotations

from collections.abc import Sequence

from fingertip.foundation.plot_style import (
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
from fingertip.sim.bench.work_precision import WorkPrecision

_COLOURS = (RED, BLUE, TEAL, ORANGE, PURPLE, BROWN, SKY, REFERENCE, PINK, TEXT_COLOUR)
_STYLES = tuple(zip(_COLOURS, "os^DvPX<>*", strict=True))


def draw(diagrams: Sequence[WorkPrecision], footnote: str) -> bytes:
    """Draw one panel per problem: CPU time over error, both logarithmic.

    A line joins the points between which times are interpolated; a solver's other points are pale.
    """
    figure = new_figure(12, 7)
    panels = figure.subplots(1, len(diagrams), squeeze=False)[0]
    names = list(dict.fromkeys(point.solver for diagram in diagrams for point in diagram.points))
    styles = {name: _STYLES[i % len(_STYLES)] for i, name in enumerate(names)}
    for axes, diagram in zip(panels, diagrams, strict=True):
        for solver in dict.fromkeys(point.solver for point in diagram.points):
            colour, marker = styles[solver]
            every = [(p.error, p.cpu_s) for p in diagram.points if p.solver == solver]
            best = [(p.error, p.cpu_s) for p in diagram.best_points(solver)]
            axes.loglog(*zip(*every, strict=True), color=colour, marker=marker, markersize=4, linestyle="", alpha=0.3)
            width = 2.2 if solver == next(iter(diagram.solvers)) else 1.2
            axes.loglog(
                *zip(*best, strict=True), color=colour, marker=marker, markersize=5, linewidth=width, label=solver
            )
        for level in diagram.levels:
            axes.axvline(level, color=REFERENCE, linestyle="--", linewidth=0.8)
        levels = ", ".join(f"{level:g}" for level in diagram.levels)
        axes.set_title(diagram.problem, loc="left", fontweight="bold")
        axes.set_xlabel(f"largest error [{diagram.unit}]; dashed: compared at {levels} {diagram.unit}")
        axes.set_ylabel("CPU time of the integration [s]")
        style_axes(axes, "both")
        axes.legend(frameon=False, fontsize=9, loc="upper center", bbox_to_anchor=(0.5, -0.1), ncols=3)
    figure.supxlabel(footnote, x=0.01, ha="left", fontsize=8, color=TEXT_COLOUR)
    return to_png(figure)
