"""Display of results: tables in HTML, data frames, pictures, and the style of all plots.

Every plot begins with `new_figure`, which raises an error if matplotlib is not installed. Modules
that draw import matplotlib only where they use it, so that the plots can be listed without it.
"""

from __future__ import annotations

import contextlib
import html
import io
import logging
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from fingertip.foundation import extras
from fingertip.foundation.errors import Issue, OutputError

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Picture:
    """Picture that Jupyter shows, and that can be saved."""

    png: bytes

    def _repr_png_(self) -> bytes:
        return self.png

    def __repr__(self) -> str:
        width, height = self.size_px
        return f"Picture({width} x {height} pixels; save it with .save('picture.png'))"

    @property
    def size_px(self) -> tuple[int, int]:
        """Width and height [pixels], as the file states them."""
        return int.from_bytes(self.png[16:20], "big"), int.from_bytes(self.png[20:24], "big")

    def save(self, path: str | Path) -> Path:
        """Write the picture to a file whose name ends in ``.png``. Raises OutputError."""
        from fingertip.foundation.files import write_file  # noqa: PLC0415

        if Path(path).suffix.lower() != ".png":
            raise OutputError(
                Issue(str(path), "would be a PNG file of another name; end it in .png.")
            )

        write_file(Path(path), self.png, "picture")
        return Path(path)


def html_table(caption: str, header: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Write a table in HTML with its caption; every text is escaped."""
    head = "".join(f"<th>{html.escape(name)}</th>" for name in header)
    lines = []
    for row in rows:
        cells = "".join(f"<td>{html.escape(str(cell))}</td>" for cell in row)
        lines.append(f"<tr>{cells}</tr>")

    return (
        f"<table><caption>{html.escape(caption)}</caption>"
        f"<thead><tr>{head}</tr></thead><tbody>{''.join(lines)}</tbody></table>"
    )


def to_dataframe(columns: Mapping[str, Any], method: str) -> pandas.DataFrame:
    """Make a data frame of columns. Raises MissingLibraryError."""
    return extras.load("pandas", method).DataFrame(dict(columns))


DPI = 150
TEXT_COLOUR = "#4a5157"
"""Colour of annotations and of reference lines."""
GRID_COLOUR = "#e5e8eb"
BLUE = "#0f2f57"
PURPLE = "#6a3590"
RED = "#b03a2e"
TEAL = "#1e8683"
ORANGE = "#c9801f"
"""Colours of lines and symbols. Each is lighter than the one before, so that they differ in grey
and for every kind of colour blindness. Their contrast with white is at least 3:1.
"""
SERIES = (BLUE, RED, TEAL, PURPLE, ORANGE)
"""Colours of curves without a meaning of their own; the first ones differ most."""
SKY = "#5fb0d3"
YELLOW = "#e3c33c"
BROWN = "#7a4b26"
PINK = "#d67fa8"
AREAS = (RED, ORANGE, BLUE, YELLOW, PURPLE, SKY, BROWN, PINK)
"""Colours of areas side by side: neighbours in this order differ much in lightness."""
SHADES = ("#9ecae1", "#4292c6", "#08519c")
"""Colours of a quantity in ascending steps."""
TRUTH = "#8fc1b5"
"""Colour of what is true, an area: lighter than every line."""
PALE_TEAL = "#cfe3d8"
PALE_RED = "#e2b6b1"
PALE_BLUE = "#a9bfd4"
PALE_GREY = "#e9ebed"
"""Colours of areas and points in the background."""
REFERENCE = "#98a1aa"
"""Colour of the reference of a comparison."""


def new_figure(width_in: float, height_in: float, *, automatic_layout: bool = True) -> Figure:
    """Begin a figure of this size [inch]. Raises MissingLibraryError without matplotlib."""
    extras.require("plot", "matplotlib")
    if "matplotlib" not in sys.modules:
        _import_matplotlib()

    layout = "constrained" if automatic_layout else None
    figure: Figure = extras.load("matplotlib.figure", "plot").Figure(
        (width_in, height_in), DPI, layout=layout
    )
    return figure


def _import_matplotlib() -> None:
    """Import matplotlib without settings.

    Those of the current folder may be a stranger's, and others would change the bytes.
    """
    # While it is imported, it warns of a home that cannot be written; a picture needs none.
    logging.getLogger("matplotlib").setLevel(logging.ERROR)
    with contextlib.ExitStack() as left:
        with contextlib.suppress(FileNotFoundError):  # the current folder was removed
            left.enter_context(contextlib.chdir(Path(__file__).parent))

        extras.load("matplotlib", "plot").rcdefaults()


def style_axes(axes: Axes, grid: Literal["x", "y", "both"] = "y") -> None:
    """Remove the top and right spines and draw a light grid behind the data."""
    axes.grid(True, axis=grid, color=GRID_COLOUR, linewidth=0.7)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)


def to_png(figure: Figure) -> bytes:
    """Render a figure as PNG without date and version: the same data gives the same bytes."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg  # noqa: PLC0415

    out = io.BytesIO()
    _take_literally(figure)
    FigureCanvasAgg(figure).print_png(out, metadata={"Software": None})

    return out.getvalue()


def _take_literally(figure: Figure) -> None:
    """Take a $ in a text, such as the name of a file, literally, and not as a formula.

    Only the labels of logarithmic axes are formulas.
    """
    from matplotlib.axis import Tick  # noqa: PLC0415
    from matplotlib.text import Text  # noqa: PLC0415

    labels = set()
    for tick in figure.findobj(Tick):
        labels |= {tick.label1, tick.label2}

    for text in figure.findobj(Text):
        if text not in labels:
            text.set_parse_math(False)
