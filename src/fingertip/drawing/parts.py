"""Sheets of a design: one for each printed part."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from fingertip.cad.shapes.parts import parts_by_name
from fingertip.design import Design
from fingertip.drawing.insert_sizes import bone_drawing, core_drawing, lid_drawing
from fingertip.drawing.mold_sizes import dorsal_drawing, palmar_drawing
from fingertip.drawing.sizes import Length, PartDrawing

_DRAWINGS: dict[str, Callable[[Design], PartDrawing]] = {
    "bone": bone_drawing,
    "lid": lid_drawing,
    "mold_palmar": palmar_drawing,
    "mold_dorsal": dorsal_drawing,
    "core": core_drawing,
}


def part_drawings(design: Design) -> tuple[PartDrawing, ...]:
    """List the printed parts of a design with what their sheets show."""
    printed = (name for name, part in parts_by_name(design).items() if part.is_printed)
    return tuple(_as_printed(design, _DRAWINGS[name](design)) for name in printed)


def _as_printed(design: Design, drawing: PartDrawing) -> PartDrawing:
    """Add to each size what the printer adds. The scale of the files is there to give the design's size."""
    sizes = tuple(replace(size, added_mm=size.growth * design.printer.offset_mm) for size in drawing.sizes)
    return replace(drawing, sizes=sizes, notes=_notes(design, drawing))


def _notes(design: Design, drawing: PartDrawing) -> tuple[str, ...]:
    notes = [f"Curved surfaces and all other sizes: see {drawing.part}.step."]
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
