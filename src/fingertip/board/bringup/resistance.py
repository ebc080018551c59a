"""Resistance that an ohmmeter reads between two nets of a board without power."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from fingertip.board.components.front_end import GAIN_RESISTOR
from fingertip.board.parts.circuit import Circuit, parse_component_value

_FAR_PIN = {"R": "2", "R_Potentiometer": "3"}
"""Pin at the other end from pin 1, by symbol."""


class _Resistor(NamedTuple):
    """Resistor between two nets, with its conductance."""

    first: str
    second: str
    siemens: float


def resistance_between(circuit: Circuit, first: str, second: str) -> float:
    """Return the resistance between two nets [ohm]; infinite if no resistors join them.

    The resistors around a part lower it, and count; capacitors and semiconductors do not conduct at
    a meter's voltage.
    """
    resistors = _list_resistors(circuit)
    reached = _find_reached(resistors, first)
    if second not in reached:
        return math.inf

    # Kirchhoff's current law of each net but the second, which is at 0 V.
    nets = sorted(reached - {second})
    row = {net: i for i, net in enumerate(nets)}
    G = np.zeros((len(nets), len(nets)))

    for resistor in resistors:
        _add_conductance(G, row, resistor.first, resistor.second, resistor.siemens)
        _add_conductance(G, row, resistor.second, resistor.first, resistor.siemens)

    return float(np.linalg.inv(G)[row[first], row[first]])


def _list_resistors(circuit: Circuit) -> list[_Resistor]:
    """List the resistors and trimmers, without the one that sets an amplifier's gain."""
    resistors = []
    for part in circuit.components:
        far_pin = _FAR_PIN.get(part.symbol.name)
        if far_pin and part.reference != GAIN_RESISTOR:
            resistors.append(
                _Resistor(
                    circuit.net_by_pin[part.reference, "1"],
                    circuit.net_by_pin[part.reference, far_pin],
                    1.0 / parse_component_value(part.value),
                )
            )

    return resistors


def _find_reached(resistors: list[_Resistor], start: str) -> set[str]:
    """Find the nets that resistors join to a net, itself included."""
    reached = {start}
    has_grown = True
    while has_grown:
        size = len(reached)
        for resistor in resistors:
            if resistor.first in reached or resistor.second in reached:
                reached |= {resistor.first, resistor.second}

        has_grown = len(reached) > size

    return reached


def _add_conductance(
    G: np.ndarray, row: dict[str, int], net: str, neighbour: str, siemens: float
) -> None:
    if net in row:
        G[row[net], row[net]] += siemens
        if neighbour in row:
            G[row[net], row[neighbour]] -= siemens
