"""The board's files: what each holds, writing them whole, comparing them with a folder's."""

from __future__ import annotations

import difflib
import json
from collections.abc import Callable
from pathlib import Path

from fingertip.board.circuit import Circuit
from fingertip.board.fabrication.bom import bill_of_materials
from fingertip.board.fabrication.made_from import differing, origin
from fingertip.board.kicad.netlist import kicad_netlist
from fingertip.board.kicad.project import kicad_project
from fingertip.board.layout.file import kicad_board
from fingertip.board.layout.tracks import load_template
from fingertip.board.readme.file import HEADING, folder_readme
from fingertip.board.schematic.file import kicad_schematic
from fingertip.board.spice.deck import spice_deck
from fingertip.board.values.board_values import BoardValues, board_values
from fingertip.board.variants import variant_of
from fingertip.design import Design
from fingertip.files import write_whole

NETLIST = "slip_filter.net"
VALUES = "values.json"
DECK = "slip_filter.cir"
PARTS = "bom.csv"
SCHEMATIC = "slip_filter.kicad_sch"
LAYOUT = "slip_filter.kicad_pcb"
PROJECT = "slip_filter.kicad_pro"
README = "README.md"

FAB_FOLDER = "fab"
MADE_FROM = "made_from.sha256"
_SHOWN_LINES = 12


def board_circuit(values: BoardValues) -> Circuit:
    """The circuit with the preferred values. Raises BoardError if it is inconsistent."""
    return variant_of(values).kind.circuit(values)


def board_files(design: Design) -> dict[str, bytes]:
    """File name -> content: KiCad project, netlist, SPICE deck, bill of materials, the values of all, a README.

    The same design gives the same bytes. Raises BoardError if the values cannot be computed.
    """
    values = board_values(design)
    record = {"parameters": design.board.model_dump(), **values.as_data()}
    text = json.dumps(record, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
    circuit, variant = board_circuit(values), variant_of(values)
    template = load_template(variant.name, circuit, variant.placement)
    return {
        NETLIST: kicad_netlist(circuit),
        SCHEMATIC: kicad_schematic(
            circuit, variant.sheet, f"Slip filter: variant {values.variant}, {variant.supply.words}"
        ),
        LAYOUT: kicad_board(circuit, variant.placement, template),
        PROJECT: kicad_project(circuit),
        DECK: spice_deck(circuit, design.board.gain_bandwidth_hz, design.board.supply_v),
        PARTS: bill_of_materials(circuit),
        VALUES: text.encode(),
        README: folder_readme(circuit, variant, values, design),
    }


def write_board(design: Design, out: str | Path = "pcb") -> tuple[Path, ...]:
    """Write the board's files into the folder `out`, all or none; returns their paths.

    A README.md that is not of this kind is left alone.

    Raises
    ------
    BoardError
        If the values cannot be computed.
    OutputError
        If `out` cannot be written; what was there is unchanged then.
    """
    files = board_files(design)
    folder = Path(out)
    if _foreign(folder / README):
        del files[README]
    write_whole(folder, files)
    return tuple(folder / name for name in files)


def write_fabrication(
    design: Design, out: str | Path = "pcb", progress: Callable[[str], None] = lambda _words: None
) -> tuple[Path, ...]:
    """Write what is sent to a board house into `out`/fab, all or none; returns the paths. Needs KiCad.

    `made_from.sha256` beside them says of which board's files they are, as `sha256sum --check` reads it.

    Raises
    ------
    MissingLibraryError
        If KiCad is not installed.
    BoardError
        If KiCad's checks find something.
    OutputError
        If the folder cannot be written.
    """
    from fingertip.board.fabrication.fab import fabrication_files

    values = board_values(design)
    placement, board = variant_of(values).placement, board_files(design)
    files = fabrication_files(board, board_circuit(values), placement, progress)
    files[MADE_FROM] = origin(board, files)
    folder = Path(out) / FAB_FOLDER
    write_whole(folder, files)
    return tuple(folder / name for name in files)


def differences(design: Design, folder: str | Path) -> list[str]:
    """What a folder's files differ in from those of the design, as sentences and lines; empty if they are current."""
    found: list[str] = []
    for name, data in board_files(design).items():
        path = Path(folder) / name
        if name == README and _foreign(path):
            continue
        try:
            kept = path.read_bytes()
        except OSError as error:
            found.append(f"{path}: cannot be read ({error.strerror}).")
            continue
        if kept != data:
            found.append(f"{path}: differs from what this design gives.")
            found += _first_lines(kept, data)
    return found


def fabrication_differences(design: Design, folder: str | Path, expected: bool = False) -> list[str]:
    """Why the fabrication files beside a folder's board are not of this design, as sentences; empty if they are.

    Where there are none, that is a issue if they are `expected`.
    """
    fab = Path(folder) / FAB_FOLDER
    if not expected and not (fab / MADE_FROM).is_file() and not any(fab.glob("slip_filter_*")):
        return []
    return differing(fab, MADE_FROM, board_files(design))


def _first_lines(kept: bytes, data: bytes) -> list[str]:
    old, new = (text.decode(errors="replace").splitlines() for text in (kept, data))
    # Files of thousands of lines: from the first that differs on, that is enough.
    first = next((i for i, (a, b) in enumerate(zip(old, new, strict=False)) if a != b), min(len(old), len(new)))
    window = slice(first, first + _SHOWN_LINES)
    lines = difflib.unified_diff(old[window], new[window], "folder", "design", n=0, lineterm="")
    return [f"    line {first + 1}:", *(f"    {line}" for line in list(lines)[3 : 3 + _SHOWN_LINES])]


def _foreign(path: Path) -> bool:
    """Whether this is somebody else's README."""
    try:
        return not path.read_bytes().startswith(HEADING.encode())
    except OSError:
        return False
