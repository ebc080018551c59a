"""Which of the simulation's assumptions moves the delay most: one at a time, on the same trials."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fingertip.campaign.judge import judge
from fingertip.campaign.plan import HELD_OUT_FROM, Amount, cases
from fingertip.campaign.record import reads_board, record
from fingertip.design import Design
from fingertip.sim import SceneFile
from fingertip.sim.jit import compiled


@dataclass(frozen=True)
class Change:
    """One assumption, changed."""

    label: str
    table: str
    """Of the scene, or ``detector`` of the design."""
    key: str
    factor: float


CHANGES: tuple[Change, ...] = (
    Change("surface starts with 0.5 m/s2", "slide", "acceleration_m_s2", 0.5),
    Change("surface starts with 4 m/s2", "slide", "acceleration_m_s2", 4.0),
    Change("resonance 60 Hz", "contact", "resonance_hz", 60 / 90),
    Change("resonance 135 Hz", "contact", "resonance_hz", 1.5),
    Change("half the force", "hold", "force", 0.5),
    Change("half the noise", "detector", "noise_v", 0.5),
    Change("twice the noise", "detector", "noise_v", 2.0),
    Change("half the speed", "slide", "speed_m_s", 0.5),
)


@dataclass(frozen=True)
class Moved:
    """What a change did."""

    label: str
    found_share: float
    median_s: float
    """Over all slips; infinite if fewer than half were found."""
    by_s: float
    """Against the trials as they are."""


def table(
    design: Design,
    detector: str,
    trials: int = 24,
    first_seed: int = HELD_OUT_FROM,
    changes: Sequence[Change] = CHANGES,
) -> list[Moved]:
    """The delay with each change, the first without any; thresholds follow a design's noise as they always do."""
    share, base = _delay(design, detector, None, trials, first_seed)
    out = [Moved("as it is", share, base, 0.0)]
    for change in changes:
        share, median = _delay(design, detector, change, trials, first_seed)
        out.append(Moved(change.label, share, median, median - base))
    return out


def _delay(design: Design, detector: str, change: Change | None, trials: int, first_seed: int) -> tuple[float, float]:
    tables = design.model_dump()
    if change and change.table == "detector":
        tables["detector"][change.key] *= change.factor
    changed = Design(**tables)
    delays: list[float] = []
    slips = 0
    with compiled():
        for case in cases(Amount(trials, 0.5), first_seed):
            if case.cause != "slip":
                break
            changed_case = replace(case, scene=_scene(case.scene, change))
            trace, force_n = record(changed, changed_case, reads_board(detector))
            (verdict,) = judge(changed_case, trace, force_n, detector, changed, [1.0])
            delays.extend(verdict.delays_s)
            slips += verdict.slips
    ranked = sorted(delays) + [np.inf] * (slips - len(delays))
    return (len(delays) / slips, float(np.median(ranked))) if slips else (0.0, np.inf)


def _scene(scene: SceneFile, change: Change | None) -> SceneFile:
    tables: dict[str, Any] = scene.model_dump()
    if change and change.table != "detector":
        keys = ["force_least_n", "force_most_n"] if change.key == "force" else [change.key]
        for key in keys:
            tables[change.table][key] *= change.factor
    return SceneFile(**tables)
