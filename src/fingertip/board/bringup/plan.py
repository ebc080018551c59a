"""Plan of a bring-up: every reading with its limits, which are what good boards would read, with
the meter's errors.

All constant voltages are above the signal ground (TP5), so that its own error does not hide others;
it is measured too. What the controller's converter reads is above supply ground. It scales with the
supply as the converter does.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fingertip.board.analysis.board_values import BoardValues
from fingertip.board.analysis.interference import compute_supply_current_a
from fingertip.board.bringup import bench
from fingertip.board.bringup.bench import resistance_between
from fingertip.board.circuits.network import Network, Value, build_network, list_amplifiers
from fingertip.board.components.front_end import AD623_OFFSET_V, GAIN_CONSTANT_OHM, GAIN_RESISTOR
from fingertip.board.components.values import SUPPLIES
from fingertip.board.parts.circuit import Circuit, parse_component_value
from fingertip.board.parts.nets import (
    ADC_FILTERED,
    ADC_TACTILE,
    ENVELOPE,
    FILTERED,
    GND,
    SENSOR,
    TACTILE,
    VCC,
    VEE,
)
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import DIODE_V, find_gain_bandwidth_hz
from fingertip.foundation.numerics import Array
from fingertip.foundation.tables import read_rows

BOARDS = 400
SEED = 1
METER_DC = (0.005, 0.003)
METER_AC = (0.02, 0.005)
"""Error of a simple multimeter: ratio of the reading, and a constant [V]; direct voltage, and
alternating voltage from 40 to 400 Hz. An assumption; a better meter has less.
"""
CONVERTER_DC = (0.01, 0.01)
CONVERTER_AC = (0.03, 0.0005)
"""The same of a controller's converter of 12 bits, for a mean
and for a tone of some thousand samples.
"""
_TEST_PART_RATIO = {bench.COUPLING_OHM: 0.01, bench.COUPLING_F: 0.1}
"""Tolerances of the parts that connect the controller's pin."""
_DUMMY_RATIO = 0.01
SUPPLY_PERCENT = 2.0
"""Tolerance of the supply during the tests: all levels scale with it."""
SHORT_RATIO = 0.05
"""Share of the resistors' resistance below which a short is likely;
the circuits in parallel lower it somewhat.
"""
_SENSOR_RATIO = 0.1
"""Tolerance of the resistance at the sensor's socket: the
amplifier's input draws little without power.
"""
CURRENT_RATIOS = (0.4, 1.7)
"""Limits of the supply current as ratios of the typical one: data
sheets allow amplifiers about half as much more.
"""
_NOISE_FACTOR = 4.0
"""Largest noise that is accepted, in units of the expected one: hum is not known."""
_ENVELOPE_SHARE = 0.6
"""Least mean of the envelope as a share of a half wave's, less the
diode's voltage on the article's board.
"""
PROBES = {row["net"]: row for row in read_rows(Path(__file__).with_name("points.csv"))}
"""Place at which each net is measured. A test compares them with the circuits."""


@dataclass(frozen=True)
class Limits:
    """Expected reading of a board without a fault, and the limits of it [V, A or ohm]."""

    expected: float
    low: float
    high: float = math.inf


@dataclass(frozen=True)
class Tone:
    """Alternating voltage of a net while the tone sounds: RMS of
    its fundamental, or with all harmonics [V].
    """

    net: str
    samples: int
    """Samples of the sketch in a period of the tone."""
    limits: Limits

    @property
    def hz(self) -> float:
        return bench.SAMPLE_HZ / self.samples


@dataclass(frozen=True)
class Board:
    """Board with its bench: all that its readings depend on."""

    circuit: Circuit
    bench: bench.Bench
    rails_v: Mapping[str, float]
    signal_ground: str
    gain_bandwidth_hz: float

    @property
    def nets(self) -> tuple[str, ...]:
        """Nets whose constant voltage is measured."""
        known = {net.name for net in self.circuit.nets}
        return tuple(net for net in PROBES if net in known and net != ENVELOPE)

    @property
    def is_sampled(self) -> bool:
        """True if the controller samples the filtered signal."""
        return ADC_FILTERED in self.circuit.net_by_pin.values()

    @classmethod
    def of_design(cls, design: Design, circuit: Circuit) -> Board:
        supply = SUPPLIES[design.board.variant]
        supply_v = design.board.supply_v
        rails = {GND: 0.0, VCC: supply_v, VEE: -supply_v}
        margin_v = max(
            output.data.output_from_rail_v for output in list_amplifiers(circuit) if output.data
        )
        swing_v = (
            min(supply.upper_headroom_v(supply_v), supply.lower_headroom_v(supply_v)) - margin_v
        )
        bandwidth = find_gain_bandwidth_hz(design.board)
        setup = bench.set_up_bench(circuit, bandwidth, design.board.cutoff_hz, swing_v)

        return cls(
            circuit=circuit,
            bench=setup,
            rails_v=rails,
            signal_ground=supply.signal_ground,
            gain_bandwidth_hz=bandwidth,
        )


@dataclass(frozen=True)
class BringUp:
    """Readings of a board to be brought up."""

    board: Board
    supply_ohm: Limits
    negative_ohm: Limits | None
    sensor_ohm: Limits
    supply_ma: Limits
    open_v: Mapping[str, Limits]
    """Constant voltage of each net with the sensor's socket open."""
    dummy_v: Mapping[float, Limits]
    """Tactile voltage with each resistor in the sensor's place."""
    pins_v: Mapping[str, Limits]
    """Mean at the pins of the controller with the lighter of them;
    none on a board that it does not sample.
    """
    tones: tuple[Tone, ...]
    quiet_v: Limits
    """RMS of the filtered signal without a tone, at the pin if the controller samples it."""
    envelope_v: Limits | None
    """Mean of the envelope with the third tone; None on a board without one."""


def plan_bring_up(board: Board, values: BoardValues) -> BringUp:
    random = np.random.default_rng(SEED)
    circuit = board.circuit
    light_ohm = board.bench.dummy_ohm[0]
    open_v = {net: _limit_constant(board, net, board.signal_ground, random) for net in board.nets}
    dummy_v = {
        ohm: _limit_constant(
            board,
            net=TACTILE,
            ground=board.signal_ground,
            random=random,
            ohm=ohm,
        )
        for ohm in board.bench.dummy_ohm
    }
    pins = (ADC_TACTILE, ADC_FILTERED) if board.is_sampled else ()
    pins_v = {
        net: _limit_constant(
            board,
            net=net,
            ground=GND,
            random=random,
            ohm=light_ohm,
            error=CONVERTER_DC,
        )
        for net in pins
    }
    # A bridge ends in the signal ground, a transimpedance stage in the tactile voltage.
    sensor_ohm = min(
        resistance_between(circuit, SENSOR, net) for net in (board.signal_ground, TACTILE)
    )
    alone_a = compute_supply_current_a(circuit, board.rails_v[VCC])
    current_ma = 1e3 * (values.shared.supply_current_a if values.shared else alone_a)
    tones = tuple(_list_tones(board, random))
    noise_v = values.noise.filtered_pin_v

    return BringUp(
        board=board,
        supply_ohm=_limit_short(resistance_between(circuit, VCC, GND)),
        negative_ohm=_limit_short(resistance_between(circuit, GND, VEE))
        if board.signal_ground == GND
        else None,
        sensor_ohm=Limits(
            sensor_ohm, (1.0 - _SENSOR_RATIO) * sensor_ohm, (1.0 + _SENSOR_RATIO) * sensor_ohm
        ),
        supply_ma=Limits(current_ma, *(current_ma * ratio for ratio in CURRENT_RATIOS)),
        open_v=open_v,
        dummy_v=dummy_v,
        pins_v=pins_v,
        tones=tones,
        quiet_v=Limits(noise_v, 0.0, _NOISE_FACTOR * noise_v + METER_AC[1]),
        envelope_v=_limit_envelope(board) if ENVELOPE in circuit.net_by_pin.values() else None,
    )


def _limit_short(ohm: float) -> Limits:
    """Resistance below whose lower limit there is a short; a meter may read infinity."""
    return Limits(ohm, SHORT_RATIO * min(ohm, 10e3))


def _limit_constant(
    board: Board,
    net: str,
    ground: str,
    random: np.random.Generator,
    ohm: float | None = None,
    error: tuple[float, float] = METER_DC,
) -> Limits:
    """Limit the constant voltage of a net above a ground, with the sensor open or a resistor in its
    place.

    Resistors and capacitors are drawn within their tolerances, offsets within their maximum, all
    uniformly.
    """
    network = build_network(
        board.circuit, board.gain_bandwidth_hz, sensor_s=1.0 / ohm if ohm else 0.0
    )
    path = network.restrict(net, *({ground} - {GND}))
    sensor = {"J1": 1.0 / ohm / (1.0 + _DUMMY_RATIO * random.uniform(-1, 1, BOARDS))} if ohm else {}
    volts = _constant(
        path.with_values(_draw(path, board, random) | sensor), board.rails_v, net, ground
    )
    if error is METER_DC:  # a converter scales with the supply
        volts = volts * (1.0 + 0.01 * SUPPLY_PERCENT * random.uniform(-1.0, 1.0, BOARDS))

    volts = volts + _draw_offset(
        path,
        board=board,
        net=net,
        ground=ground,
        random=random,
    )
    return _widen(float(_constant(path, board.rails_v, net, ground)[0]), volts, error)


def _constant(network: Network, rails_v: Mapping[str, float], net: str, ground: str) -> Array:
    """Constant voltage of a net above the signal ground, or of that
    above ground, for one or many boards at once.
    """
    volts = network.response(np.zeros(1), rails_v, net)[:, 0].real
    if ground not in (net, GND):
        volts = volts - network.response(np.zeros(1), rails_v, ground)[:, 0].real

    return volts


def _list_tones(board: Board, random: np.random.Generator) -> list[Tone]:
    """List the tones: as the sketch computes them from its samples, or
    as a meter shows them at the filter's output.
    """
    samples = board.bench.periods
    wanted = [(FILTERED, each) for each in samples[:-1]]
    if board.is_sampled:
        wanted = [*((ADC_FILTERED, each) for each in samples), (ADC_TACTILE, samples[-1])]

    found = []
    error = CONVERTER_AC if board.is_sampled else METER_AC
    for net, each in wanted:
        path = bench.feed_tone(board.circuit, board.bench, board.gain_bandwidth_hz).restrict(net)
        measure = bench.level if board.is_sampled else bench.square_level
        hz = bench.SAMPLE_HZ / each
        parts = path.with_values(_draw(path, board, random))
        expected = bench.TONE_V * float(measure(path, hz, net)[0])
        found.append(
            Tone(net, each, _widen(expected, bench.TONE_V * measure(parts, hz, net), error))
        )

    return found


def _limit_envelope(board: Board) -> Limits:
    """Limit the mean of the envelope with the third tone from below:
    that of a half wave, less what a diode takes.
    """
    path = bench.feed_tone(board.circuit, board.bench, board.gain_bandwidth_hz).restrict(FILTERED)
    rms_v = bench.TONE_V * float(bench.level(path, board.bench.tones_hz[2], FILTERED)[0])
    mean_v = (math.sqrt(2.0) * rms_v - (0.0 if board.is_sampled else DIODE_V)) / math.pi

    return Limits(mean_v, _ENVELOPE_SHARE * mean_v)


def _widen(expected: float, drawn: Array, error: tuple[float, float]) -> Limits:
    ratio, constant = error
    low = min(expected, float(drawn.min()))
    high = max(expected, float(drawn.max()))
    margin = ratio * max(abs(low), abs(high)) + constant

    return Limits(expected, low - margin, high + margin)


def _draw(path: Network, board: Board, random: np.random.Generator) -> dict[str, Value]:
    drawn: dict[str, Value] = {}
    required = {
        part.reference: part.requirement for part in board.circuit.components if part.requirement
    }
    for name in sorted({term.quantity for term in path.terms}):
        ratio = _TEST_PART_RATIO.get(name) or (
            required[name].tolerance_percent / 100.0 if name in required else 0.0
        )
        if ratio:
            factor = 1.0 + ratio * random.uniform(-1.0, 1.0, BOARDS)
            value = path.values[name]
            drawn[name] = (
                value / factor if name.startswith("R") else value * factor
            )  # conductance of a resistor

    return drawn


def _draw_offset(
    path: Network,
    board: Board,
    net: str,
    ground: str,
    random: np.random.Generator,
) -> Array:
    """Draw the offsets of the amplifiers before a net, as they appear between it and a
    ground [V].
    """
    transfers = path.constant_transfers(net, ground if ground != net else GND)
    total = np.zeros(BOARDS)

    for output in list_amplifiers(board.circuit):
        if output.net in transfers:
            if output.data:
                limit_v = output.data.max_offset_v
            else:
                gain_ohm = parse_component_value(board.circuit.component(GAIN_RESISTOR).value)
                limit_v = AD623_OFFSET_V * (1.0 + GAIN_CONSTANT_OHM / gain_ohm)

            total += transfers[output.net] * limit_v * random.uniform(-1.0, 1.0, BOARDS)

    return total
