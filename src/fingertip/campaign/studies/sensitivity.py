"""Which of the simulation's assumptions moves the delay most: one at a time, on the same trials."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from fingertip.campaign.judge import Verdict, judge
from fingertip.campaign.plan import APART, HELD_OUT_FROM, Amount, cases
from fingertip.campaign.record import reads_board, record
from fingertip.campaign.study import Total
from fingertip.design import Design
from fingertip.sim import SceneFile
from fingertip.sim.jit import compiled
from fingertip.slip.detectors.noise import noise_level


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


_QUIET_MINUTES = 2.0


@dataclass(frozen=True)
class Moved:
    """What a change did."""

    label: str
    found_share: float
    median_s: float
    """Over all slips; infinite if fewer than half were found."""
    by_s: float
    """Against the trials as they are."""
    alarms_per_minute: float
    """In a few minutes without slip: what makes a detector sooner may make it noisy too."""


def table(
    design: Design,
    detector: str,
    trials: int = 24,
    first_seed: int = HELD_OUT_FROM,
    changes: Sequence[Change] = CHANGES,
) -> list[Moved]:
    """The delay with each change, the first without any; thresholds follow the noise, the design's own one too."""
    base = _tried(design, detector, None, trials, first_seed)
    median = base.delay_s(0.5)
    out = [Moved("as it is", base.found_share, median, 0.0, base.alarms_per_minute)]
    for change in changes:
        total = _tried(design, detector, change, trials, first_seed)
        by = total.delay_s(0.5) - median if math.isfinite(median) else math.nan
        out.append(Moved(change.label, total.found_share, total.delay_s(0.5), by, total.alarms_per_minute))
    return out


def _tried(design: Design, detector: str, change: Change | None, trials: int, first_seed: int) -> Total:
    changed = _design(design, change) if change and change.table == "detector" else design
    kept: list[Verdict] = []
    with compiled():
        for case in cases(Amount(trials, _QUIET_MINUTES), first_seed):
            if case.cause in APART:
                continue
            changed_case = replace(case, scene=_scene(case.scene, change))
            trace, force_n = record(changed, changed_case, reads_board(detector))
            kept += judge(changed_case, trace, force_n, detector, changed, [1.0])
    return Total(1.0, tuple(kept))


def _design(design: Design, change: Change) -> Design:
    """The design changed, and its threshold by as much as the rule's."""
    tables = design.model_dump()
    tables["detector"][change.key] *= change.factor
    before, after = noise_level(design).threshold_v, noise_level(Design(**tables)).threshold_v
    if before > 0.0 and after > 0.0:
        tables["detector"]["threshold_v"] *= after / before
    return Design(**tables)


def _scene(scene: SceneFile, change: Change | None) -> SceneFile:
    tables: dict[str, Any] = scene.model_dump()
    if change and change.table != "detector":
        keys = ["min_force_n", "max_force_n"] if change.key == "force" else [change.key]
        for key in keys:
            tables[change.table][key] *= change.factor
    return SceneFile(**tables)
