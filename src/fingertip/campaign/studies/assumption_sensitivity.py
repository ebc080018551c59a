"""Sensitivity of the delay to the simulation's assumptions: one at a time, on the same trials."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from fingertip.campaign.evaluate import TrialResult, evaluate, needs_board, simulate_trace
from fingertip.campaign.plan import HELD_OUT_FROM, REPORTED_SEPARATELY, CampaignPlan, generate_cases
from fingertip.campaign.run import DetectorResult
from fingertip.design import Design
from fingertip.jit import compiled
from fingertip.sim import SceneFile
from fingertip.slip.detectors.noise import noise_level


@dataclass(frozen=True)
class Variation:
    """One changed assumption."""

    label: str
    table: str
    """Table of the scene, or ``detector`` of the design."""
    key: str
    factor: float


VARIATIONS: tuple[Variation, ...] = (
    Variation("surface accelerates at 0.5 m/s2", "slide", "acceleration_m_s2", 0.5),
    Variation("surface accelerates at 4 m/s2", "slide", "acceleration_m_s2", 4.0),
    Variation("resonance 60 Hz", "contact", "resonance_hz", 60 / 90),
    Variation("resonance 135 Hz", "contact", "resonance_hz", 1.5),
    Variation("half the force", "hold", "force", 0.5),
    Variation("half the noise", "detector", "noise_v", 0.5),
    Variation("twice the noise", "detector", "noise_v", 2.0),
    Variation("half the speed", "slide", "speed_m_s", 0.5),
)


_NEGATIVE_MINUTES = 2.0


@dataclass(frozen=True)
class VariationResult:
    """Result with one changed assumption."""

    label: str
    found_share: float
    median_s: float
    """Median delay over all slips [s]; infinite if fewer than half were found."""
    change_s: float
    """Change of the median against the unchanged trials [s]."""
    alarms_per_minute: float
    """False alarms in a few minutes without slip: a change that shortens the delay may also cause alarms."""


def study_assumptions(
    design: Design,
    detector: str,
    trials: int = 24,
    first_seed: int = HELD_OUT_FROM,
    variations: Sequence[Variation] = VARIATIONS,
) -> list[VariationResult]:
    """Measure the delay without and with each change; all thresholds follow the noise, the design's own one too."""
    base = _run_variation(design, detector, None, trials, first_seed)
    median = base.delay_s(0.5)
    results = [VariationResult("unchanged", base.found_share, median, 0.0, base.alarms_per_minute)]
    for variation in variations:
        pooled = _run_variation(design, detector, variation, trials, first_seed)
        change = pooled.delay_s(0.5) - median if math.isfinite(median) else math.nan
        results.append(
            VariationResult(variation.label, pooled.found_share, pooled.delay_s(0.5), change, pooled.alarms_per_minute)
        )
    return results


def _run_variation(
    design: Design, detector: str, variation: Variation | None, trials: int, first_seed: int
) -> DetectorResult:
    changed_design = _vary_design(design, variation) if variation and variation.table == "detector" else design
    collected: list[TrialResult] = []
    with compiled():
        for case in generate_cases(CampaignPlan(trials, _NEGATIVE_MINUTES), first_seed):
            if case.cause in REPORTED_SEPARATELY:
                continue
            changed_case = replace(case, scene=_vary_scene(case.scene, variation))
            trace, force_n = simulate_trace(changed_design, changed_case, needs_board(detector))
            collected += evaluate(changed_case, trace, force_n, detector, changed_design, [1.0])
    return DetectorResult(1.0, tuple(collected))


def _vary_design(design: Design, variation: Variation) -> Design:
    """Change the design, and its threshold by the same ratio as the threshold that its noise allows."""
    tables = design.model_dump()
    tables["detector"][variation.key] *= variation.factor
    before, after = noise_level(design).threshold_v, noise_level(Design(**tables)).threshold_v
    if before > 0.0 and after > 0.0:
        tables["detector"]["threshold_v"] *= after / before
    return Design(**tables)


def _vary_scene(scene: SceneFile, variation: Variation | None) -> SceneFile:
    tables: dict[str, Any] = scene.model_dump()
    if variation and variation.table != "detector":
        keys = ["min_force_n", "max_force_n"] if variation.key == "force" else [variation.key]
        for key in keys:
            tables[variation.table][key] *= variation.factor
    return SceneFile(**tables)
