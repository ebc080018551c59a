"""Versions of a finger to be compared: read from a folder, or made from a design."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from fingertip.catalogues.output_files import DESIGN, DETECTION, REPORT, SIGNAL_FOLDER
from fingertip.design import Design
from fingertip.design.design_file import load_tables
from fingertip.documents.comparison import Version
from fingertip.foundation.errors import InputFileError, Issue
from fingertip.foundation.files import temporary_folder
from fingertip.tasks.make import make
from fingertip.tasks.report_file import read_json_file


def read_version(folder: Path) -> Version:
    """Read what `make` or `build` wrote to a folder. Raises InputFileError or DesignError."""
    if not (folder / REPORT).is_file():
        message = (
            f"is a folder without the {REPORT} of build or make; give a folder that has one, or "
            "for the git revision "
            f"of this name refs/heads/{folder.name}."
        )
        raise InputFileError(Issue(str(folder), message))

    loaded = load_tables([folder / DESIGN], (), below=folder)
    detection = folder / SIGNAL_FOLDER / DETECTION
    return Version(
        label=str(folder),
        design=Design.from_tables(loaded.tables),
        report=read_json_file(folder / REPORT, folder),
        detection=read_json_file(detection, folder) if detection.is_file() else {},
    )


def make_version(label: str, design: Design, progress: Callable[[str], None]) -> Version:
    """Make a design in a temporary folder, and read its reports.

    Raises FingertipError as `make` does.
    """
    with temporary_folder() as temporary:
        # One level deeper: the temporary folder itself is locked.
        folder = temporary / "made" / design.name
        make(design, folder, formats=["stl"], progress=progress)
        version = read_version(folder)

    return Version(label, design, version.report, version.detection)
