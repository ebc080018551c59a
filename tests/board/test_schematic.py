"""Schematic and netlist against KiCad: its rules check, its netlist of
the drawing, its libraries, its PCB editor.
"""

from __future__ import annotations

import fnmatch
import functools
import json
from pathlib import Path

import pytest

from fingertip.board.analysis.board_values import board_values
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.components.values import VARIANT_CHANGES
from fingertip.board.kicad.project import load_project
from fingertip.board.parts.symbols import DUAL_AMPLIFIERS
from fingertip.catalogues.output_files import NETLIST, SCHEMATIC
from tests.board.conftest import BOARDS, BoardFolder
from tests.board.kicad import HOW_TO_INSTALL_KICAD, kicad_cli, read_netlist
from tests.board.test_layout import NO_VIOLATIONS, run_drc
from tests.designs import load_article
from tests.oracles.sexpressions import Expression, children, descendants, parse
from tests.tools import require_tool


def run_erc(folder: Path) -> list[str]:
    run = kicad_cli(
        folder, "sch", "erc", SCHEMATIC, "--severity-all", "--format", "json", "-o", "erc.json"
    )
    assert run.returncode == 0, run.stderr
    report = json.loads((folder / "erc.json").read_text("utf-8"))
    return [violation["type"] for sheet in report["sheets"] for violation in sheet["violations"]]


def export_netlist(folder: Path) -> tuple[object, object]:
    run = kicad_cli(folder, "sch", "export", "netlist", SCHEMATIC, "-o", "kicad.net")
    assert run.returncode == 0, run.stderr
    return read_netlist(folder / "kicad.net")


@pytest.mark.full
@pytest.mark.parametrize(
    "changes",
    [
        *BOARDS.values(),
        ("board.variant=precision", "board.channels=5"),
        ("board.variant=precision", "board.channels=3"),
    ],
    ids=str,
)
def test_kicad_finds_no_fault_and_the_same_circuit(
    board_folder: BoardFolder, changes: tuple[str, ...]
) -> None:
    folder = board_folder(*changes)
    assert run_erc(folder) == []
    assert run_drc(folder) == NO_VIOLATIONS
    assert export_netlist(folder) == read_netlist(folder / NETLIST)


@pytest.mark.parametrize("name", VARIANT_CHANGES)
def test_pin_positions_equal_those_of_kicads_library(name: str) -> None:
    """Symbols can then be updated from the library without disconnecting wires."""
    (drawn,) = children(parse(load_project(name).schematics[SCHEMATIC]), "lib_symbols")
    symbols = {own[1]: own for own in children(drawn, "symbol")}
    assert [
        n
        for n, own in symbols.items()
        if pin_places(own) != pin_places(list_symbols(*n.split(":"))[-1])
    ] == []


def pin_places(symbol: Expression) -> dict[str, tuple[float, ...]]:
    """Position and angle of each pin of a library symbol."""
    return {
        next(children(pin, "number"))[1]: tuple(
            float(word) for word in next(children(pin, "at"))[1:]
        )
        for pin in descendants(symbol, "pin")
    }


# Distinct components of all boards. The same reference may be another component on another supply.
COMPONENTS = {
    (component.reference, component.symbol.name, component.footprint): component
    for changes in VARIANT_CHANGES.values()
    for component in board_circuit(board_values(load_article(changes))).components
}.values()
SYMBOLS = sorted(
    {component.symbol for component in COMPONENTS} | set(DUAL_AMPLIFIERS.values()),
    key=lambda s: (s.library, s.name),
)


class LazySymbols(dict[str, Expression]):
    """Symbols of a library by name.

    Each is parsed on first access, because the whole library takes seconds.
    """

    def __init__(self, library: Path) -> None:
        chunks = library.read_text("utf-8").split('\n\t(symbol "')[1:]
        self.texts = {chunk.split('"', 1)[0]: chunk[: chunk.index("\n\t)") + 3] for chunk in chunks}

    def __missing__(self, name: str) -> Expression:
        self[name] = parse(f'(symbol "{self.texts[name]}')
        return self[name]


@functools.cache
def load_symbols(library: Path) -> LazySymbols:
    return LazySymbols(library)


def list_symbols(library: str, name: str) -> list[Expression]:
    """Symbol of KiCad's library and those that it extends, the one with pins last."""
    symbols = load_symbols(
        require_tool("/usr/share/kicad/symbols", HOW_TO_INSTALL_KICAD) / f"{library}.kicad_sym"
    )
    assert name in symbols.texts, f"{library} has no {name}"
    chain = [symbols[name]]
    while extended := next(children(chain[-1], "extends"), None):
        chain.append(symbols[extended[1]])
    return chain


def library_symbol(library: str, name: str) -> tuple[dict[str, str], dict[str, tuple[str, str]]]:
    """Properties and pins (number -> name, type) of a symbol,
    including those of the symbol that it extends.
    """
    chain = list_symbols(library, name)
    properties = {p[1]: p[2] for symbol in reversed(chain) for p in children(symbol, "property")}
    pins = {}
    for pin in descendants(chain[-1], "pin"):
        number = next(children(pin, "number"))[1]
        label = next(children(pin, "name"))[1]
        pins[number] = (label, pin[1])
    return properties, pins


def test_library_has_the_symbols_with_these_pins() -> None:
    wrong = []
    for symbol in SYMBOLS:
        pins = {pin.number: (pin.name, pin.electrical_type) for pin in symbol.pins}
        if pins != library_symbol(symbol.library, symbol.name)[1]:
            wrong.append((symbol.library, symbol.name))
    assert wrong == []


def test_footprints_match_the_filters_of_their_symbols() -> None:
    wrong = []
    for component in COMPONENTS:
        properties, _ = library_symbol(component.symbol.library, component.symbol.name)
        filters = properties["ki_fp_filters"].split()
        candidates = (component.footprint, component.footprint.split(":")[1])
        if not any(
            fnmatch.fnmatchcase(name, pattern) for name in candidates for pattern in filters
        ):
            wrong.append((component.reference, component.footprint))
    assert wrong == []
