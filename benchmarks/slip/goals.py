"""Goals of `fast` on the half that judges: what must be reached, and what was."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from benchmarks.slip.bench import Results
from benchmarks.slip.own_sets import LINES, LOAD_LAWS, TRIAL_DESIGNS, TRIALS, name_trials
from benchmarks.slip.real_sets import STARTS_S, STRENGTHS
from benchmarks.slip.scores import known

ON_P90_MS = {"full": 26.0, "half": 34.0, "quarter": 73.0}
INCIPIENT_P90_MS = {"full": 14.0, "half": 22.0, "quarter": 55.0}
ON_SHARES = {"full": 0.98, "half": 0.98, "quarter": 0.95}
STAGE_P90_MS = 15.0
STAGE_ON_SHARE = 0.98
ON_ALARMS = 1
INCIPIENT_ALARMS = 2
"""Alarms in all real grasps, those of both halves: 19 minutes."""
HITS_SHARE = 0.15
STEADY = ("hand motion", "servo steps", "steps", "set-downs", "ramps")
STEADY_ALARMS = 6
"""Alarms in these lines of one run: those of the detector before, 1, and 5 more."""
HUM_ALARMS = 2
TAPS_SHARE = 0.05
BURST_P90_MS = 15.0
TRIAL_P90_MS = 35.0
BURST = "burst above 60 Hz"


@dataclass(frozen=True)
class Goal:
    """One number of `fast`, and its bound."""

    words: str
    reached: float
    bound: float
    is_least: bool = False
    unit: str = ""

    @property
    def is_met(self) -> bool:
        return self.reached >= self.bound if self.is_least else self.reached <= self.bound

    def as_data(self) -> dict[str, Any]:
        return vars(self) | {"reached": known(self.reached), "is_met": self.is_met}

    def describe(self) -> str:
        """Write it as a row of a table."""
        sign = "at least" if self.is_least else "at most"
        reached = f"{self.reached:.3g}" if math.isfinite(self.reached) else "never"
        met = "yes" if self.is_met else "**no**"
        return f"| {self.words} | {sign} {self.bound:g}{self.unit} | {reached}{self.unit} | {met} |"


def list_goals(on: Results, incipient: Results) -> Iterator[Goal]:
    """List the goals in the order in which they count."""
    yield Goal("real grasps, 19 min: alarms of `on`", on.of("grasp").counted, ON_ALARMS)
    alarms = incipient.of("grasp").counted
    yield Goal("real grasps, 19 min: alarms of `incipient`", alarms, INCIPIENT_ALARMS)

    for kind in STRENGTHS:
        words = f"real slides, {kind}: "
        found = on.of(f"slide {kind}")
        yield Goal(f"{words}p90 of `on`", found.quantile_ms(0.9), ON_P90_MS[kind], unit=" ms")
        yield Goal(f"{words}ON", found.on_share, ON_SHARES[kind], is_least=True)
        early_ms = incipient.of(f"slide {kind}").quantile_ms(0.9)
        yield Goal(f"{words}p90 of `incipient`", early_ms, INCIPIENT_P90_MS[kind], unit=" ms")

    stage = on.of("stage")
    yield Goal("stage: slides found", len(stage.delays_s), len(STARTS_S), is_least=True)
    yield Goal("stage: ON", stage.on_share, STAGE_ON_SHARE, is_least=True)
    yield Goal("stage: p90 of `on`", stage.quantile_ms(0.9), STAGE_P90_MS, unit=" ms")
    yield Goal("stick hits taken", on.of("stick hit").taken_share, HITS_SHARE)
    yield from _list_own(on)


def _list_own(on: Results) -> Iterator[Goal]:
    """List the goals on the project's own signals."""
    rows = [row for line in STEADY for row in LINES[line]]
    hum = LINES["late hum"]
    for run in list_runs(on):
        alarms = on.of(*rows, run=run).counted
        yield Goal(f"hand motion to ramps, seed {run}: alarms", alarms, STEADY_ALARMS)
        yield Goal(f"late hum, seed {run}: alarms", on.of(*hum, run=run).counted, HUM_ALARMS)
        taken = on.of(*LINES["taps"], run=run).taken_share
        yield Goal(f"taps, seed {run}: taken", taken, TAPS_SHARE)

    late_ms = on.of(BURST).quantile_ms(0.9)
    yield Goal("bursts of 10 times the noise or more: p90", late_ms, BURST_P90_MS, unit=" ms")
    for design in TRIAL_DESIGNS:
        for law in LOAD_LAWS:
            trials = on.of(name_trials(design, law))
            words = f"own {name_trials(design, law)}: "
            yield Goal(f"{words}found", len(trials.delays_s), TRIALS, is_least=True)
            yield Goal(f"{words}p90", trials.quantile_ms(0.9), TRIAL_P90_MS, unit=" ms")


def list_runs(on: Results) -> list[int]:
    """List the seeds of the generators."""
    rows = set(LINES["taps"])
    return sorted({run for kind, run in on.by_kind if kind in rows})
