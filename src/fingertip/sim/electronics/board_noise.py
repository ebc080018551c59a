"""What the board's amplifiers add to its signals, so that a simulated board is as noisy as the real one is said to be.

Nearly all of it arises ahead of the filter, in the bridge's amplifier, and nearly all of that lies above what samples
can show (`fingertip.board.analysis.noise`). It is put into the board's input as white noise of the samples, as strong
as makes the filter's output as noisy as the noise budget says, from 0.1 Hz to 1 MHz. So its strength ahead of the
rectifier is right, and with it where the envelope rests; within the band of slip it is stronger than it would be, at
2 kHz 1.6 times on a board with a low-pass in its first stage and four times on one without, where a bare diode hides
it.

The converter's noise is another matter: it comes behind the board's gain, or with no gain at all
(`fingertip.sim.electronics.converter`).
"""

from __future__ import annotations

import functools
import math

import numpy as np

from fingertip.board import board_circuit, board_values
from fingertip.board.analysis.noise import total_v
from fingertip.board.nets import FILTERED
from fingertip.design import Design
from fingertip.sim.electronics.analog import respond
from fingertip.sim.electronics.circuit import Analog

_MEMORY_S = 0.1
"""After which the filter has forgotten an impulse, in periods of 67 Hz: seven."""
_SMALL_V = 1e-6
"""An impulse that no diode notices."""


@functools.lru_cache(maxsize=256)
def input_noise_v(design: Design) -> float:
    """White noise of the samples at the board's input that stands for its amplifiers', rms [V]."""
    return total_v(board_circuit(board_values(design)), design.board.gain_bandwidth_hz, FILTERED) / gain(design)


def gain(design: Design) -> float:
    """Deviation at the filter's output for white samples of deviation 1 at the board's input."""
    rate, cutoff = design.detector.sample_rate_hz, design.board.cutoff_hz
    impulse = np.zeros(2 + round(_MEMORY_S * rate * 67.0 / cutoff))
    impulse[1] = _SMALL_V
    h = respond(Analog.of(design), 1 / rate, impulse).filtered_v / _SMALL_V
    return math.sqrt(float(h @ h))
