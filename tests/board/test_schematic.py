"""The schematic: KiCad's electrical rules check passes, and KiCad's netlist of the drawing equals ours."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest

from fingertip.board.kicad.project import BOARD_CONFIGURATIONS
from fingertip.catalogues.output_files import BOM, NETLIST, SCHEMATIC
from tests.board.conftest import BOARDS, BoardFolder
from tests.board.kicad import HOW_TO_INSTALL_KICAD, kicad_cli, read_netlist
from tests.board.test_kicad_libraries import load_symbols
from tests.oracles.sexpressions import Expression, children, descendants, parse
from tests.tools import require_tool


def run_erc(folder: Path) -> list[str]:
    run = kicad_cli(folder, "sch", "erc", SCHEMATIC, "--severity-all", "--format", "json", "-o", "erc.json")
    assert run.returncode == 0, run.stderr
    report = json.loads((folder / "erc.json").read_text("utf-8"))
    return [violation["type"] for sheet in report["sheets"] for violation in sheet["violations"]]


def export_netlist(folder: Path) -> tuple[object, object]:
    run = kicad_cli(folder, "sch", "export", "netlist", SCHEMATIC, "-o", "kicad.net")
    assert run.returncode == 0, run.stderr
    return read_netlist(folder / "kicad.net")


@pytest.mark.full
@pytest.mark.parametrize("changes", BOARDS.values(), ids=BOARDS)
def test_kicads_netlist_of_the_drawing_equals_ours(board_folder: BoardFolder, changes: tuple[str, ...]) -> None:
    assert export_netlist(board_folder(*changes)) == read_netlist(board_folder(*changes) / NETLIST)


@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_kicads_bill_of_materials_has_our_numbers(board_folder: BoardFolder, name: str) -> None:
    folder, fields = board_folder(*BOARD_CONFIGURATIONS[name].changes), "Reference,Manufacturer,MPN,LCSC"
    run = kicad_cli(folder, "sch", "export", "bom", SCHEMATIC, "--fields", fields, "-o", "kicad_bom.csv")
    assert run.returncode == 0, run.stderr
    ours = {
        reference: (row["Manufacturer"], row["MPN"], row["LCSC"])
        for row in csv.DictReader((folder / BOM).read_text("utf-8").splitlines())
        for reference in row["References"].split()
    }
    rows = csv.reader((folder / "kicad_bom.csv").read_text("utf-8").splitlines()[1:])
    assert {reference: tuple(numbers) for reference, *numbers in rows} == ours


@pytest.mark.full
@pytest.mark.parametrize("changes", BOARDS.values(), ids=BOARDS)
def test_schematic_passes_electrical_rules_check(board_folder: BoardFolder, changes: tuple[str, ...]) -> None:
    assert run_erc(board_folder(*changes)) == []


@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_pin_positions_equal_those_of_kicads_library(name: str) -> None:
    """Symbols can then be updated from the library without disconnecting wires."""
    folder = require_tool("/usr/share/kicad/symbols", HOW_TO_INSTALL_KICAD)
    (drawn,) = children(parse(BOARD_CONFIGURATIONS[name].project.schematic), "lib_symbols")
    wrong = []
    for own in children(drawn, "symbol"):
        library, _, name = own[1].partition(":")
        symbols = load_symbols(folder / f"{library}.kicad_sym")
        symbol = symbols[name]
        while extended := next(children(symbol, "extends"), None):
            symbol = symbols[extended[1]]
        if pin_places(own) != pin_places(symbol):
            wrong.append(own[1])
    assert wrong == []


def pin_places(symbol: Expression) -> dict[str, tuple[float, ...]]:
    """Position and angle of each pin of a library symbol."""
    return {
        next(children(pin, "number"))[1]: tuple(float(word) for word in next(children(pin, "at"))[1:])
        for pin in descendants(symbol, "pin")
    }
