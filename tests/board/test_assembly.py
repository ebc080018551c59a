"""Files for the assembly house: read by a parser of their published columns, rotations against the table."""

from __future__ import annotations

import csv
import io
import re
from dataclasses import dataclass

import pytest

from fingertip.board import board_circuit, board_values
from fingertip.board.fabrication.bom import (
    assembly_bom_file,
    bill_of_materials,
    is_assembled,
    placement_file,
    purchased_components,
)
from fingertip.board.kicad.project import BOARD_CONFIGURATIONS
from fingertip.board.parts.select_part import select_part
from tests.designs import load_article

MAX_ROW_CHARACTERS = 2048
"""Longest row of a bill of materials that the house accepts."""
TABLE = {"JST_PH_S": 180, "MSOP-": 270, "SOIC-": 270, "SOT-23": 180}
"""Rotations of the packages used here, read from the source a second time."""


@dataclass(frozen=True)
class BomRow:
    comment: str
    designators: tuple[str, ...]
    footprint: str
    number: str
    mpn: str = ""
    manufacturer: str = ""


def parse_bom(data: bytes) -> list[BomRow]:
    """Parse a bill of materials by the house's column rules; AssertionError if it breaks one."""
    lines = data.decode("utf-8").splitlines()
    assert all(0 < len(line) <= MAX_ROW_CHARACTERS for line in lines)
    header, *rows = csv.reader(lines, strict=True)
    assert header[:4] == ["Comment", "Designator", "Footprint", "JLCPCB Part #"]
    assert header[4:] in ([], ["MPN", "Manufacturer"]), "the house ignores further columns; people read them"
    parsed = []
    for row in rows:
        assert len(row) == len(header)
        comment, designators, footprint, number, *others = row
        assert "" not in (comment, footprint), "a line without comment or footprint cannot be matched"
        names = designators.split(",")
        assert all(re.fullmatch(r"[A-Z]+[1-9]\d*", name) for name in names), designators
        assert re.fullmatch(r"(C[1-9]\d*)?", number), number
        parsed.append(BomRow(comment, tuple(names), footprint, number, *others))
    every = [name for row in parsed for name in row.designators]
    assert len(set(every)) == len(every), "a designator stands in one line only"
    return parsed


@dataclass(frozen=True)
class Placed:
    x_mm: float
    y_mm: float
    layer: str
    rotation_deg: float


def parse_placement(data: bytes) -> dict[str, Placed]:
    """Parse a placement file by the house's column rules; AssertionError if it breaks one."""
    header, *rows = csv.reader(io.StringIO(data.decode("utf-8")), strict=True)
    assert header == ["Designator", "Mid X", "Mid Y", "Layer", "Rotation"]
    placed: dict[str, Placed] = {}
    for designator, x, y, layer, rotation in rows:
        assert designator not in placed
        assert layer in ("Top", "Bottom")
        assert 0 <= float(rotation) < 360
        for value in (x, y):
            assert re.fullmatch(r"-?\d+\.\d+mm", value), value
        placed[designator] = Placed(float(x[:-2]), float(y[:-2]), layer, float(rotation))
    return placed


@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_independent_parser_accepts_both_files(name: str) -> None:
    configuration = BOARD_CONFIGURATIONS[name]
    circuit = board_circuit(board_values(load_article(configuration.changes)))
    bom, placed = (
        parse_bom(assembly_bom_file(circuit)),
        parse_placement(placement_file(circuit, configuration.placement, for_house=True)),
    )
    assert {d for row in bom for d in row.designators} == set(placed), "each fitted part stands in both files"
    assert set(placed) == {c.reference for c in purchased_components(circuit) if is_assembled(c)}
    numbers = {
        reference: row["LCSC"]
        for row in csv.DictReader(io.StringIO(bill_of_materials(circuit).decode()))
        for reference in row["References"].split()
    }
    for row in bom:
        assert {numbers[d] for d in row.designators} == {row.number}
        assert {select_part(circuit.component(d)).fields["MPN"] for d in row.designators} == {row.mpn}
        assert {select_part(circuit.component(d)).fields["Manufacturer"] for d in row.designators} == {row.manufacturer}
        assert {circuit.component(d).footprint.split(":")[1] for d in row.designators} == {row.footprint}
    width, height = configuration.placement.width, configuration.placement.height
    assert all(0 < p.x_mm < width and 0 < p.y_mm < height and p.layer == "Top" for p in placed.values())


@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_rotations_differ_from_kicads_by_the_table(name: str) -> None:
    configuration = BOARD_CONFIGURATIONS[name]
    circuit = board_circuit(board_values(load_article(configuration.changes)))
    house = parse_placement(placement_file(circuit, configuration.placement, for_house=True))
    kicad = parse_placement(placement_file(circuit, configuration.placement, for_house=False))
    assert set(house) == set(kicad)
    for reference, placed in house.items():
        package = circuit.component(reference).footprint.split(":")[1]
        expected = sum(angle for prefix, angle in TABLE.items() if package.startswith(prefix))
        assert (placed.rotation_deg - kicad[reference].rotation_deg) % 360 == expected, reference
        # Only a footprint whose origin is not at its middle is moved.
        part = configuration.placement.parts[reference]
        is_centred = part.pad_centre == pytest.approx((part.x, part.y))
        assert is_centred == ((placed.x_mm, placed.y_mm) == (kicad[reference].x_mm, kicad[reference].y_mm))
