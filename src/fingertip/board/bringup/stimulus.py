"""Stimulus of a bring-up: resistors in place of the sensor, and a tone from a controller's pin.

A resistor in place of the sensor stands for a force, the same on every day. A pin of the controller
that switches between 0 and its supply reaches the sensor's socket through a capacitor and a large
resistor, so that some millivolts at TACTILE result, as from a slip. Its fundamental and its odd
harmonics are known exactly.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from fingertip.board.circuits.network import Network, build_network
from fingertip.board.components.front_end import ARTICLE_POINTS, sensor_conductance_s
from fingertip.board.components.selection import nearest_value
from fingertip.board.parts import nets
from fingertip.board.parts.circuit import Circuit, Component
from fingertip.board.parts.symbols import C_0603, CAPACITOR, R_0603, RESISTOR
from fingertip.foundation.numerics import Array

TONE = "TONE"
"""Net that the controller's pin drives, above ground."""
COUPLING_OHM = "R99"
COUPLING_F = "C99"
COUPLING_FARAD = 100e-9
TONE_PIN = 4
"""Pin that is neither A0 nor A1 of a listed controller: GPIO2 of an ESP32-S3 is A1."""
PIN_V = 3.3
"""Supply of the controller, between which and 0 its pin switches [V]."""
TONE_V = math.sqrt(2.0) / math.pi * PIN_V
"""RMS of the fundamental of a square wave between 0 and that [V]."""
SAMPLE_HZ = 6000
"""Samples per second of the sketch. A period of each tone takes an even number of them."""
HARMONICS = tuple(range(1, 32, 2))
"""Harmonics that a meter sees; further ones add less than 0.1 %."""
_SWING_SHARE = 0.5
"""Peak of the filtered fundamental over the filter's swing; a square wave's edges add half."""
_TONE_RATIOS = (0.6, 1.0, 2.0)
"""Frequencies of the tone as multiples of the cutoff: well below, at, and well above it."""
_TOP_SAMPLES = 6
"""Samples in a period of the highest tone, beyond the poles of C20, C25, C9 and C19."""


@dataclass(frozen=True)
class Stimulus:
    """Resistors and tones with which a board is tested instead of a sensor."""

    dummy_ohm: tuple[float, float]
    """Resistors in place of the sensor: for the lighter and the firmer of two forces."""
    coupling_ohm: float
    """Resistor from the controller's pin to the sensor's socket, in series with `COUPLING_FARAD`.
    """
    periods: tuple[int, ...]
    """Samples in a period of each tone; the frequency rises."""

    @property
    def tones_hz(self) -> tuple[float, ...]:
        return tuple(SAMPLE_HZ / samples for samples in self.periods)


def choose_stimulus(
    circuit: Circuit, gain_bandwidth_hz: float, cutoff_hz: float, swing_v: float
) -> Stimulus:
    """Choose the stimulus of a board whose filter can swing by `swing_v` [V]."""
    # Values of E24 are in any kit of resistors; the expected readings follow from the values that
    # are used.
    light_ohm, firm_ohm = (
        nearest_value(1.0 / sensor_conductance_s(force_n), "E24")
        for force_n, _ in ARTICLE_POINTS[1:]
    )
    periods = (
        2 * max(round(SAMPLE_HZ / (2.0 * ratio * cutoff_hz)), _TOP_SAMPLES // 2)
        for ratio in _TONE_RATIOS
    )
    # The current into the socket is the tone over this resistor, which is far larger than what it
    # meets there.
    trial = Stimulus((light_ohm, firm_ohm), 1e6, (*periods, _TOP_SAMPLES))
    path = feed_tone(circuit, trial, gain_bandwidth_hz).restrict(nets.FILTERED)
    gain = float(tone_level(path, trial.tones_hz[2], nets.FILTERED)[0])
    target_gain = _SWING_SHARE * swing_v / (math.sqrt(2.0) * TONE_V)

    return replace(
        trial, coupling_ohm=nearest_value(trial.coupling_ohm * gain / target_gain, "E24")
    )


def feed_tone(circuit: Circuit, stimulus: Stimulus, gain_bandwidth_hz: float) -> Network:
    """Return the network with the tone at the sensor's pin, and the lighter resistor."""
    resistor = Component(
        reference=COUPLING_OHM,
        value=f"{stimulus.coupling_ohm:.10g}",
        symbol=RESISTOR,
        footprint=R_0603,
        role="test: from the controller's pin to the sensor",
    )
    capacitor = Component(
        reference=COUPLING_F,
        value=f"{COUPLING_FARAD:.10g}",
        symbol=CAPACITOR,
        footprint=C_0603,
        role="test: blocks direct current",
    )
    middle = "TONE_MIDDLE"
    with_tone = circuit.connect(resistor, {"1": middle, "2": nets.SENSOR}).connect(
        capacitor, {"1": TONE, "2": middle}
    )

    return build_network(with_tone, gain_bandwidth_hz, sensor_s=1.0 / stimulus.dummy_ohm[0]).drive(
        TONE
    )


def tone_level(network: Network, hz: float, net: str) -> Array:
    """Return the magnitude of a net's voltage for 1 V of the tone, of one or of many boards."""
    return np.abs(network.response(np.array([hz]), {TONE: 1.0}, net)[:, 0])


def square_wave_level(network: Network, hz: float, net: str) -> Array:
    """Return a net's RMS voltage with all harmonics, for a square wave of 1 V fundamental."""
    squares = [(tone_level(network, k * hz, net) / k) ** 2 for k in HARMONICS]
    return np.asarray(np.sqrt(np.sum(squares, axis=0)))
