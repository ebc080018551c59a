"""Style shared by all plots: figure size, colours, axes, and output as PNG or SVG.

Every plot begins with `new_figure`, which raises an error if matplotlib is not installed. Modules that draw import
matplotlib only where they use it, so that the plots can be listed without it.
"""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Literal

from fingertip import extras

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DPI = 150
"""Resolution of every figure [pixels/inch]."""
TEXT_COLOUR = "#4a5157"
"""Colour of annotations and of reference lines."""
GRID_COLOUR = "#e5e8eb"
"""Colour of grid lines."""
BLUE, RED, ORANGE, GREEN = "#1f4e79", "#b03a2e", "#d98c2b", "#2e7d5b"


def new_figure(width_in: float, height_in: float, *, automatic_layout: bool = True) -> Figure:
    """Create an empty figure.

    Parameters
    ----------
    width_in, height_in
        Size [inch].
    automatic_layout
        Whether matplotlib keeps axes and labels from overlapping. With many axes this takes seconds; pass False to
        place the axes yourself.

    Raises
    ------
    MissingLibraryError
        If matplotlib is not installed.
    """
    module = extras.load("matplotlib.figure", "plot")
    layout = "constrained" if automatic_layout else None
    figure: Figure = module.Figure(figsize=(width_in, height_in), dpi=DPI, layout=layout)
    return figure


def style_axes(axes: Axes, grid: Literal["x", "y", "both"] = "y") -> None:
    """Remove the top and right spines and draw a light grid behind the data."""
    axes.grid(True, axis=grid, color=GRID_COLOUR, linewidth=0.7)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)


def to_png(figure: Figure) -> bytes:
    """Render a figure as PNG.

    The file holds no date and no version, so the same data gives the same bytes.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    out = io.BytesIO()
    FigureCanvasAgg(figure).print_png(out, metadata={"Software": None})
    return out.getvalue()


def to_svg(figure: Figure) -> bytes:
    """Render a figure as SVG, with its text as outlines.

    The file holds no date, version or random identifier, so the same data gives the same bytes.
    """
    import matplotlib
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    out = io.BytesIO()
    with matplotlib.rc_context({"svg.hashsalt": "fingertip", "svg.fonttype": "path"}):
        FigureCanvasSVG(figure).print_svg(out, metadata={"Creator": None, "Date": None})
    return out.getvalue()
