"""Run time of the board's calculations: 10 000 boards, the joint searches, and the whole command in
a fresh process.

    python -m benchmarks.board_montecarlo [runs]

Times are processor time. The targets are multiples of a fixed piece of work that is measured in the
same run (`benchmarks.yardstick`): 1 for 10 000 boards, 0.8 for each search, and 8 for the command.
"""

from __future__ import annotations

import platform
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable

from benchmarks.yardstick import measure_yardstick_s
from fingertip.board.analysis.board_values import board_values
from fingertip.board.analysis.response import model_filter
from fingertip.board.analysis.tolerance import TolerancedFilter, component_tolerances, monte_carlo
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.circuits.network import build_network
from fingertip.board.components.selection import choose_jointly, select_filter_capacitor
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import find_gain_bandwidth_hz
from fingertip.design.parameters.board_and_detector import Board


def timed(action: Callable[[], object], runs: int) -> list[float]:
    """Processor time of each run and of the processes it waits for [s], after a warm-up run."""
    action()
    seconds = []

    for _ in range(runs):
        start_s = _processor_s()
        action()
        seconds.append(_processor_s() - start_s)

    return seconds


def _processor_s() -> float:
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + children.ru_utime + children.ru_stime


def main() -> None:
    """Print the table; exit 1 if the best run of a row misses its target."""
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 7
    design = Design.load(changes=["board.variant=precision"])
    values = board_values(design)
    circuit = board_circuit(values)
    network = build_network(circuit, find_gain_bandwidth_hz(design.board))
    toleranced = TolerancedFilter(model_filter(circuit), network.values)
    tolerances = component_tolerances(circuit)
    board = Board(capacitor_series="E12", series="E96")

    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "fingertip", "board", "--out", folder, "--quiet"]
        rows: list[tuple[str, Callable[[], object], float]] = [
            ("10 000 boards", lambda: monte_carlo(toleranced, tolerances), 1.0),
            (
                "joint E96 search",
                lambda: choose_jointly.__wrapped__((2375.5, 1187.7, 4750.9), "E96"),
                0.8,
            ),
            ("joint E12 x E96 search", lambda: select_filter_capacitor(board), 0.8),
            (
                "fingertip board, fresh",
                lambda: subprocess.run(command, check=True, stdout=subprocess.DEVNULL),
                8.0,
            ),
        ]
        yardstick_s = measure_yardstick_s()
        print(f"Python {platform.python_version()}, {platform.machine()}, {runs} runs each\n")
        print(f"{'calculation':24}{'best':>12}{'median':>12}{'target':>12}")
        missed = False

        for name, action, target in rows:
            seconds = timed(action, runs)
            best = 1e3 * min(seconds)
            middle = 1e3 * statistics.median(seconds)
            limit = 1e3 * target * yardstick_s
            print(f"{name:24}{best:9.2f} ms{middle:9.2f} ms{limit:9.0f} ms")
            missed = missed or best > limit

    sys.exit(1 if missed else 0)


if __name__ == "__main__":
    main()
