"""The board's files: what each holds, and writing them whole."""

from __future__ import annotations

import json
from pathlib import Path

from fingertip.board.bom import bill_of_materials
from fingertip.board.circuit import Circuit
from fingertip.board.layout import kicad_board
from fingertip.board.netlist import kicad_netlist
from fingertip.board.paper_circuit import paper_circuit
from fingertip.board.paper_placement import PAPER_PLACEMENT
from fingertip.board.paper_sheet import PAPER_SHEET
from fingertip.board.project import kicad_project
from fingertip.board.schematic import kicad_schematic
from fingertip.board.spice import spice_deck
from fingertip.board.tracks import load_template
from fingertip.board.values import BoardValues, board_values
from fingertip.design import Design
from fingertip.files import write_whole

NETLIST = "slip_filter.net"
VALUES = "values.json"
DECK = "slip_filter.cir"
PARTS = "bom.csv"
SCHEMATIC = "slip_filter.kicad_sch"
LAYOUT = "slip_filter.kicad_pcb"
PROJECT = "slip_filter.kicad_pro"


def board_circuit(values: BoardValues) -> Circuit:
    """The circuit with the preferred values. Raises BoardError if it is inconsistent."""
    return paper_circuit(values.preferred, values.bridge)


def board_files(design: Design) -> dict[str, bytes]:
    """File name -> content: netlist for KiCad, SPICE deck, bill of materials, and the values of all.

    The same design gives the same bytes. Raises BoardError if the values cannot be computed.
    """
    values = board_values(design)
    record = {"parameters": design.board.model_dump(), **values.as_data()}
    text = json.dumps(record, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
    circuit = board_circuit(values)
    return {
        NETLIST: kicad_netlist(circuit),
        SCHEMATIC: kicad_schematic(circuit, PAPER_SHEET),
        LAYOUT: kicad_board(circuit, PAPER_PLACEMENT, load_template("paper", circuit, PAPER_PLACEMENT)),
        PROJECT: kicad_project(circuit),
        DECK: spice_deck(circuit, design.board.gain_bandwidth_hz, design.board.supply_v),
        PARTS: bill_of_materials(circuit),
        VALUES: text.encode(),
    }


def write_board(design: Design, out: str | Path = "pcb") -> tuple[Path, ...]:
    """Write the board's files into the folder `out`, all or none; returns their paths.

    Raises
    ------
    BoardError
        If the values cannot be computed.
    OutputError
        If `out` cannot be written; what was there is unchanged then.
    """
    files = board_files(design)
    folder = Path(out)
    write_whole(folder, files)
    return tuple(folder / name for name in files)
