"""The layout: KiCad's design rules check, parity with the schematic, size, decoupling and pads."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path

import pytest

from fingertip.board import board_circuit, board_values
from fingertip.board.kicad.placement import PlacedPart
from fingertip.board.kicad.project import BOARD_CONFIGURATIONS
from fingertip.board.kicad.sexpr import turn
from fingertip.board.parts.circuit import Circuit
from fingertip.board.parts.symbols import M2_HOLE
from fingertip.catalogues.output_files import LAYOUT
from fingertip.tasks.board import write_board
from tests.board.conftest import BOARDS, BoardFolder
from tests.board.kicad import HOW_TO_INSTALL_KICAD, kicad_cli
from tests.designs import ARTICLE, load_article
from tests.oracles.sexpressions import children, parse
from tests.tools import require_tool


def load_circuit(name: str) -> Circuit:
    return board_circuit(board_values(load_article(BOARD_CONFIGURATIONS[name].changes)))


PARTS: dict[str, PlacedPart] = {
    part.footprint: part for board in BOARD_CONFIGURATIONS.values() for part in board.placement.parts.values()
}
"""A part with each footprint."""


def run_drc(folder: Path) -> dict[str, list[str]]:
    """Violations, unconnected items and differences from the schematic that KiCad's design rules check finds."""
    run = kicad_cli(
        folder, "pcb", "drc", LAYOUT, "--schematic-parity", "--severity-all", "--exit-code-violations",
        "--all-track-errors", "--format", "json", "-o", "drc.json",
    )  # fmt: skip
    report = json.loads((folder / "drc.json").read_text("utf-8"))
    found = {key: [v["type"] for v in report[key]] for key in ("violations", "unconnected_items", "schematic_parity")}
    assert (run.returncode == 0) == (not any(found.values()))
    return found


NO_VIOLATIONS: dict[str, list[str]] = {"violations": [], "unconnected_items": [], "schematic_parity": []}


@pytest.mark.full
@pytest.mark.parametrize("changes", BOARDS.values(), ids=BOARDS)
def test_board_passes_design_rules_check_and_matches_the_schematic(
    board_folder: BoardFolder, changes: tuple[str, ...]
) -> None:
    assert run_drc(board_folder(*changes)) == NO_VIOLATIONS


CORRUPTIONS = {
    "reference": ('(property "Reference" "R4"', '(property "Reference" "R44"', "schematic_parity"),
    "pin": (r'\(pad "2" smd(.*?)\(pintype "passive"\)', r'(pad "7" smd\1(pintype "passive")', "schematic_parity"),
    "value": ('(property "Value" "4.7k"', '(property "Value" "47k"', "schematic_parity"),
    "footprint": ('(footprint "Diode_SMD:D_SOD-123"', '(footprint "Diode_SMD:D_SOD-323"', "schematic_parity"),
    "width": (r"\(width 0.2\)", "(width 0.6)", "violations"),
    "layer": (r'\(layer "B.Cu"\)', '(layer "F.Cu")', "violations"),
    "text height": (r"\(size 1 1\)", "(size 0.9 0.9)", "violations"),
    "text line": (r"\(thickness 0.15\)", "(thickness 0.14)", "violations"),
    "mark": (r"\(clearance 0.6\)", "(clearance 9)", "violations"),
    "no tracks": (r'\n  \(segment.*?\(uuid "[^"]*"\)\)', "", "unconnected_items"),
}


@pytest.mark.full
@pytest.mark.parametrize(("original", "corrupted", "key"), CORRUPTIONS.values(), ids=CORRUPTIONS)
def test_design_rules_check_detects_a_corrupted_board(tmp_path: Path, original: str, corrupted: str, key: str) -> None:
    write_board(ARTICLE, tmp_path / "pcb")
    path = tmp_path / "pcb" / LAYOUT
    pattern = original if "\\" in original else re.escape(original)
    maximum = 1 if original.startswith(r"\(pad") else 0
    text, count = re.subn(pattern, corrupted, path.read_text("utf-8"), count=maximum, flags=re.DOTALL)
    assert count
    path.write_text(text, encoding="utf-8")
    assert run_drc(tmp_path / "pcb")[key]


@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_board_has_its_size_and_holes(name: str) -> None:
    placement = BOARD_CONFIGURATIONS[name].placement
    assert (placement.width, placement.height, placement.thickness_mm) == (40.0, 25.0, 1.6)
    assert sum(part.footprint == M2_HOLE for part in placement.parts.values()) == 2


DECOUPLING_MM = 7.0
"""Greatest way from a decoupling capacitor to the supply pin of its amplifier, or to where the supply enters."""


@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_decoupling_capacitors_are_at_the_supply_pins_and_at_the_entry(name: str) -> None:
    circuit, parts = load_circuit(name), BOARD_CONFIGURATIONS[name].placement.parts
    found = [(c, match[1]) for c in circuit.components if (match := re.search(r"at (U\d+|its entry)$", c.role))]
    assert len(found) >= 3
    for component, place in found:
        own = [pad for pad in parts[component.reference].pads if pad.net != "GND"]
        owners = ("J2", "Q1") if place == "its entry" else (place,)
        pins = [pad for name in owners if name in parts for pad in parts[name].pads if pad.net == own[0].net]
        assert min(math.dist(a.centre, b.centre) for a in own for b in pins) < DECOUPLING_MM, component.reference


@pytest.mark.parametrize("footprint", sorted(PARTS))
def test_pads_equal_those_of_kicads_library(footprint: str) -> None:
    folder = require_tool("/usr/share/kicad/footprints", HOW_TO_INSTALL_KICAD)
    library, name = footprint.split(":")
    module = parse((folder / f"{library}.pretty" / f"{name}.kicad_mod").read_text("utf-8"))
    kicad_pads = set()
    for pad in children(module, "pad"):
        x, y = (float(word) for word in next(children(pad, "at"))[1:3])
        w, h = (float(word) for word in next(children(pad, "size"))[1:3])
        drill = next((float(d[1]) for d in children(pad, "drill")), 0.0)
        ratio = next((float(r[1]) for r in children(pad, "roundrect_rratio")), 0.0)
        kicad_pads.add((pad[1], pad[3], round(x, 4) + 0.0, round(y, 4) + 0.0, w, h, drill, round(ratio, 4)))
    part, own_pads = PARTS[footprint], set()
    for own in part.pads:
        x, y = turn(own.centre[0] - part.x, own.centre[1] - part.y, -part.angle)
        size = (own.width, own.height, own.drill, round(own.rounding, 4))
        own_pads.add((own.name, own.shape, round(x, 4) + 0.0, round(y, 4) + 0.0, *size))
    assert own_pads == kicad_pads
