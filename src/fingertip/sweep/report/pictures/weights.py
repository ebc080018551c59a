"""What weighs how much: shares of variance as a table of squares."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from fingertip.plot_style import to_png, new_figure
from fingertip.sweep.report.plot_scales import wrapped
from fingertip.sweep.report.sensitivity import Sensitivity


def draw(found: Sequence[Sensitivity], axes: Sequence[str]) -> bytes:
    """A row for each output, a column for each axis and one for what is not explained by any alone: a PNG."""
    columns = [*axes, "no axis alone"]
    shares = np.zeros((len(found), len(columns)))
    figure = new_figure(max(9.0, 2.6 + 1.15 * len(columns)), 1.9 + 0.55 * len(found))
    plot = figure.subplots()
    for i, one in enumerate(found):
        signs = {weight.axis: weight.rank_correlation for weight in one.weights}
        share = {weight.axis: weight.share for weight in one.weights} | {columns[-1]: max(0.0, one.together)}
        for j, name in enumerate(columns):
            shares[i, j] = share.get(name, 0.0)
            if shares[i, j] <= 0:
                continue
            sign = signs.get(name, math.nan)
            arrow = "" if abs(sign) < 0.1 or math.isnan(sign) else " \u2191" if sign > 0 else " \u2193"
            colour = "white" if shares[i, j] > 0.55 else "black"
            plot.text(j, i, f"{_percent(shares[i, j])}{arrow}", ha="center", va="center", fontsize=9, color=colour)
    plot.imshow(shares, cmap="Blues", vmin=0, vmax=1, aspect="auto")
    plot.set_xticks(range(len(columns)), [wrapped(name, 16) for name in columns], fontsize=8)
    plot.set_yticks(range(len(found)), [wrapped(one.output, 30) for one in found], fontsize=9)
    plot.tick_params(length=0, top=True, labeltop=True, bottom=False, labelbottom=False)
    plot.spines[:].set_visible(False)
    for gap in range(1, len(columns)):
        plot.axvline(gap - 0.5, color="white", linewidth=2)
    said = (
        "share of each output's variance that an axis explains alone, over the feasible designs (feasible: over all)\n"
        "arrow: it rises or falls with the axis; empty: no more than chance; infeasible points let shares overlap"
    )
    figure.suptitle(said, x=0.01, ha="left", fontsize=9)
    return to_png(figure)


def _percent(share: float) -> str:
    return f"{100 * share:.0f} %" if share >= 0.01 else "< 1 %"
