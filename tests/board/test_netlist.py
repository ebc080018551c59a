"""Circuits are consistent, and values are written with SI prefixes."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fingertip.board.analysis.board_values import board_values
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.components.values import VARIANT_CHANGES
from fingertip.board.parts.circuit import format_component_value, parse_component_value
from tests.designs import load_article


@pytest.mark.every_case
@pytest.mark.parametrize("name", VARIANT_CHANGES)
def test_every_pin_is_in_one_net_and_every_net_has_two_pins(name: str) -> None:
    circuit = board_circuit(board_values(load_article(VARIANT_CHANGES[name])))
    nodes = [node for net in circuit.nets for node in net.nodes]
    assert len(nodes) == len(set(nodes))
    assert set(nodes) == {
        (c.reference, pin.number) for c in circuit.components for pin in c.symbol.pins
    }
    assert all(len(net.nodes) >= 2 for net in circuit.nets)
    assert len({c.reference for c in circuit.components}) == len(circuit.components)
    assert all(c.reference[-1].isdigit() for c in circuit.components)


@pytest.mark.every_case
@pytest.mark.parametrize(
    ("value", "text"),
    [
        (4700, "4.7k"),
        (1180, "1.18k"),
        (10e6, "10M"),
        (47, "47"),
        (1e-6, "1u"),
        (2.2e-6, "2.2u"),
        (1e-7, "100n"),
        (1e-12, "1p"),
        (1e-3, "1m"),
        (0.99999999999999e-6, "1u"),
    ],
)
def test_format_component_value_uses_si_prefixes(value: float, text: str) -> None:
    assert format_component_value(value) == text


@given(st.floats(1e-12, 1e8))
def test_formatted_component_values_can_be_parsed(value: float) -> None:
    assert parse_component_value(format_component_value(value)) == pytest.approx(value, rel=1e-9)
