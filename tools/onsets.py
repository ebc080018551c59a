"""Command `python -m tools.onsets`: how a slip begins in the article's trials, for the text of a
validation.

Writes `src/fingertip/lab/report/onsets.toml`. Motion and slip are those of the simulation, without
sensor and noise, so they are the same for every design with the same skin.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from fingertip.design import Design
from fingertip.foundation.jit import compiled
from fingertip.sim.contact.friction import GROSS_SLIP_M_S
from fingertip.sim.runs.scene import SceneRun, run_scene
from tools.article.steps import generate_trials

PATH = Path(__file__).resolve().parents[1] / "src/fingertip/lab/report/onsets.toml"
SLIDING_QUANTILES = (0.25, 0.95)
"""Quantiles of the time from which the pad moves: those of most trials."""


def measure_onsets_ms(design: Design, trials: int = 120) -> tuple[float, float, float]:
    """Measure times before gross slip [ms]: motion of the robot,
    median, and a pad as fast as in gross slip, range.
    """
    motion_s = []
    sliding_s = []

    with compiled():
        for case in generate_trials(trials):
            scene = case.scene.model_copy(update={"outputs": ["voltage_v", "slip", "shear_m"]})
            result = run_scene(design, scene, case.seed)
            slide = SceneRun(design, scene, case.seed).timeline.slide
            assert slide
            time_s = result.trace.time_s
            gross = int(np.argmax(result.columns["slip"]))
            motion_s.append(time_s[gross] - slide.start_s)
            # The pad's own motion includes the elastic deflection of the bristles, which the slip
            # does not.
            speed_m_s = np.gradient(slide.position_m(time_s) - result.columns["shear_m"], time_s)
            slow = np.flatnonzero(speed_m_s[:gross] <= GROSS_SLIP_M_S)
            sliding_s.append(time_s[gross] - time_s[slow[-1] + 1])

    low_s, high_s = np.quantile(sliding_s, SLIDING_QUANTILES)
    return 1000 * float(np.median(motion_s)), 1000 * float(low_s), 1000 * float(high_s)


def main() -> None:
    """Measure, and write the file."""
    motion, low, high = measure_onsets_ms(Design.load("article"))
    PATH.write_text(
        "# Times before gross slip in the article's 120 trials, written by `python -m "
        "tools.onsets`.\n\n"
        f"# Start of the robot's motion, median.\nmotion_ms = {motion:.1f}\n\n"
        "# The pad moves at 1 mm/s, deflection of its bristles included: lower quartile, and 95 % "
        "of the trials.\n"
        f"sliding_ms = [{low:.1f}, {high:.1f}]\n",
        encoding="utf-8",
    )


if __name__ == "__main__":
    main()
