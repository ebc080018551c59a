"""Errors of simulated traces by the time step, against run time.

Errors are differences from steps `REFERENCE` times as short. Noise is drawn on the base grid and
stays the same, so every difference is an error of the step.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

from fingertip.design import Design
from fingertip.foundation import extras
from fingertip.foundation.progress import ReportProgress, Work
from fingertip.foundation.workers import find_workers, side_by_side
from fingertip.lab.accuracy.extremes import FamilyResult, try_families
from fingertip.lab.accuracy.step_error import find_comparable_s, find_differences, run_on_grid
from fingertip.sim.runs.scene_and_manipulation_files import ManipulationFile, SceneFile
from fingertip.sim.signal.grid import Grid
from fingertip.sim.simulation import Trial

REFERENCE = 16
"""Number of steps of the reference per step of the shipped grid."""
_REFINEMENTS = (1, 2, 4)


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


def measure_steps(
    design: Design, name: str, scene: SceneFile | ManipulationFile
) -> list[StepError]:
    """Run a scene without noise with the shipped step, a half and a quarter of it.

    Raises TraceError.
    """
    signals = ["force_n", "tactile_v", *(["envelope_v"] if design.board.has_filter else [])]
    quiet = scene.sensing.model_copy(update={"noise": False})
    scene = scene.model_copy(update={"outputs": signals, "sensing": quiet})
    runs = []
    cpu_s = list[float]()

    for refinement in (1, *_REFINEMENTS, REFERENCE):  # the first run loads the loops
        begin = time.process_time()
        runs.append(run_on_grid(design, scene, grid=Grid(refinement)))
        cpu_s.append(time.process_time() - begin)

    until_s = find_comparable_s(runs)
    step_errors = []

    for refinement, run, spent_s in zip(_REFINEMENTS, runs[1:], cpu_s[1:], strict=False):
        step_errors.append(
            StepError(
                run=name,
                step_s=Grid(refinement).step_s,
                errors=find_differences(run, runs[-1], signals, until_s),
                cpu_s=spent_s,
                real_time_ratio=run.duration_s / spent_s,
            )
        )

    return step_errors


@dataclass(frozen=True, eq=False)
class Accuracy:
    """Errors by time step of a design, and results of the extreme cases."""

    design: Design
    steps: tuple[StepError, ...]
    extremes: tuple[FamilyResult, ...]


def measure_accuracy(
    design: Design, cases: int, progress: ReportProgress | None = None, jobs: int | None = 1
) -> Accuracy:
    """Measure errors by time step, and try so many extreme cases, which depend on no design.

    Raises FingertipError.
    """
    extras.require("fingertip accuracy", "numba")
    work = Work("accuracy", {"time steps": 5.0, "extreme cases": 0.004 * cases}, progress)

    with side_by_side(find_workers(jobs)):
        work.begin("time steps")
        grasp = ManipulationFile.load("real_manipulation")
        steps = (
            *measure_steps(design, "trial", Trial().scene),
            *measure_steps(design, "grasp", grasp),
        )
        work.begin("extreme cases")
        return Accuracy(design, steps, tuple(try_families(cases, work.advance)))
