"""Readings of a board with or without a fault: constant voltages, levels of the tone, and the envelope.

All voltages are above the signal ground (TP5), so that its own error does not hide others; it is measured too.

Up to FILTERED the circuit is linear, and the network gives the readings. An amplifier whose output would leave its
swing holds the end of it, and no tone passes. Behind FILTERED, on boards with an envelope, `rectifier` steps through
time.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fingertip.board.analysis.limits import OUTPUT_LOWER_MARGIN_V, OUTPUT_UPPER_MARGIN_V
from fingertip.board.bringup import bench
from fingertip.board.bringup.bench import Bench, Fault
from fingertip.board.bringup.rectifier import Drive, measure_voltages
from fingertip.board.circuits.network import Network, build_network, list_amplifiers
from fingertip.board.components.values import SUPPLIES
from fingertip.board.parts import nets
from fingertip.board.parts.circuit import Circuit
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import find_gain_bandwidth_hz
from fingertip.foundation.numerics import Array
from fingertip.foundation.tables import read_rows

_MAX_SATURATED = 8
_TONE_END = "hz_v"
_PATH = (nets.VMID, nets.TACTILE, nets.STAGE1_OUT, nets.FILTERED)
PROBES = {row["net"]: row for row in read_rows(Path(__file__).with_name("points.csv"))}
POINTS = {net: row["point"] for net, row in PROBES.items()}
"""Test point or part at which each net is measured. A test compares them with the circuits."""
_SINE = np.sin(2.0 * math.pi * (np.arange(256) + 0.5) / 256)


@dataclass(frozen=True)
class Limits:
    """Expected reading of a board without a fault [V]."""

    expected_v: float
    low_v: float
    high_v: float

    def allow(self, reading: float) -> bool:
        return self.low_v <= reading <= self.high_v


def find_failed(limits: Mapping[str, Limits], readings: Mapping[str, float]) -> list[str]:
    return [name for name, reading in readings.items() if not limits[name].allow(reading)]


@dataclass(frozen=True)
class Board:
    """Board with its bench: all that its readings depend on."""

    circuit: Circuit
    bench: Bench
    rails_v: Mapping[str, float]
    signal_ground: str
    swing_v: tuple[float, float]
    """Ends of the swing of an amplifier's output above ground [V]."""
    gain_bandwidth_hz: float

    @property
    def nets(self) -> tuple[str, ...]:
        """Nets whose constant voltage is measured."""
        known = {net.name for net in self.circuit.nets}
        return tuple(n for n in POINTS if n in known and n not in (nets.STAGE2_MID, nets.RECT_OUT))

    @property
    def has_envelope(self) -> bool:
        return nets.ENVELOPE in self.nets

    @classmethod
    def of_design(cls, design: Design, circuit: Circuit) -> Board:
        supply, supply_v = SUPPLIES[design.board.variant], design.board.supply_v
        rails = {nets.GND: 0.0, nets.VCC: supply_v, nets.VEE: -supply_v}
        margin_v = max(output.data.output_from_rail_v for output in list_amplifiers(circuit) if output.data)
        low, high = rails[supply.negative_rail] + margin_v, supply_v - margin_v
        ground_v = supply.signal_ground_v(supply_v)
        bandwidth = find_gain_bandwidth_hz(design.board)
        setup = bench.set_up_bench(circuit, bandwidth, design.board.cutoff_hz, min(high - ground_v, ground_v - low))
        return cls(circuit, setup, rails, supply.signal_ground, (low, high), bandwidth)

    @property
    def ends_v(self) -> dict[str, tuple[float, float]]:
        """Ends of the swing of each measured output of an amplifier [V], by its net."""
        return {
            a.net: self.swing_of(a.amplifier)
            for a in list_amplifiers(self.circuit)
            if a.net in POINTS and a.net != nets.RECT_OUT
        }

    def swing_of(self, amplifier: str) -> tuple[float, float]:
        if amplifier != "U2":  # the AD623; units of a dual amplifier have a letter
            return self.swing_v
        return self.rails_v[nets.VEE] + OUTPUT_LOWER_MARGIN_V, self.rails_v[nets.VCC] - OUTPUT_UPPER_MARGIN_V


def predict(board: Board, faults: Sequence[Fault], *tones_v: float) -> list[dict[str, float]]:
    """Predict the readings of boards that each have one fault, by the reading's name."""
    readings: list[dict[str, float]] = []
    drives: list[Drive] = []
    tones = tones_v if len(tones_v) > 1 else (tones_v or (bench.TONE_V,)) * len(faults)
    for fault, tone_v in zip(faults, tones, strict=True):
        values, levels = _predict_linear(board, fault, tone_v)
        readings.append(values)
        drives += levels
    if board.has_envelope:
        _add_envelope(board, faults, readings, drives)
    for i, values in enumerate(readings):
        # The pins of J3 are above supply ground, the other readings above signal ground.
        middle_v = values[name_voltage(nets.VMID)] if board.signal_ground == nets.VMID else 0.0
        sources_v = {
            pin.source: values[name_voltage(pin.source)] + (0.0 if pin.source == nets.VMID else middle_v)
            for pin in bench.list_output_pins(faults[i].circuit)
        }
        values |= bench.predict_constants(faults[i].circuit, {**board.rails_v, **sources_v})
    return readings


def _add_envelope(
    board: Board, faults: Sequence[Fault], readings: Sequence[dict[str, float]], drives: Sequence[Drive]
) -> None:
    """Add the readings behind the rectifier, quiet and with the tone."""
    hz = board.bench.tones_hz[-1]
    means, ripple = measure_voltages(drives, board.swing_v, board.gain_bandwidth_hz, hz)
    for i, values in enumerate(readings):
        ground_v = drives[2 * i].given_v[board.signal_ground]
        stuck = faults[i].stuck_v.get(nets.ENVELOPE)
        quiet, loud = means[nets.ENVELOPE][2 * i : 2 * i + 2] if stuck is None else (stuck, stuck)
        values[name_voltage(nets.ENVELOPE)] = float(quiet) - ground_v
        values[name_tone(nets.ENVELOPE, hz)] = float(loud) - ground_v
        values[name_ripple(hz)] = float(ripple[2 * i + 1]) if stuck is None else 0.0
        if nets.RECT_OUT in means:
            values[name_tone(nets.RECT_OUT, hz)] = float(means[nets.RECT_OUT][2 * i + 1]) - ground_v


def name_voltage(net: str, ohm: float | None = None) -> str:
    """Name of the reading of a constant voltage, with the sensor open or a resistor in its place."""
    return f"{POINTS[net].lower()}_{'open' if ohm is None else f'{ohm:.0f}ohm'}_v"


def name_tone(net: str, hz: float) -> str:
    """Name of a reading while the tone sounds: RMS of the alternating part, or the envelope's mean."""
    return f"{POINTS[net].lower()}_{hz:.0f}{_TONE_END}"


def name_ripple(hz: float) -> str:
    """Name of the reading of the envelope's alternating part while the tone sounds."""
    return f"{POINTS[nets.ENVELOPE].lower()}ac_{hz:.0f}{_TONE_END}"


def is_tone(name: str) -> bool:
    return name.endswith(_TONE_END)


def list_levels(setup: Bench) -> tuple[tuple[str, float], ...]:
    """Nets and frequencies [Hz] at which the tone is measured."""
    low, middle, high = setup.tones_hz
    return (
        (nets.FILTERED, low), (nets.FILTERED, middle), (nets.FILTERED, high), (nets.STAGE1_OUT, middle),
        (nets.STAGE2_MID, low), (nets.STAGE2_MID, middle), (nets.STAGE2_MID, high),
    )  # fmt: skip


def _predict_linear(board: Board, fault: Fault, tone_v: float) -> tuple[dict[str, float], tuple[Drive, Drive]]:
    """Readings up to the filter's output, and what drives the rectifier: nothing but a level, and the tone."""
    measured = tuple(net for net in board.nets if net != nets.ENVELOPE)
    volts, _ = solve_constant(board, fault, 0.0, measured)
    ground = board.signal_ground
    values = {name_voltage(net): volts[net] - (volts[ground] if net != ground else 0.0) for net in measured}
    for ohm in reversed(board.bench.dummy_ohm):
        volts, held = solve_constant(board, fault, 1.0 / ohm, measured)
        values[name_voltage(nets.TACTILE, ohm)] = volts[nets.TACTILE] - volts[ground]
    network = bench.feed_tone(fault.circuit, board.bench, board.gain_bandwidth_hz)
    path = network.ground(*held).restrict(*(net for net, _ in list_levels(board.bench) if net not in held))

    def peak_v(net: str, hz: float) -> float:
        return math.sqrt(2.0) * tone_v * float(batch_level(path, hz, net)[0]) if net in path.nets else 0.0

    peaks_v = {(net, hz): peak_v(net, hz) for net, hz in list_levels(board.bench)}
    for (net, hz), peak in peaks_v.items():
        values[name_tone(net, hz)] = _clipped_rms(volts.get(net, 0.0), peak, board.swing_v)
    if ratios := bench.attenuate_tones(fault.circuit):
        rms = _clipped_rms(volts[nets.FILTERED], peak_v(nets.FILTERED, bench.TOP_HZ), board.swing_v)
        values |= {name: ratio * rms for name, ratio in ratios.items()}
    level = volts[nets.FILTERED]
    given = {name: v for name, v in board.rails_v.items() if name != nets.VEE or board.signal_ground == nets.GND}
    if board.signal_ground == nets.VMID:
        given[nets.VMID] = volts[nets.VMID]
    low, high = board.swing_v
    peak = min(peaks_v[nets.FILTERED, board.bench.tones_hz[-1]], high - low)
    return values, (Drive(fault.circuit, level, 0.0, given), Drive(fault.circuit, level, peak, given))


def solve_constant(
    board: Board, fault: Fault, sensor_s: float, measured: Sequence[str]
) -> tuple[dict[str, float], Mapping[str, float]]:
    """Constant voltages [V], and the outputs among them that are held at an end of their swing."""
    network = build_network(fault.circuit, board.gain_bandwidth_hz, sensor_s=sensor_s)
    outputs = tuple(list_amplifiers(fault.circuit))
    held = dict(fault.stuck_v)
    while True:
        wanted = [net for net in measured if net not in held]
        path = network.drive(*(net for net in held if net not in network.inputs)).restrict(*wanted)
        volts = path.operating_point({**board.rails_v, **held}) | held
        beyond: dict[str, float] = {}
        for output in outputs:
            low, high = board.swing_of(output.amplifier)
            if output.net in volts and output.net not in held and not low <= volts[output.net] <= high:
                beyond[output.net] = min(max(volts[output.net], low), high)
        if not beyond or len(held) > _MAX_SATURATED:
            return volts, held
        # The first amplifier along the path saturates; those behind it may be within their swing then.
        first = min(beyond, key=lambda net: _PATH.index(net) if net in _PATH else len(_PATH))
        held[first] = beyond[first]


def _clipped_rms(level: float, peak: float, swing_v: tuple[float, float]) -> float:
    """RMS of a tone's alternating part [V], clipped at the ends of the output's swing."""
    return float(np.std(np.clip(level + peak * _SINE, *swing_v)))


def batch_constant(network: Network, rails_v: Mapping[str, float], net: str, ground: str) -> Array:
    """Constant voltage of a net above the signal ground, or of that above ground, for many boards at once [V]."""
    volts = network.response(np.zeros(1), rails_v, net)[:, 0].real
    if ground not in (net, nets.GND):
        volts = volts - network.response(np.zeros(1), rails_v, ground)[:, 0].real
    return volts


def batch_level(network: Network, hz: float, net: str) -> Array:
    """Magnitude of a net's voltage for 1 V of the tone, for one or many boards at once."""
    return np.abs(network.response(np.array([hz]), {bench.TONE: 1.0}, net)[:, 0])
