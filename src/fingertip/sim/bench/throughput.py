"""How long campaigns take: the article's 120 trials and 12 manipulations, thousands of boards, the compiler's first
run."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from typing import Any

import numpy as np

from fingertip.design import Design
from fingertip.sim.campaign import manipulations, trials
from fingertip.sim.electronics.analog import respond_in_parts
from fingertip.sim.electronics.circuit import Analog
from fingertip.sim.electronics.monte_carlo import spread
from fingertip.sim.hand.controller import FixedGrip
from fingertip.sim.hand.manipulation import run_manipulation
from fingertip.sim.scenes.scene_file import SceneFile
from fingertip.sim.stages.result import run_scene

CAMPAIGN_TARGET_S = 6.0
MANIPULATION_TARGET_S = 1.0
BOARDS_TARGET_S = 15.0
BOARDS_TOLERANCE_V = 1e-3
_COLD = """
import time
start = time.process_time()
from fingertip.design import Design
from fingertip.sim import SceneFile, run_scene
from fingertip.jit import compiled
scene = SceneFile(slide={"distance_m": 0.01}, outputs=["voltage_v", "envelope_v"])
with compiled():
    run_scene(Design(), scene)
    run_scene(Design(), scene.model_copy(update={"contact": scene.contact.model_copy(update={"feedback": True})}))
print(time.process_time() - start)
"""


def campaign() -> dict[str, Any]:
    """CPU time of the 120 trials [s], loops compiled before."""
    design = Design()
    wanted = list(trials())
    run_scene(design, *wanted[0])
    start = time.process_time()
    slipping = sum(bool(run_scene(design, scene, seed).columns["slip"].any()) for scene, seed in wanted)
    cpu = time.process_time() - start
    return {"trials": len(wanted), "slipping": slipping, "cpu_s": cpu, "target_s": CAMPAIGN_TARGET_S}


def hands() -> dict[str, Any]:
    """CPU time of the 12 manipulations [s], stepped by a controller that does nothing, loops compiled before."""
    design = Design()
    wanted = list(manipulations())
    run_manipulation(design, wanted[0][0], FixedGrip(), 0)
    start = time.process_time()
    made = [run_manipulation(design, scene, FixedGrip(), seed) for scene, seed in wanted]
    cpu = time.process_time() - start
    return {
        "manipulations": len(made),
        "simulated_s": round(sum(float(one.time_s[-1]) for one in made), 3),
        "lost": sum(one.lost_s is not None for one in made),
        "cpu_s": cpu,
        "target_s": MANIPULATION_TARGET_S * len(made),
    }


def boards(count: int) -> dict[str, Any]:
    """CPU time of many boards on 5 s of one strong trial [s], and what their tolerances do to the envelope's peak."""
    design = Design()
    scene = SceneFile(
        contact={"surface": "wood"},
        hold={"min_force_n": 2.0, "max_force_n": 2.0},
        slide={"distance_m": 0.04},
        outputs=["tactile_v"],
    )
    voltage = run_scene(design, scene, 1).columns["tactile_v"][: round(5 * design.detector.sample_rate_hz)]
    step, nominal = 1 / design.detector.sample_rate_hz, Analog.of(design)
    list(respond_in_parts(nominal, step, voltage[:10]))
    start = time.process_time()
    peaks, implicit, steps = [], 0, 0
    for part in respond_in_parts(spread(nominal, count), step, voltage, BOARDS_TOLERANCE_V):
        peaks.append(part.envelope_v.max(axis=1))
        implicit, steps = implicit + part.implicit, steps + part.steps
    cpu = time.process_time() - start
    low, middle, high = np.quantile(np.concatenate(peaks), [0.05, 0.5, 0.95]).tolist()
    return {
        "boards": count,
        "samples": len(voltage),
        "cpu_s": cpu,
        "target_s": BOARDS_TARGET_S * count / 10_000,
        "tolerance_v": BOARDS_TOLERANCE_V,
        "conducting": implicit / steps,
        "peak_v": {"5 %": low, "50 %": middle, "95 %": high},
    }


def first_run() -> dict[str, Any]:
    """CPU time of a fresh process [s] that uses every loop: with an empty cache, and again."""
    with tempfile.TemporaryDirectory() as folder:
        times = []
        for _ in range(2):
            done = subprocess.run(
                [sys.executable, "-c", _COLD], env=os.environ | {"NUMBA_CACHE_DIR": folder}, capture_output=True,
                text=True, check=True,
            )  # fmt: skip
            times.append(float(done.stdout))
    return {"empty_cache_cpu_s": times[0], "kept_cache_cpu_s": times[1]}
