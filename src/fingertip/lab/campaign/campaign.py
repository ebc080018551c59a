"""Campaign of simulated trials: the article's trials, scenes without slip, and the seeds of tuning
and of validation.

`TUNING_SEEDS` are the seeds on which the constants of the detector `fast` were chosen, by trials
like these and scenes of the same kinds. A validation starts beyond them, so that everything it
reports is held out. The simulation was not changed for any detector's sake. `analog` was not tuned
at all: its constants are the article's and its threshold is the design's.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from fingertip.catalogues.file_kinds import PARAMS
from fingertip.foundation.errors import Issue, TraceError, checked, raise_issues
from fingertip.sim.runs.scene_and_manipulation_files import SceneFile
from fingertip.sim.simulation import article_trials

TUNING_SEEDS = range(1000, 1400)
HELD_OUT_FROM = 5_000_000
LAST_SEED = 2**31 - 1 - 20_000_000
"""Largest first seed of a validation, which uses some millions of seeds from it on."""


def check_first_seed(seed: int) -> None:
    """Refuse seeds on which a detector may have been trained or tuned. Raises TraceError."""
    if not HELD_OUT_FROM <= seed <= LAST_SEED:
        reason = (
            "seeds below were used to train and tune detectors"
            if seed < HELD_OUT_FROM
            else "it is too large"
        )
        raise TraceError(
            Issue("--seed", f"{seed} is refused, {reason}; choose {HELD_OUT_FROM} to {LAST_SEED}.")
        )


_SCENES = {
    "contact": ("contact", 0.25, 2.5),
    "release": ("release", 0.2, 5.0),
    "load change": ("load_change", 0.2, 3.4),
    "drift": ("drift", 0.1, 22.3),
    "motor": ("motor_vibration", 0.1, 5.3),
    "hard tap": ("hard_tap", 0.1, 4.3),
    "cable": ("cable_touch", 0.05, 3.8),
}
"""Cause of alarms -> scene without slip, its share of the time without slip, and duration [s]."""
NEGATIVE_SCENES = {
    cause: (SceneFile.load(PARAMS / "scenes" / f"{name}.toml"), share)
    for cause, (name, share, _) in _SCENES.items()
}
"""Cause of alarms -> bundled scene without slip, and its share of the time without slip."""
REPORTED_SEPARATELY = ("hard tap", "motor", "cable")
"""Causes whose alarms are reported separately and not limited by a requirement.

They shake the finger, or its wire, in the band of slip. A single force axis cannot distinguish them
from slip before several periods have passed, unless they are stronger than slip ever is.
"""


@dataclass(frozen=True)
class Case:
    """Scene of a campaign with its seed."""

    cause: str
    """Cause of the alarms in it; ``slip`` for a trial."""
    scene: SceneFile
    seed: int


@checked
@dataclass(frozen=True)
class CampaignPlan:
    """Size of a campaign. Raises TraceError."""

    trials: int = 120
    negative_minutes: float = 40.0
    """Duration of the scenes without slip [min]."""

    def __post_init__(self) -> None:
        issues = []
        if not 1 <= self.trials <= 100_000:
            issues.append(
                Issue("--trials", f"{self.trials} is refused; choose 1 to 100000 (article: 120).")
            )
        if not 0.5 <= self.negative_minutes <= 10_000:
            issues.append(
                Issue(
                    "--minutes",
                    f"{self.negative_minutes:g} min is refused; choose 0.5 to 10000 min.",
                )
            )

        raise_issues(TraceError, issues)


def generate_cases(plan: CampaignPlan, first_seed: int = HELD_OUT_FROM) -> Iterator[Case]:
    """Generate the trials, spread over surfaces and speeds, then the scenes without slip."""
    seed = first_seed
    scenes = [scene for scene, _ in article_trials()]

    for i in range(plan.trials):
        index = i % len(scenes) if plan.trials >= len(scenes) else i * len(scenes) // plan.trials
        yield Case("slip", scenes[index], seed)
        seed += 1

    for cause, (scene, fraction) in NEGATIVE_SCENES.items():
        count = math.ceil(60 * plan.negative_minutes * fraction / nominal_duration_s(cause))
        for _ in range(count):
            yield Case(cause, scene, seed)
            seed += 1


def nominal_duration_s(cause: str) -> float:
    """Approximate duration of a scene without slip [s]."""
    return _SCENES[cause][2]
