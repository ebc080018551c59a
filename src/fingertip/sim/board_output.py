"""The design's board on a recorded voltage or force, as its converter samples it; and what noise leaves there."""

from __future__ import annotations

import math
import random

import numpy as np
from numpy.typing import NDArray

from fingertip.board import board_values
from fingertip.design import Design
from fingertip.sim import analog, fsr
from fingertip.sim.circuit import Analog
from fingertip.slip.noise import NoiseLevel, input_noise_v, quiet_level

Array = NDArray[np.float64]

_MEMORY_S = 0.1
_WINDOWS = 133
"""Windows of noise through the board: the deviation is known to 6 %."""


def envelope_v(design: Design, voltage_v: Array) -> Array:
    """The board's enveloped output, sampled [V], for its sampled input [V], between whose samples it is linear.

    Raises
    ------
    TraceError
        If a sample is not finite.
    """
    return _enveloped_v(Analog.of(design), design, voltage_v)


def _enveloped_v(board: Analog, design: Design, voltage_v: Array) -> Array:
    d = design.detector
    enveloped = analog.respond(board, 1 / d.sample_rate_hz, voltage_v).envelope_v
    return fsr.quantise(enveloped, d.adc_bits, d.adc_range_v)


class BoardStream:
    """The boards of some fingers, on voltages that come in chunks of at least one sample.

    Each chunk is simulated anew from 0.1 s before it: by then filters and envelope have forgotten what was before (a
    test compares with the whole trace at once). So the fingers' stretches can stand one behind the other in one
    simulation, though the voltage jumps between them: making a board's matrices takes longer than running them.
    """

    def __init__(self, design: Design) -> None:
        self._design, self._board = design, Analog.of(design)
        self._keep = math.ceil(_MEMORY_S * design.detector.sample_rate_hz)
        self._past: Array | None = None

    def process(self, voltage_v: Array) -> Array:
        """The enveloped outputs at the chunk's samples [V], (fingers, samples) like the voltages [V]."""
        if self._past is None:  # settled on the first sample
            self._past = np.repeat(voltage_v[:, :1], self._keep, axis=1)
        known = np.concatenate((self._past, voltage_v), axis=1)
        self._past = known[:, -self._keep :]
        return _enveloped_v(self._board, self._design, known.ravel()).reshape(known.shape)[:, self._keep :]


def bridge_v(design: Design, force_n: Array) -> Array:
    """What the design's sensor and bridge make of a normal force [N], without the sensor's hysteresis [V]."""
    values, supply, sensor = board_values(design).bridge, design.board.supply_v, fsr.fit_conductance()
    return np.array([values.tactile_v(sensor.siemens(force), supply) for force in force_n.tolist()])


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
