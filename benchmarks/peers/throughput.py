"""CPU time of the article's 120 trials and 12 manipulations, of thousands of boards, of the first
compilation, and of each solver's start-up, which is part of no point of the diagrams.
"""

from __future__ import annotations

import os
import random
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.peers import spice
from benchmarks.peers.board import STEP_S, BoardProblem
from benchmarks.peers.native import NATIVE, NativeSolvers
from benchmarks.peers.spice import Spice
from benchmarks.yardstick import measure_yardstick_s
from fingertip.design import Design
from fingertip.foundation.errors import Issue, TraceError
from fingertip.foundation.files import temporary_folder
from fingertip.foundation.numerics import Array
from fingertip.sim.runs.manipulation import run_manipulation
from fingertip.sim.runs.manipulation_plan import Observation
from fingertip.sim.runs.scene import run_scene
from fingertip.sim.runs.scene_and_manipulation_files import SceneFile
from fingertip.sim.signal.analog_circuit import AnalogBoard
from fingertip.sim.signal.filter_board import simulate_board
from fingertip.sim.simulation import article_manipulations, article_trials

CAMPAIGN_TARGET = 50.0
"""Processor time of the 120 trials, in yardsticks (`benchmarks.yardstick`)."""
MANIPULATION_TARGET = 16.0
"""Processor time of one manipulation, in yardsticks."""
BOARDS_TARGET = 160.0
"""Processor time of 10 000 boards, in yardsticks."""
BOARDS_TOLERANCE_V = 1e-3
_CHUNK = 256
"""Boards whose matrices are in memory at a time: 4 MB."""
RESISTOR_TOLERANCE = 0.01
"""Relative tolerance of the resistors."""
CAPACITOR_TOLERANCE = 0.05
"""Relative tolerance of the capacitors."""
SATURATION_FACTOR = 2.0
"""Range of the diodes' saturation current: from the nominal value
divided by this to the value times it. Assumption.
"""
_COLD = """
import time
start = time.process_time()
from fingertip.design import Design
from fingertip.sim.runs.scene_and_manipulation_files import SceneFile
from fingertip.sim.runs.scene import run_scene
from fingertip.foundation.jit import compiled
scene = SceneFile(slide={"distance_m": 0.01}, outputs=["voltage_v", "envelope_v"])
with compiled():
    run_scene(Design(), scene)
    contact = scene.contact.model_copy(update={"feedback": True})
    run_scene(Design(), scene.model_copy(update={"contact": contact}))
print(time.process_time() - start)
"""
_PROCESS = """
import time
{imports}
print(time.process_time())
"""
_LOAD_LOOPS = f"""
import sys
sys.path.insert(0, {str(Path(__file__).parents[2])!r})
from fingertip.foundation.jit import compiled
from benchmarks.peers.board import BoardProblem
from benchmarks.peers.contact import ContactProblem
from fingertip.design import Design
from fingertip.sim.signal.analog_circuit import AnalogBoard
with compiled():
    ContactProblem.over(1.0).run_fingertip(1e-3)
    BoardProblem(AnalogBoard.from_design(Design(), "ideal"), 0.5).run_fingertip(1e-3)
"""


def measure_trials() -> dict[str, Any]:
    """Measure the CPU time of the 120 trials [s], with compiled loops."""
    design = Design()
    planned = list(article_trials())
    run_scene(design, *planned[0])
    start = time.process_time()
    slipping = sum(
        bool(run_scene(design, scene, seed).columns["slip"].any()) for scene, seed in planned
    )
    cpu = time.process_time() - start

    return {
        "trials": len(planned),
        "slipping": slipping,
        "cpu_s": cpu,
        "target_s": CAMPAIGN_TARGET * measure_yardstick_s(),
    }


def measure_manipulations() -> dict[str, Any]:
    """Measure the CPU time of the 12 manipulations [s] under a
    controller without feedback, with compiled loops.
    """
    design = Design()
    planned = list(article_manipulations())
    run_manipulation(design, planned[0][0], FixedGrip(), 0)
    start = time.process_time()
    results = [run_manipulation(design, scene, FixedGrip(), seed) for scene, seed in planned]
    cpu = time.process_time() - start

    return {
        "manipulations": len(results),
        "simulated_s": round(sum(float(result.time_s[-1]) for result in results), 3),
        "lost": sum(result.lost_s is not None for result in results),
        "cpu_s": cpu,
        "target_s": MANIPULATION_TARGET * len(results) * measure_yardstick_s(),
    }


class FixedGrip:
    """Controller that does not react: it commands the planned closing."""

    def step(self, observation: Observation) -> Array:
        return observation.planned_m


def measure_boards(count: int) -> dict[str, Any]:
    """Measure the CPU time of many boards on 5 s of one strong trial
    [s], and the spread of the envelope's peak.
    """
    design = Design()
    scene = SceneFile(
        contact={"surface": "wood"},
        hold={"min_force_n": 2.0, "max_force_n": 2.0},
        slide={"distance_m": 0.04},
        outputs=["tactile_v"],
    )
    voltage = run_scene(design, scene, 1).columns["tactile_v"][
        : round(5 * design.detector.sample_rate_hz) + 1
    ]
    step = 1 / design.detector.sample_rate_hz
    nominal = AnalogBoard.from_design(design, "ideal")
    simulate_board(nominal, step, voltage[:10])
    start = time.process_time()
    peaks = []
    implicit = 0
    steps = 0

    for boards in split_boards(draw_boards(nominal, count)):
        chunk = simulate_board(boards, step, voltage, BOARDS_TOLERANCE_V)
        peaks.append(chunk.envelope_v.max(axis=1))
        implicit = implicit + chunk.implicit
        steps = steps + chunk.steps

    cpu = time.process_time() - start
    low, middle, high = np.quantile(np.concatenate(peaks), [0.05, 0.5, 0.95]).tolist()
    return {
        "boards": count,
        "samples": len(voltage),
        "cpu_s": cpu,
        "target_s": BOARDS_TARGET * count / 10_000 * measure_yardstick_s(),
        "tolerance_v": BOARDS_TOLERANCE_V,
        "conducting_ratio": implicit / steps,
        "peak_v": {"5 %": low, "50 %": middle, "95 %": high},
    }


def measure_first_run() -> dict[str, Any]:
    """Measure the CPU time of a fresh process that uses the loops [s],
    with an empty and with a full compiler cache.
    """
    with temporary_folder() as folder:
        times = []
        for _ in range(2):
            done = subprocess.run(
                [sys.executable, "-c", _COLD],
                env=os.environ | {"NUMBA_CACHE_DIR": str(folder)},
                capture_output=True,
                text=True,
                check=True,
            )
            times.append(float(done.stdout))

    return {"empty_cache_cpu_s": times[0], "full_cache_cpu_s": times[1]}


def measure_start_up(peers: tuple[str, ...], native: NativeSolvers) -> dict[str, float]:
    """Measure the CPU time of each solver's start-up [s], with filled caches.

    fingertip and scipy start in a fresh process of Python. Equations in C are compiled with their
    solver, and ngspice reads a deck.
    """
    found = {
        "fingertip: process, imports, and loading both compiled loops": _time_process(_LOAD_LOOPS)
    }
    if set(peers) - {*NATIVE, "ngspice"}:
        found["scipy: process and import, without the compilation of the equations"] = (
            _time_process("import scipy.integrate")
        )

    for name, cpu_s in native.compilation_s.items():
        found[f"{name}: compilation of both problems"] = cpu_s

    if "ngspice" in peers and (program := spice.find_program()):
        board = AnalogBoard.from_design(Design.load("article"), "ideal")
        problem = BoardProblem(board, 1.0)
        source = spice.sampled_source(STEP_S, problem.voltage_v)
        simulator = Spice(
            program=program,
            board=board,
            source=source,
            step_s=STEP_S,
            end_s=problem.seconds,
        )
        found["ngspice: process and reading a deck of 2001 samples"] = (
            simulator.measure_start_up_s()
        )

    return found


def _time_process(imports: str) -> float:
    """CPU time of a fresh process [s]; the second of two, so that caches are filled."""
    code = _PROCESS.format(imports=imports)
    runs = [
        subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        for _ in range(2)
    ]
    return float(runs[-1].stdout)


def draw_boards(board: AnalogBoard, count: int, seed: int = 0) -> AnalogBoard:
    """Draw boards with independent components, uniform within their tolerances.

    Raises TraceError.
    """
    if count < 1:
        raise TraceError(Issue("count", f"{count} is too few; give at least 1 board."))

    rng = random.Random(f"{seed}:boards")
    nominal = board.components
    drawn = np.array(
        [[2 * rng.random() - 1 for _ in range(len(nominal) + 1)] for _ in range(count)]
    )
    values: dict[str, NDArray[np.float64]] = {
        name: value
        * (1 + (RESISTOR_TOLERANCE if name.startswith("R") else CAPACITOR_TOLERANCE) * drawn[:, i])
        for i, (name, value) in enumerate(nominal.items())
    }
    factors = np.array([SATURATION_FACTOR**x for x in drawn[:, -1].tolist()])
    saturation = np.asarray(board.diode.saturation_a) * factors

    return replace(
        board.with_components(**values), diode=replace(board.diode, saturation_a=saturation)
    )


def split_boards(boards: AnalogBoard) -> Iterator[AnalogBoard]:
    """Split drawn boards into chunks whose matrices fit in memory."""
    saturation = np.asarray(boards.diode.saturation_a)
    for start in range(0, len(saturation), _CHUNK):
        part = slice(start, start + _CHUNK)
        chunk = boards.with_components(
            **{name: np.asarray(row)[part] for name, row in boards.components.items()}
        )
        yield replace(chunk, diode=replace(boards.diode, saturation_a=saturation[part]))
