"""Drawing of a design: a sheet for each printed part, as SVG files and one PDF."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

from fingertip.cad.shapes.parts import PARTS, parts_by_name
from fingertip.design import Design
from fingertip.design.geometry.sizes import Length, PartDrawing
from fingertip.design.geometry.solids import Solid
from fingertip.foundation import extras
from fingertip.pictures.drawing import mold_sizes, part_sizes
from fingertip.pictures.drawing.layout import lay_out
from fingertip.pictures.drawing.primitives import Sheet
from fingertip.pictures.drawing.projection import Job, project_part, run_apart
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


def sheet_jobs(design: Design) -> Job[Sheet]:
    """List what draws the sheet of each printed part."""
    drawings = part_drawings(design)
    # The engraved letters would hide the rest under some hundred edges. A note names them.
    plain = design.with_values({"mold.engraving_depth_mm": 0.0})
    headings = (Heading(design.name, "", number, len(drawings)) for number in range(1, len(drawings) + 1))
    return tuple(
        (drawing.part, partial(_draw_sheet, drawing, PARTS[drawing.part].solid(plain), heading))
        for drawing, heading in zip(drawings, headings, strict=True)
    )


def _draw_sheet(drawing: PartDrawing, solid: Solid, heading: Heading, evaluator: Any) -> Sheet:
    return lay_out(drawing, project_part(solid, drawing.views, evaluator), heading)


def render_sheets(design: Design, sheets: Mapping[str, Sheet]) -> dict[str, bytes]:
    """Render sheets in the order of the parts: file name -> content."""
    ordered = {drawing.part: sheets[drawing.part] for drawing in part_drawings(design)}
    files = {svg_name(part): render_svg(sheet) for part, sheet in ordered.items()}
    return files | {PDF: render_pdf(tuple(ordered.values()), f"fingertip {design.name}")}


def draw_files(design: Design) -> dict[str, bytes]:
    """Draw a design: file name -> content. Raises MissingLibraryError or GeometryError."""
    require_packages("drawing")
    return render_sheets(design, run_apart(sheet_jobs(design)))
