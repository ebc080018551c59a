"""The design's board on a recorded voltage or force, as its converter samples it; and what noise leaves there."""

from __future__ import annotations

import random

import numpy as np
from numpy.typing import NDArray

from fingertip.design import Design
from fingertip.sim.electronics import analog, fsr
from fingertip.sim.electronics.circuit import Analog
from fingertip.sim.electronics.sensing import voltage_of
from fingertip.slip.noise import NoiseLevel, input_noise_v, quiet_level

Array = NDArray[np.float64]

_WINDOWS = 133
"""Windows of noise through the board: the deviation is known to 6 %."""


def envelope_v(design: Design, voltage_v: Array) -> Array:
    """The board's enveloped output, sampled [V], for its sampled input [V], between whose samples it is linear.

    Raises
    ------
    TraceError
        If a sample is not finite.
    """
    d = design.detector
    enveloped = analog.respond(Analog.of(design), 1 / d.sample_rate_hz, voltage_v).envelope_v
    return fsr.quantise(enveloped, d.adc_bits, d.adc_range_v)


class BoardStream:
    """The boards of some fingers, on voltages that come in chunks; any chunks give the same bits as the whole."""

    def __init__(self, design: Design) -> None:
        self._design = design
        self._stream: analog.Stream | None = None

    def process(self, voltage_v: Array) -> Array:
        """The enveloped outputs at the chunk's samples [V], (fingers, samples) like the voltages [V]."""
        d = self._design.detector
        if self._stream is None:
            self._stream = analog.Stream(Analog.of(self._design), 1 / d.sample_rate_hz, len(voltage_v))
        return fsr.quantise(self._stream.process(voltage_v)[1], d.adc_bits, d.adc_range_v)


def bridge_v(design: Design, force_n: Array) -> Array:
    """What the design's sensor and bridge make of a normal force [N], without the sensor's hysteresis [V]."""
    voltage = voltage_of(design, "board")
    return np.array([voltage(force) for force in force_n.tolist()])


def noise_level(design: Design, noise_v: float | None = None) -> NoiseLevel:
    """Mean and deviation of the detector `paper`'s window in noise alone, measured on the simulated board.

    The threshold that follows is at least one step of the converter: a diode without bias passes so little noise that
    the converter shows none.

    Parameters
    ----------
    design
        Its board, window and converter.
    noise_v
        White noise of the board's input, rms [V]; without it, the design's.
    """
    d = design.detector
    sigma = input_noise_v(design) if noise_v is None else noise_v
    settling = round(0.1 * d.sample_rate_hz)
    rng = random.Random(0)
    noise = np.array([rng.gauss(0.0, sigma) for _ in range(_WINDOWS * d.window_samples + settling)])
    sampled = envelope_v(design, noise)
    return quiet_level(sampled[settling:], design, "simulated noise")
