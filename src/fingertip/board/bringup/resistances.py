"""Resistances of a board without power, ahead of its first current.

The resistors around a part lower it, and count; capacitors and semiconductors do not conduct at a meter's voltage.
"""

from __future__ import annotations

import math

import numpy as np

from fingertip.board.components.front_end import GAIN_RESISTOR
from fingertip.board.parts.circuit import Circuit, parse_component_value


def resistance_between(circuit: Circuit, first: str, second: str) -> float:
    """Resistance between two nets through the resistors alone [ohm]; infinite if they do not join them."""
    edges = []
    for part in circuit.components:
        far_pin = {"R": "2", "R_Potentiometer": "3"}.get(part.symbol.name)
        if far_pin and part.reference != GAIN_RESISTOR:
            ends = circuit.net_by_pin[part.reference, "1"], circuit.net_by_pin[part.reference, far_pin]
            edges.append((*ends, 1.0 / parse_component_value(part.value)))
    reached, grew = {first}, True
    while grew:
        added = {net for a, b, _ in edges for net in (a, b) if a in reached or b in reached} - reached
        reached, grew = reached | added, bool(added)
    if second not in reached:
        return math.inf
    nets = sorted(reached - {second})
    G = np.zeros((len(nets), len(nets)))
    row = {net: i for i, net in enumerate(nets)}
    for a, b, siemens in edges:
        for one, other in ((a, b), (b, a)):
            if one in row:
                G[row[one], row[one]] += siemens
                if other in row:
                    G[row[one], row[other]] -= siemens
    return float(np.linalg.inv(G)[row[first], row[first]])
