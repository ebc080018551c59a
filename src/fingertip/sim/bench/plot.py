"""Plot of work-precision diagrams."""

from __future__ import annotations

from collections.abc import Sequence

from fingertip.plot_style import new_figure, style_axes, to_png
from fingertip.sim.bench.work_precision import WorkPrecision

_STYLES = (("#b03a2e", "o"), ("#1f4e79", "s"), ("#2e8b57", "^"), ("#b8860b", "D"), ("#6c5b7b", "v"))


def draw(diagrams: Sequence[WorkPrecision], footnote: str) -> bytes:
    """Draw one panel per problem: CPU time over error, both logarithmic.

    Returns
    -------
    bytes
        A PNG, 1800 x 975 pixels.
    """
    figure = new_figure(12, 6.5)
    panels = figure.subplots(1, len(diagrams), squeeze=False)[0]
    for axes, diagram in zip(panels, diagrams, strict=True):
        solvers = list(dict.fromkeys(point.solver for point in diagram.points))
        for solver, (colour, marker) in zip(solvers, _STYLES, strict=False):
            points = sorted((p.error, p.cpu_s) for p in diagram.points if p.solver == solver)
            axes.loglog(*zip(*points, strict=True), color=colour, marker=marker, markersize=5, label=solver)
        axes.axvline(diagram.target, color="#7f8c8d", linestyle="--", linewidth=1)
        axes.annotate(
            f"target {diagram.target:g} {diagram.unit}", (diagram.target, 0.14), xycoords=("data", "axes fraction"),
            xytext=(-4, 0), textcoords="offset points", rotation=90, ha="right", va="bottom", fontsize=8,
            color="#5d6d7e",
        )  # fmt: skip
        axes.set_title(diagram.problem, loc="left", fontweight="bold")
        axes.set_xlabel(f"largest error at a sample [{diagram.unit}]")
        axes.set_ylabel("CPU time [s]")
        style_axes(axes, "both")
        axes.legend(frameon=False, fontsize=9, loc="upper center", bbox_to_anchor=(0.5, -0.1), ncols=3)
    figure.supxlabel(footnote, x=0.01, ha="left", fontsize=8, color="#5d6d7e")
    return to_png(figure)
