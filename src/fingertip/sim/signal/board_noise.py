"""Noise of the board's amplifiers, so that a simulated board is as noisy as its noise budget.

Nearly all of this noise arises ahead of the filter, in the bridge's amplifier, and much of that lies beyond what the
grid holds (`fingertip.board.analysis.noise`). The simulation adds white noise at the points of the base grid to the
board's input, of the strength that makes the filter's output as noisy as the noise budget, from 0.1 Hz to 1 MHz. So the
noise ahead of the rectifier has the right strength, and with it the envelope's quiescent level, at every sampling rate.

The noise of the ADC is separate: it is added after the board's gain (`fingertip.sim.signal.converter`).
"""

from __future__ import annotations

import functools
import math

import numpy as np

from fingertip.board import board_circuit
from fingertip.board.analysis.noise import add_noise
from fingertip.board.components.component_values import select_components
from fingertip.board.nets import FILTERED
from fingertip.design import Design
from fingertip.design.amplifier_choice import find_gain_bandwidth_hz
from fingertip.sim.grid import BASE_HZ
from fingertip.sim.signal.analog_circuit import AnalogBoard
from fingertip.sim.signal.filter_board import simulate_board

_MEMORY_S = 0.1
"""Time in which the filter forgets an impulse at a cutoff of 67 Hz [s]: seven periods."""
_SMALL_V = 1e-6
"""Impulse too small for the diode to conduct [V]."""


@functools.lru_cache(maxsize=256)
def compute_input_noise_v(design: Design) -> float:
    """Compute the white RMS noise at the board's input, on the base grid, that stands for its amplifiers' noise [V]."""
    circuit = board_circuit(select_components(design))
    return add_noise(circuit, find_gain_bandwidth_hz(design.board)).total_v(FILTERED) / compute_noise_gain(design)


def compute_noise_gain(design: Design) -> float:
    """Compute the standard deviation at the filter's output for white noise of deviation 1 on the base grid."""
    impulse = np.zeros(2 + round(_MEMORY_S * BASE_HZ * 67.0 / design.board.cutoff_hz))
    impulse[1] = _SMALL_V
    h = simulate_board(AnalogBoard.from_design(design), 1 / BASE_HZ, impulse).filtered_v / _SMALL_V
    return math.sqrt(float(h @ h))
