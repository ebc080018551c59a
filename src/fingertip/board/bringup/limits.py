"""Limits of each reading: what thousands of good boards would read, with the errors of the meter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fingertip.board.analysis.board_values import BoardValues
from fingertip.board.bringup.bench import (
    COUPLING_F,
    COUPLING_OHM,
    TONE,
    TONE_V,
    TOP_HZ,
    Fault,
    connect_meter,
    connect_tone,
    has_tone,
    list_output_pins,
)
from fingertip.board.bringup.prediction import (
    Board,
    batch_constant,
    batch_level,
    list_levels,
    name_tone,
    name_voltage,
    predict,
)
from fingertip.board.circuits.network import Network, Value, build_network, list_amplifiers
from fingertip.board.circuits.signal_paths import RECT_OUT
from fingertip.board.components.bridge import AD623_OFFSET_V, AMPLIFIERS, GAIN_CONSTANT_OHM, GAIN_RESISTOR
from fingertip.board.parts.circuit import ENVELOPE, FILTERED, GND, TACTILE, Circuit, parse_component_value
from fingertip.foundation.numerics import Array

RECTIFIER_V = 0.15
"""Deviation of the mean of a precision rectifier's amplifier: the drops of two diodes differ by less [V]."""
BOARDS, SEED = 400, 1
METER_DC, METER_AC = (0.005, 0.003), (0.02, 0.005)
"""Error of a simple multimeter: ratio of the reading, and a constant [V]; direct voltage, and alternating voltage from
40 to 400 Hz. An assumption; a better meter has less."""
_TEST_PART_RATIO = {COUPLING_OHM: 0.01, COUPLING_F: 0.1}
"""Tolerances of the parts that connect the generator. Measure the resistor to know it better."""
_DUMMY_RATIO = 0.01
_HOLDING = "C4"
"""Capacitor that holds the envelope."""
SUPPLY_PERCENT = 2.0
"""Tolerance of the supply during the tests: all levels of a bridge scale with it."""


@dataclass(frozen=True)
class Limits:
    """Expected reading of a board without a fault [V]."""

    expected_v: float
    low_v: float
    high_v: float


def compute_limits(board: Board, values: BoardValues, tone_v: float = TONE_V) -> dict[str, Limits]:
    """Compute the limits of all readings, by the reading's name.

    Resistors and capacitors are drawn within their tolerances, offsets within their maximum, both uniformly. `tone_v`
    is the RMS of the generator's tone [V].
    """
    random = np.random.default_rng(SEED)
    drawn: dict[str, Array] = {}
    light, firm = board.bench.dummy_ohm

    for net in board.nets:
        if net != ENVELOPE:
            drawn[name_voltage(net)] = _draw_constant(board, net, board.signal_ground, random)
    for ohm in (light, firm):
        drawn[name_voltage(TACTILE, ohm)] = _draw_constant(board, TACTILE, board.signal_ground, random, ohm)
    toned = build_network(connect_tone(board.circuit, board.bench), board.gain_bandwidth_hz, sensor_s=1.0 / light)
    path = toned.drive(TONE).restrict(FILTERED)
    parts = path.with_values(_draw(path, board, random))
    levels = {name_tone(net, hz): tone_v * batch_level(parts, hz, net) for net, hz in list_levels(board.bench)}

    # The envelope follows the filtered tone: between the weakest and the strongest of the boards. Behind a bare diode
    # it also follows C4, which holds it between the peaks.
    filtered = levels[name_tone(FILTERED, board.bench.tones_hz[-1])]
    middle = tone_v * float(batch_level(path, board.bench.tones_hz[-1], FILTERED))
    tones_v = [tone_v * float(level) / middle for level in (middle, filtered.min(), filtered.max())]
    circuits = [board.circuit, *(_change(board, _HOLDING, sign) for sign in (-1.0, 1.0))]
    nominal, *ends = predict(board, [Fault("", "", circuit) for circuit in circuits], *tones_v)
    limits = {name: _widen(nominal[name], volts, METER_DC) for name, volts in drawn.items()}
    limits |= {name: _widen(nominal[name], volts, METER_AC) for name, volts in levels.items()}
    limits |= _limit_envelope(board, values, nominal, ends)
    return limits | _limit_pins(board, limits, nominal, tone_v, random)


def _draw_constant(board: Board, net: str, ground: str, random: np.random.Generator, ohm: float | None = None) -> Array:
    """Draw the constant voltage of a net above a ground [V], with the sensor open or a resistor in its place."""
    circuit = connect_meter(board.circuit) if ground != board.signal_ground else board.circuit
    network = build_network(circuit, board.gain_bandwidth_hz, sensor_s=1.0 / ohm if ohm else 0.0)
    path = network.restrict(net, *({ground} - {GND}))
    sensor = {"J1": 1.0 / ohm / (1.0 + _DUMMY_RATIO * random.uniform(-1, 1, BOARDS))} if ohm else {}
    parts = _draw(path, board, random) | sensor
    supply = 1.0 + 0.01 * SUPPLY_PERCENT * random.uniform(-1.0, 1.0, BOARDS)
    volts = batch_constant(path.with_values(parts), board.rails_v, net, ground)
    return volts * supply + _draw_offset(path, board, net, ground, random)


def _limit_pins(
    board: Board,
    limits: Mapping[str, Limits],
    nominal: Mapping[str, float],
    tone_v: float,
    random: np.random.Generator,
) -> dict[str, Limits]:
    """Limits of the readings at J3, against supply ground."""
    found = {}
    for pin in list_output_pins(board.circuit):
        if pin.source == ENVELOPE:
            # The rectifier is not linear: its own limits, above every level that the signal ground may have.
            has_middle = board.signal_ground != GND
            ground_v = _draw_constant(board, board.signal_ground, GND, random) if has_middle else np.zeros(BOARDS)
            quiet, expected_v = limits[name_voltage(ENVELOPE)], nominal[pin.constant_name]
            change_v = quiet.expected_v - nominal[name_voltage(ENVELOPE)]
            ends_v = np.array([ground_v.min() + quiet.low_v, ground_v.max() + quiet.high_v])
            found[pin.constant_name] = _widen(expected_v + change_v, ends_v, METER_DC)
        else:
            volts = _draw_constant(board, pin.net, GND, random)
            found[pin.constant_name] = _widen(nominal[pin.constant_name], volts, METER_DC)
        if has_tone(pin):
            light = board.bench.dummy_ohm[0]
            circuit = connect_tone(connect_meter(board.circuit), board.bench)
            path = build_network(circuit, board.gain_bandwidth_hz, sensor_s=1.0 / light).drive(TONE).restrict(pin.net)
            level = tone_v * batch_level(path.with_values(_draw(path, board, random)), TOP_HZ, pin.net)
            found[pin.tone_name] = _widen(nominal[pin.tone_name], level, METER_AC)
    return found


def _widen(expected_v: float, drawn_v: Array, meter: tuple[float, float]) -> Limits:
    """Limits of a reading: the extremes of the boards, and the meter's error."""
    ratio, constant_v = meter
    low, high = min(expected_v, float(drawn_v.min())), max(expected_v, float(drawn_v.max()))
    error_v = ratio * max(abs(low), abs(high)) + constant_v
    return Limits(expected_v, low - error_v, high + error_v)


def _limit_envelope(
    board: Board,
    values: BoardValues,
    nominal: Mapping[str, float],
    ends: Sequence[Mapping[str, float]],
) -> dict[str, Limits]:
    """Limits of the envelope at rest and with the tone: the rectifier adds offsets."""
    offset, constant_v, noise_v = values.output_offset, METER_DC[1], values.noise.mean_envelope_v or 0.0
    low_v, high_v = (offset.min_v - constant_v, offset.max_v + constant_v) if offset else (-constant_v, constant_v)
    quiet, loud = name_voltage(ENVELOPE), name_tone(ENVELOPE, board.bench.tones_hz[-1])
    meter_v = METER_DC[0] * abs(nominal[loud])
    part_v = 2.0 * _find_tolerance("R6", board) * abs(nominal[loud])
    found = {
        # Noise is rectified as a tone is: its mean is there at rest, and hardly adds to a tone.
        quiet: Limits(nominal[quiet] + noise_v, nominal[quiet] + low_v, nominal[quiet] + 2.0 * noise_v + high_v),
        loud: Limits(
            nominal[loud], ends[0][loud] - part_v + low_v - meter_v, ends[1][loud] + part_v + high_v + meter_v
        ),
    }
    output = name_tone(RECT_OUT, board.bench.tones_hz[-1])
    if output in nominal:
        # The drops of the two diodes alternate there, so the mean is small, and a diode that is missing shows.
        found[output] = Limits(nominal[output], nominal[output] - RECTIFIER_V, nominal[output] + RECTIFIER_V)
    return found


def _draw(path: Network, board: Board, random: np.random.Generator) -> dict[str, Value]:
    """Draw the values of a network's parts within their tolerances."""
    drawn: dict[str, Value] = {}
    for name in sorted({term.quantity for term in path.terms}):
        ratio = _TEST_PART_RATIO.get(name) or _find_tolerance(name, board)
        if ratio:
            factor = 1.0 + ratio * random.uniform(-1.0, 1.0, BOARDS)
            value = path.values[name]
            drawn[name] = value / factor if name.startswith("R") else value * factor  # conductance of a resistor
    return drawn


def _change(board: Board, reference: str, sign: float) -> Circuit:
    """Change a part's value by its tolerance."""
    value = parse_component_value(board.circuit.component(reference).value)
    return board.circuit.replace(reference, f"{value * (1.0 + sign * _find_tolerance(reference, board)):.10g}")


def _find_tolerance(reference: str, board: Board) -> float:
    """Relative tolerance of a part; 0 of what is none."""
    parts = {part.reference: part for part in board.circuit.components}
    requirement = parts[reference].requirement if reference in parts else None
    return requirement.tolerance_percent / 100.0 if requirement else 0.0


def _draw_offset(path: Network, board: Board, net: str, ground: str, random: np.random.Generator) -> Array:
    """Draw the offsets of the amplifiers before a net, as they appear between it and a ground [V]."""
    transfers, total = path.constant_transfers(net), np.zeros(BOARDS)
    if ground not in (net, GND):
        of_ground = path.constant_transfers(ground)
        transfers = {name: transfer - of_ground[name] for name, transfer in transfers.items()}
    gain = 1.0 + GAIN_CONSTANT_OHM / parse_component_value(board.circuit.component(GAIN_RESISTOR).value)
    for output in list_amplifiers(board.circuit):
        if output.net in transfers:
            symbol = board.circuit.component(output.reference).symbol.name
            limit_v = AMPLIFIERS[symbol].max_offset_v if symbol in AMPLIFIERS else AD623_OFFSET_V * gain
            total += transfers[output.net] * limit_v * random.uniform(-1.0, 1.0, BOARDS)
    return total
