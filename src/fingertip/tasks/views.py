"""Drawings and page of a design, written beside its other files."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from fingertip.catalogues.output_files import PAGE, PART_FILES
from fingertip.design import Design
from fingertip.foundation import extras
from fingertip.foundation.errors import FingertipError, Issue, OutputError
from fingertip.page.page import Prepared, render_page
from fingertip.page.sources import read_sources
from fingertip.pictures.drawing.draw import draw_files, file_names


def write_page(
    design: Design,
    out: str | Path | None = None,
    *,
    force: bool = False,
    prepared: Prepared | None = None,
) -> tuple[Path, int, tuple[str, ...]]:
    """Write the page of a design beside its files; returns its size [byte]. Raises OutputError."""
    folder = PART_FILES.folder(design, out)
    writer = PART_FILES.writer(design, folder, force)
    writer.check((PAGE,))

    try:
        sources = read_sources(design, folder)
        data = render_page(sources, prepared)
    except (FingertipError, OSError, MemoryError):
        raise
    except Exception as error:  # what the manifest lists may be any file all the same
        message = (
            f"holds files that cannot be shown ({type(error).__name__}: {error}); "
            "`fingertip make` makes others."
        )
        fault = " If it made these, this is a fault of fingertip: please report it."
        raise OutputError(Issue(str(folder), message + fault)) from error

    writer.add({PAGE: data})
    return folder / PAGE, len(data), tuple(sources.remarks.values())


def write_drawing(
    design: Design,
    out: str | Path | None = None,
    *,
    force: bool = False,
    progress: Callable[[str], None] = lambda message: None,
) -> tuple[Path, ...]:
    """Write a drawing of each printed part as SVG, and all as one PDF, whose path is last.

    Raises MissingLibraryError or GeometryError or OutputError.
    """
    extras.require(
        "drawing", "cadquery", "reportlab", alternative="draw a picture with fingertip picture"
    )
    folder = PART_FILES.folder(design, out)
    writer = PART_FILES.writer(design, folder, force)
    writer.check_addition(file_names(design))
    progress(f"{design.name}: projecting the parts and placing their sizes")
    files = draw_files(design)
    writer.add(files)

    return tuple(folder / name for name in files)
