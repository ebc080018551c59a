"""Markdown page of a validation: failures, assumptions beside each figure, and what was not tested."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

from fingertip.catalogues.sensors import PART_TO_PART
from fingertip.documents.template import render
from fingertip.lab.campaign.closed_loop import NO_CONTROL, ClosedLoopTrial
from fingertip.lab.campaign.plan import REPORTED_SEPARATELY
from fingertip.lab.campaign.run import CampaignResult, DetectorResult, surface
from fingertip.lab.report.numbers import BESIDE_ARTICLE, format_milli, format_mn, format_ms, format_mv
from fingertip.lab.report.robustness import LEVELS_ARE_ASSUMED
from fingertip.lab.report.tables import STATED, StudyResults
from fingertip.lab.studies import sensitivity
from fingertip.lab.studies.article import RESONANCES_HZ
from fingertip.lab.studies.steps import GOAL_SHARE
from fingertip.sim.contact.materials import ARTICLE_SURFACES, SURFACES

_EXPLAINED = {
    "patch": sensitivity.PATCH_AVERAGE,
    "stick_slip": sensitivity.STICK_SLIP,
    "both": sensitivity.BOTH,
    "elasto_plastic": sensitivity.ELASTO_PLASTIC,
}
"""Name in the template -> label of a variation that it explains."""


def as_markdown(
    result: CampaignResult,
    missed: Sequence[str],
    closed_loop: Sequence[ClosedLoopTrial],
    studies: StudyResults,
    detector: str,
) -> str:
    """Write the page; `missed` are the messages of requirements."""
    shifts = studies.steps.shifts
    return render(
        "validation/omissions.md",
        **STATED,
        **collect_effects(studies.variations, studies.patch_radius_m),
        steps=studies.steps,
        goal_share=GOAL_SHARE,
        goal_missed=[row.detector for row in shifts if not row.meets_goal],
        found_once=[f"{row.detector} {row.one_grid_only}" for row in shifts if row.one_grid_only],
        largest_errors=[f"{row.signal} {format_milli(row.worst, row.signal)}" for row in studies.steps.errors],
        detector=detector,
        missed=missed,
        failures=[_collect_failures(name, result.at_nominal_threshold(name)) for name in result.detectors],
        manipulations=list(_list_manipulations(closed_loop)),
        all_held=all(trial.held for trial in closed_loop),
        resonances_hz=RESONANCES_HZ,
        part_to_part=PART_TO_PART,
    )


def collect_effects(variations: Sequence[sensitivity.VariationResult], patch_radius_m: float) -> dict[str, Any]:
    """Collect what the page says of effects that the trials leave out."""
    base, rows = variations[0], {v.label: v for v in variations}
    patch = rows.get(sensitivity.PATCH_AVERAGE)
    return {
        **{name: rows.get(label) for name, label in _EXPLAINED.items()},
        "base": base,
        "other_effects": [v for v in variations[1:] if v.is_realistic and v.label not in _EXPLAINED.values()],
        "laws": [v for v in variations if v.is_law],
        "beside": BESIDE_ARTICLE,
        "loaded_on": sensitivity.LOADED_ON,
        "loads_n": sensitivity.LOADS_N,
        "patch_radius_m": patch_radius_m,
        "patch_ratio": base.vibration_n / patch.vibration_n if patch and patch.vibration_n else math.inf,
        "wavelengths_mm": sorted({SURFACES[name].longest_wave_mm for name in ARTICLE_SURFACES}),
        "held_longer": sensitivity.HELD_LONGER,
        "levels_are_assumed": LEVELS_ARE_ASSUMED,
        "isfinite": math.isfinite,
        "ms": format_ms,
        "mn": format_mn,
        "mv": format_mv,
    }


def _collect_failures(name: str, nominal: DetectorResult) -> dict[str, Any]:
    groups: dict[str, list[int]] = {}
    for trial in nominal.trials:
        if trial.slips:
            group = groups.setdefault(surface(trial), [0, 0])
            group[0] += trial.slips - len(trial.delays_s)
            group[1] += trial.slips
    minutes = nominal.minutes()
    return {
        "detector": name,
        "missed": [f"{count} of {total} on {where}" for where, (count, total) in groups.items() if count],
        "alarms": [
            f"{cause} {count} in {minutes[cause]:.1f} min"
            f"{' (reported separately)' if cause in REPORTED_SEPARATELY else ''}"
            if cause in minutes
            else f"{cause} {count}"
            for cause, count in nominal.alarms().items()
            if count
        ],
    }


def _list_manipulations(closed_loop: Sequence[ClosedLoopTrial]) -> Iterator[tuple[str, list[str]]]:
    """Yield the name of each manipulation that failed, and how."""
    for trial in closed_loop:
        failures = [] if trial.held else ["object lost"]
        if trial.detector != NO_CONTROL:
            if trial.onset_s is not None and trial.reaction_s is None:
                failures.append("no reaction to slip")
            if trial.false_grips:
                failures.append(f"{trial.false_grips} grip increases without slip")
            if trial.suppressed_true:
                failures.append(f"{trial.suppressed_true} true detections suppressed before the first grip increase")
        if failures:
            yield f"{trial.detector}, {trial.name}, seed {trial.seed}", failures
