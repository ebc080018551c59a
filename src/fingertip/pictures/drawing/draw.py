"""Drawing of a design: a sheet for each printed part, as SVG files and one PDF.

Parts are projected in a separate process: the B-rep kernel can hang or crash. Those of
`cad.files.step_process` project the parts that they have made anyway.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
from functools import partial
from typing import Any, TypeVar

from fingertip.cad.kernel.kernel_process import import_without_viewer, start_kernel
from fingertip.cad.parts import exact_parts
from fingertip.design import Design
from fingertip.design.geometry.sizes import Length, PartDrawing, ViewName
from fingertip.foundation.errors import FingertipError, GeometryError, Issue
from fingertip.foundation.files import temporary_folder
from fingertip.models.parts import PARTS, parts_by_name
from fingertip.models.solids import Solid
from fingertip.pictures.drawing import part_sizes
from fingertip.pictures.drawing.layout import lay_out
from fingertip.pictures.drawing.primitives import ProjectedView, Sheet
from fingertip.pictures.drawing.svg_and_pdf import render_pdf, render_svg
from fingertip.pictures.drawing.title_block import Heading

_DRAWINGS: dict[str, Callable[[Design], PartDrawing]] = {
    "bone": part_sizes.bone_drawing,
    "mold_palmar": part_sizes.palmar_drawing,
    "mold_dorsal": part_sizes.dorsal_drawing,
    "core": part_sizes.core_drawing,
    "holder": part_sizes.holder_drawing,
    "plug": part_sizes.plug_drawing,
    "stand": part_sizes.stand_drawing,
    "pin": part_sizes.pin_drawing,
    "hand_stub": part_sizes.hand_stub_drawing,
}


def part_drawings(design: Design) -> tuple[PartDrawing, ...]:
    """List the drawings of the printed parts, with the sizes that a print has."""
    printed = exact_parts(
        design, (name for name, part in parts_by_name(design).items() if part.is_printed)
    )
    drawings = []
    for drawing in (_DRAWINGS[name](design) for name in printed):
        # Only the printer's offset is added: the scale of the files is there to give the design's
        # size.
        sizes = tuple(
            replace(size, added_mm=size.growth * design.printer.offset_mm) for size in drawing.sizes
        )
        drawings.append(replace(drawing, sizes=sizes, notes=_notes(design, drawing)))

    return tuple(drawings)


def _notes(design: Design, drawing: PartDrawing) -> tuple[str, ...]:
    notes = [f"Curved surfaces and all other sizes: see {drawing.part}.step.", *drawing.notes]
    if drawing.part.startswith("mold") and design.mold.engraving_depth_mm:
        notes.append("Engraved text is not shown.")

    offset = design.printer.offset_mm
    scale = design.printer.scale_percent
    if offset:
        fault = "thick" if offset > 0.0 else "thin"
        notes.append(
            f"All sizes are those of the print, {abs(offset):g} mm too {fault} (printer.offset_mm):"
        )
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


T = TypeVar("T")
Job = tuple[tuple[str, Callable[[Any], T]], ...]
"""Functions of the B-rep evaluator by the names of their results."""


def project_part(
    solid: Solid, views: Collection[ViewName], evaluator: Any
) -> dict[ViewName, ProjectedView]:
    """Project a part in its views. Raises GeometryError."""
    from fingertip.pictures.drawing.hidden_lines import project  # noqa: PLC0415

    return project(evaluator.solid(solid), views)


def run_job(job: Job[T]) -> dict[str, T]:
    """Compute everything with one evaluator. Raises MissingLibraryError or GeometryError."""
    import_without_viewer()
    from fingertip.cad.kernel import brep  # raises MissingLibraryError if OCP cannot be loaded  # noqa: PLC0415

    evaluator = brep.BrepEvaluator()
    return {name: compute(evaluator) for name, compute in job}


TIME_LIMIT_S = 180.0


def run_apart(job: Job[T]) -> dict[str, T]:
    """Run a job in a process of its own. Raises MissingLibraryError or GeometryError."""
    # Open CASCADE reads settings of the current folder.
    with temporary_folder() as folder, start_kernel(folder) as worker:
        worker.send(run_job, job)
        try:
            return worker.receive_within(TIME_LIMIT_S)  # type: ignore[no-any-return]
        except FingertipError:
            raise
        except TimeoutError:
            problem = f"was still projecting after {TIME_LIMIT_S:g} s"
        except Exception as error:
            problem = f"crashed ({error})"

    raise GeometryError(
        Issue("drawing", f"the B-rep kernel {problem}; check the design with build.")
    )


def sheet_jobs(design: Design) -> Job[Sheet]:
    """List what draws the sheet of each printed part."""
    drawings = part_drawings(design)
    # The engraved letters would hide the rest under some hundred edges. A note names them.
    plain = design.with_values({"mold.engraving_depth_mm": 0.0})
    headings = (
        Heading(design.name, "", number, len(drawings)) for number in range(1, len(drawings) + 1)
    )

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
    return render_sheets(design, run_apart(sheet_jobs(design)))
