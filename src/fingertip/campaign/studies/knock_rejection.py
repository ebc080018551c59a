"""Knocks on the held object, from weak to hard: which of them a detector takes for slip.

A knock excites the pad's own resonance, in the band in which slip shows, and lasts as long as the energy window of a
few milliseconds: on one force axis a weak knock looks like a short slip. A hard knock differs only in its rate of
change, which no slip reaches. The trees of `fast` weigh slope, decay and one-way movement.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from fingertip.campaign.evaluate import evaluate, simulate_trace
from fingertip.campaign.plan import HELD_OUT_FROM, NEGATIVE_SCENES, Case
from fingertip.design import Design
from fingertip.jit import compiled

FORCES_N = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0)
RISES_S = (0.002, 0.004, 0.01)
"""Rise times of a knock [s]: 2 to 10 ms (assumption, as in ``params/scenes/hard_tap.toml``)."""
_SEED_OFFSET = 20_000


@dataclass(frozen=True)
class KnockResult:
    """Result of one detector for knocks of one force and rise time."""

    detector: str
    force_n: float
    """Peak force [N]."""
    rise_s: float
    false_alarm_share: float
    """Fraction of the knocks that were reported as slip: alarms over knocks, at most 1."""


def study_knock_rejection(
    design: Design,
    detectors: Sequence[str] = ("digital", "fast"),
    scenes: int = 3,
    first_seed: int = HELD_OUT_FROM,
    forces_n: Sequence[float] = FORCES_N,
    rises_s: Sequence[float] = RISES_S,
) -> list[KnockResult]:
    """Run scenes with a few knocks each, for every force and rise time."""
    scene = NEGATIVE_SCENES["hard tap"][0]
    results, seed = [], first_seed + _SEED_OFFSET
    with compiled():
        for rise_s in rises_s:
            for force_n in forces_n:
                tap = scene.tap.model_copy(update={"force_n": force_n, "rise_s": rise_s})
                alarms = dict.fromkeys(detectors, 0)
                for _ in range(scenes):
                    case = Case("hard tap", scene.model_copy(update={"tap": tap}), seed)
                    trace, held_n = simulate_trace(design, case, detectors)
                    for name in detectors:
                        (result,) = evaluate(case, trace, held_n, name, design, [1.0])
                        alarms[name] += len(result.alarms)
                    seed += 1
                for name in detectors:
                    fraction = min(1.0, alarms[name] / (scenes * tap.count))
                    results.append(KnockResult(name, force_n, rise_s, fraction))
    return results
