"""Circuits are consistent, and inconsistent circuits are refused."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fingertip.board import board_circuit, board_values
from fingertip.board.fabrication.bom import bill_of_materials
from fingertip.board.kicad.project import BOARD_CONFIGURATIONS
from fingertip.board.parts import symbols
from fingertip.board.parts.circuit import (
    Circuit,
    Component,
    Net,
    build_circuit,
    find_issues,
    format_component_value,
    parse_component_value,
)
from fingertip.foundation.errors import BoardError
from tests.designs import ARTICLE, load_article
from tests.oracles.netlist_nodal import number

CIRCUIT = board_circuit(board_values(ARTICLE))


@pytest.mark.full
def test_amplifiers_are_ordered_with_a_grade_whose_offset_is_known() -> None:
    """The TL082 without a grade may have 15 mV, nearly the threshold."""
    for name, order_name, offset in (
        ("article_split", "TL082BC", "3 mV"),
        ("precision_split", "TLV2372", "4.5 mV"),
        ("comparator_split", "OPA2197ID", "0.1 mV"),
    ):
        circuit = board_circuit(board_values(load_article(BOARD_CONFIGURATIONS[name].changes)))
        duals = [c for c in circuit.components if c.footprint == symbols.SOIC_8]
        assert len(duals) == (1 if name.startswith("article") else 2)
        assert all(c.value == order_name and f"offset {offset} at most" in c.rating for c in duals)
        assert f"{order_name},SOIC-8" in bill_of_materials(circuit).decode()


@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_every_pin_is_in_one_net_and_every_net_has_two_pins(name: str) -> None:
    """The test does not use the package's own check."""
    circuit = board_circuit(board_values(load_article(BOARD_CONFIGURATIONS[name].changes)))
    assert not list(find_issues(circuit))
    nodes = [node for net in circuit.nets for node in net.nodes]
    assert len(nodes) == len(set(nodes))
    assert set(nodes) == {(c.reference, pin.number) for c in circuit.components for pin in c.symbol.pins}
    assert all(len(net.nodes) >= 2 for net in circuit.nets)
    assert len({c.reference for c in circuit.components}) == len(circuit.components)
    assert all(c.reference[-1].isdigit() for c in circuit.components)


def _resistor(reference: str) -> Component:
    return Component(reference, "1k", symbols.RESISTOR, symbols.R_0603, "")


def _without_node(circuit: Circuit) -> Circuit:
    first, *others = circuit.nets
    return replace(circuit, nets=(replace(first, nodes=first.nodes[1:]), *others))


@pytest.mark.parametrize(
    ("corrupt", "expected"),
    [
        (lambda c: replace(c, components=(*c.components, c.component("R1"))), "R1: names 2 components"),
        (lambda c: replace(c, nets=(*c.nets, Net("EXTRA", (("R1", "1"), ("R2", "1"))))), "R1.1: is connected 2 times"),
        (lambda c: replace(c, nets=(*c.nets, Net("LONE", (("R99", "1"),)))), "LONE: connects 1 pin"),
        (lambda c: replace(c, nets=(*c.nets, Net("GHOST", (("R99", "1"), ("U1", "9"))))), "U1.9: is connected, but"),
        (lambda c: replace(c, components=(*c.components, _resistor("R99"))), "R99.2: is not connected"),
        (lambda c: replace(c, components=(*c.components, _resistor("R_LP"))), "R_LP: is not letters followed by a"),
        (lambda c: replace(c, nets=(*c.nets, Net("GND", (("R99", "1"), ("R99", "2"))))), "GND: names 2 nets"),
        (_without_node, "is not connected"),
    ],
)
def test_find_issues_reports_every_inconsistency(corrupt: Callable[[Circuit], Circuit], expected: str) -> None:
    assert any(expected in str(issue) for issue in find_issues(corrupt(CIRCUIT)))


def test_build_circuit_refuses_inconsistent_wiring() -> None:
    with pytest.raises(BoardError, match="A: connects 1 pin"):
        build_circuit("bad", {_resistor("R1"): {"1": "A", "2": "B"}, _resistor("R2"): {"1": "B", "2": "B"}})


@pytest.mark.parametrize(
    ("value", "text"),
    [(4700, "4.7k"), (1180, "1.18k"), (10e6, "10M"), (47, "47"), (1e-6, "1u"), (2.2e-6, "2.2u"), (1e-7, "100n"),
     (1e-12, "1p"), (1e-3, "1m"), (0.99999999999999e-6, "1u")],
)  # fmt: skip
def test_format_component_value_uses_si_prefixes(value: float, text: str) -> None:
    assert format_component_value(value) == text


@given(st.floats(1e-12, 1e8))
def test_formatted_component_values_can_be_parsed(value: float) -> None:
    assert number(format_component_value(value)) == pytest.approx(value, rel=1e-9)
    assert parse_component_value(format_component_value(value)) == pytest.approx(value, rel=1e-9)
