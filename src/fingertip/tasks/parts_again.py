"""Parts of a folder, made again from their design and compared byte by byte."""

from __future__ import annotations

import json
from pathlib import Path

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes.parts import parts_by_name
from fingertip.cad.verification.verify import verify
from fingertip.catalogues.output_files import PART_FORMATS, PRINT_FOLDER, REPORT
from fingertip.design import Design
from fingertip.foundation.input_files import PARSED_LIMIT, read_input
from fingertip.foundation.output_set import read_manifest
from fingertip.tasks.verification import compare_with_design

_FORMATS = ("stl", "3mf")


def compare_made_again(design: Design, folder: Path) -> list[str]:
    """Make the STL and 3MF files of a folder again, and describe which of them differ; none if all are equal.

    Raises InputFileError if the folder has no report, and GeometryError.
    """
    report = json.loads(read_input(folder / REPORT, PARSED_LIMIT, below=folder))
    manifest = read_manifest(folder)
    known = manifest.files if manifest else {}

    formats = [name for name in _FORMATS if any(file.endswith(PART_FORMATS[name].suffix) for file in known)]
    names = [name for name in parts_by_name(design) if name in report["parts"]]
    made = verify(design, names, formats, MeshEvaluator(report["tolerance_mm"]))

    prints = read_manifest(folder / PRINT_FOLDER)
    parts = {name: data for name, data in made.contents.items() if name in known}
    lying = {name: data for name, data in made.prints.contents.items() if prints and name in prints.files}
    return [*compare_with_design(folder, parts), *compare_with_design(folder / PRINT_FOLDER, lying)]
