"""Command `python -m tools.figures.creep`: what `fast` answers to a
skin that creeps on the bone in jumps, as JSON.
"""

from __future__ import annotations

import json

import numpy as np

from fingertip.design import Design
from fingertip.sim.runs.pose import GRASP_POSE
from fingertip.sim.runs.scene import run_scene
from fingertip.sim.runs.scene_and_manipulation_files import SceneFile
from fingertip.slip.detectors.registry import make_detector

HOLD = {
    "mode": "grasp",
    "min_force_n": 0.5,
    "max_force_n": 2.0,
    "min_s": 4.0,
}
SEEDS = range(6)
STEP_N = 0.03
"""Jump of the force, within 3 ms. Friction that drops by 0.1 under 1 N lets 0.1 N along the surface
jump, of which 5 to 20 % press on the sensor.
"""
CLOSE_S = 0.1
RARE_S = 0.3
"""Times between two jumps."""


def count_alarms(interval_s: float, step_n: float = STEP_N) -> list[int]:
    """Count turns to ON of a finger that holds, while its skin jumps by so much force, by seed."""
    design = Design.load("first_finger")
    found = list[int]()
    steps = {"step_n": step_n, "rise_s": 0.003, "interval_s": interval_s}

    for seed in SEEDS:
        trace = run_scene(
            design,
            SceneFile(
                scene="creep",
                pose=GRASP_POSE,
                hold=HOLD,
                servo=steps,
            ),
            seed,
        ).trace
        on = make_detector("fast", design).process(trace.voltage_v).on
        found.append(int(np.count_nonzero(np.diff(on[trace.time_s > 0.9].astype(int)) > 0)))

    return found


def main() -> None:
    """Print the alarms of each seed, for jumps that follow each other closely and for rare ones."""
    print(json.dumps({"close": count_alarms(CLOSE_S), "rare": count_alarms(RARE_S)}))


if __name__ == "__main__":
    main()
