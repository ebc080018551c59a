"""What a design is tried on: the article's trials, and minutes in which nothing slips. Which seeds tuned what.

`TUNING_SEEDS` are those on which the constants of the detector `fast` were chosen, by trials like these and scenes of
the same kinds; a validation starts beyond them, so that nothing it reports was ever tuned on. The simulation was not
changed for any detector's sake. `analog` was not tuned at all: its figures are the article's and its threshold is the
design's.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from fingertip.errors import Issue, TraceError
from fingertip.sim import SceneFile
from fingertip.sim.campaign import trials

TUNING_SEEDS = range(1000, 1400)
HELD_OUT_FROM = 5_000_000
"""First seed of a validation."""

_GRASP = {"mode": "grasp", "min_force_n": 0.5, "max_force_n": 2.0}
QUIET: dict[str, tuple[SceneFile, float]] = {
    "contact": (SceneFile(scene="contact", hold={"min_s": 1.0, "release": False}), 0.25),
    "release": (SceneFile(scene="release", hold={"min_s": 1.0}), 0.2),
    "load change": (
        SceneFile(
            scene="load_change",
            hold={**_GRASP, "max_force_n": 1.5},
            load_change={"by_n": 1.0, "rise_s": 0.15},
        ),
        0.2,
    ),
    "drift": (
        SceneFile(
            scene="drift", hold={**_GRASP, "min_s": 20.0}, drift={"share_per_decade": 0.05, "volt_per_s": 0.0005}
        ),
        0.1,
    ),
    "motor": (
        SceneFile(scene="motor_vibration", hold=_GRASP, motor={"force_n": 0.01, "duration_s": 2.0}),
        0.1,
    ),
    "hard tap": (
        SceneFile(
            scene="hard_tap",
            hold={**_GRASP, "min_force_n": 1.0},
            tap={"force_n": 2.0, "rise_s": 0.004, "count": 3},
        ),
        0.1,
    ),
    "cable": (SceneFile(scene="cable_touch", hold=_GRASP, cable={"step_v": 0.02, "hum_v": 0.005}), 0.05),
}
"""Cause -> scene, and its share of the quiet minutes. The scenes are those of ``params/scenes``, with their sources and
assumptions."""
APART = ("hard tap", "motor", "cable")
"""Causes that shake the finger, or its wire, in the very band of slip: one force axis cannot tell them from slip before
several periods have passed, unless they are stronger than slip ever is. They are counted, each by itself, and not among
the alarms that a requirement limits."""


@dataclass(frozen=True)
class Case:
    """One scene to run."""

    cause: str
    """Of the alarms in it; ``slip`` for a trial."""
    scene: SceneFile
    seed: int


@dataclass(frozen=True)
class Amount:
    """How much is tried.

    Raises
    ------
    TraceError
        With one sentence for each number that is refused.
    """

    trials: int = 120
    quiet_minutes: float = 40.0

    def __post_init__(self) -> None:
        issues = []
        if not 1 <= self.trials <= 100_000:
            issues.append(Issue("--trials", f"{self.trials} is refused; choose 1 to 100000 (article: 120)."))
        if not 0.5 <= self.quiet_minutes <= 10_000:
            issues.append(Issue("--minutes", f"{self.quiet_minutes:g} min is refused; choose 0.5 to 10000."))
        if issues:
            raise TraceError(issues)


def cases(amount: Amount, first_seed: int = HELD_OUT_FROM) -> Iterator[Case]:
    """The trials, spread over surfaces and velocities where there are fewer than the article's 120, then the quiet
    scenes; every case has a seed of its own."""
    seed = first_seed
    scenes = [scene for scene, _ in trials()]
    for i in range(amount.trials):
        at = i % len(scenes) if amount.trials >= len(scenes) else i * len(scenes) // amount.trials
        yield Case("slip", scenes[at], seed)
        seed += 1
    for cause, (scene, share) in QUIET.items():
        for _ in range(math.ceil(60 * amount.quiet_minutes * share / duration_s(cause))):
            yield Case(cause, scene, seed)
            seed += 1


def duration_s(cause: str) -> float:
    """About how long a quiet scene lasts [s]."""
    return {"contact": 2.5, "release": 5.0, "load change": 3.4, "drift": 22.3, "motor": 5.3, "hard tap": 4.3}.get(
        cause, 3.8
    )
