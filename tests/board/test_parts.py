"""Parts table, bill of materials, and files for the assembly house
by makers' codes and the house's columns.
"""

from __future__ import annotations

import csv
import io
import math
import re

import pytest

from fingertip.board.analysis.board_values import board_values
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.components.selection import SOLD, capacitances_in_range, nearest_capacitance
from fingertip.board.components.values import VARIANT_CHANGES
from fingertip.board.fabrication.bom import (
    COLUMNS,
    PRICE,
    assembly_bom_file,
    bill_of_materials,
    estimate_cost,
    is_assembled,
    list_extended,
    list_unconfirmed,
    missing_numbers_note,
    placement_file,
    purchased_components,
)
from fingertip.board.kicad.project import load_project
from fingertip.board.parts.circuit import (
    CapacitorRequirement,
    Component,
    ResistorRequirement,
    parse_component_value,
)
from fingertip.board.parts.select_part import (
    OrderingCode,
    find_package,
    list_capacitances,
    resistance_code,
    select_part,
)
from fingertip.board.parts.table import (
    PRICES,
    ChipCapacitor,
    ChipResistor,
    NamedPart,
    Part,
    load_sources,
    load_table,
    read_rows,
)
from fingertip.design import Design
from tests.designs import load_article

CHANGES = (
    ("board.capacitor_series=E12",),
    ("board.capacitor_series=preferred",),
    ("board.capacitor_tolerance_percent=5",),
    ("board.resistor_tolerance_percent=0.1",),
    ("board.resistor_tolerance_percent=0",),
    ("board.series=E96", "board.cutoff_hz=71"),
)
LINKS = re.compile(r"https?://\S+")


def listed_parts() -> list[Part]:
    """Every part of the table."""
    chips = (
        *load_table(ChipResistor, "resistors.csv"),
        *load_table(ChipCapacitor, "capacitors.csv"),
    )
    return [item.part for item in chips] + [
        item.part for item in load_table(NamedPart, "named_parts.csv") if item.part
    ]


def test_every_number_has_a_source_and_every_source_is_used() -> None:
    sources = load_sources()
    codes = {code.source for code in load_table(OrderingCode, "ordering_codes.csv")}
    rotations = {row["source"] for row in read_rows("rotations.csv")}
    wires = {row["source"] for row in read_rows("plug_wires.csv")}
    plugs = {key for row in read_rows("mating_parts.csv") for key in row["sources"].split()}
    assert {
        key for part in listed_parts() for key in part.sources
    } | codes | rotations | wires | plugs == set(sources)
    for source in sources.values():
        assert len(source.title) > 10
        assert re.fullmatch(r"(read )?20\d\d-\d\d-\d\d", source.date)
        assert source.address == "" or LINKS.fullmatch(source.address)
    assert len(list(read_rows("sources.csv"))) == len(sources)


def test_numbers_are_unique_and_have_their_form() -> None:
    parts = list(dict.fromkeys(listed_parts()))  # one connector serves a sensor and a host
    assert len({(part.manufacturer, part.number) for part in parts}) == len(parts)
    numbers = [part.lcsc for part in parts if part.lcsc]
    assert len(set(numbers)) == len(numbers)
    assert all(re.fullmatch(r"C[1-9]\d{3,8}", number) for number in numbers)
    for part in parts:
        assert part.number == part.number.strip() != ""
        assert part.price in PRICES
        assert len(set(part.sources)) == len(part.sources) > 0
    for item in load_table(NamedPart, "named_parts.csv"):
        assert bool(item.part) != bool(item.reason) or not item.part.lcsc, (
            f"{item.value}: a part, or why there is none"
        )


def decode_resistor(number: str) -> tuple[float, float]:
    """Resistance [ohm] and tolerance [%] in a maker's number."""
    match = re.fullmatch(r"0603WAF(\d{3})([J0-6])T5E", number)
    if match:
        return int(match[1]) * (0.1 if match[2] == "J" else 10.0 ** int(match[2])), 1.0
    match = re.fullmatch(r"(RT0603B|RC0603[FD])R[D-]07(\d+)([RKM])(\d*)L", number)
    assert match, number
    scale = {"R": 1.0, "K": 1e3, "M": 1e6}[match[3]]
    return float(f"{match[2]}.{match[4] or 0}") * scale, {"B": 0.1, "F": 1.0, "D": 0.5}[
        match[1][-1]
    ]


def test_numbers_of_resistors_state_their_value_and_tolerance() -> None:
    for resistor in load_table(ChipResistor, "resistors.csv"):
        ohm, percent = decode_resistor(resistor.part.number)
        assert (ohm, percent) == (
            pytest.approx(resistor.ohm, rel=1e-12),
            resistor.tolerance_percent,
        )


def decode_capacitor(number: str) -> tuple[float, str, float]:
    """Capacitance [F], dielectric class and tolerance [%] in a
    maker's number, by the EIA codes all of them use.
    """
    patterns = {
        "Samsung": r"CL\d\d(?P<kind>[ABC])(?P<code>\d{3})(?P<tol>[JKM])\w+",
        "Fenghua": r"\d{4}(?P<kind>B|CG)(?P<code>\d{3})(?P<tol>[JKM])\d{3}NT",
        "Yageo": r"CC\d{4}(?P<tol>[JKM])R(?P<kind>X7R|NPO)\dBB?N?(?P<code>\d{3})",
        "Murata": r"GRM\w{3}(?P<kind>5C|R6|R7|Z7)1[ACEH](?P<code>\d{3})(?P<tol>[JKM])\w+",
    }
    match = next(m for pattern in patterns.values() if (m := re.fullmatch(pattern, number)))
    kinds = {
        "A": "X5R",
        "B": "X7R",
        "C": "C0G",
        "CG": "C0G",
        "X7R": "X7R",
        "NPO": "C0G",
        "5C": "C0G",
        "R6": "X5R",
        "R7": "X7R",
        "Z7": "X7R",
    }
    code = match["code"]
    farad = int(code[:2]) * 10.0 ** int(code[2]) * 1e-12
    return farad, kinds[match["kind"]], {"J": 5.0, "K": 10.0, "M": 20.0}[match["tol"]]


def test_numbers_of_capacitors_state_their_value() -> None:
    wrong = []
    for capacitor in load_table(ChipCapacitor, "capacitors.csv"):
        stated = (
            pytest.approx(capacitor.farad, rel=1e-9),
            capacitor.dielectric,
            capacitor.tolerance_percent,
        )
        if decode_capacitor(capacitor.part.number) != stated:
            wrong.append((capacitor.part.number, stated))
    assert wrong == []


def test_ordering_code_has_the_data_sheets_examples() -> None:
    codes = {
        56: "56R",
        120: "120R",
        976: "976R",
        1e3: "1K",
        1.2e3: "1K2",
        9.76e3: "9K76",
        97.6: "97R6",
        4.7: "4R7",
        100e3: "100K",
        1e6: "1M",
        9.76e6: "9M76",
    }
    assert {ohm: resistance_code(ohm) for ohm in codes} == codes


def test_ordering_code_gives_the_numbers_that_were_found() -> None:
    """Numbers of the series in the table were copied, so the composed ones must equal them."""
    codes = {code.prefix: code for code in load_table(OrderingCode, "ordering_codes.csv")}
    copied = [
        r for r in load_table(ChipResistor, "resistors.csv") if r.part.manufacturer == "Yageo"
    ]
    assert len(copied) >= 8
    for resistor in copied:
        assert codes["RT0603BRD07"].is_made(resistor.ohm)
        assert codes["RT0603BRD07"].compose(resistor.ohm).part.number == resistor.part.number
    # The data sheet's ordering example.
    assert codes["RC0603FR-07"].compose(56).part.number == "RC0603FR-0756RL"


def meets(component: Component, part: Part) -> bool:
    """Return whether a part has the value, package and
    requirement of a component, by its own number.
    """
    value = parse_component_value(component.value)
    requirement = component.requirement
    if isinstance(requirement, ResistorRequirement):
        ohm, percent = decode_resistor(part.number)
        return math.isclose(ohm, value, rel_tol=1e-9) and percent <= requirement.tolerance_percent
    assert isinstance(requirement, CapacitorRequirement)
    farad, dielectric, percent = decode_capacitor(part.number)
    listed = next(c for c in load_table(ChipCapacitor, "capacitors.csv") if c.part == part)
    return (
        math.isclose(farad, value, rel_tol=1e-9)
        and dielectric in requirement.dielectrics
        and percent <= requirement.tolerance_percent
        and listed.voltage_v >= requirement.voltage_v
        and listed.package == find_package(component.footprint)
    )


@pytest.mark.full
def test_boards_for_a_controller_have_order_numbers_and_alternates() -> None:
    """Every line has a number of its maker, and an alternate or the
    reason; few numbers wait to be confirmed.
    """
    for change, amplifiers, unconfirmed in (
        ("board.variant=precision", "U1 U2", 2),
        ("board.variant=comparator", "U1 U2 U3", 1),
        ("board.channels=5", "U101 to U502", 1),
    ):
        design = Design.load(changes=[change])
        circuit = board_circuit(board_values(design), design.board.channels)
        assert len(list_unconfirmed(circuit)) == unconfirmed
        assert f"({unconfirmed} of " in missing_numbers_note(circuit)
        rows = list(csv.DictReader(io.StringIO(bill_of_materials(circuit).decode())))
        assert all(row["MPN"] for row in rows)
        assert [
            row["MPN"]
            for row in rows
            if not row["Alternate"] and "another maker's" not in row["Note"]
        ] == []
        amplified = next(row for row in rows if row["References"].startswith("U1"))
        name = amplified["Alternate"].split("; or ")[-1]
        other = Design.load(
            changes=[change, re.fullmatch(r"(\w+) with --set (board\.amplifier=\1)", name)[2]]
        )
        assert not [each for each in board_values(other).gate if not each.passed]
        if design.board.channels > 1:
            continue
        low, high = estimate_cost(circuit)
        assert 1.2 < low < 5 < high < 40
        extended = list_extended(circuit)
        assert amplifiers in extended


@pytest.mark.parametrize(
    ("name", "extra"),
    [*((name, ()) for name in VARIANT_CHANGES), *(("precision", c) for c in CHANGES)],
)
def test_every_line_has_a_number_or_an_empty_field_and_the_reason(
    name: str, extra: tuple[str, ...]
) -> None:
    circuit = board_circuit(board_values(load_article((*VARIANT_CHANGES[name], *extra))))
    rows = list(csv.DictReader(io.StringIO(bill_of_materials(circuit).decode())))
    assert tuple(rows[0]) == COLUMNS
    references = [reference for row in rows for reference in row["References"].split()]
    assert sorted(references) == sorted(c.reference for c in purchased_components(circuit))
    for row in rows:
        assert row["Quantity"] == str(len(row["References"].split()))
        # Two documents, or a note.
        documents = re.findall(
            r"\((?:read )?20\d\d-\d\d-\d\d\)", row["Source"].split("; alternate: ")[0]
        )
        assert bool(row["Note"]) != (row["LCSC"] != "" and len(documents) > 1), row
        assert row["Note"].startswith("confirm before ordering: ") == bool(
            row["Note"] and row["MPN"]
        )
        assert bool(row[PRICE]) == bool(row["MPN"])
        assert row["MPN"] in row["Note"] or not row["Note"]
        assert bool(row["MPN"]) == bool(row["Source"])
        assert not row["Alternate"] or row["MPN"] or "--set" in row["Alternate"]
        for reference in row["References"].split():
            component = circuit.component(reference)
            fields = select_part(component).fields
            assert fields == {field: row[field] for field in ("Manufacturer", "MPN", "LCSC")}
            for part in (select_part(component).part, select_part(component).alternate):
                assert part is None or component.requirement is None or meets(component, part)


def test_capacitors_have_the_tolerance_that_is_sold() -> None:
    large = "board.capacitor_uf=1"
    circuit = board_circuit(board_values(load_article(["board.variant=precision", large])))
    percent = {
        c.reference: c.requirement.tolerance_percent for c in circuit.components if c.requirement
    }
    assert [percent[name] for name in ("C1", "C9", "C14", "C20", "C25", "R1")] == [
        10,
        10,
        10,
        5,
        10,
        1,
    ]
    stated = board_circuit(
        board_values(
            load_article(["board.variant=precision", large, "board.capacitor_tolerance_percent=5"])
        )
    )
    assert stated.component("C1").rating == "X7R 16 V, 5 % or better"
    selection = select_part(stated.component("C1"))
    assert selection.part is None
    assert selection.reason == (
        "the parts table has 1u X7R 16 V in 1206 with 10 %, not 5 %; "
        "board.capacitor_tolerance_percent=0 accepts the "
        "tolerance that is sold"
    )
    remedied = load_article(
        ["board.variant=precision", large, selection.reason.split("; ")[1].split()[0]]
    )
    assert select_part(board_circuit(board_values(remedied)).component("C1")).part


def test_value_that_is_not_in_the_table_still_makes_a_board() -> None:
    circuit = board_circuit(board_values(load_article(["board.capacitor_uf=0.82"])))
    selection = select_part(circuit.component("C1"))
    assert (selection.part, selection.fields["MPN"]) == (None, "")
    assert selection.reason == (
        "the parts table has no 820n X7R 16 V in 1206; board.capacitor_series=preferred selects "
        "values that it has"
    )
    assert circuit.component("C1").rating == "X7R 16 V, 10 % or better"


@pytest.mark.parametrize("cutoff", [15, 20, 67, 90, 120, 300, 1000])
def test_preferred_capacitors_are_sold_without_exception(cutoff: float) -> None:
    changes = [
        f"board.cutoff_hz={cutoff}",
        "board.capacitor_series=preferred",
        "detector.sample_rate_hz=4000",
        "board.band_limit_hz=4000",
    ]
    for name in ("article", "comparator"):
        design = load_article([*VARIANT_CHANGES[name], *changes])
        for component in board_circuit(board_values(design)).components:
            if isinstance(component.requirement, CapacitorRequirement):
                assert select_part(component).part, f"{component.reference} {component.value}"


def test_choice_of_sold_capacitors_is_the_nearest() -> None:
    small = list_capacitances("0603")
    for target in (1e-12, 1.4e-9, 6e-9, 150e-9, 9e-6):
        found = nearest_capacitance(target, SOLD)
        assert all(
            abs(math.log(found / target)) <= abs(math.log(f / target)) + 1e-12 for f in small
        )
    assert capacitances_in_range(1e-7, 3e-6, SOLD, "1206") == (100e-9, 1e-6, 2.2e-6)
    assert capacitances_in_range(1.2e-6, 1.3e-6, SOLD, "1206") == (1e-6,)
    assert capacitances_in_range(1e-7, 3e-7, "E6", "1206") == (100e-9, 150e-9, 220e-9)


TABLE = {"MSOP-": 270, "SOIC-": 270, "SOT-23": 180}
"""Rotations of the packages used here, read from the source a second time."""


def parse_bom(data: bytes) -> list[dict[str, str]]:
    """Parse a bill of materials by the house's column rules; AssertionError if it breaks one."""
    assert max(map(len, data.decode().splitlines())) <= 2048, (
        "the longest row that the house accepts"
    )
    rows = list(csv.DictReader(io.StringIO(data.decode()), strict=True))
    for row in rows:
        # The house ignores the last three; people read them. A line without comment or footprint
        # cannot be matched.
        assert list(row) == [
            "Comment",
            "Designator",
            "Footprint",
            "JLCPCB Part #",
            "MPN",
            "Manufacturer",
            "Note",
        ]
        assert row["Comment"] and row["Footprint"]  # noqa: PT018
        assert all(re.fullmatch(r"[A-Z]+[1-9]\d*", name) for name in row["Designator"].split(","))
        assert re.fullmatch(r"(C[1-9]\d*)?", row["JLCPCB Part #"])
    return rows


def parse_placement(data: bytes) -> dict[str, tuple[float, float, float]]:
    """Position [mm] and rotation [deg] of each part of a placement
    file; AssertionError if it breaks a column rule.
    """
    placed: dict[str, tuple[float, float, float]] = {}
    for row in csv.DictReader(io.StringIO(data.decode()), strict=True):
        assert list(row) == ["Designator", "Mid X", "Mid Y", "Layer", "Rotation"]
        assert row["Designator"] not in placed
        assert row["Layer"] == "Top"
        assert all(re.fullmatch(r"-?\d+\.\d+mm", row[name]) for name in ("Mid X", "Mid Y"))
        placed[row["Designator"]] = (
            float(row["Mid X"][:-2]),
            float(row["Mid Y"][:-2]),
            float(row["Rotation"]),
        )
    return placed


@pytest.mark.every_case
@pytest.mark.parametrize("name", VARIANT_CHANGES)
def test_independent_parser_reads_the_parts_of_the_circuit_in_both_files(name: str) -> None:
    circuit = board_circuit(board_values(load_article(VARIANT_CHANGES[name])))
    placement = load_project(name).placement
    house, kicad = (
        parse_placement(placement_file(circuit, placement, for_house=own)) for own in (True, False)
    )
    listed = dict[str, tuple[str, ...]]()
    for row in parse_bom(assembly_bom_file(circuit)):
        comments = set()
        for reference in row["Designator"].split(","):
            component, fields = (
                circuit.component(reference),
                select_part(circuit.component(reference)).fields,
            )
            assert reference not in listed, "a designator stands in one line only"
            listed[reference] = (
                row["JLCPCB Part #"],
                row["MPN"],
                row["Manufacturer"],
                row["Footprint"],
            )
            assert listed[reference] == (
                fields["LCSC"],
                fields["MPN"],
                fields["Manufacturer"],
                component.footprint.split(":")[1],
            )
            comments.add(component.value + f", {component.rating}" * (reference[0] in "RCJ"))
        assert comments == {row["Comment"]}, "components of different ratings are never merged"
    assert set(listed) == set(house) == set(kicad)
    assert set(house) == {c.reference for c in purchased_components(circuit) if is_assembled(c)}
    for reference, (x_mm, y_mm, rotation_deg) in house.items():
        assert 0 < x_mm < placement.width
        assert 0 < y_mm < placement.height
        package = listed[reference][-1]
        expected = sum(angle for prefix, angle in TABLE.items() if package.startswith(prefix))
        assert (rotation_deg - kicad[reference][2]) % 360 == expected, reference
        assert 0 <= rotation_deg < 360
        moved = [a - b for a, b in zip((x_mm, y_mm), kicad[reference], strict=False)]
        part = placement.parts[reference]
        assert (moved == [0, 0]) == (part.pad_centre == pytest.approx((part.x, part.y)))
