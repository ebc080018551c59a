"""KiCad projects of the boards as files that KiCad opens: `python -m tools.boards unpack article FOLDER`.

`unpack` writes layout, schematic, project and 3D models to a folder. Edit them in KiCad, then store them again with
`python -m tools.boards pack article FOLDER`, which refuses a project of another circuit than the program has: the
parts of the layout, their footprints and nets, and the parts of the schematic. It does not run KiCad's checks; the
tests do. `python -m tools.boards pack models FOLDER` stores the models, which all boards share.
"""

from __future__ import annotations

import argparse
import io
import sys
import zipfile
from collections.abc import Mapping
from pathlib import Path

from fingertip.board import board_circuit, board_values
from fingertip.board.circuits.channels import PLACES
from fingertip.board.components.values import VARIANT_CHANGES
from fingertip.board.kicad.project import (
    MODEL_FOLDER,
    PROJECT_FILES,
    PROJECTS,
    SEVERAL,
    make_project,
    model_files,
    read_archive,
)
from fingertip.catalogues.output_files import CHANNEL_SHEET
from fingertip.design import Design
from fingertip.foundation.errors import BoardError

_DATE = (1980, 1, 1, 0, 0, 0)
"""Date of all files in an archive: the earliest that the format allows."""


def main() -> None:
    """Unpack a project, or store one."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("action", choices=("unpack", "pack"))
    parser.add_argument("name", choices=(*VARIANT_CHANGES, SEVERAL, "models"))
    parser.add_argument("folder", type=Path)
    arguments = parser.parse_args()
    if arguments.action == "unpack":
        unpack(arguments.name, arguments.folder)
    elif found := pack(arguments.name, arguments.folder):
        sys.exit(f"{arguments.name}: {found}")


def unpack(name: str, folder: Path) -> None:
    """Write a project with its models to a folder."""
    files = {} if name == "models" else read_archive(name)
    for path, data in (files | {f"{MODEL_FOLDER}/{path}": data for path, data in model_files().items()}).items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_bytes(data)


def pack(name: str, folder: Path) -> str:
    """Store the project of a folder. Return why it is refused; empty if it is stored."""
    if name == "models":
        models = folder / MODEL_FOLDER
        files = {path.relative_to(models).as_posix(): path.read_bytes() for path in sorted(models.rglob("*.step"))}
    else:
        names = (*PROJECT_FILES, CHANNEL_SHEET) if name == SEVERAL else PROJECT_FILES
        files = {file: (folder / file).read_bytes() for file in names}
        changes = [f"board.channels={PLACES}"] if name == SEVERAL else VARIANT_CHANGES[name]
        design = Design.load(changes=changes)
        circuit = board_circuit(board_values(design), design.board.channels)
        try:
            make_project(name, files).enter(circuit)
        except BoardError as error:
            return str(error)
    (PROJECTS / f"{name}.zip").write_bytes(make_archive(files))
    return ""


def make_archive(files: Mapping[str, bytes]) -> bytes:
    """Content of an archive. The same files give the same bytes: there is no date."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for path, data in files.items():
            archive.writestr(zipfile.ZipInfo(path, _DATE), data, zipfile.ZIP_DEFLATED, 9)
    return buffer.getvalue()


if __name__ == "__main__":
    main()
