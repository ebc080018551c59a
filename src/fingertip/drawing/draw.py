"""Drawing of a design: a sheet for each printed part, as SVG files and one PDF."""

from __future__ import annotations

from collections.abc import Callable

from fingertip import extras
from fingertip.cad.shapes.parts import PARTS
from fingertip.design import Design
from fingertip.drawing.layout import lay_out
from fingertip.drawing.parts import part_drawings
from fingertip.drawing.pdf import render_pdf
from fingertip.drawing.primitives import Sheet
from fingertip.drawing.projection_process import project_parts
from fingertip.drawing.svg import render_svg
from fingertip.drawing.title_block import Heading

PDF = "drawing.pdf"


def svg_name(part: str) -> str:
    """Name of the file with the sheet of a part."""
    return f"drawing_{part}.svg"


def file_names(design: Design) -> tuple[str, ...]:
    """List the files of a drawing."""
    return (*(svg_name(drawing.part) for drawing in part_drawings(design)), PDF)


def require_packages(field: str) -> None:
    """Raise a `MissingLibraryError` that blames `field` unless cadquery and reportlab are installed."""
    extras.require(field, "cadquery", "reportlab", alternative="draw a picture with fingertip picture")


def draw_sheets(design: Design, progress: Callable[[str], None] = lambda message: None) -> dict[str, Sheet]:
    """Draw a sheet for each printed part, by name.

    Raises
    ------
    MissingLibraryError
        If cadquery cannot be loaded.
    GeometryError
        If the B-rep kernel fails, or no paper has room for all dimensions.
    """
    drawings = part_drawings(design)
    # The engraved letters would hide the rest under some hundred edges. A note names them.
    plain = design.with_values({"mold.engraving_depth_mm": 0.0})
    progress("projecting the parts in a second process")
    views = project_parts(tuple((d.part, PARTS[d.part].solid(plain), d.views) for d in drawings))
    sheets = {}
    for number, drawing in enumerate(drawings, 1):
        progress(f"laying out {drawing.part}")
        sheets[drawing.part] = lay_out(drawing, views[drawing.part], Heading(design.name, "", number, len(drawings)))
    return sheets


def draw_files(design: Design, progress: Callable[[str], None] = lambda message: None) -> dict[str, bytes]:
    """Draw a design: file name -> content.

    Raises
    ------
    MissingLibraryError
        If cadquery or reportlab is missing.
    GeometryError
        As `draw_sheets` does.
    """
    require_packages("drawing")
    sheets = draw_sheets(design, progress)
    files = {svg_name(part): render_svg(sheet) for part, sheet in sheets.items()}
    return files | {PDF: render_pdf(tuple(sheets.values()), f"fingertip {design.name}")}
