"""CPU time of trials by stage, and of what a validation of 120 trials and 40 min without slip is
made of.

    python benchmarks/trials.py [--trials 12] [--rounds 3]

Every figure is CPU time of this process with compiled loops, after a first run that loads them. A
trial's is the median, the 90th percentile and the worst of the article's trials; a part's is the
median of the rounds for one case, times the number of such cases in a validation.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable, Sequence

import numpy as np

from fingertip.design import Design
from fingertip.foundation.jit import compiled
from fingertip.lab.campaign.campaign import CampaignPlan, Case, generate_cases, generate_trials
from fingertip.lab.campaign.closed_loop import run_closed_loop
from fingertip.lab.campaign.run import SCALES, run_cases
from fingertip.sim.runs.scene import SceneRun
from fingertip.sim.signal.grid import CostMeter, StageCost
from fingertip.sim.signal.simulated_finger import FingerSignals
from fingertip.slip.detectors.registry import DETECTORS

OUTPUTS = {
    "force": ["force_n"],
    "voltage": ["voltage_v"],
    "envelope": ["envelope_v"],
    "all": [
        "voltage_v",
        "force_n",
        "slip",
        "shear_m",
        "filtered_v",
        "envelope_v",
        "sampled_filtered_v",
    ],
    "voltage, coloured noise": ["voltage_v"],
}
COLOURED = {"pink_v": 1e-4, "hand_v": 1e-4, "hum_v": 1e-3}
EVERY = 12
"""Every so many-th case of a campaign is run for its parts."""


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--trials", type=int, default=12)
    parser.add_argument("--rounds", type=int, default=3)
    arguments = parser.parse_args()
    design = Design()

    with compiled():
        measure_trials(design, list(generate_trials(arguments.trials)))
        measure_parts(design, arguments.rounds)


def measure_trials(design: Design, cases: Sequence[Case]) -> None:
    """Print the CPU time of a trial to some of its outputs, and the median of each stage."""
    for name, outputs in OUTPUTS.items():
        noise = COLOURED if "noise" in name else {}
        seconds = []
        results = []

        for case in (cases[0], *cases):
            changed = {"outputs": outputs, "noise": case.scene.noise.model_copy(update=noise)}
            start = time.process_time()
            run = SceneRun(
                design,
                case.scene.model_copy(update=changed),
                case.seed,
                meter=CostMeter(time.process_time),
            )
            FingerSignals.join(list(run.chunks()))
            seconds.append(time.process_time() - start)
            results.append(run.meter.costs)

        median, p90, worst = (
            1e3 * float(np.quantile(seconds[1:], q, method="higher")) for q in (0.5, 0.9, 1.0)
        )
        print(
            f"trial to {name}: median {median:.1f} ms, 90th percentile {p90:.1f} ms, worst "
            f"{worst:.1f} ms"
        )
        print("   " + ", ".join(describe_stages(results[1:])))


def describe_stages(results: Sequence[Sequence[StageCost]]) -> list[str]:
    names = [stage.name for stage in results[0]]
    costs = {
        name: [s.cpu_s for stages in results for s in stages if s.name == name] for name in names
    }
    return [f"{name} {1e3 * statistics.median(found):.2f}" for name, found in costs.items()]


def measure_parts(design: Design, rounds: int) -> None:
    """Print the CPU time of the largest parts of a validation, for one case and for all of them."""
    cases = list(generate_cases(CampaignPlan()))
    some = cases[::EVERY]
    every: dict[str, Sequence[float]] = dict.fromkeys(DETECTORS, SCALES)
    whole = len(cases) / len(some)
    parts: dict[str, tuple[float, Callable[[], object]]] = {
        "trials, all detectors and thresholds": (whole, lambda: run_cases(design, some, every)),
        "closed loops": (
            6.0 * 3,
            lambda: run_closed_loop(design, ("fast",), 1, uncontrolled=False),
        ),
    }
    total_s = 0.0

    for name, (count, run) in parts.items():
        run()
        seconds = []
        for _ in range(rounds):
            start = time.process_time()
            run()
            seconds.append(time.process_time() - start)

        total_s += count * statistics.median(seconds)
        print(
            f"{name}: {statistics.median(seconds):.2f} s, {count:.1f} times: "
            f"{count * statistics.median(seconds):.0f} s"
        )

    print(f"together {total_s:.0f} s")


if __name__ == "__main__":
    main()
