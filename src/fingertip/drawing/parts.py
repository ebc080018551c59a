"""Sheets of a design: one for each printed part."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from fingertip.cad.shapes.parts import parts_by_name
from fingertip.design import Design
from fingertip.drawing.insert_sizes import bone_drawing, core_drawing, lid_drawing
from fingertip.drawing.mold_sizes import dorsal_drawing, palmar_drawing
from fingertip.drawing.sizes import PartDrawing

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
    return tuple(replace(drawing, notes=_notes(design, drawing)) for drawing in (_DRAWINGS[n](design) for n in printed))


def _notes(design: Design, drawing: PartDrawing) -> tuple[str, ...]:
    notes = [f"Curved surfaces and all other sizes: see {drawing.part}.step."]
    if drawing.part.startswith("mold") and design.mold.engraving_depth_mm:
        notes.append("Engraved text is not shown.")
    return tuple(notes)
