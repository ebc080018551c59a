"""Price of slip and of alarms in a closed loop: millimetres slipped and excess force, over the
detector's threshold.

    python benchmarks/slip_closed_loop.py [--design fsr400] [--repeats 3] [--minutes 2]

The article's manipulations, in which a robot's pin hits a held object, are repeated in hands that
are not steady: one with the tremor of an able hand, and one whose servo hunts in steps. Then the
same hands hold objects that nothing hits, and every tightening is an alarm. All hands obey the grip
law of `fingertip.lab.campaign.closed_loop`, which suppresses detections while the force grows; the
hand's own motion is added to its commands, so that its motors' lag smooths it.
"""

from __future__ import annotations

import argparse
import json
import random
from dataclasses import dataclass
from typing import Any

import numpy as np

from fingertip.design import Design
from fingertip.foundation.jit import compiled
from fingertip.foundation.numerics import Array, poisson_interval
from fingertip.lab.campaign.campaign import HELD_OUT_FROM
from fingertip.lab.campaign.closed_loop import (
    ClosedLoopTrial,
    evaluate_manipulation,
    plan_manipulations,
)
from fingertip.lab.campaign.run import select_board_outputs
from fingertip.pad.response import Pad
from fingertip.sim.runs.grip import GripController, GripSettings
from fingertip.sim.runs.manipulation import run_manipulation
from fingertip.sim.runs.manipulation_plan import Observation, plan_motion
from fingertip.sim.runs.scene_and_manipulation_files import ManipulationFile
from fingertip.sim.runs.tremor_and_servo import HandMotion, Servo, Tremor

FIRST_SEED = HELD_OUT_FROM + 9_000_000
HANDS = {
    "steady": (Tremor(), Servo()),
    "tremor of an able hand": (Tremor(share=0.01, voluntary_share=0.045), Servo()),
    "servo in steps of 30 mN": (Tremor(), Servo(step_n=0.03, rise_s=0.01, interval_s=0.3)),
}
DETECTORS = {"fast": (0.8, 1.0, 1.2), "digital": (1.0, 2.0, 4.0), "fft": (1.0, 2.0, 4.0)}
"""Detector -> factors of its threshold."""
OUTPUTS = ["voltage_v", "force_n", "slip", "closing_m", "object_m"]
HOLD_S = 10.0
_RATE_HZ = 1000.0
_TIMES_S = np.arange(0.0, 40.0, 1 / _RATE_HZ)


class UnsteadyGrip(GripController):
    """Grip law of a hand whose own motion is added to its commands."""

    def __init__(
        self,
        design: Design,
        settings: GripSettings,
        forces_n: Array,
        hand: str,
        seed: int,
    ) -> None:
        super().__init__(design, settings, len(forces_n))
        self._added_by_hand_m = np.zeros((len(forces_n), len(_TIMES_S)))
        pad = Pad.from_design(design)

        for i, force_n in enumerate(forces_n.tolist()):
            motion = HandMotion.draw(
                *HANDS[hand], random.Random(f"{seed}:{i}"), force_n, 0.0, float(_TIMES_S[-1])
            )
            if motion is not None:
                moved_n = np.linspace(0.0, 3 * force_n, 301)
                depths = np.array([pad.depth_m(n) for n in moved_n.tolist()])
                wanted = np.interp(force_n * motion.factor(_TIMES_S), moved_n, depths)
                self._added_by_hand_m[i] = wanted - pad.depth_m(force_n)

    def step(self, observation: Observation) -> Array:
        now = min(round(observation.time_s * _RATE_HZ), len(_TIMES_S) - 1)
        return np.maximum(super().step(observation) + self._added_by_hand_m[:, now], 0.0)


@dataclass(frozen=True)
class Price:
    detector: str
    scale: float
    trials: tuple[ClosedLoopTrial, ...]
    alarms: int
    minutes: float

    def as_data(self) -> dict[str, Any]:
        """Convert it to plain data for JSON."""
        slipped_mm = [1000 * trial.slipped_m for trial in self.trials]
        return {
            "detector": self.detector,
            "factor": self.scale,
            "held": sum(trial.held for trial in self.trials),
            "trials": len(self.trials),
            "median_mm": float(np.median(slipped_mm)),
            "p90_mm": float(np.quantile(slipped_mm, 0.9)),
            "force_ratio": float(
                np.mean([trial.force_ratio for trial in self.trials if trial.held])
            ),
            "alarms": self.alarms,
        }

    def describe(self) -> str:
        slipped_mm = [1000 * trial.slipped_m for trial in self.trials]
        ratios = [trial.force_ratio for trial in self.trials if trial.held]
        delays = sorted(trial.reaction_s for trial in self.trials if trial.reaction_s is not None)
        low, high = (bound / self.minutes for bound in poisson_interval(self.alarms))

        return (
            f"{self.detector:9} x{self.scale:4.2f}  held {sum(t.held for t in self.trials):2} of "
            f"{len(self.trials)}  "
            f"slipped {np.median(slipped_mm):5.2f} mm, p90 {np.quantile(slipped_mm, 0.9):6.2f}  "
            f"force {np.mean(ratios):4.2f}  reaction "
            f"{1000 * delays[len(delays) // 2] if delays else np.nan:6.1f} ms  "
            f"tightened without slip {self.alarms / self.minutes:5.2f} /min [{low:.2f}, {high:.2f}]"
        )


def run_loop(
    design: Design,
    scene: ManipulationFile,
    settings: GripSettings | None,
    hand: str,
    seed: int,
) -> ClosedLoopTrial:
    """Run one manipulation in a hand, with a grip law or without."""
    name = "no control" if settings is None else settings.detector
    outputs = [
        *OUTPUTS,
        *select_board_outputs(design, ["fast" if settings is None else settings.detector]),
    ]
    scene = scene.model_copy(update={"outputs": outputs})
    # Without a detector the hand moves all the same: a threshold that nothing reaches.
    used = settings or GripSettings(threshold_scale=100.0)
    forces_n = plan_motion(design, scene, Pad.from_design(design), seed).force_n
    controller = UnsteadyGrip(
        design=design,
        settings=used,
        forces_n=forces_n,
        hand=hand,
        seed=seed,
    )
    found = run_manipulation(design, scene, controller, seed)

    return evaluate_manipulation(name, found, controller.decisions)


def hold_scene(number: int) -> ManipulationFile:
    """Make a scene in which a light object is held, and nothing hits it."""
    kind = ("pinch", "power")[number % 2]
    return ManipulationFile(
        scene="hold",
        object={"mass_kg": 0.02},
        knock={"speed_m_s": 0.0},
        grasp={"kind": kind, "force_n": 0.8 + 0.2 * (number % 5), "after_s": HOLD_S},
    )


def measure(
    design: Design,
    settings: GripSettings | None,
    hand: str,
    repeats: int,
    minutes: float,
) -> Price:
    """Run all manipulations, and hold objects for some minutes."""
    trials = [
        run_loop(
            design,
            scene=s,
            settings=settings,
            hand=hand,
            seed=seed,
        )
        for s, seed in plan_manipulations(repeats, FIRST_SEED)
    ]
    alarms = 0
    held_s = 0.0
    number = 0

    while held_s < 60 * minutes:
        held = run_loop(
            design,
            scene=hold_scene(number),
            settings=settings,
            hand=hand,
            seed=FIRST_SEED + 1000 + number,
        )
        alarms += held.false_grips
        held_s += HOLD_S
        number += 1

    name, scale = (
        ("no control", 1.0) if settings is None else (settings.detector, settings.threshold_scale)
    )
    return Price(
        detector=name,
        scale=scale,
        trials=tuple(trials),
        alarms=alarms,
        minutes=held_s / 60,
    )


def main() -> None:
    """Print one line for each hand, detector and threshold."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--design", default="fsr400", help="design file or bundled name")
    parser.add_argument("--repeats", type=int, default=3, help="of each manipulation, 1 to 3")
    parser.add_argument("--minutes", type=float, default=2.0, help="of holding, for each line")
    parser.add_argument("--json", action="store_true", help="print data in place of lines")
    arguments = parser.parse_args()
    design = Design.load(arguments.design)
    cases: list[GripSettings | None] = [None]
    cases += [GripSettings(name, scale) for name, scales in DETECTORS.items() for scale in scales]
    data: dict[str, list[dict[str, Any]]] = {}

    with compiled():
        for hand in HANDS:
            data[hand] = []
            if not arguments.json:
                print(hand)

            for settings in cases:
                price = measure(
                    design,
                    settings=settings,
                    hand=hand,
                    repeats=arguments.repeats,
                    minutes=arguments.minutes,
                )
                data[hand].append(price.as_data())
                if not arguments.json:
                    print(f"  {price.describe()}", flush=True)

    if arguments.json:
        print(json.dumps(data, indent=1, allow_nan=False))


if __name__ == "__main__":
    main()
