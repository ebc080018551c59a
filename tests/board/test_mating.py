"""What plugs into the connectors: a number or a reason for each, and wires that fit both plug and finger."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest

from fingertip import Design
from fingertip.board import board_circuit, board_values
from fingertip.board.kicad.project import BOARD_CONFIGURATIONS
from fingertip.board.parts.table import (
    PlugWire,
    count_wires,
    find_plug_wire,
    list_connectors,
    list_mating_parts,
)
from fingertip.casting.hardware import describe_plug_wires, size_wires
from fingertip.catalogues.output_files import README
from fingertip.tasks.board import board_files
from tests.designs import load_article

SH = PlugWire("JST SH", 28, 32, 0.4, 0.8, "")


@pytest.mark.full
@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_every_connector_has_its_plug_with_a_number_or_a_reason(name: str) -> None:
    design = load_article(BOARD_CONFIGURATIONS[name].changes)
    circuit = board_circuit(board_values(design))
    readme = board_files(design)[README].decode()
    connectors = list(list_connectors(circuit))
    assert [connector.reference for connector in connectors] == ["J1", "J2", "J3"]
    for connector in connectors:
        parts = list_mating_parts(connector)
        pins = [pin for pin in connector.symbol.pins if pin.number != "MP"]
        assert count_wires(connector) == len(pins)
        assert parts
        for mating in parts:
            assert bool(mating.part) != bool(mating.reason)
            line = f"| {connector.reference} | {mating.count(len(pins))} | {mating.item} |"
            assert line in readme
            if mating.part:
                assert f"{line} JST {mating.part.number} | {mating.part.lcsc} |" in readme
        # A maker's housing has its number of positions, and one contact for each wire.
        if connector.footprint.startswith("Connector_JST"):
            housing, contact, lead = parts
            assert housing.part
            assert int(re.findall(r"-(?:0)?(\d+)", housing.part.number)[0]) == len(pins)
            assert (housing.count(len(pins)), contact.count(len(pins))) == (1, len(pins))
            assert lead.count(len(pins)) == len(pins) // 2


@pytest.mark.parametrize(
    ("max_diameter_mm", "thickest_awg", "expected"),
    [
        (1.2, 23, "all of them fit the finger"),
        (0.5, 31, "of them, AWG 31 to 32 with at most 0.5 mm fit the finger"),
        (0.8, 32, "of them, AWG 32 with at most 0.8 mm fit the finger"),
        (0.39, 30, "none of them fits the finger"),
        (0.8, 33, "none of them fits the finger"),
    ],
)
def test_wires_that_fit_plug_and_finger(max_diameter_mm: float, thickest_awg: int, expected: str) -> None:
    assert SH.describe_common(max_diameter_mm, thickest_awg).startswith(expected)


@pytest.mark.full
def test_wires_of_the_bundled_designs_fit_their_boards_plug() -> None:
    for name in ("fsr400", "fsr402", "adult_finger", "child_thumb"):
        design = Design.load(name)
        plug = find_plug_wire(board_circuit(board_values(design)).component("J1"))
        assert plug == replace(SH, source="jst_sh")
        said = describe_plug_wires(design, size_wires(design))
        assert "fit the finger" in said
        assert "none" not in said
    article = Design.load("article")
    assert describe_plug_wires(article, size_wires(article)) == ""
