"""Sensitivity of the delay to the simulation's assumptions: one at a time, on the same trials.

Among them are effects that real fingers show and that the trials leave out by default: a pad that averages the surface
over its contact patch, stick-slip, noise that is not white, mains hum, and converters of microcontrollers. Their levels
are assumptions that nobody has verified.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from fingertip.campaign.evaluate import TrialResult, evaluate, simulate_trace
from fingertip.campaign.plan import HELD_OUT_FROM, REPORTED_SEPARATELY, CampaignPlan, generate_cases
from fingertip.campaign.run import DetectorResult
from fingertip.campaign.studies.assumption_variations import VARIATIONS, Variation
from fingertip.campaign.true_slip import find_onset_s, measure_vibration_n, median_of_known
from fingertip.design import Design
from fingertip.jit import compiled

UNCHANGED = Variation("unchanged", {})
_NEGATIVE_MINUTES = 2.0


@dataclass(frozen=True)
class VariationResult:
    """Result with one changed assumption."""

    label: str
    is_realistic: bool
    """True for an effect that real fingers show and the trials leave out by default."""
    slips: int
    """Number of true slips; a trial with stick-slip may have several."""
    found_share: float
    median_s: float
    """Median delay over all slips [s]; infinite if fewer than half were found."""
    change_s: float
    """Change of the median against the unchanged trials [s]; NaN if either is infinite."""
    alarms_per_minute: float
    """False alarms in a few minutes without slip: a change that shortens the delay may also cause alarms."""
    onset_change_s: float
    """Median change of the true onset of slip, counted from the start of the slide [s]; NaN if none is comparable."""
    vibration_n: float
    """RMS vibration of the normal force in slip, median of the trials [N]; NaN without slip."""


@dataclass(frozen=True)
class _VariationRun:
    pooled: DetectorResult
    onsets_s: tuple[float, ...]
    """True onset in each trial, NaN without slip."""
    vibrations_n: tuple[float, ...]


def study_assumptions(
    design: Design,
    detector: str,
    trials: int = 24,
    first_seed: int = HELD_OUT_FROM,
    variations: Sequence[Variation] = VARIATIONS,
) -> list[VariationResult]:
    """Measure the delay without and with each change; all thresholds follow the noise, the design's own one too."""
    base = _run_variation(design, detector, UNCHANGED, trials, first_seed)
    results = [_compare(UNCHANGED, base, base)]
    for variation in variations:
        results.append(_compare(variation, _run_variation(design, detector, variation, trials, first_seed), base))
    return results


def _run_variation(design: Design, detector: str, variation: Variation, trials: int, first_seed: int) -> _VariationRun:
    changed_design = variation.vary_design(design)
    collected: list[TrialResult] = []
    onsets_s, vibrations_n = [], []
    with compiled():
        for case in generate_cases(CampaignPlan(trials, _NEGATIVE_MINUTES), first_seed):
            if case.cause in REPORTED_SEPARATELY:
                continue
            changed_case = replace(case, scene=variation.vary_scene(case.scene))
            trace, force_n = simulate_trace(changed_design, changed_case, [detector])
            collected += evaluate(changed_case, trace, force_n, detector, changed_design, [1.0])
            if case.cause == "slip":
                onsets_s.append(find_onset_s(changed_design, changed_case, trace))
                vibrations_n.append(measure_vibration_n(trace))
    return _VariationRun(DetectorResult(1.0, tuple(collected)), tuple(onsets_s), tuple(vibrations_n))


def _compare(variation: Variation, run: _VariationRun, base: _VariationRun) -> VariationResult:
    median_s, before_s = run.pooled.delay_s(0.5), base.pooled.delay_s(0.5)
    is_comparable = math.isfinite(median_s) and math.isfinite(before_s)
    return VariationResult(
        variation.label,
        variation.is_realistic,
        run.pooled.slips,
        run.pooled.found_share,
        median_s,
        median_s - before_s if is_comparable else math.nan,
        run.pooled.alarms_per_minute,
        median_of_known(now - before for now, before in zip(run.onsets_s, base.onsets_s, strict=True)),
        median_of_known(run.vibrations_n),
    )
