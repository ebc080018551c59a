"""Plan of a bring-up: every reading in the order in which it is taken, with its limits."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from fingertip.board.board_values import BoardValues
from fingertip.board.bringup.bench import TONE_V
from fingertip.board.bringup.limits import METER_AC, Limits, compute_limits
from fingertip.board.bringup.pins import HOST, has_tone, list_output_pins
from fingertip.board.bringup.prediction import Board, list_levels, name_tone, name_voltage
from fingertip.board.bringup.unpowered import CURRENT_RATIOS, SHORT_RATIO, resistance_between, supply_current_a
from fingertip.board.bringup.wiring import list_pins
from fingertip.board.circuits.signal_paths import RECT_OUT
from fingertip.board.nets import ENVELOPE, GND, SENSOR, TACTILE, VCC, VEE
from fingertip.output_set import hash_parameters

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
