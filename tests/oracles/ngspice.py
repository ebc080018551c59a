"""Oracle: the article's filter and envelope in ngspice, driven by a sampled voltage."""

from __future__ import annotations

from pathlib import Path

from fingertip.arrays import Array
from fingertip.sim.bench.spice import Spice, sampled_source
from fingertip.sim.signal.analog_circuit import AnalogBoard


def simulate_with_ngspice(
    program: Path, folder: Path, board: AnalogBoard, step_s: float, voltage_v: Array, reltol: float, longest_s: float
) -> tuple[Array, Array]:
    """Filtered voltage and envelope at the samples [V]."""
    write_deck(folder, board, step_s, voltage_v, reltol, longest_s)
    run_deck(program, folder)
    return read_result(folder, step_s, len(voltage_v))
