"""Resistances without power: of the whole board ahead of its first current, and across single resistors in place.

Voltages often leave several faults that explain them alike. A resistance across one of the parts names most of them.
The resistors around a part lower it, and count; capacitors and semiconductors do not conduct at a meter's voltage.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence

import numpy as np

from fingertip.board.bringup.prediction import Board, Limits
from fingertip.board.components.front_end import GAIN_RESISTOR
from fingertip.board.parts.circuit import Circuit, parse_component_value
from fingertip.board.parts.nets import GND, SENSOR, TACTILE, VCC, VEE

SUPPLY_OHM, SENSOR_OHM, NEGATIVE_OHM = "supply_ohm", "sensor_ohm", "negative_supply_ohm"
SHORT_RATIO = 0.05
"""Share of the resistors' resistance below which a short is likely; the circuits in parallel lower it somewhat."""
_SENSOR_RATIO = 0.1
"""Tolerance of the resistance at the sensor's connector: the amplifier's input draws little without power."""
TOP_OHM = 1e7
"""Largest resistance that a simple meter reads; beyond it, it shows none."""
METER_RATIO, METER_CONSTANT_OHM = 0.02, 1.0
"""Error of a simple meter: ratio of the reading, and a constant with the resistance of its probes."""
_APART = 1.25
"""Ratio of two resistances from which a meter and the parts' tolerances do not hide the difference."""
_MOST = 3


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


def limit_board_resistances(board: Board) -> dict[str, Limits]:
    """Resistances without power. Below the lower limit there is a short; a meter may read infinity."""
    found, limits = {SUPPLY_OHM: (VCC, GND)}, dict[str, Limits]()
    if board.signal_ground == GND:
        found[NEGATIVE_OHM] = GND, VEE
    for name, (first, second) in found.items():
        ohm = resistance_between(board.circuit, first, second)
        limits[name] = Limits(ohm, SHORT_RATIO * min(ohm, 10e3), math.inf)
    # A bridge ends in the signal ground, a transimpedance stage in the tactile voltage.
    ohm = min(resistance_between(board.circuit, SENSOR, net) for net in (board.signal_ground, TACTILE))
    limits[SENSOR_OHM] = Limits(ohm, (1.0 - _SENSOR_RATIO) * ohm, (1.0 + _SENSOR_RATIO) * ohm)
    return limits


# Resistances in place that tell likely faults apart.


def name_resistance(reference: str) -> str:
    return f"{reference.lower()}_ohm"


def list_measurable(circuit: Circuit) -> tuple[str, ...]:
    """List the resistors whose resistance in place depends on resistors alone."""
    return tuple(c.reference for c in circuit.components if c.symbol.name == "R" and c.reference != GAIN_RESISTOR)


def predict_resistance(circuit: Circuit, reference: str) -> float:
    """Resistance across a part in its place, as a meter shows it [ohm]."""
    ends = (circuit.net_by_pin[reference, pin] for pin in "12")
    return min(resistance_between(circuit, *ends), TOP_OHM)


def limit_resistances(circuit: Circuit) -> dict[str, Limits]:
    """Limits of the resistance across each resistor, in place and without power, by the reading's name [ohm]."""
    found = {}
    for name in list_measurable(circuit):
        requirement, ohm = circuit.component(name).requirement, predict_resistance(circuit, name)
        error = ohm * (METER_RATIO + (requirement.tolerance_percent / 100.0 if requirement else 0.0))
        found[name_resistance(name)] = Limits(ohm, ohm - error - METER_CONSTANT_OHM, ohm + error + METER_CONSTANT_OHM)
    return found


def choose_follow_up(
    good: Circuit, circuits: Sequence[Circuit], measured: Collection[str], suspects: Collection[str]
) -> tuple[str, ...]:
    """Choose the resistors of a board whose resistances in place tell these faulty circuits apart, the best one first.

    Each splits the largest group of circuits that look alike so far. Suspects are measured too, before anybody
    unsolders them. Readings that are `measured` are not asked again.
    """
    groups, chosen = [list(range(len(circuits)))], list[str]()
    names = [n for n in list_measurable(good) if name_resistance(n) not in measured] if circuits else []
    ohms = {name: [predict_resistance(circuit, name) for circuit in circuits] for name in names}
    while names and len(chosen) < _MOST:
        name = min(names, key=lambda n: max(map(len, _split(groups, ohms[n]))))
        split = _split(groups, ohms[name])
        if max(map(len, split)) == max(map(len, groups)):
            break
        groups = split
        chosen.append(name)
    chosen += [name for name in names if name in suspects and name not in chosen]
    return tuple(chosen[:_MOST])


def _split(groups: Sequence[Sequence[int]], ohms: Sequence[float]) -> list[list[int]]:
    """Split each group where the resistances of its members lie apart."""
    found: list[list[int]] = []
    for group in groups:
        last = None
        for i in sorted(group, key=ohms.__getitem__):
            if last is None or ohms[i] > _APART * last + METER_CONSTANT_OHM:
                found.append([])
            found[-1].append(i)
            last = ohms[i]
    return found
