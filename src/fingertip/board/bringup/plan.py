"""Plan of a bring-up: every reading with its limits, which are what good boards would read, with the meter's errors."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fingertip.board.analysis.board_values import BoardValues
from fingertip.board.analysis.interference import compute_supply_current_a
from fingertip.board.bringup import bench, prediction
from fingertip.board.bringup.prediction import Board, Limits, name_tone, name_voltage
from fingertip.board.bringup.resistances import limit_board_resistances
from fingertip.board.circuits.network import Network, Value, build_network, list_amplifiers
from fingertip.board.components.front_end import AD623_OFFSET_V, GAIN_CONSTANT_OHM, GAIN_RESISTOR
from fingertip.board.parts.circuit import parse_component_value
from fingertip.board.parts.nets import ENVELOPE, FILTERED, GND, RECT_OUT, TACTILE, VCC
from fingertip.foundation.numerics import Array
from fingertip.foundation.output_set import hash_parameters

RECTIFIER_V = 0.15
"""Deviation of the mean of a precision rectifier's amplifier: the drops of two diodes differ by less [V]."""
BOARDS, SEED = 400, 1
METER_DC, METER_AC = (0.005, 0.003), (0.02, 0.005)
"""Error of a simple multimeter: ratio of the reading, and a constant [V]; direct voltage, and alternating voltage from
40 to 400 Hz. An assumption; a better meter has less."""
_TEST_PART_RATIO = {bench.COUPLING_OHM: 0.01, bench.COUPLING_F: 0.1}
"""Tolerances of the parts that connect the generator. Measure the resistor to know it better."""
_DUMMY_RATIO = 0.01
SUPPLY_PERCENT = 2.0
"""Tolerance of the supply during the tests: all levels of a bridge scale with it."""


def compute_limits(board: Board, values: BoardValues, tone_v: float = bench.TONE_V) -> dict[str, Limits]:
    """Compute the limits of all readings, by the reading's name.

    Resistors and capacitors are drawn within their tolerances, offsets within their maximum, both uniformly. `tone_v`
    is the RMS of the generator's tone [V].
    """
    random = np.random.default_rng(SEED)
    drawn: dict[str, Array] = {}
    high_hz = board.bench.tones_hz[-1]

    for net in board.nets:
        if net != ENVELOPE:
            drawn[name_voltage(net)] = _draw_constant(board, net, board.signal_ground, random)
    for ohm in board.bench.dummy_ohm:
        drawn[name_voltage(TACTILE, ohm)] = _draw_constant(board, TACTILE, board.signal_ground, random, ohm)
    path = bench.feed_tone(board.circuit, board.bench, board.gain_bandwidth_hz).restrict(FILTERED)
    parts = path.with_values(_draw(path, board, random))
    levels = {
        name_tone(net, hz): tone_v * prediction.batch_level(parts, hz, net)
        for net, hz in prediction.list_levels(board.bench)
    }

    circuits, tones_v, ratio = [board.circuit], [tone_v], _find_tolerance("C4", board)
    if board.has_envelope:
        # The envelope follows the filtered tone: between the weakest and the strongest of the boards. Behind a bare
        # diode it also follows C4, which holds it between the peaks.
        filtered = levels[name_tone(FILTERED, high_hz)]
        middle = tone_v * float(prediction.batch_level(path, high_hz, FILTERED)[0])
        tones_v += [tone_v * float(level) / middle for level in (filtered.min(), filtered.max())]
        c4_f = parse_component_value(board.circuit.component("C4").value)
        circuits += [board.circuit.replace("C4", f"{c4_f * factor:.10g}") for factor in (1.0 - ratio, 1.0 + ratio)]
    nominal, *ends = prediction.predict(board, [bench.Fault("", "", circuit) for circuit in circuits], *tones_v)
    limits = {name: _widen(nominal[name], volts, METER_DC) for name, volts in drawn.items()}
    limits |= {name: _widen(nominal[name], volts, METER_AC) for name, volts in levels.items()}
    if board.has_envelope:
        limits |= _limit_envelope(board, values, nominal, ends)
        ripple, tolerance = prediction.name_ripple(high_hz), ratio + 2.0 * _find_tolerance("R6", board)
        spread = np.array([tones_v[1] * (1.0 - tolerance), tones_v[2] / (1.0 - tolerance)]) / tone_v
        limits[ripple] = _widen(nominal[ripple], spread * nominal[ripple], METER_AC)
    return limits | _limit_pins(board, limits, nominal, tone_v, random)


def _draw_constant(board: Board, net: str, ground: str, random: np.random.Generator, ohm: float | None = None) -> Array:
    """Draw the constant voltage of a net above a ground [V], with the sensor open or a resistor in its place."""
    circuit = bench.connect_meter(board.circuit) if ground != board.signal_ground else board.circuit
    network = build_network(circuit, board.gain_bandwidth_hz, sensor_s=1.0 / ohm if ohm else 0.0)
    path = network.restrict(net, *({ground} - {GND}))
    sensor = {"J1": 1.0 / ohm / (1.0 + _DUMMY_RATIO * random.uniform(-1, 1, BOARDS))} if ohm else {}
    parts = _draw(path, board, random) | sensor
    supply = 1.0 + 0.01 * SUPPLY_PERCENT * random.uniform(-1.0, 1.0, BOARDS)
    volts = prediction.batch_constant(path.with_values(parts), board.rails_v, net, ground)
    return volts * supply + _draw_offset(path, board, net, ground, random)


def _limit_pins(
    board: Board, limits: Mapping[str, Limits], nominal: Mapping[str, float], tone_v: float, random: np.random.Generator
) -> dict[str, Limits]:
    found = {}
    for pin in bench.list_output_pins(board.circuit):
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
        if bench.has_tone(pin):
            circuit = bench.connect_meter(board.circuit)
            path = bench.feed_tone(circuit, board.bench, board.gain_bandwidth_hz).restrict(pin.net)
            level = tone_v * prediction.batch_level(path.with_values(_draw(path, board, random)), bench.TOP_HZ, pin.net)
            found[pin.tone_name] = _widen(nominal[pin.tone_name], level, METER_AC)
    return found


def _widen(expected_v: float, drawn_v: Array, meter: tuple[float, float]) -> Limits:
    ratio, constant_v = meter
    low, high = min(expected_v, float(drawn_v.min())), max(expected_v, float(drawn_v.max()))
    error_v = ratio * max(abs(low), abs(high)) + constant_v
    return Limits(expected_v, low - error_v, high + error_v)


def _limit_envelope(
    board: Board, values: BoardValues, nominal: Mapping[str, float], ends: Sequence[Mapping[str, float]]
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
    drawn: dict[str, Value] = {}
    for name in sorted({term.quantity for term in path.terms}):
        ratio = _TEST_PART_RATIO.get(name) or _find_tolerance(name, board)
        if ratio:
            factor = 1.0 + ratio * random.uniform(-1.0, 1.0, BOARDS)
            value = path.values[name]
            drawn[name] = value / factor if name.startswith("R") else value * factor  # conductance of a resistor
    return drawn


def _find_tolerance(reference: str, board: Board) -> float:
    requirement = next((part.requirement for part in board.circuit.components if part.reference == reference), None)
    return requirement.tolerance_percent / 100.0 if requirement else 0.0


def _draw_offset(path: Network, board: Board, net: str, ground: str, random: np.random.Generator) -> Array:
    """Draw the offsets of the amplifiers before a net, as they appear between it and a ground [V]."""
    transfers, total = path.constant_transfers(net, ground if ground != net else GND), np.zeros(BOARDS)
    for output in list_amplifiers(board.circuit):
        if output.net in transfers:
            if output.data:
                limit_v = output.data.max_offset_v
            else:
                gain_ohm = parse_component_value(board.circuit.component(GAIN_RESISTOR).value)
                limit_v = AD623_OFFSET_V * (1.0 + GAIN_CONSTANT_OHM / gain_ohm)
            total += transfers[output.net] * limit_v * random.uniform(-1.0, 1.0, BOARDS)
    return total


# Further readings: the supply current, noise, and the tone at which the comparator answers.

CURRENT_RATIOS = (0.4, 1.7)
"""Limits of the supply current as ratios of the typical one: data sheets allow amplifiers about half as much more."""

SUPPLY_MA = "supply_ma"
QUIET, SLIP_TONE = "tp3_quiet_v", "slip_tone_v"
_NOISE_FACTOR = 4.0
"""Largest noise that is accepted, in units of the expected one: the meter's bandwidth and hum are not known."""
_LEAST_THRESHOLD_V = 2e-3
"""Smallest threshold at which the comparator can be told from one that is stuck [V]."""


@dataclass(frozen=True)
class BringUp:
    """Readings of a board to be brought up, by name, each in the unit that its name ends in."""

    board: Board
    identity: str
    """Hash of the values of its components."""
    before_power: Mapping[str, Limits]
    current: Mapping[str, Limits]
    levels: Mapping[str, Limits]
    """Voltages that are predicted for every fault, so that they serve the diagnosis."""
    others: Mapping[str, Limits]
    """Noise, and the tone at which the comparator answers."""

    @property
    def all(self) -> dict[str, Limits]:
        levels = {name: self.levels[name] for name in _list_levels_in_order(self.board) if name in self.levels}
        return {**self.before_power, **self.current, **levels, **self.others}


def _list_levels_in_order(board: Board) -> list[str]:
    """List the voltages in the order of the sheet: without the tone, at the output connector, with the tone."""
    pins = {pin.net: pin for pin in bench.list_output_pins(board.circuit)}
    at_host = [pins[net] for _, net in board.circuit.list_wires(board.circuit.component(bench.HOST)) if net in pins]
    high = board.bench.tones_hz[-1]
    return [
        *(name_voltage(net) for net in board.nets),
        *(name_voltage(TACTILE, ohm) for ohm in board.bench.dummy_ohm),
        *(pin.constant_name for pin in at_host),
        *(name_tone(net, hz) for net, hz in (*prediction.list_levels(board.bench), (ENVELOPE, high))),
        prediction.name_ripple(high),
        name_tone(RECT_OUT, high),
        *(pin.tone_name for pin in pins.values() if bench.has_tone(pin)),
    ]


def plan_bring_up(board: Board, values: BoardValues, tone_v: float = bench.TONE_V) -> BringUp:
    levels = compute_limits(board, values, tone_v)
    alone_a = compute_supply_current_a(board.circuit, board.rails_v[VCC])
    current_a = values.shared.supply_current_a if values.shared else alone_a
    return BringUp(
        board,
        hash_parameters({part.reference: part.value for part in board.circuit.components})[:8],
        limit_board_resistances(board),
        {SUPPLY_MA: Limits(1e3 * current_a, *(1e3 * current_a * ratio for ratio in CURRENT_RATIOS))},
        levels,
        _others(board, values, levels, tone_v),
    )


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
