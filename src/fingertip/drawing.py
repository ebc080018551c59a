"""The style that all plots share. It imports matplotlib: import it only in modules that draw."""

from __future__ import annotations

import io
from typing import Literal

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

DPI = 150
INK = "#4a5157"
"""Of lines and words that explain."""
GRID = "#e5e8eb"
BLUE, RED, ORANGE, GREEN = "#1f4e79", "#b03a2e", "#d98c2b", "#2e7d5b"


def sheet(width_in: float, height_in: float, *, arranged: bool = True) -> Figure:
    """An empty figure of that size [inch], 150 pixels to the inch, whose parts keep clear of each other; of many parts
    that takes seconds, and `arranged=False` leaves their places to the caller."""
    return Figure(figsize=(width_in, height_in), dpi=DPI, layout="constrained" if arranged else None)


def plain(axes: Axes, grid: Literal["x", "y", "both"] = "y") -> None:
    """No frame above and at the right, a faint grid behind the data."""
    axes.grid(True, axis=grid, color=GRID, linewidth=0.7)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)


def png(figure: Figure) -> bytes:
    """The figure as a PNG: the same bytes for the same data, for neither date nor version stands in it."""
    out = io.BytesIO()
    FigureCanvasAgg(figure).print_png(out, metadata={"Software": None})
    return out.getvalue()
