"""Plot of the studies: delay by window length (figure 5)."""

from __future__ import annotations

import math
from collections.abc import Sequence

from fingertip.foundation import display as style
from fingertip.lab.report.plots import NOTE
from tools.article.protocol import WindowResult


def plot_windows(rows: Sequence[WindowResult]) -> bytes:
    """Plot delay and false alarms of the article's chain over its window length; returns a PNG."""
    figure = style.new_figure(10, 5)
    left, right = figure.subplots(1, 2)
    ms = [1000 * row.window_s for row in rows]

    for label, line, delays_s in (
        ("median", "-", [row.median_s for row in rows]),
        ("90th percentile", "--", [row.p90_s for row in rows]),
    ):
        kept = [(w, 1000 * d) for w, d in zip(ms, delays_s, strict=True) if math.isfinite(d)]
        left.plot(
            [w for w, _ in kept],
            [d for _, d in kept],
            line,
            marker=".",
            color=style.BLUE,
            label=label,
        )

    right.plot(ms, [row.contact_alarms_per_minute for row in rows], marker=".", color=style.RED)
    left.set_ylabel("delay [ms]")
    left.legend(frameon=False, fontsize=9)
    right.set_ylabel("false alarms per minute from contact, release, load change")
    left.set_title(f"digital, by window length ({NOTE})", loc="left", fontsize=10)

    for axes in (left, right):
        axes.axvline(30, color=style.TEXT_COLOUR, linestyle=":", linewidth=1)
        axes.set_ylim(bottom=0)
        axes.set_xlabel("window length [ms]; dotted: the article's")
        style.style_axes(axes)

    return style.to_png(figure)
