"""Markdown page of a validation: failures, assumptions beside each figure, and what was not tested."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from fingertip.catalogues.sensors import PART_TO_PART
from fingertip.documents.template import render
from fingertip.lab.campaign.closed_loop import NO_CONTROL, ClosedLoopTrial
from fingertip.lab.campaign.plan import REPORTED_SEPARATELY
from fingertip.lab.campaign.run import CampaignResult, DetectorResult, surface
from fingertip.lab.report.tables import STATED


def as_markdown(result: CampaignResult, missed: Sequence[str], closed_loop: Sequence[ClosedLoopTrial]) -> str:
    """Write the page; `missed` are the messages of requirements."""
    return render(
        "validation/omissions.md",
        **STATED,
        missed=missed,
        failures=[_collect_failures(name, result.at_nominal_threshold(name)) for name in result.detectors],
        manipulations=list(_list_manipulations(closed_loop)),
        all_held=all(trial.held for trial in closed_loop),
        part_to_part=PART_TO_PART,
    )


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
