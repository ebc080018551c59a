"""Comparison of two versions of a finger: folders that exist, or designs that are made for it."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from fingertip.catalogues.output_files import DESIGN, DETECTION, REPORT, SIGNAL_FOLDER
from fingertip.design import Design
from fingertip.design.files import load_tables
from fingertip.documents.comparison import Version
from fingertip.foundation.errors import InputFileError, Issue
from fingertip.foundation.files import temporary_folder
from fingertip.foundation.input_files import PARSED_LIMIT, read_input
from fingertip.tasks.make import make


def read_version(folder: Path) -> Version:
    """Read what `make` or `build` wrote to a folder. Raises InputFileError or DesignError."""
    loaded = load_tables([folder / DESIGN], (), below=folder)
    detection = folder / SIGNAL_FOLDER / DETECTION
    return Version(
        label=str(folder),
        design=Design.from_tables(loaded.tables),
        report=_read_json(folder / REPORT, folder),
        detection=_read_json(detection, folder) if detection.is_file() else {},
    )


def make_version(label: str, design: Design, progress: Callable[[str], None]) -> Version:
    """Make a design for a moment, to read what is reported of it. Raises FingertipError as `make` does."""
    with temporary_folder() as temporary:
        folder = temporary / "made" / design.name  # one level deeper: the temporary folder itself is locked
        make(design, folder, formats=["stl"], progress=progress)
        made = read_version(folder)
    return Version(label, design, made.report, made.detection)


def _read_json(path: Path, below: Path) -> dict[str, Any]:
    try:
        data = json.loads(read_input(path, PARSED_LIMIT, below=below))
    except (ValueError, RecursionError):
        data = None
    if not isinstance(data, dict):
        raise InputFileError(Issue(str(path), "is no report of fingertip; make the design there again."))
    return data
