"""The bench: what replaces the sensor while a board is brought up, and the tone that is fed in.

A resistor in place of the sensor stands for a force, the same on every day. The tone of a phone or a generator reaches
the bridge through a capacitor and a large resistor, so that some millivolts at TACTILE result, as from a slip.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from fingertip.board.circuit import Circuit, Component, Net
from fingertip.board.components.bridge import ARTICLE_POINTS, sensor_conductance_s
from fingertip.board.components.preferred_values import nearest_value
from fingertip.board.kicad.symbols import C_0603, CAPACITOR, R_0603, RESISTOR
from fingertip.board.nets import FILTERED, SENSOR
from fingertip.board.network import build_network

TONE = "TONE"
"""Net that the generator drives, above ground."""
_MIDDLE = "TONE_MIDDLE"
COUPLING_OHM, COUPLING_F = "R99", "C99"
COUPLING_FARAD = 100e-9
TONE_V = 0.3
"""Tone of the generator, RMS [V]: what the headphone output of a phone gives without distortion."""
_SWING_SHARE = 0.45
"""Peak of the filtered tone as a share of the filter's swing: well above a meter's error, well below clipping."""
_TONE_RATIOS = (0.6, 1.0, 2.0)
"""Frequencies of the tone as multiples of the cutoff: well below, at, and well above it."""


@dataclass(frozen=True)
class Bench:
    """Parts and tones for the tests of one board."""

    dummy_ohm: tuple[float, float]
    """Resistors in place of the sensor: for the lighter and the firmer of two forces."""
    coupling_ohm: float
    """Resistor between generator and sensor connector, in series with `COUPLING_FARAD`."""
    tones_hz: tuple[float, float, float]
    """Frequencies of the tone, rising."""


def set_up_bench(circuit: Circuit, gain_bandwidth_hz: float, cutoff_hz: float, swing_v: float) -> Bench:
    """Select parts and tones for a board.

    Parameters
    ----------
    circuit
        Circuit of the board.
    gain_bandwidth_hz
        Gain-bandwidth product of its amplifiers [Hz].
    cutoff_hz
        Cutoff of the design.
    swing_v
        Smaller swing of the filter's output from the signal ground [V].
    """
    # Values of E24 are in any kit of resistors; the expected readings follow from the values that are used.
    light_ohm, firm_ohm = (
        nearest_value(1.0 / sensor_conductance_s(force_n), "E24") for force_n, _ in ARTICLE_POINTS[1:]
    )
    low, middle, high = (float(round(ratio * cutoff_hz)) or cutoff_hz for ratio in _TONE_RATIOS)
    # The current into the bridge is the tone over this resistor, which is far larger than the bridge.
    trial = Bench((light_ohm, firm_ohm), 1e6, (low, middle, high))
    network = build_network(connect_tone(circuit, trial), gain_bandwidth_hz, sensor_s=1.0 / light_ohm)
    gain = abs(network.drive(TONE).restrict(FILTERED).response(np.array([high]), {TONE: 1.0}, FILTERED)[0, 0])
    wanted = _SWING_SHARE * swing_v / (math.sqrt(2.0) * TONE_V)
    return replace(trial, coupling_ohm=nearest_value(trial.coupling_ohm * gain / wanted, "E24"))


def connect_tone(circuit: Circuit, bench: Bench) -> Circuit:
    """Connect the generator to the sensor's pin, through the coupling parts."""
    resistor = Component(
        COUPLING_OHM, f"{bench.coupling_ohm:.10g}", RESISTOR, R_0603, "test: from the generator to the sensor"
    )
    capacitor = Component(COUPLING_F, f"{COUPLING_FARAD:.10g}", CAPACITOR, C_0603, "test: blocks direct current")
    nets = [Net(net.name, (*net.nodes, (COUPLING_OHM, "2"))) if net.name == SENSOR else net for net in circuit.nets]
    nets += [Net(_MIDDLE, ((COUPLING_OHM, "1"), (COUPLING_F, "2"))), Net(TONE, ((COUPLING_F, "1"),))]
    return Circuit(circuit.name, (*circuit.components, resistor, capacitor), tuple(nets))
