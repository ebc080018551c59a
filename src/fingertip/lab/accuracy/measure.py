"""Errors of simulated traces by the time step, against run time.

Errors are differences from steps `REFERENCE` times as short. Noise is drawn on the base grid and stays the same, so
every difference is an error of the step. scipy integrates the contact once more, around the onset of slip.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fingertip.design import Design
from fingertip.foundation import extras
from fingertip.foundation.numerics import Array
from fingertip.foundation.progress import ReportProgress, Work
from fingertip.foundation.workers import find_workers, side_by_side
from fingertip.lab.accuracy.extremes import FamilyResult, try_families
from fingertip.sim import ManipulationFile, ManipulationResult, SceneFile, SceneResult, run_manipulation, run_scene
from fingertip.sim.contact.friction import LOAD_SCALE_N, stribeck
from fingertip.sim.runs.scene import SceneRun
from fingertip.sim.runs.timeline import mount_pad
from fingertip.sim.signal.grid import Grid
from fingertip.sim.simulation import Trial

REFERENCE = 16
"""Number of steps of the reference per step of the shipped grid."""
_REFINEMENTS = (1, 2, 4)
_BEFORE_LOSS_S = 0.005
"""Time before an object is lost from which a grasp is not compared [s]: what hits nothing rings."""
_WINDOW_S = -0.02, 0.3
"""Window around the start of the slide in which scipy integrates [s]."""


@dataclass(frozen=True)
class StepError:
    """Largest errors of one run with one step, and its cost."""

    run: str
    step_s: float
    errors: dict[str, float]
    """Signal -> largest error at a sample [N, V], of all fingers."""
    cpu_s: float
    real_time_ratio: float
    """Simulated time over CPU time."""


def measure_steps(design: Design, name: str, scene: SceneFile | ManipulationFile) -> list[StepError]:
    """Run a scene without noise with the shipped step, a half and a quarter of it. Raises TraceError."""
    signals = ["force_n", "tactile_v", *(["envelope_v"] if design.board.has_filter else [])]
    scene, runs, cpu_s = silence(scene, signals), list[SceneResult | ManipulationResult](), list[float]()
    base = (SceneRun(design, scene).grid or Grid()).refinement if isinstance(scene, SceneFile) else 1
    for refinement in (1, *_REFINEMENTS, REFERENCE):  # the first run loads the loops
        begin, grid = time.process_time(), Grid(base * refinement)
        if isinstance(scene, SceneFile):
            runs.append(run_scene(design, scene, grid=grid))
        else:
            runs.append(run_manipulation(design, scene, grid=grid))
        cpu_s.append(time.process_time() - begin)
    lost_s = [run.lost_s for run in runs if isinstance(run, ManipulationResult) and run.lost_s]
    compared = runs[0].time_s < min(lost_s, default=math.inf) - _BEFORE_LOSS_S
    found = []
    for refinement, run, spent_s in zip(_REFINEMENTS, runs[1:], cpu_s[1:], strict=False):
        errors = dict.fromkeys(signals, 0.0)
        for column, exact in runs[-1].columns.items():
            signal = next(signal for signal in signals if column.endswith(signal))
            errors[signal] = max(errors[signal], float(np.abs(run.columns[column] - exact)[compared].max()))
        found.append(StepError(name, Grid(base * refinement).step_s, errors, spent_s, run.duration_s / spent_s))
    return found


def silence(scene: Any, outputs: Sequence[str]) -> Any:
    """Copy of a scene without noise, with other outputs."""
    quiet = scene.sensing.model_copy(update={"noise": False})
    return scene.model_copy(update={"outputs": [*outputs], "sensing": quiet})


def compare_with_scipy(design: Design, trial: Trial) -> float:
    """Largest difference of the pad's pull from scipy's solution of its equations, around the onset of slip [N]."""
    run = SceneRun(design, silence(trial.scene, ["shear_m"]), trial.seed)
    assert run.timeline.slide
    found = run_scene(design, run.scene, trial.seed, grid=Grid(REFERENCE * (run.grid or Grid()).refinement))
    since_s = found.time_s - run.timeline.slide.start_s
    inside = (since_s >= _WINDOW_S[0]) & (since_s <= _WINDOW_S[1])
    error_m = np.abs(found.columns["shear_m"][inside] - _integrate_contact(run, since_s[inside])).max()
    return float(error_m) * run.pad.tangential_stiffness_n_per_m(run.force_n)


def _integrate_contact(run: SceneRun, since_s: Array) -> Array:
    """Shear of the pad [m] at moments since the start of the slide, under its constant load, by scipy's LSODA."""
    f, load, mount, (slide,) = run.friction, run.force_n, mount_pad(run.pad, run.force_n), run.timeline.moves
    m, k, c = mount.mass_kg, mount.stiffness_n_per_m, mount.damping_n_s_per_m
    peak, a, scale = slide.peak_m_s, slide.acceleration_m_s2, 1 / math.sqrt(load + LOAD_SCALE_N)

    def carriage(t: float) -> tuple[float, float]:
        t = max(t, 0.0)
        return (a * t * t / 2, a * t) if a * t < peak else (peak * t - peak * peak / (2 * a), peak)

    def rates(t: float, state: Array) -> list[float]:
        x, v, s = state
        at, speed = carriage(t)
        g, _ = stribeck(f.curve, v)
        bending = v - f.sigma0 * abs(v) * scale * s / g
        grip = load * (f.sigma0 * scale * s + f.sigma1 * load * scale * scale * bending + f.sigma2 * v)
        return [v, (k * (at - x) + c * (speed - v) - grip) / m, load * scale * bending]

    solve = extras.load("scipy.integrate", "accuracy").solve_ivp
    state, shear = np.zeros(3), []
    for begin, end in ((since_s[0], 0.0), (0.0, peak / a), (peak / a, since_s[-1] + 1e-6)):  # from corner to corner
        inside = since_s[(since_s >= begin) & (since_s < end)]
        absolute = 1e-10 * np.array([1 / k, 1e-3, 1 / f.sigma0])
        solution = solve(rates, (begin, end), state, "LSODA", [*inside, end], rtol=1e-9, atol=absolute).y
        shear += [carriage(t)[0] - x for t, x in zip(inside, solution[0], strict=False)]
        state = solution[:, -1]
    return np.array(shear)


@dataclass(frozen=True, eq=False)
class Accuracy:
    design: Design
    steps: tuple[StepError, ...]
    scipy_n: float
    """Largest difference from scipy [N]."""
    extremes: tuple[FamilyResult, ...]


def measure_accuracy(
    design: Design, cases: int, progress: ReportProgress | None = None, jobs: int | None = 1
) -> Accuracy:
    """Measure all of it; the cases do not depend on the design. Raises FingertipError."""
    extras.require("fingertip accuracy", "scipy", "numba", "matplotlib")
    work = Work("accuracy", {"time steps": 5.0, "extreme cases": 0.004 * cases}, progress)
    with side_by_side(find_workers(jobs)):
        work.begin("time steps")
        grasp = ManipulationFile.load("real_manipulation")
        steps = *measure_steps(design, "trial", Trial().scene), *measure_steps(design, "grasp", grasp)
        scipy_n = compare_with_scipy(design, Trial())
        work.begin("extreme cases")
        return Accuracy(design, steps, scipy_n, tuple(try_families(cases, work.advance)))
