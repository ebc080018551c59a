"""Drawing of a design: a sheet for each printed part, as SVG files and one PDF."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from fingertip.cad.shapes.parts import PARTS, parts_by_name
from fingertip.design import Design
from fingertip.design.geometry.sizes import Length, PartDrawing
from fingertip.foundation import extras
from fingertip.foundation.progress import Work
from fingertip.pictures.drawing import mold_sizes, part_sizes
from fingertip.pictures.drawing.layout import lay_out
from fingertip.pictures.drawing.primitives import Sheet
from fingertip.pictures.drawing.projection import project_parts
from fingertip.pictures.drawing.render import render_pdf, render_svg
from fingertip.pictures.drawing.title_block import Heading

_DRAWINGS: dict[str, Callable[[Design], PartDrawing]] = {
    "bone": part_sizes.bone_drawing,
    "lid": part_sizes.lid_drawing,
    "mold_palmar": mold_sizes.palmar_drawing,
    "mold_dorsal": mold_sizes.dorsal_drawing,
    "core": part_sizes.core_drawing,
    "sensor_insert": part_sizes.insert_drawing,
    "insert_jig": part_sizes.jig_drawing,
}


def part_drawings(design: Design) -> tuple[PartDrawing, ...]:
    printed = (name for name, part in parts_by_name(design).items() if part.is_printed)
    drawings = []
    for drawing in (_DRAWINGS[name](design) for name in printed):
        # Only the printer's offset is added: the scale of the files is there to give the design's size.
        sizes = tuple(replace(size, added_mm=size.growth * design.printer.offset_mm) for size in drawing.sizes)
        drawings.append(replace(drawing, sizes=sizes, notes=_notes(design, drawing)))
    return tuple(drawings)


def _notes(design: Design, drawing: PartDrawing) -> tuple[str, ...]:
    notes = [f"Curved surfaces and all other sizes: see {drawing.part}.step.", *drawing.notes]
    if design.mold.draft_deg and drawing.part.startswith(("mold", "bone", "core")):
        drafted = "Recess, keys and sockets" if drawing.part.startswith("mold") else "The collar's foot"
        notes.append(f"{drafted}: {design.mold.draft_deg:g} degrees of draft from the parting plane.")
    if drawing.part.startswith("mold") and design.mold.engraving_depth_mm:
        notes.append("Engraved text is not shown.")
    offset, scale = design.printer.offset_mm, design.printer.scale_percent
    if offset:
        much = "thick" if offset > 0.0 else "thin"
        notes.append(f"All sizes are those of the print, {abs(offset):g} mm too {much} (printer.offset_mm):")
        outer, inner = ("smaller", "larger") if offset > 0.0 else ("larger", "smaller")
        notes.append(f"in STEP, outer sizes are so much {outer}, inner ones {inner}.")
    if scale != 100.0:
        notes.append(f"STL and 3MF hold the sizes of STEP times {scale:g} %.")
    if any(isinstance(size, Length) and size.is_reference for size in drawing.sizes):
        notes.append("Sizes in parentheses start at no surface: for reference only.")
    return tuple(notes)


PDF = "drawing.pdf"


def svg_name(part: str) -> str:
    return f"drawing_{part}.svg"


def file_names(design: Design) -> tuple[str, ...]:
    return (*(svg_name(drawing.part) for drawing in part_drawings(design)), PDF)


def require_packages(field: str) -> None:
    """Raise a `MissingLibraryError` that blames `field` unless Open CASCADE and reportlab are installed."""
    extras.require(field, "OCP", "reportlab", alternative="draw a picture with fingertip picture")


def draw_sheets(design: Design, progress: Callable[[str], None] = lambda message: None) -> dict[str, Sheet]:
    """Draw a sheet for each printed part, by name. Raises MissingLibraryError or GeometryError."""
    drawings = part_drawings(design)
    # The engraved letters would hide the rest under some hundred edges. A note names them.
    plain = design.with_values({"mold.engraving_depth_mm": 0.0})
    work = Work("", {"projecting the parts": 20.0, **{f"drawing of {d.part}": 1.0 for d in drawings}}, progress)
    work.begin("projecting the parts")
    views = project_parts(tuple((d.part, PARTS[d.part].solid(plain), d.views) for d in drawings))
    sheets = {}
    for number, drawing in enumerate(drawings, 1):
        work.begin(f"drawing of {drawing.part}")
        sheets[drawing.part] = lay_out(drawing, views[drawing.part], Heading(design.name, "", number, len(drawings)))
    return sheets


def draw_files(design: Design, progress: Callable[[str], None] = lambda message: None) -> dict[str, bytes]:
    """Draw a design: file name -> content. Raises MissingLibraryError or GeometryError."""
    require_packages("drawing")
    sheets = draw_sheets(design, progress)
    files = {svg_name(part): render_svg(sheet) for part, sheet in sheets.items()}
    return files | {PDF: render_pdf(tuple(sheets.values()), f"fingertip {design.name}")}
