"""KiCad projects of the boards as files that KiCad opens: `python -m tools.boards unpack article
FOLDER`.

`unpack` writes layout, schematic, project and 3D models to a folder. Edit them in KiCad, then store
them again with `python -m tools.boards pack article FOLDER`, which refuses a project of another
circuit than the program has: the parts of the layout, their footprints and nets, and the parts of
the schematic. It does not run KiCad's checks; the tests do. `python -m tools.boards pack models
FOLDER` stores the models, which all boards share.
"""

from __future__ import annotations

import argparse
import io
import sys
import zipfile
from collections.abc import Iterator, Mapping
from pathlib import Path

from fingertip.board.analysis.board_values import board_values
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.circuits.channels import PLACES
from fingertip.board.components.values import VARIANT_CHANGES
from fingertip.board.kicad.netlist import CircuitRecord, Part, describe_structure_changes
from fingertip.board.kicad.project import (
    MODEL_FOLDER,
    PROJECTS,
    SEVERAL,
    StoredProject,
    library_id,
    make_project,
    model_files,
    read_archive,
)
from fingertip.board.parts.circuit import Circuit
from fingertip.board.parts.symbols import DUAL_AMPLIFIERS
from fingertip.catalogues.output_files import CHANNEL_SHEET, LAYOUT, PROJECT, SCHEMATIC
from fingertip.design import Design
from fingertip.foundation.errors import BoardError

PROJECT_FILES = (LAYOUT, SCHEMATIC, PROJECT)
"""Files in the archive of a board; that of several fingers also has the sheet of a channel."""
_DATE = (1980, 1, 1, 0, 0, 0)
"""Date of all files in an archive: the earliest that the format allows."""


def main() -> None:
    """Unpack a project, or store one."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
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
    for path, data in (
        files | {f"{MODEL_FOLDER}/{path}": data for path, data in model_files().items()}
    ).items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_bytes(data)


def pack(name: str, folder: Path) -> str:
    """Store the project of a folder. Return why it is refused; empty if it is stored."""
    if name == "models":
        models = folder / MODEL_FOLDER
        files = {
            path.relative_to(models).as_posix(): path.read_bytes()
            for path in sorted(models.rglob("*.step"))
        }
    else:
        names = (*PROJECT_FILES, CHANNEL_SHEET) if name == SEVERAL else PROJECT_FILES
        files = {file: (folder / file).read_bytes() for file in names}
        changes = [f"board.channels={PLACES}"] if name == SEVERAL else VARIANT_CHANGES[name]
        design = Design.load(changes=changes)
        circuit = board_circuit(board_values(design), design.board.channels)
        project = make_project(name, files)
        found = list(find_differences(project, circuit))
        if found:
            return f"the project is not that of its circuit ({'; '.join(found)})"

        try:
            project.enter(circuit)
        except BoardError as error:
            return str(error)

    (PROJECTS / f"{name}.zip").write_bytes(make_archive(files))
    return ""


def find_differences(project: StoredProject, circuit: Circuit) -> Iterator[str]:
    """Describe how a circuit differs from a layout in parts, footprints and nets, or from the
    schematic.

    A dual amplifier may be another one: their symbols have the same pins and lines.
    """
    wanted = {component.reference: component for component in circuit.components}
    amplifiers = set(map(library_id, DUAL_AMPLIFIERS.values()))
    stored = {}
    nets = dict[str, set[tuple[str, str]]]()

    for reference, part in project.placement.parts.items():
        symbol = project.symbols.get(reference, "")
        if reference in wanted and {symbol, library_id(wanted[reference].symbol)} <= amplifiers:
            symbol = library_id(wanted[reference].symbol)

        stored[reference] = Part("", (part.footprint, symbol), {})
        for pad in part.pads:
            if pad.net:
                nets.setdefault(pad.net, set()).add((reference, pad.name))

    parts = {name: Part("", (c.footprint, library_id(c.symbol)), {}) for name, c in wanted.items()}
    yield from describe_structure_changes(
        CircuitRecord(stored, {net: frozenset(nodes) for net, nodes in nets.items()}),
        CircuitRecord(parts, {net.name: frozenset(net.nodes) for net in circuit.nets}),
    )
    undrawn = sorted(wanted.keys() ^ project.symbols.keys())
    if undrawn:
        yield f"the schematic and the circuit do not both have {', '.join(undrawn)}"


def make_archive(files: Mapping[str, bytes]) -> bytes:
    """Content of an archive. The same files give the same bytes: there is no date."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for path, data in files.items():
            archive.writestr(zipfile.ZipInfo(path, _DATE), data, zipfile.ZIP_DEFLATED, 9)

    return buffer.getvalue()


if __name__ == "__main__":
    main()
