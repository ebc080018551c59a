"""Writing of the drawings of a design into its folder."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from fingertip.catalogues.output_files import PART_FILES
from fingertip.design import Design
from fingertip.foundation import extras
from fingertip.pictures.drawing.draw import draw_files, file_names


def write_drawing(
    design: Design,
    out: str | Path | None = None,
    *,
    force: bool = False,
    progress: Callable[[str], None] = lambda message: None,
) -> tuple[Path, ...]:
    """Write a sheet for each printed part as SVG, and all as one PDF, the last path of those that are returned.

    Raises MissingLibraryError or GeometryError or OutputError.
    """
    extras.require("drawing", "OCP", "reportlab", alternative="draw a picture with fingertip picture")
    folder = PART_FILES.folder(design, out)
    writer = PART_FILES.writer(design, folder, force)
    writer.check_addition(file_names(design))
    progress(f"{design.name}: projecting the parts and placing their sizes")
    files = draw_files(design)
    writer.add(files)
    return tuple(folder / name for name in files)
