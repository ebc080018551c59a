"""The Pareto front of two objectives."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fingertip.plot_style import TEXT_COLOUR, RED, style_axes, to_png, new_figure
from fingertip.sweep.report.statistics import Column
from fingertip.sweep.report.plot_scales import chosen

_CLOUD_COLOUR = "#a9bfd4"
_MAX_POINTS = 20000


def draw(
    names: tuple[str, str], words: tuple[str, str], values: tuple[Column, Column], front: NDArray[np.intp],
    best: int, objectives: int,
) -> bytes:  # fmt: skip
    """All feasible designs by two objectives, those that none beats joined to a front.

    Parameters
    ----------
    names
        The two outputs.
    words
        For each, "minimise" or "maximise".
    values
        For each, the values of the feasible designs, shape (designs,), finite.
    front
        Places of the designs that none beats in all objectives.
    best
        Place of the one that is ringed.
    objectives
        How many objectives the front has; with more than two it is no line here.

    Returns
    -------
    bytes
        A PNG.
    """
    figure = new_figure(10, 7)
    plot = figure.subplots()
    x, y = values
    drawn = np.array(chosen(len(x), _MAX_POINTS), dtype=np.intp)
    size = 3.5 if len(drawn) > 2000 else 6.0
    plot.plot(x[drawn], y[drawn], ".", color=_CLOUD_COLOUR, markersize=size, markeredgewidth=0)
    order = front[np.lexsort((y[front], x[front]))]
    label = f"{len(front)} that none beats" + ("" if objectives == 2 else f" in all {objectives} objectives")
    if objectives == 2:
        # A step: nothing between two designs of the front is known to exist.
        plot.step(x[order], y[order], where="post" if words[0] == "minimise" else "pre", color=RED, linewidth=1)
    plot.plot(x[order], y[order], "o", color=RED, markersize=4.5, markeredgewidth=0, label=label)
    plot.plot(x[best], y[best], "o", markersize=14, markerfacecolor="none", color=TEXT_COLOUR, label="best.toml")
    plot.set_xlabel(f"{names[0]}, to {words[0]}")
    plot.set_ylabel(f"{names[1]}, to {words[1]}")
    how = f"{len(drawn)} of {len(x)} feasible designs, drawn at random" if len(drawn) < len(x) else (
        f"all {len(x)} feasible designs"
    )  # fmt: skip
    plot.set_title(f"{how}, and their Pareto front", loc="left", fontsize=10)
    plot.legend(frameon=False, fontsize=9)
    style_axes(plot, "both")
    return to_png(figure)
