"""Error of the time step in one simulation, by a second one on a finer grid.

Noise is drawn on the base grid and stays the same, so every difference is an error of the step.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from fingertip.design import Design
from fingertip.sim.runs.manipulation import ManipulationResult, run_manipulation
from fingertip.sim.runs.scene import SceneResult, run_scene
from fingertip.sim.runs.scene_and_manipulation_files import ManipulationFile, SceneFile
from fingertip.sim.signal.grid import Grid
from fingertip.sim.simulation import Simulation

SAFETY = 2.0
"""Error over the difference from half the step: 4/3 at order 2, 2 at order 1."""
_BEFORE_LOSS_S = 0.005
"""Time before the loss of an object from which on a grasp is not compared [s]: a finger that hits
nothing rings.
"""


def run_on_grid(
    design: Design, scene: SceneFile | ManipulationFile, seed: int = 0, grid: Grid | None = None
) -> SceneResult | ManipulationResult:
    """Run a scene or a manipulation; None: the grid that it takes by itself. Raises TraceError."""
    if isinstance(scene, SceneFile):
        return run_scene(design, scene, seed, grid=grid)

    return run_manipulation(design, scene, seed=seed, grid=grid)


def find_comparable_s(runs: Sequence[SceneResult | ManipulationResult]) -> float:
    """Return the time up to which runs of one scene are comparable: none has lost the object."""
    lost_s = [run.lost_s for run in runs if isinstance(run, ManipulationResult) and run.lost_s]
    return min(lost_s, default=math.inf) - _BEFORE_LOSS_S


def find_differences(
    run: SceneResult | ManipulationResult,
    exact: SceneResult | ManipulationResult,
    signals: Sequence[str],
    until_s: float,
) -> dict[str, float]:
    """Return the largest difference of each signal at a sample [N, V], of all fingers."""
    compared = run.time_s < until_s
    largest = dict.fromkeys(signals, 0.0)

    for column, values in exact.columns.items():
        # Columns of a grasp begin with the name of the finger.
        signal = next(signal for signal in signals if column.endswith(signal))
        difference = float(np.abs(run.columns[column] - values)[compared].max())
        largest[signal] = max(largest[signal], difference)

    return largest


def bound_errors(simulation: Simulation, signals: Sequence[str]) -> dict[str, float]:
    """Return the largest error of each signal [N, V] by the time step, as the double of what half
    of the step changes; the simulation runs twice for it.

    `python -m tools.accuracy` states how often that holds. Raises TraceError.
    """
    scene = simulation.scene.model_copy(update={"outputs": [*signals]})
    run = run_on_grid(simulation.design, scene, simulation.seed)
    half = Grid(2 * round(Grid().step_s / run.step_s))
    finer = run_on_grid(simulation.design, scene, simulation.seed, half)
    until_s = find_comparable_s((run, finer))
    differences = find_differences(run, finer, signals, until_s)
    return {signal: SAFETY * difference for signal, difference in differences.items()}
