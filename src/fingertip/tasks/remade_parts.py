"""Parts of a folder made again from their design, and compared byte by byte."""

from __future__ import annotations

from pathlib import Path

from fingertip.cad.kernel.mesh import MAX_TOLERANCE_MM, MIN_TOLERANCE_MM, MeshEvaluator
from fingertip.cad.verification.verify import verify
from fingertip.catalogues.output_files import PRINT_FOLDER, REPORT
from fingertip.design import Design
from fingertip.foundation.errors import InputFileError, Issue
from fingertip.foundation.output_set import read_manifest
from fingertip.models.parts import parts_by_name
from fingertip.tasks.manifest_comparison import compare_with_design
from fingertip.tasks.report_file import read_json_file

_FORMATS = ("stl", "3mf")


def compare_made_again(design: Design, folder: Path) -> list[str]:
    """Make the STL and 3MF files of a folder again, and describe which of them differ.

    Raises InputFileError if the folder has no report of fingertip, and GeometryError.
    """
    in_folder = _list_meshes(folder)
    on_bed = _list_meshes(folder / PRINT_FOLDER)
    if not in_folder:
        return [f"{folder}: holds no STL or 3MF file to compare; make the parts again."]

    names = [
        name
        for name in parts_by_name(design)
        if any(file.startswith(f"{name}.") for file in in_folder)
    ]
    formats = [name for name in _FORMATS if any(file.endswith(f".{name}") for file in in_folder)]
    parts = verify(design, names, formats, MeshEvaluator(_read_tolerance(folder)))
    sets = (
        (folder, in_folder, parts.contents),
        (folder / PRINT_FOLDER, on_bed, parts.prints.contents),
    )
    differences = []

    for place, files, contents in sets:
        expected = {name: data for name, data in contents.items() if name in files}
        differences += compare_with_design(place, expected)
        differences += [
            f"{place / name}: is of no part of this design; remove it, or make the parts again."
            for name in files
            if name not in contents
        ]

    return differences


def _list_meshes(folder: Path) -> list[str]:
    """List the STL and 3MF files of a set."""
    manifest = read_manifest(folder)
    return [name for name in manifest.files if name.endswith((".stl", ".3mf"))] if manifest else []


def _read_tolerance(folder: Path) -> float:
    """Read the tolerance at which the meshes of a folder were made [mm]."""
    tolerance_mm = read_json_file(folder / REPORT, folder).get("tolerance_mm")
    if not isinstance(tolerance_mm, int | float):
        tolerance_mm = 0.0
    if MIN_TOLERANCE_MM <= tolerance_mm <= MAX_TOLERANCE_MM:
        return float(tolerance_mm)

    message = (
        f"states no tolerance of {MIN_TOLERANCE_MM:g} to {MAX_TOLERANCE_MM:g} mm; make the "
        "parts again."
    )
    raise InputFileError(Issue(str(folder / REPORT), message))
