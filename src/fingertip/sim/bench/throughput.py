"""CPU time of the article's 120 trials and 12 manipulations, of thousands of boards, and of the first compilation."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from typing import Any

import numpy as np

from fingertip.design import Design
from fingertip.foundation.files import TemporaryFolder
from fingertip.sim.article import article_manipulations, article_trials
from fingertip.sim.files.scene import SceneFile
from fingertip.sim.hand.manipulation import run_manipulation
from fingertip.sim.hand.motion import FixedGrip
from fingertip.sim.scene.run import run_scene
from fingertip.sim.signal.analog_circuit import AnalogBoard, draw_boards
from fingertip.sim.signal.filter_board import simulate_boards

CAMPAIGN_TARGET_S = 3.0
MANIPULATION_TARGET_S = 1.0
BOARDS_TARGET_S = 10.0
BOARDS_TOLERANCE_V = 1e-3
_COLD = """
import time
start = time.process_time()
from fingertip.design import Design
from fingertip.sim import SceneFile, run_scene
from fingertip.foundation.jit import compiled
scene = SceneFile(slide={"distance_m": 0.01}, outputs=["voltage_v", "envelope_v"])
with compiled():
    run_scene(Design(), scene)
    run_scene(Design(), scene.model_copy(update={"contact": scene.contact.model_copy(update={"feedback": True})}))
print(time.process_time() - start)
"""


def measure_trials() -> dict[str, Any]:
    """Measure the CPU time of the 120 trials [s], with compiled loops."""
    design = Design()
    planned = list(article_trials())
    run_scene(design, *planned[0])
    start = time.process_time()
    slipping = sum(bool(run_scene(design, scene, seed).columns["slip"].any()) for scene, seed in planned)
    cpu = time.process_time() - start
    return {"trials": len(planned), "slipping": slipping, "cpu_s": cpu, "target_s": CAMPAIGN_TARGET_S}


def measure_manipulations() -> dict[str, Any]:
    """Measure the CPU time of the 12 manipulations [s] under a controller without feedback, with compiled loops."""
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
        "target_s": MANIPULATION_TARGET_S * len(results),
    }


def measure_boards(count: int) -> dict[str, Any]:
    """Measure the CPU time of many boards on 5 s of one strong trial [s], and the spread of the envelope's peak."""
    design = Design()
    scene = SceneFile(
        contact={"surface": "wood"},
        hold={"min_force_n": 2.0, "max_force_n": 2.0},
        slide={"distance_m": 0.04},
        outputs=["tactile_v"],
    )
    voltage = run_scene(design, scene, 1).columns["tactile_v"][: round(5 * design.detector.sample_rate_hz) + 1]
    step, nominal = 1 / design.detector.sample_rate_hz, AnalogBoard.from_design(design)
    list(simulate_boards(nominal, step, voltage[:10]))
    start = time.process_time()
    peaks, implicit, steps = [], 0, 0
    for chunk in simulate_boards(draw_boards(nominal, count), step, voltage, BOARDS_TOLERANCE_V):
        peaks.append(chunk.envelope_v.max(axis=1))
        implicit, steps = implicit + chunk.implicit, steps + chunk.steps
    cpu = time.process_time() - start
    low, middle, high = np.quantile(np.concatenate(peaks), [0.05, 0.5, 0.95]).tolist()
    return {
        "boards": count,
        "samples": len(voltage),
        "cpu_s": cpu,
        "target_s": BOARDS_TARGET_S * count / 10_000,
        "tolerance_v": BOARDS_TOLERANCE_V,
        "conducting_ratio": implicit / steps,
        "peak_v": {"5 %": low, "50 %": middle, "95 %": high},
    }


def measure_first_run() -> dict[str, Any]:
    """Measure the CPU time of a fresh process that uses the loops [s], with an empty and with a full compiler cache."""
    with TemporaryFolder() as folder:
        times = []
        for _ in range(2):
            done = subprocess.run(
                [sys.executable, "-c", _COLD], env=os.environ | {"NUMBA_CACHE_DIR": str(folder)}, capture_output=True,
                text=True, check=True,
            )  # fmt: skip
            times.append(float(done.stdout))
    return {"empty_cache_cpu_s": times[0], "full_cache_cpu_s": times[1]}
