"""Readings of an ohmmeter and an ammeter: resistances without power, and the supply current."""

from __future__ import annotations

import numpy as np

from fingertip.board.bringup.faults import Fault
from fingertip.board.bringup.prediction import Board, solve_constant
from fingertip.board.circuit import Circuit, parse_component_value
from fingertip.board.components.amplifiers import AD623_SUPPLY_A, AMPLIFIERS, COMPARATOR_SUPPLY_A, GAIN_RESISTOR
from fingertip.board.nets import VCC, VREF

CURRENT_RATIOS = (0.4, 1.7)
"""Limits of the supply current as ratios of the typical one: data sheets allow amplifiers about half as much more."""
SHORT_RATIO = 0.05
"""Share of the resistors' resistance below which a short is likely; the circuits in parallel lower it somewhat."""


def resistance_between(circuit: Circuit, first: str, second: str) -> float:
    """Resistance between two nets through the resistors alone [ohm]; infinite if they do not join them."""
    edges = []
    for part in circuit.components:
        if part.symbol.name == "R" and part.reference != GAIN_RESISTOR:
            ends = circuit.net_by_pin[part.reference, "1"], circuit.net_by_pin[part.reference, "2"]
            edges.append((*ends, 1.0 / parse_component_value(part.value)))
        elif part.symbol.name == "R_Potentiometer":
            ohm = parse_component_value(part.value)
            ends = circuit.net_by_pin[part.reference, "1"], circuit.net_by_pin[part.reference, "3"]
            edges.append((*ends, 1.0 / ohm))
    reached, grew = {first}, True
    while grew:
        added = {net for a, b, _ in edges for net in (a, b) if a in reached or b in reached} - reached
        reached, grew = reached | added, bool(added)
    if second not in reached:
        return float("inf")
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


def supply_current_a(board: Board) -> float:
    """Typical current into the positive supply with an open sensor [A]."""
    circuit, total = board.circuit, 0.0
    fed = (VCC, VREF) if VREF in circuit.net_by_pin.values() else (VCC,)
    for part in circuit.components:
        symbol = part.symbol.name
        if symbol in AMPLIFIERS:
            total += AMPLIFIERS[symbol].supply_current_a * len(AMPLIFIERS[symbol].units)
        elif symbol == "AD623ARMZ":
            total += AD623_SUPPLY_A
        elif symbol == "LMV331":
            total += COMPARATOR_SUPPLY_A
    resistors = [
        (part, circuit.net_by_pin[part.reference, "1"], circuit.net_by_pin[part.reference, "2"])
        for part in circuit.components
        if part.symbol.name == "R" and part.reference != GAIN_RESISTOR
    ]
    ends = {other for _, a, b in resistors for one, other in ((a, b), (b, a)) if one in fed and other not in fed}
    wanted = sorted((ends | set(fed)) - set(board.rails_v))
    volts, _ = solve_constant(board, Fault("", "", circuit), 0.0, wanted)
    volts = {**volts, **board.rails_v}
    for part, a, b in resistors:
        for one, other in ((a, b), (b, a)):
            if one in fed and other not in fed:
                total += (volts[one] - volts[other]) / parse_component_value(part.value)
    return total
