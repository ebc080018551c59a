"""Results of a validation: one JSON object, text, and the page of failures beside the assumptions of each figure."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

from fingertip.catalogues.electronics import PART_TO_PART
from fingertip.documents.template import lay_out_page, render
from fingertip.lab.campaign.closed_loop import NO_CONTROL, ClosedLoopSummary, ClosedLoopTrial
from fingertip.lab.campaign.mix import MixSummary
from fingertip.lab.campaign.plan import REPORTED_SEPARATELY, TUNING_SEEDS
from fingertip.lab.campaign.run import CampaignResult, DetectorResult, speed_m_s, surface
from fingertip.sim.signal.parameters import ACCELERATION_M_S2
from fingertip.slip.traces.truth import ENCODER_HZ, ENCODER_NOTE, INCIPIENT_S, encoder_delay_band_s, format_delay_band

MATCHED_ALARMS_PER_MINUTE = 0.1
"""Rate of false alarms at which detectors are compared [1/min]."""
ONSETS: Mapping[str, Any] = tomllib.loads(Path(__file__).with_name("onsets.toml").read_text(encoding="utf-8"))
"""Times before gross slip in the article's trials [ms], which ``tools/onsets.py`` measures."""
STATED: Mapping[str, Any] = {
    "onsets": ONSETS,
    "incipient_s": INCIPIENT_S,
    "acceleration_m_s2": ACCELERATION_M_S2,
    "tuning_seeds": TUNING_SEEDS,
    "reported_separately": REPORTED_SEPARATELY,
}


def format_ms(seconds: float, otherwise: str = "missed", form: str = ".1f", unit: str = " ms") -> str:
    """Format a time in milliseconds; another text stands for one that is not finite."""
    return f"{1000 * seconds:{form}}{unit}" if math.isfinite(seconds) else otherwise


def to_number(value: float) -> float | None:
    """Round a number for JSON; None stands for one that is not finite."""
    return round(value, 7) if math.isfinite(value) else None


@dataclass(frozen=True)
class FurtherResults:
    """Results beside the campaign."""

    closed_loop: Sequence[ClosedLoopSummary]
    """Manipulations, without control and with each detector."""
    seed_ranges: Sequence[DetectorResult]
    """The detector's campaign on several ranges of seeds, the reported one first."""
    wider_mix: Mapping[str, MixSummary]


def as_data(result: CampaignResult, further: FurtherResults) -> dict[str, Any]:
    """Return all results for JSON, in seconds and fractions; an infinite delay is null."""
    assumptions = lay_out_page(render("validation/assumptions.md", **STATED))
    return {
        "matched_alarms_per_minute": MATCHED_ALARMS_PER_MINUTE,
        "matched": {name: _summary(matched) if matched else None for name, matched in _matched(result).items()},
        "trials": result.plan.trials,
        "negative_minutes": result.plan.negative_minutes,
        "first_seed": result.first_seed,
        "detectors": {name: _detector(result, name) for name in result.detectors},
        "closed_loop": [
            {
                **asdict(row),
                "reactions_s": [round(s, 7) for s in row.reactions_s],
                "slipped_m": round(row.slipped_m, 7),
                "force_ratio": to_number(row.force_ratio),
            }
            for row in further.closed_loop
        ],
        "seed_ranges": ranges_as_data(further.seed_ranges),
        "wider_mix": mix_as_data(further.wider_mix),
        "assumptions": [line.removeprefix("- ") for line in assumptions.splitlines()],
    }


def _matched(result: CampaignResult) -> dict[str, DetectorResult | None]:
    return {name: result.at_alarm_rate(name, MATCHED_ALARMS_PER_MINUTE) for name in result.detectors}


def _detector(result: CampaignResult, name: str) -> dict[str, Any]:
    nominal = result.at_nominal_threshold(name)
    minutes = nominal.minutes()
    alarms: dict[str, dict[str, Any]] = {}
    for cause, count in nominal.alarms().items():
        if cause != "slip":
            duration, is_separate = round(minutes.get(cause, 0.0), 3), cause in REPORTED_SEPARATELY
            alarms[cause] = {"count": count, "minutes": duration, "reported_separately": is_separate}
    return {
        **_summary(nominal),
        "below_30_ms": round(nominal.share_within_30_ms, 4),
        "surfaces": {str(k): _group(v) for k, v in nominal.group_delays(surface).items()},
        "speeds_m_s": {str(k): _group(v) for k, v in nominal.group_delays(speed_m_s).items()},
        "alarms": alarms,
        "trial_minutes": round(minutes.get("slip", 0.0), 3),
        "delays_s": [round(d, 7) for d in nominal.delays_s],
        "trade_off": [_summary(r) for r in result.detectors[name]],
    }


def _summary(result: DetectorResult) -> dict[str, Any]:
    return {
        "scale": result.scale,
        "found_share": round(result.found_share, 5),
        "median_s": to_number(result.delay_s(0.5)),
        "p90_s": to_number(result.delay_s(0.9)),
        "worst_s": to_number(result.worst_s),
        "median_since_motion_s": to_number(result.motion_delay_s(0.5)),
        "p90_since_motion_s": to_number(result.motion_delay_s(0.9)),
        "p90_since_motion_by_encoders_s": [to_number(s) for s in encoder_delay_band_s(result.motion_delay_s(0.9))],
        "on_share": round(result.on_share, 4),
        "alarms_per_minute": round(result.alarms_per_minute, 4),
        "alarms_per_minute_95": [to_number(rate) for rate in result.alarm_interval],
    }


def _group(values: tuple[float, float, int]) -> dict[str, Any]:
    mean, deviation, count = values
    return {"mean_s": to_number(mean), "deviation_s": to_number(deviation), "found": count}


def pool_ranges(ranges: Sequence[DetectorResult]) -> DetectorResult:
    """Pool the trials of all ranges of seeds, whose thresholds are the same."""
    return DetectorResult(1.0, tuple(trial for result in ranges for trial in result.trials))


def ranges_as_data(ranges: Sequence[DetectorResult]) -> dict[str, Any]:
    pooled = pool_ranges(ranges)
    low, high = pooled.alarm_interval
    return {
        "ranges": [{"alarms": r.limited_alarms, "minutes": round(r.limited_minutes, 3)} for r in ranges],
        "alarms": pooled.limited_alarms,
        "minutes": round(pooled.limited_minutes, 3),
        "alarms_per_minute_95": [round(low, 5), to_number(high)],
    }


def mix_as_data(mix: Mapping[str, MixSummary]) -> dict[str, Any]:
    """Return the wider mix for JSON; what a kind does not have is null."""
    return {
        kind: {
            "slips": summary.slides,
            "found_share": to_number(summary.found_share),
            "median_s": to_number(summary.delay_s(0.5)),
            "p90_s": to_number(summary.delay_s(0.9)),
            "worst_s": to_number(summary.worst_s),
            "p90_since_motion_s": to_number(summary.motion_delay_s(0.9)),
            "smallest_on_share": to_number(summary.smallest_on_share),
            "events": summary.events,
            "disturbed_share": to_number(summary.disturbed_share),
            "alarms": summary.alarms,
            "minutes": round(summary.minutes, 3),
        }
        for kind, summary in mix.items()
    }


def mix_table(ranges: Sequence[DetectorResult], mix: Mapping[str, MixSummary], detector: str) -> list[str]:
    pooled = pool_ranges(ranges)
    low, high = pooled.alarm_interval
    counts = ", ".join(f"{r.limited_alarms} in {r.limited_minutes:.1f} min" for r in ranges)
    lines = [
        "",
        f"alarms of {detector} over {len(ranges)} ranges of seeds: {counts};",
        f"together {pooled.limited_alarms} in {pooled.limited_minutes:.1f} min, with 95 % probability {low:.3f} to "
        f"{high:.3f} per minute",
        "",
        f"{detector} on the wider mix; delays since gross slip, p90 also since motion; disturbed: events with alarm;",
        f"{ENCODER_NOTE}:",
        f"{'':26} {'found':>7} {'median':>9} {'p90':>9} {'worst':>9} {'p90 motion':>10} {'disturbed':>12} "
        f"{'alarms/min':>10}",
    ]
    for kind, summary in mix.items():
        found = f"{100 * summary.found_share:6.1f}%" if summary.slides else ""
        delays = (summary.delay_s(0.5), summary.delay_s(0.9), summary.worst_s, summary.motion_delay_s(0.9))
        cells = [format_ms(delay) if summary.slides else "" for delay in delays]
        events = f"{100 * summary.disturbed_share:.1f}% of {summary.events}" if summary.events else ""
        lines.append(
            f"{kind:26} {found:>7} {cells[0]:>9} {cells[1]:>9} {cells[2]:>9} {cells[3]:>10} {events:>12} "
            f"{summary.alarms_per_minute:10.2f}"
        )
    return lines


_ms = partial(format_ms, otherwise="  missed ", form="6.1f")


def as_text(result: CampaignResult, detector: str, further: FurtherResults) -> str:
    return "\n".join(
        [
            *_delay_table(result),
            *_alarm_table(result),
            *_matched_table(result),
            *mix_table(further.seed_ranges, further.wider_mix, detector),
            *_closed_loop_table(further.closed_loop),
        ]
    )


def _delay_table(result: CampaignResult) -> Iterator[str]:
    yield f"{'':17}{'since gross slip':>27} {'since motion':>21} {'p90 since motion,':>18}"
    yield (
        f"{'detector':8} {'found':>7} {'median':>9} {'p90':>9} {'worst':>9} {'median':>9} {'p90':>9} "
        f"{f'encoders {ENCODER_HZ:g} Hz':>18} {'< 30 ms':>7}"
    )
    for name in result.detectors:
        nominal = result.at_nominal_threshold(name)
        p90_s = nominal.motion_delay_s(0.9)
        band = format_delay_band(p90_s) if math.isfinite(p90_s) else "missed"
        yield (
            f"{name:8} {100 * nominal.found_share:6.1f}% {_ms(nominal.delay_s(0.5))} {_ms(nominal.delay_s(0.9))} "
            f"{_ms(nominal.worst_s)} {_ms(nominal.motion_delay_s(0.5))} {_ms(p90_s)} "
            f"{band:>18} {100 * nominal.share_within_30_ms:6.1f}%"
        )
    yield "found, median, p90, worst: slips found, percentiles of the delay, longest found."
    yield "Since gross slip: the pad slides at 1 mm/s. Since motion: the robot moved;"
    yield f"{ENCODER_NOTE}."
    yield "< 30 ms: slips found within 30 ms of gross slip."
    yield ""


def _alarm_table(result: CampaignResult) -> Iterator[str]:
    yield f"{'detector':8} {'ON':>7} {'alarms/min (95 %)':>20}   " + "   ".join(REPORTED_SEPARATELY)
    for name in result.detectors:
        nominal = result.at_nominal_threshold(name)
        alarms, minutes = nominal.alarms(), nominal.minutes()
        separate = "   ".join(f"{alarms[c] / minutes[c]:{len(c)}.1f}" for c in REPORTED_SEPARATELY if c in minutes)
        low, high = nominal.alarm_interval
        rate = f"{nominal.alarms_per_minute:.2f} ({low:.2f}-{high:.2f})"
        yield f"{name:8} {100 * nominal.on_share:6.1f}% {rate:>20}   {separate}".rstrip()
    yield "ON: share of a slip, after its detection, in which the detector is ON."
    yield f"{', '.join(REPORTED_SEPARATELY)}: false alarms per minute in these scenes;"
    yield "alarms/min excludes them."
    yield ""


def _matched_table(result: CampaignResult) -> Iterator[str]:
    yield f"each detector at its lowest threshold with at most {MATCHED_ALARMS_PER_MINUTE:g} alarms per minute:"
    for name, matched in _matched(result).items():
        if matched is None:
            yield f"{name:8} none of the thresholds has so few alarms"
        else:
            yield (
                f"{name:8} {100 * matched.found_share:6.1f}% {_ms(matched.delay_s(0.5))} "
                f"{_ms(matched.delay_s(0.9))}   at {matched.scale:g} times its nominal threshold"
            )


def _closed_loop_table(rows: Sequence[ClosedLoopSummary]) -> Iterator[str]:
    yield ""
    yield "closed loop: four objects, each hit by a robot's pin. False grips: grip increases"
    yield "without slip. Suppressed: detections without slip that did not tighten the grip,"
    yield "because the hand was closing or its force was growing."
    yield "Slipped: median way of the object. Force: at the end, over the planned one, of objects held."
    yield (
        f"{'detector':18} {'held':>9} {'slipped':>9} {'force':>6}   {'reaction median, slowest':>24} "
        f"{'false grips':>11} {'suppressed':>10}"
    )
    for row in rows:
        text = f"{row.detector:18} {f'{row.held} of {row.count}':>9} {1000 * row.slipped_m:6.1f} mm"
        text += f" {row.force_ratio:6.2f}" if row.held else f" {'-':>6}"
        if row.detector != NO_CONTROL:
            ranked = row.reactions_s
            times = f"{_ms(ranked[len(ranked) // 2])} {_ms(ranked[-1])}" if ranked else "no slip"
            text += f"   {times:>24} {row.false_grips:11} {row.suppressed:10}"
        yield text


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
