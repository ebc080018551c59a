"""Knocks on the held object, from weak to hard: which of them a detector takes for slip, and why no more can be done.

A knock rings the pad at its own resonance, in the very band in which slip shows, and lasts as long as the energy of a
few milliseconds: on one force axis a weak knock is a short slip. What sets a hard one apart is only that no slip ever
changed the force so steeply; `fast` takes steeper ones for knocks, and the bar that grows with the slope does the rest.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from fingertip.campaign.judge import judge
from fingertip.campaign.plan import HELD_OUT_FROM, QUIET, Case
from fingertip.campaign.record import reads_board, record
from fingertip.design import Design
from fingertip.sim.jit import compiled

FORCES_N = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0)
RISES_S = (0.002, 0.004, 0.01)
"""Rise times of a hard tap: 2 to 10 ms (assumption, as in ``params/scenes/hard_tap.toml``)."""
_FIRST = 20_000


@dataclass(frozen=True)
class Taps:
    """Knocks of one force and rise."""

    detector: str
    force_n: float
    """Peak."""
    rise_s: float
    taken_share: float
    """Of the knocks, taken for slip at least once: alarms over knocks, at most 1."""


def taps(
    design: Design,
    detectors: Sequence[str] = ("digital", "fast"),
    scenes: int = 3,
    first_seed: int = HELD_OUT_FROM,
    forces_n: Sequence[float] = FORCES_N,
    rises_s: Sequence[float] = RISES_S,
) -> list[Taps]:
    """Scenes with a few knocks each, of every force and rise."""
    scene = QUIET["hard tap"][0]
    out, seed = [], first_seed + _FIRST
    with compiled():
        for rise_s in rises_s:
            for force_n in forces_n:
                tap = scene.tap.model_copy(update={"force_n": force_n, "rise_s": rise_s})
                alarms = dict.fromkeys(detectors, 0)
                for _ in range(scenes):
                    case = Case("hard tap", scene.model_copy(update={"tap": tap}), seed)
                    trace, held_n = record(design, case, reads_board(*detectors))
                    for name in detectors:
                        (verdict,) = judge(case, trace, held_n, name, design, [1.0])
                        alarms[name] += len(verdict.alarms)
                    seed += 1
                for name in detectors:
                    out.append(Taps(name, force_n, rise_s, min(1.0, alarms[name] / (scenes * tap.count))))
    return out
