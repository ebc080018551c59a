"""The design's board on a recorded voltage or force, as its converter samples it; and what noise leaves there."""

from __future__ import annotations

import random

import numpy as np

from fingertip.arrays import Array
from fingertip.design import Design
from fingertip.sim.electronics import analog
from fingertip.sim.electronics.anti_alias import Poles
from fingertip.sim.electronics.board_noise import input_noise_v as board_noise_v
from fingertip.sim.electronics.circuit import Analog
from fingertip.sim.electronics.converter import noise_v, sampled_v
from fingertip.sim.electronics.sensing import voltage_of
from fingertip.slip.detectors.noise import NoiseLevel, input_noise_v, measure_noise_level

_WINDOWS = 133
"""Windows of noise through the board: the deviation is known to 6 %."""


def envelope_v(design: Design, voltage_v: Array) -> Array:
    """The board's enveloped output, sampled [V], for its sampled input [V], between whose samples it is linear.

    A recording has passed the tactile voltage's poles (`fingertip.sim.electronics.anti_alias`), which the real board's
    filter has not: the envelope comes out some 3 % low at 2 kHz, 12 % at 1 kHz.

    Raises
    ------
    TraceError
        If a sample is not finite.
    """
    enveloped = analog.respond(Analog.of(design), 1 / design.detector.sample_rate_hz, voltage_v).envelope_v
    return sampled_v(design, Poles.envelope(design).process(enveloped), None)


class BoardStream:
    """The boards of some fingers, on voltages that come in chunks; any chunks give the same bits as the whole."""

    def __init__(self, design: Design) -> None:
        self._design = design
        self._stream: analog.Stream | None = None
        self._poles: list[Poles] = []

    def process(self, voltage_v: Array) -> Array:
        """The enveloped outputs at the chunk's samples [V], (fingers, samples) like the voltages [V]."""
        if self._stream is None:
            step_s = 1 / self._design.detector.sample_rate_hz
            self._stream = analog.Stream(Analog.of(self._design), step_s, len(voltage_v))
            self._poles = [Poles.envelope(self._design) for _ in voltage_v]
        enveloped = self._stream.process(voltage_v)[1]
        at_pins = np.stack([poles.process(v) for poles, v in zip(self._poles, enveloped, strict=True)])
        return sampled_v(self._design, at_pins, None)


def bridge_v(design: Design, force_n: Array) -> Array:
    """What the design's sensor and bridge make of a normal force [N], without the sensor's hysteresis [V]."""
    voltage = voltage_of(design, "board")
    return np.array([voltage(force) for force in force_n.tolist()])


def rest_level(design: Design) -> NoiseLevel:
    """Mean and deviation of the detector `analog`'s window behind the design's board while nothing happens: noise of the
    board's amplifiers ahead of the filter, of the converter behind it."""
    return _level(design, board_noise_v(design), random.Random("converter"))


def replayed_level(design: Design) -> NoiseLevel:
    """The same where the board is simulated on a recorded voltage, whose noise is the converter's already."""
    return _level(design, input_noise_v(design), None)


def _level(design: Design, sigma_v: float, converter: random.Random | None) -> NoiseLevel:
    """Measured on the simulated board. The threshold that follows is at least one step of the converter: a diode
    without bias passes so little noise that the converter shows none."""
    d = design.detector
    settling = round(0.1 * d.sample_rate_hz)
    noise = noise_v(random.Random(0), sigma_v, _WINDOWS * d.window_samples + settling)
    enveloped = analog.respond(Analog.of(design), 1 / d.sample_rate_hz, noise).envelope_v
    at_pin = Poles.envelope(design).process(enveloped)
    return measure_noise_level(sampled_v(design, at_pin, converter)[settling:], design, "simulated noise")
