"""Oracle: the article's filter and envelope in ngspice, driven by a sampled voltage."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from benchmarks.peers.spice import Spice, sampled_source
from fingertip.foundation.numerics import Array
from fingertip.sim.signal.analog_circuit import AnalogBoard


def simulate_with_ngspice(
    program: Path, board: AnalogBoard, step_s: float, voltage_v: Array, reltol: float, longest_s: float
) -> tuple[Array, Array]:
    """Filtered voltage and envelope at the samples [V], where ngspice has time points."""
    time = np.arange(len(voltage_v)) * step_s
    simulator = Spice(program, board, sampled_source(step_s, voltage_v), step_s, float(time[-1]))
    found, filtered, envelope = simulator.simulate(reltol, longest_s)
    return np.interp(time, found, filtered), np.interp(time, found, envelope)
