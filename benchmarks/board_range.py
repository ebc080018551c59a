"""Share of slides outside the board's own range, and what its limits change in the delays, over
random trials.

    python -m benchmarks.board_range [--trials 1000] [--designs article fsr400 comparator fsr402]

Each trial runs with ideal amplifiers and with those of the board. A sample counts where the ideal
filtered voltage leaves the range that `fingertip board` states. Where a delay moves by more than a
sample, the trial runs again with the board's amplifiers but without rails, slew and phase reversal,
which tells what of it their bandwidth does. `comparator` is fsr400 with that variant.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, replace
from functools import partial
from unittest.mock import patch

import numpy as np
from numpy.typing import NDArray

from fingertip.board.analysis.board_values import board_values
from fingertip.design import Design
from fingertip.foundation.numerics import Array
from fingertip.foundation.workers import call_each
from fingertip.lab.board_comparison import with_variant
from fingertip.lab.campaign.campaign import HELD_OUT_FROM, CampaignPlan, Case, generate_cases
from fingertip.lab.campaign.run import evaluate, score_trial
from fingertip.sim.runs.scene import SceneResult, run_scene
from fingertip.sim.signal.analog_circuit import Amplifiers
from fingertip.sim.signal.filter_board import PIN_LOW_V
from fingertip.sim.signal.parameters import Sensing
from fingertip.sim.signal.simulated_finger import _prepare_board

DESIGNS = ("article", "fsr400", "comparator", "fsr402")
DETECTORS = ("analog", "fast")
OUTPUTS = "voltage_v", "force_n", "slip", "sampled_envelope_v", "filtered_v"
IDEAL = "ideal"
ENDLESS = "without rails"
REAL = "real"


@dataclass(frozen=True)
class Beside:
    """One trial with ideal amplifiers and with those of the board."""

    case: Case
    beyond: float
    """Share of the slide's samples outside the range with ideal amplifiers."""
    outside_ms: tuple[float, ...]
    """Times at which the voltage leaves the range, from the onset of slip."""
    delays_ms: dict[str, dict[str, list[float]]]
    """Detector -> amplifiers -> delays."""

    def moves(
        self,
        detector: str,
        first: str,
        second: str,
        sample_ms: float = 0.5,
    ) -> bool:
        a = self.delays_ms[detector][first]
        b = self.delays_ms[detector][second]
        return len(a) != len(b) or any(
            abs(x - y) > 1.01 * sample_ms for x, y in zip(a, b, strict=True)
        )


def load(name: str) -> Design:
    return with_variant(Design.load("fsr400"), name) if name == "comparator" else Design.load(name)


def has_pin(design: Design) -> bool:
    return design.board.variant == "comparator"


def run(design: Design, case: Case, amplifiers: str) -> SceneResult:
    sensing = Sensing(amplifiers="ideal" if amplifiers == IDEAL else "real")
    pin = ["slip_pin_v"] * has_pin(design)
    scene = case.scene.model_copy(update={"outputs": [*OUTPUTS, *pin], "sensing": sensing})
    if amplifiers != ENDLESS:
        return run_scene(design, scene, case.seed)

    fitted = replace(
        Amplifiers.from_design(design),
        slew_v_per_s=1e12,
        peak_v=1e6,
        trough_v=1e6,
        reversal_v=None,
    )
    _prepare_board.cache_clear()
    with patch.object(Amplifiers, "from_design", lambda _: fitted):
        found = run_scene(design, scene, case.seed)

    _prepare_board.cache_clear()
    return found


def measure_beyond_range(design: Design, filtered_v: Array, slip: NDArray[np.bool_]) -> float:
    """Measure the share of the slip in which the filtered voltage [V]
    leaves the board's range; 0 without slip.
    """
    limits = board_values(design).voltage_limits
    sliding_v = filtered_v[slip]
    beyond = (sliding_v > limits.filter_peak_v) | (sliding_v < -limits.filter_trough_v)

    return float(beyond.mean()) if beyond.size else 0.0


def compare(design: Design, case: Case) -> Beside:
    runs = {name: run(design, case, name) for name in (IDEAL, REAL)}
    ideal = runs[IDEAL]
    limits = board_values(design).voltage_limits
    filtered_v = ideal.columns["filtered_v"]
    slip = ideal.columns["slip"]
    time_s = ideal.time_s
    outside = (filtered_v > limits.filter_peak_v) | (filtered_v < -limits.filter_trough_v)
    first = outside & ~np.append(False, outside[:-1])
    outside_ms = tuple(np.round(1e3 * (time_s[first] - time_s[np.argmax(slip)]), 1).tolist())
    beyond = measure_beyond_range(design, filtered_v, slip)

    def detect(name: str) -> dict[str, list[float]]:
        trials = {
            one: evaluate(
                case,
                trace=runs[name].trace,
                detector=one,
                design=design,
                scales=[1.0],
            )[0]
            for one in DETECTORS
        }
        delays_s = {one: trial.delays_s for one, trial in trials.items()}
        if has_pin(design):
            on = runs[name].columns["slip_pin_v"] == PIN_LOW_V
            delays_s["pin"] = score_trial(case, runs[name].trace, on, 0.1).delays_s

        return {one: [round(1e3 * delay, 1) for delay in each] for one, each in delays_s.items()}

    delays = {
        one: {IDEAL: ideal, REAL: real}
        for (one, ideal), real in zip(detect(IDEAL).items(), detect(REAL).values(), strict=True)
    }
    found = Beside(case, beyond, outside_ms, delays)
    if any(found.moves(one, IDEAL, REAL) for one in delays):
        runs[ENDLESS] = run(design, case, ENDLESS)
        for one, endless in detect(ENDLESS).items():
            delays[one][ENDLESS] = endless

    return found


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--trials", type=int, default=1000)
    parser.add_argument("--designs", nargs="+", default=DESIGNS)
    parser.add_argument("--seed", type=int, default=HELD_OUT_FROM, help="seed of the first trial")
    arguments = parser.parse_args()

    for name in arguments.designs:
        design = load(name)
        plan = CampaignPlan(arguments.trials, 0.5)
        cases = [case for case in generate_cases(plan, arguments.seed) if case.cause == "slip"]
        found = list(call_each(partial(compare, design, case) for case in cases))
        share = 100 * np.mean([one.beyond for one in found])
        some = sum(one.beyond > 0.0 for one in found)
        print(
            f"{name}: {share:.2f} % of the slides' samples leave the range, in {some} of "
            f"{len(found)}",
            flush=True,
        )

        for detector in found[0].delays_ms:
            moved = [one for one in found if one.moves(detector, IDEAL, REAL)]
            by_rails = sum(one.moves(detector, ENDLESS, REAL) for one in moved)
            print(
                f"  {detector}: {len(moved)} delays move by more than a sample, {by_rails} of "
                "them by rails"
            )

            for one in moved:
                words = ", ".join(
                    f"{amplifiers} {ms}" for amplifiers, ms in one.delays_ms[detector].items()
                )
                surface = one.case.scene.contact.surface
                outside = ", ".join(map(str, one.outside_ms[:8]))
                print(
                    f"    {surface}, seed {one.case.seed}: delay [ms] {words}; outside [ms] "
                    f"{outside}",
                    flush=True,
                )


if __name__ == "__main__":
    main()
