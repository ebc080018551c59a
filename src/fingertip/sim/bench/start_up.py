"""CPU time until each solver is ready for its first problem; it is part of no point of the diagrams."""

from __future__ import annotations

import subprocess
import sys

from fingertip.design import Design
from fingertip.sim.bench import spice
from fingertip.sim.bench.board import STEP_S, BoardProblem
from fingertip.sim.bench.cvode import CvodeLibrary
from fingertip.sim.bench.spice import Spice
from fingertip.sim.signal.analog_circuit import AnalogBoard

_PROCESS = """
import time
{imports}
print(time.process_time())
"""
_LOAD_LOOPS = """
from fingertip.foundation.jit import compiled
from fingertip.sim.bench.board import BoardProblem
from fingertip.sim.bench.contact import ContactProblem
from fingertip.design import Design
from fingertip.sim.signal.analog_circuit import AnalogBoard
with compiled():
    ContactProblem.over(1.0).run_fingertip(1e-3)
    BoardProblem(AnalogBoard.from_design(Design()), 0.5).run_fingertip(1e-3)
"""


def measure_start_up(peers: tuple[str, ...], cvode: CvodeLibrary | str) -> dict[str, float]:
    """Measure the CPU time of each solver's start-up [s], with filled caches.

    fingertip and scipy start in a fresh process of Python. CVODE's programs are compiled, and ngspice reads a deck.
    """
    found = {"fingertip: process, imports, and loading both compiled loops": _time_process(_LOAD_LOOPS)}
    if set(peers) - {"CVODE", "ngspice"}:
        found["scipy: process and import, without the compilation of the equations"] = _time_process(
            "import scipy.integrate"
        )
    if isinstance(cvode, CvodeLibrary):
        found["CVODE: compilation of both problems"] = cvode.compilation_s
    if "ngspice" in peers and (program := spice.find_program()):
        board = AnalogBoard.from_design(Design())
        problem = BoardProblem(board, 1.0)
        source = spice.sampled_source(STEP_S, problem.voltage_v)
        simulator = Spice(program, board, source, STEP_S, problem.seconds)
        found["ngspice: process and reading a deck of 2001 samples"] = simulator.measure_start_up_s()
    return found


def _time_process(imports: str) -> float:
    """CPU time of a fresh process [s]; the second of two, so that caches are filled."""
    code = _PROCESS.format(imports=imports)
    runs = [subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True) for _ in range(2)]
    return float(runs[-1].stdout)
