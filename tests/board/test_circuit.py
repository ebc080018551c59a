"""The circuit is consistent, and what is not is found."""

from __future__ import annotations

from dataclasses import replace
from typing import get_args

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fingertip.board import board_circuit, board_values
from fingertip.board.circuit import Circuit, Net, Part, connected, engineering, issues
from fingertip.board.fabrication.bom import bill_of_materials
from fingertip.board.kicad import symbols
from fingertip.board.supplies import SUPPLIES
from fingertip.board.variants import KINDS, VARIANTS
from fingertip.design import Design
from fingertip.design.sections import Board
from fingertip.errors import BoardError
from tests.board.nodal import number

CIRCUIT = board_circuit(board_values(Design()))


def test_the_articles_circuit() -> None:
    assert not list(issues(CIRCUIT))
    values = {part.reference: part.value for part in CIRCUIT.parts if part.reference[0] in "RC"}
    article = {
        "R1": "2.4k", "R2": "1.2k", "R3": "4.7k", "R4": "1.5k", "R5": "100k", "R6": "2k",
        "C1": "1u", "C2": "1u", "C3": "1u", "C4": "2.2u",
    }  # fmt: skip
    assert article.items() <= values.items()
    others = {part.reference: part.symbol.name for part in CIRCUIT.parts if part.reference[0] in "UDJ"}
    assert others == {
        "U1": "TL082", "U2": "AD623ARMZ", "D1": "1N4148W", "D2": "BAT54S", "D3": "BAT54S",
        "J1": "Conn_01x02", "J2": "Conn_01x03", "J3": "Conn_01x04",
    }  # fmt: skip


def test_variants_are_those_the_design_file_takes() -> None:
    assert tuple(KINDS) == get_args(Board.model_fields["variant"].annotation)
    assert tuple(SUPPLIES) == get_args(Board.model_fields["supply"].annotation)
    assert len(VARIANTS) == len(KINDS) * len(SUPPLIES)


def test_ratings_are_of_what_can_be_bought_and_of_the_designs_tolerance() -> None:
    changes = ["board.variant=precision", "board.capacitor_tolerance_percent=10", "board.capacitor_uf=0.1",
               "board.resistor_tolerance_percent=0.5", "board.r5_ohm=20000"]  # fmt: skip
    circuit = board_circuit(board_values(Design.load(changes=changes)))
    ratings = {reference: circuit.part(reference).rating for reference in ("C1", "C4", "C8", "C14", "R1", "R10")}
    assert ratings == {
        "C1": "C0G 25 V, 10 % or better",
        "C4": "X7R 16 V, 10 % or better",
        "C8": "X7R 16 V, 10 % or better",
        "C14": "X5R or X7R, 6.3 V, 20 %",  # 100 uF; there is no direct voltage across it
        "R1": "0.5 % or better, 0.1 W",
        "R10": "0.1 %, 25 ppm/K, 0.1 W",
    }
    assert circuit.part("C14").value == "100u"


def test_amplifiers_are_bought_by_a_grade_whose_offset_is_known() -> None:
    """The TL082 without a grade may have 15 mV, nearly the threshold."""
    for name, bought, offset in (("article_split", "TL082BC", "3 mV"), ("comparator_split", "TLV2372", "4.5 mV")):
        circuit = board_circuit(board_values(Design.load(changes=VARIANTS[name].changes)))
        duals = [part for part in circuit.parts if part.footprint == symbols.SOIC_8]
        assert len(duals) == (1 if name.startswith("article") else 2)
        assert all(part.value == bought and f"offset {offset} at most" in part.rating for part in duals)
        assert f"{bought},SOIC-8" in bill_of_materials(circuit).decode()


def test_a_single_supply_has_amplifiers_that_reach_its_rails() -> None:
    for kind in KINDS:
        names = {
            p.symbol.name
            for p in board_circuit(board_values(Design.load(changes=VARIANTS[f"{kind}_single"].changes))).parts
        }
        assert {"TLV2372", "TLV2371DBV", "Conn_01x05"} <= names
        assert not {"TL082", "Conn_01x03"} & names


@pytest.mark.parametrize("variant", VARIANTS)
def test_every_pin_in_one_net_and_two_pins_in_every_net(variant: str) -> None:
    """Said again without the package's own check."""
    CIRCUIT = board_circuit(board_values(Design.load(changes=VARIANTS[variant].changes)))
    nodes = [node for net in CIRCUIT.nets for node in net.nodes]
    assert len(nodes) == len(set(nodes))
    assert set(nodes) == {(part.reference, pin.number) for part in CIRCUIT.parts for pin in part.symbol.pins}
    assert all(len(net.nodes) >= 2 for net in CIRCUIT.nets)
    assert len({part.reference for part in CIRCUIT.parts}) == len(CIRCUIT.parts)
    assert all(part.reference[-1].isdigit() for part in CIRCUIT.parts)


def _resistor(reference: str) -> Part:
    return Part(reference, "1k", symbols.RESISTOR, symbols.R_0603, "")


def _without_node(circuit: Circuit) -> Circuit:
    first, *rest = circuit.nets
    return replace(circuit, nets=(replace(first, nodes=first.nodes[1:]), *rest))


@pytest.mark.parametrize(
    ("spoil", "expected"),
    [
        (lambda c: replace(c, parts=(*c.parts, c.part("R1"))), "R1: names 2 parts"),
        (lambda c: replace(c, nets=(*c.nets, Net("EXTRA", (("R1", "1"), ("R2", "1"))))), "R1.1: is connected 2 times"),
        (lambda c: replace(c, nets=(*c.nets, Net("LONE", (("R99", "1"),)))), "LONE: connects 1 pin"),
        (lambda c: replace(c, nets=(*c.nets, Net("GHOST", (("R99", "1"), ("U1", "9"))))), "U1.9: is connected, but"),
        (lambda c: replace(c, parts=(*c.parts, _resistor("R99"))), "R99.2: is not connected"),
        (lambda c: replace(c, parts=(*c.parts, _resistor("R_LP"))), "R_LP: is not letters and a number"),
        (lambda c: replace(c, nets=(*c.nets, Net("GND", (("R99", "1"), ("R99", "2"))))), "GND: names 2 nets"),
        (_without_node, "is not connected"),
    ],
)
def test_faults_are_found(spoil, expected: str) -> None:  # type: ignore[no-untyped-def]
    assert any(expected in str(issue) for issue in issues(spoil(CIRCUIT)))


def test_connected_refuses() -> None:
    with pytest.raises(BoardError, match="A: connects 1 pin"):
        connected("bad", {_resistor("R1"): {"1": "A", "2": "B"}, _resistor("R2"): {"1": "B", "2": "B"}})


@pytest.mark.parametrize(
    ("value", "text"),
    [(4700, "4.7k"), (1180, "1.18k"), (10e6, "10M"), (47, "47"), (1e-6, "1u"), (2.2e-6, "2.2u"), (1e-7, "100n"),
     (1e-12, "1p"), (1e-3, "1m"), (0.99999999999999e-6, "1u")],
)  # fmt: skip
def test_values_as_a_schematic_prints_them(value: float, text: str) -> None:
    assert engineering(value) == text


@given(st.floats(1e-12, 1e8))
def test_printed_values_read_back(value: float) -> None:
    assert number(engineering(value)) == pytest.approx(value, rel=1e-9)
