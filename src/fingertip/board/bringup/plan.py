"""Plan of a bring-up: every reading in the order in which it is taken, with its limits."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from fingertip.board.analysis.board_values import BoardValues
from fingertip.board.bringup.bench import HOST, TONE_V, Fault, has_tone, list_output_pins
from fingertip.board.bringup.limits import METER_AC, Limits, compute_limits
from fingertip.board.bringup.prediction import Board, list_levels, name_tone, name_voltage, solve_constant
from fingertip.board.bringup.wiring import list_pins
from fingertip.board.circuits.signal_paths import RECT_OUT
from fingertip.board.components.bridge import AD623_SUPPLY_A, AMPLIFIERS, COMPARATOR_SUPPLY_A, GAIN_RESISTOR
from fingertip.board.parts.circuit import ENVELOPE, GND, SENSOR, TACTILE, VCC, VEE, VREF, Circuit, parse_component_value
from fingertip.foundation.output_set import hash_parameters

# Readings of an ohmmeter and an ammeter: resistances without power, and the supply current.


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


SUPPLY_OHM, SENSOR_OHM, SUPPLY_MA = "supply_ohm", "sensor_ohm", "supply_ma"
QUIET, SLIP_TONE = "tp3_quiet_v", "slip_tone_v"
QUIET_ENVELOPE = name_voltage(ENVELOPE)
NEGATIVE_OHM = "negative_supply_ohm"
_SENSOR_RATIO = 0.1
"""Tolerance of the resistance at the sensor's connector: the amplifier's input draws little without power."""
_NOISE_FACTOR = 4.0
"""Largest noise that is accepted, in units of the expected one: the meter's bandwidth and hum are not known."""
_LEAST_THRESHOLD_V = 2e-3
"""Smallest threshold at which the comparator can be told from one that is stuck [V]."""


@dataclass(frozen=True)
class BringUp:
    """Readings of a board to be brought up, by name, each in the unit that its name ends in."""

    board: Board
    identity: str
    """Identifies the board by the values of its components."""
    before_power: Mapping[str, Limits]
    current: Mapping[str, Limits]
    levels: Mapping[str, Limits]
    """Voltages that are predicted for every fault, so that they serve the diagnosis."""
    others: Mapping[str, Limits]
    """Noise, and the tone at which the comparator answers."""

    @property
    def all(self) -> dict[str, Limits]:
        """All readings in the order in which they are taken."""
        levels = {name: self.levels[name] for name in _list_levels_in_order(self.board) if name in self.levels}
        return {**self.before_power, **self.current, **levels, **self.others}

    @property
    def voltages(self) -> frozenset[str]:
        """Names of the readings at the board itself that are voltages."""
        return frozenset({*self.levels, QUIET} & set(self.all))


def _list_levels_in_order(board: Board) -> list[str]:
    """List the voltages in the order of the sheet: without the tone, at the output connector, with the tone."""
    pins = {pin.net: pin for pin in list_output_pins(board.circuit)}
    at_host = [pins[net] for _, net in list_pins(board.circuit, board.circuit.component(HOST)) if net in pins]
    high = board.bench.tones_hz[-1]
    return [
        *(name_voltage(net) for net in board.nets),
        *(name_voltage(TACTILE, ohm) for ohm in board.bench.dummy_ohm),
        *(pin.constant_name for pin in at_host),
        *(name_tone(net, hz) for net, hz in (*list_levels(board.bench), (ENVELOPE, high), (RECT_OUT, high))),
        *(pin.tone_name for pin in pins.values() if has_tone(pin)),
    ]


def plan_bring_up(board: Board, values: BoardValues, tone_v: float = TONE_V) -> BringUp:
    """Plan the bring-up of a board with a tone of this RMS [V]."""
    levels = compute_limits(board, values, tone_v)
    return BringUp(
        board,
        identify_board(board),
        resistance_limits(board),
        {SUPPLY_MA: _scale(1e3 * supply_current_a(board), CURRENT_RATIOS)},
        levels,
        _others(board, values, levels, tone_v),
    )


def identify_board(board: Board) -> str:
    """Identify a board by the references and values of its components."""
    return hash_parameters({part.reference: part.value for part in board.circuit.components})[:8]


def resistance_limits(board: Board) -> dict[str, Limits]:
    """Resistances without power. Below the lower limit there is a short; a meter may read infinity."""
    found = {SUPPLY_OHM: (VCC, GND), NEGATIVE_OHM: (GND, VEE)}
    if board.signal_ground != GND:
        del found[NEGATIVE_OHM]
    limits = {}
    for name, (first, second) in found.items():
        ohm = resistance_between(board.circuit, first, second)
        limits[name] = Limits(ohm, SHORT_RATIO * min(ohm, 10e3), math.inf)
    ohm = resistance_between(board.circuit, SENSOR, board.signal_ground)
    limits[SENSOR_OHM] = _scale(ohm, (1.0 - _SENSOR_RATIO, 1.0 + _SENSOR_RATIO))
    return limits


def _others(board: Board, values: BoardValues, levels: Mapping[str, Limits], tone_v: float) -> dict[str, Limits]:
    noise_v = values.noise.filtered_v
    found = {QUIET: Limits(noise_v, 0.0, _NOISE_FACTOR * noise_v + METER_AC[1])}
    if values.comparator_levels:
        # Hum whose mean is half of the threshold at which slip ends; a rectified tone has a mean of RMS sqrt(2) / pi.
        hum_v = 0.5 * values.comparator_levels.off_v * math.pi / math.sqrt(2.0)
        found[QUIET] = Limits(noise_v, 0.0, min(found[QUIET].high_v, max(hum_v, 2.0 * noise_v)))
    if values.comparator_levels and values.threshold_spread:
        # The mean of the envelope is proportional to the tone, so the threshold is reached at this share of it.
        loud, quiet = (levels[name_tone(ENVELOPE, board.bench.tones_hz[-1])], levels[name_voltage(ENVELOPE)])
        per_volt = (loud.expected_v - quiet.expected_v) / tone_v
        spread, ratio = values.threshold_spread, METER_AC[0]
        low, high = (max(v, _LEAST_THRESHOLD_V) / per_volt for v in (spread.min_v, spread.max_v))
        expected = values.comparator_levels.on_v / per_volt
        found[SLIP_TONE] = Limits(expected, low * (1.0 - ratio), high * (1.0 + ratio) + METER_AC[1])
    return found


def _scale(expected: float, ratios: tuple[float, float]) -> Limits:
    return Limits(expected, ratios[0] * expected, ratios[1] * expected)
