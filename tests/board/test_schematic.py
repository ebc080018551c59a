"""The schematic, judged by KiCad: no errors, and KiCad's own netlist of the drawing is ours."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from fingertip.board import board_values, write_board
from fingertip.board.output import NETLIST, SCHEMATIC
from fingertip.board.schematic.file import pin_point
from fingertip.board.schematic.symbol_shapes import SHAPES
from fingertip.board.variants import VARIANTS, Variant
from fingertip.design import Design
from tests.board.conftest import BOARDS, Written
from tests.board.expressions import children, everywhere
from tests.board.kicad import HOW, kicad_cli, nets_and_parts
from tests.board.test_kicad_libraries import PARTS, all_symbols
from tests.tools import require_tool


def violations(folder: Path) -> list[str]:
    run = kicad_cli(folder, "sch", "erc", SCHEMATIC, "--severity-all", "--format", "json", "-o", "erc.json")
    assert run.returncode == 0, run.stderr
    report = json.loads((folder / "erc.json").read_text("utf-8"))
    return [violation["type"] for sheet in report["sheets"] for violation in sheet["violations"]]


def exported(folder: Path) -> tuple[object, object]:
    run = kicad_cli(folder, "sch", "export", "netlist", SCHEMATIC, "-o", "kicad.net")
    assert run.returncode == 0, run.stderr
    return nets_and_parts(folder / "kicad.net")


@pytest.mark.parametrize("changes", BOARDS.values(), ids=BOARDS)
def test_kicads_netlist_of_the_drawing_is_ours(written: Written, changes: tuple[str, ...]) -> None:
    assert exported(written(*changes)) == nets_and_parts(written(*changes) / NETLIST)


@pytest.mark.parametrize("changes", BOARDS.values(), ids=BOARDS)
def test_electrical_rules_are_kept(written: Written, changes: tuple[str, ...]) -> None:
    assert violations(written(*changes)) == []


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ('(label "STAGE2_IN"', '(label "STAGE2_MID"'),
        ("(xy 45.72 53.34) (xy 45.72 58.42)", "(xy 45.72 53.34) (xy 45.72 57.15)"),
        ('(property "Value" "4.7k"', '(property "Value" "47k"'),
    ],
    ids=["label", "wire", "value"],
)
def test_a_spoiled_drawing_is_noticed(tmp_path: Path, right: str, wrong: str) -> None:
    """The check above can fail."""
    write_board(Design(), tmp_path / "pcb")
    path = tmp_path / "pcb" / SCHEMATIC
    assert right in path.read_text("utf-8")
    path.write_text(path.read_text("utf-8").replace(right, wrong), encoding="utf-8")
    assert exported(tmp_path / "pcb") != nets_and_parts(tmp_path / "pcb" / NETLIST)


@pytest.mark.parametrize("variant", VARIANTS.values(), ids=VARIANTS)
def test_every_unit_is_placed_once_on_the_grid(variant: Variant) -> None:
    circuit = variant.kind.circuit(board_values(Design.load(changes=variant.changes)))
    placed = [(p.reference, p.unit) for p in variant.sheet.placed]
    wanted = {(part.reference, unit) for part in circuit.parts for unit in range(1, len(SHAPES[part.symbol.name]) + 1)}
    assert len(placed) == len(set(placed))
    assert set(placed) == wanted
    for p in variant.sheet.placed:
        for pin in SHAPES[circuit.part(p.reference).symbol.name][p.unit - 1].pins.values():
            x, y = pin_point(p, pin)
            assert (x, y) == (int(x), int(y))


@pytest.mark.parametrize("name", sorted(SHAPES))
def test_pins_lie_where_kicads_library_has_them(name: str) -> None:
    """So that somebody can update the symbols from the library without tearing wires off."""
    folder = require_tool("/usr/share/kicad/symbols", HOW)
    libraries = {part.symbol.name: part.symbol.library for part in PARTS}
    symbols = all_symbols(folder / f"{libraries.get(name, 'power')}.kicad_sym")
    symbol = symbols[name]
    while extended := next(children(symbol, "extends"), None):
        symbol = symbols[extended[1]]
    theirs = {
        next(children(pin, "number"))[1]: tuple(float(word) for word in next(children(pin, "at"))[1:])
        for pin in everywhere(symbol, "pin")
    }
    ours = {key: (p.x, p.y, float(p.angle)) for shape in SHAPES[name] for key, p in shape.pins.items()}
    assert ours == theirs
