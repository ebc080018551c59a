"""Expected readings of a bring-up, with the limits that a good board and the meter's errors give.

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
from fingertip.board.bringup.resistance import resistance_between
from fingertip.board.bringup.stimulus import (
    COUPLING_F,
    COUPLING_OHM,
    SAMPLE_HZ,
    TONE_V,
    Stimulus,
    choose_stimulus,
    feed_tone,
    square_wave_level,
    tone_level,
)
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
"""The same for a controller's 12-bit converter: of a mean, and of a tone of some 1000 samples."""
_TEST_PART_RATIO = {COUPLING_OHM: 0.01, COUPLING_F: 0.1}
"""Tolerances of the parts that connect the controller's pin."""
_DUMMY_RATIO = 0.01
SUPPLY_PERCENT = 2.0
"""Tolerance of the supply during the tests: all levels scale with it."""
SHORT_RATIO = 0.05
"""Share of the expected resistance below which a short is likely; parallel circuits lower it."""
_SENSOR_RATIO = 0.1
"""Tolerance of the sensor socket's resistance: the unpowered amplifier draws little."""
CURRENT_RATIOS = (0.4, 1.7)
"""Limits of the supply current over the typical one; data sheets allow about half as much more."""
_NOISE_FACTOR = 4.0
"""Largest noise that is accepted, in units of the expected one: hum is not known."""
_ENVELOPE_SHARE = 0.6
"""Least mean of the envelope over a half wave's, less the diode's drop in variant article."""
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
    """RMS voltage of a net while the tone sounds: its fundamental, or with all harmonics [V]."""

    net: str
    samples: int
    """Samples of the sketch in a period of the tone."""
    limits: Limits

    @property
    def hz(self) -> float:
        return SAMPLE_HZ / self.samples


@dataclass(frozen=True)
class BoardUnderTest:
    """Board with its stimulus: all that its readings depend on."""

    circuit: Circuit
    stimulus: Stimulus
    rails_v: Mapping[str, float]
    signal_ground: str
    gain_bandwidth_hz: float

    @property
    def nets(self) -> tuple[str, ...]:
        """Nets whose constant voltage is measured."""
        names = {net.name for net in self.circuit.nets}
        return tuple(net for net in PROBES if net in names and net != ENVELOPE)

    @property
    def is_sampled(self) -> bool:
        """True if the controller samples the filtered signal."""
        return ADC_FILTERED in self.circuit.net_by_pin.values()

    @classmethod
    def of_design(cls, design: Design, circuit: Circuit) -> BoardUnderTest:
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
        stimulus = choose_stimulus(circuit, bandwidth, design.board.cutoff_hz, swing_v)

        return cls(
            circuit=circuit,
            stimulus=stimulus,
            rails_v=rails,
            signal_ground=supply.signal_ground,
            gain_bandwidth_hz=bandwidth,
        )


@dataclass(frozen=True)
class BringUp:
    """Readings of a board to be brought up."""

    board: BoardUnderTest
    supply_ohm: Limits
    negative_ohm: Limits | None
    sensor_ohm: Limits
    supply_ma: Limits
    open_v: Mapping[str, Limits]
    """Constant voltage of each net with the sensor's socket open."""
    dummy_v: Mapping[float, Limits]
    """Tactile voltage with each resistor in the sensor's place."""
    pins_v: Mapping[str, Limits]
    """Mean at the controller's pins with the lighter resistor; none if it does not sample them."""
    tones: tuple[Tone, ...]
    quiet_v: Limits
    """RMS of the filtered signal without a tone, at the pin if the controller samples it."""
    envelope_v: Limits | None
    """Mean of the envelope with the third tone; None on a board without one."""


def plan_bring_up(board: BoardUnderTest, values: BoardValues) -> BringUp:
    """Compute the expected readings of a board from `BOARDS` simulated ones."""
    random = np.random.default_rng(SEED)
    circuit = board.circuit
    open_v = {net: _limit_constant(board, net, board.signal_ground, random) for net in board.nets}
    dummy_v = {
        ohm: _limit_constant(
            board,
            net=TACTILE,
            ground=board.signal_ground,
            random=random,
            ohm=ohm,
        )
        for ohm in board.stimulus.dummy_ohm
    }
    pins_v = _limit_pins(board, random)
    tones = tuple(_list_tones(board, random))
    noise_v = values.noise.filtered_pin_v
    has_negative_rail = board.signal_ground == GND
    has_envelope = ENVELOPE in circuit.net_by_pin.values()

    return BringUp(
        board=board,
        supply_ohm=_limit_short(resistance_between(circuit, VCC, GND)),
        negative_ohm=(
            _limit_short(resistance_between(circuit, GND, VEE)) if has_negative_rail else None
        ),
        sensor_ohm=_limit_sensor_ohm(board),
        supply_ma=_limit_supply_ma(board, values),
        open_v=open_v,
        dummy_v=dummy_v,
        pins_v=pins_v,
        tones=tones,
        quiet_v=Limits(noise_v, 0.0, _NOISE_FACTOR * noise_v + METER_AC[1]),
        envelope_v=_limit_envelope(board) if has_envelope else None,
    )


def _limit_pins(board: BoardUnderTest, random: np.random.Generator) -> dict[str, Limits]:
    """Limit the mean at the controller's pins with the lighter resistor, if it samples them."""
    pins = (ADC_TACTILE, ADC_FILTERED) if board.is_sampled else ()
    return {
        net: _limit_constant(
            board,
            net=net,
            ground=GND,
            random=random,
            ohm=board.stimulus.dummy_ohm[0],
            error=CONVERTER_DC,
        )
        for net in pins
    }


def _limit_sensor_ohm(board: BoardUnderTest) -> Limits:
    """Limit the resistance at the sensor's socket without power [ohm]."""
    # A bridge ends in the signal ground, a transimpedance stage in the tactile voltage.
    ohm = min(
        resistance_between(board.circuit, SENSOR, net) for net in (board.signal_ground, TACTILE)
    )
    return Limits(ohm, (1.0 - _SENSOR_RATIO) * ohm, (1.0 + _SENSOR_RATIO) * ohm)


def _limit_supply_ma(board: BoardUnderTest, values: BoardValues) -> Limits:
    """Limit the supply current at rest [mA], of all channels where there are several."""
    if values.shared:
        current_a = values.shared.supply_current_a
    else:
        current_a = compute_supply_current_a(board.circuit, board.rails_v[VCC])

    current_ma = 1e3 * current_a
    return Limits(current_ma, *(current_ma * ratio for ratio in CURRENT_RATIOS))


def _limit_short(ohm: float) -> Limits:
    """Limit a resistance [ohm]: below the lower limit there is a short; infinity is allowed."""
    return Limits(ohm, SHORT_RATIO * min(ohm, 10e3))


def _limit_constant(
    board: BoardUnderTest,
    net: str,
    ground: str,
    random: np.random.Generator,
    ohm: float | None = None,
    error: tuple[float, float] = METER_DC,
) -> Limits:
    """Limit a net's constant voltage above a ground, with a resistor or none for the sensor.

    Resistors and capacitors are drawn within their tolerances, offsets within their maximum, all
    uniformly.
    """
    network = build_network(
        board.circuit, board.gain_bandwidth_hz, sensor_s=1.0 / ohm if ohm else 0.0
    )
    path = network.restrict(net, *({ground} - {GND}))
    sensor: dict[str, Value] = {}
    if ohm:
        sensor["J1"] = 1.0 / ohm / (1.0 + _DUMMY_RATIO * random.uniform(-1, 1, BOARDS))

    boards = path.with_values(_draw(path, board, random) | sensor)
    volts = _constant(boards, board.rails_v, net, ground)
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
    """Return the constant voltage of a net above `ground`, for one or many boards."""
    volts = network.response(np.zeros(1), rails_v, net)[:, 0].real
    if ground not in (net, GND):
        volts = volts - network.response(np.zeros(1), rails_v, ground)[:, 0].real

    return volts


def _list_tones(board: BoardUnderTest, random: np.random.Generator) -> list[Tone]:
    """List the tones, as the sketch computes them or a meter shows them at the filter's output."""
    periods = board.stimulus.periods
    if board.is_sampled:
        places = [*((ADC_FILTERED, samples) for samples in periods), (ADC_TACTILE, periods[-1])]
    else:
        places = [(FILTERED, samples) for samples in periods[:-1]]

    tones = []
    error = CONVERTER_AC if board.is_sampled else METER_AC
    measure = tone_level if board.is_sampled else square_wave_level
    for net, samples in places:
        path = feed_tone(board.circuit, board.stimulus, board.gain_bandwidth_hz).restrict(net)
        hz = SAMPLE_HZ / samples
        parts = path.with_values(_draw(path, board, random))
        expected = TONE_V * float(measure(path, hz, net)[0])
        drawn_v = TONE_V * measure(parts, hz, net)
        tones.append(Tone(net, samples, _widen(expected, drawn_v, error)))

    return tones


def _limit_envelope(board: BoardUnderTest) -> Limits:
    """Limit the envelope's mean with the third tone from below: a half wave's, less a diode."""
    path = feed_tone(board.circuit, board.stimulus, board.gain_bandwidth_hz).restrict(FILTERED)
    rms_v = TONE_V * float(tone_level(path, board.stimulus.tones_hz[2], FILTERED)[0])
    mean_v = (math.sqrt(2.0) * rms_v - (0.0 if board.is_sampled else DIODE_V)) / math.pi

    return Limits(mean_v, _ENVELOPE_SHARE * mean_v)


def _widen(expected: float, readings: Array, error: tuple[float, float]) -> Limits:
    """Return the range of the readings, widened by the meter's error: a ratio and a constant."""
    ratio, constant = error
    low = min(expected, float(readings.min()))
    high = max(expected, float(readings.max()))
    margin = ratio * max(abs(low), abs(high)) + constant

    return Limits(expected, low - margin, high + margin)


def _draw(path: Network, board: BoardUnderTest, random: np.random.Generator) -> dict[str, Value]:
    """Draw the values of the quantities of a network on many boards, within their tolerances."""
    ratios = {
        part.reference: part.requirement.tolerance_percent / 100.0
        for part in board.circuit.components
        if part.requirement
    }
    ratios |= _TEST_PART_RATIO
    values: dict[str, Value] = {}

    for name in sorted({term.quantity for term in path.terms}):
        ratio = ratios.get(name, 0.0)
        if ratio:
            factor = 1.0 + ratio * random.uniform(-1.0, 1.0, BOARDS)
            value = path.values[name]
            # The value of a resistor is its conductance.
            values[name] = value / factor if name.startswith("R") else value * factor

    return values


def _draw_offset(
    path: Network,
    board: BoardUnderTest,
    net: str,
    ground: str,
    random: np.random.Generator,
) -> Array:
    """Draw the amplifiers' offsets on many boards, as they appear above a ground [V]."""
    transfers = path.constant_transfers(net, ground if ground != net else GND)
    offset_v = np.zeros(BOARDS)

    for output in list_amplifiers(board.circuit):
        if output.net not in transfers:
            continue

        if output.data:
            limit_v = output.data.max_offset_v
        else:
            gain_ohm = parse_component_value(board.circuit.component(GAIN_RESISTOR).value)
            limit_v = AD623_OFFSET_V * (1.0 + GAIN_CONSTANT_OHM / gain_ohm)

        offset_v += transfers[output.net] * limit_v * random.uniform(-1.0, 1.0, BOARDS)

    return offset_v
