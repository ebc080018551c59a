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
