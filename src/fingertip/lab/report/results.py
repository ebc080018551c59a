"""Results of a validation: data for JSON, text, and the page of failures and assumptions."""

from __future__ import annotations

import math
import tomllib
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any

from fingertip.catalogues.electronics import PART_TO_PART
from fingertip.documents.template import lay_out_page, render
from fingertip.lab.campaign.campaign import REPORTED_SEPARATELY, TUNING_SEEDS
from fingertip.lab.campaign.closed_loop import NO_CONTROL, ClosedLoopSummary, ClosedLoopTrial
from fingertip.lab.campaign.run import (
    CampaignResult,
    DetectorResult,
    TrialResult,
    speed_m_s,
    surface,
)
from fingertip.sim.signal.parameters import ACCELERATION_M_S2
from fingertip.slip.traces.truth import (
    ENCODER_HZ,
    ENCODER_NOTE,
    INCIPIENT_S,
    encoder_delay_band_s,
    format_delay_band,
)

MATCHED_ALARMS_PER_MINUTE = 0.1
"""Rate of false alarms at which detectors are compared [1/min]."""
ONSETS: Mapping[str, Any] = tomllib.loads(
    Path(__file__).with_name("onsets.toml").read_text(encoding="utf-8")
)
"""Times before gross slip in the article's trials [ms], which ``tools/onsets.py`` measures."""
STATED: Mapping[str, Any] = {
    "onsets": ONSETS,
    "incipient_s": INCIPIENT_S,
    "acceleration_m_s2": ACCELERATION_M_S2,
    "tuning_seeds": TUNING_SEEDS,
    "reported_separately": REPORTED_SEPARATELY,
}


def format_ms(
    seconds: float, otherwise: str = "missed", form: str = ".1f", unit: str = " ms"
) -> str:
    """Format a time in milliseconds; another text stands for one that is not finite."""
    return f"{1000 * seconds:{form}}{unit}" if math.isfinite(seconds) else otherwise


def format_interval(span_s: tuple[float, float]) -> str:
    """Format an interval of delays in ms; it has no upper end if too few slips were found."""
    low_s, high_s = span_s
    low = format_ms(low_s, unit="")
    return f"{low}-{format_ms(high_s, unit='')}" if math.isfinite(high_s) else f"from {low}"


def to_number(value: float) -> float | None:
    """Round a number for JSON; None stands for one that is not finite."""
    return round(value, 7) if math.isfinite(value) else None


def as_data(result: CampaignResult, closed_loop: Sequence[ClosedLoopSummary]) -> dict[str, Any]:
    """Return all results for JSON, in seconds and fractions; an infinite delay is null."""
    assumptions = lay_out_page(render("validation/assumptions.md", **STATED))
    return {
        "matched_alarms_per_minute": MATCHED_ALARMS_PER_MINUTE,
        "matched": {
            name: summarise(matched) if matched else None
            for name, matched in _matched(result).items()
        },
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
            for row in closed_loop
        ],
        "assumptions": [line.removeprefix("- ") for line in assumptions.splitlines()],
    }


def _matched(result: CampaignResult) -> dict[str, DetectorResult | None]:
    return {
        name: result.at_alarm_rate(name, MATCHED_ALARMS_PER_MINUTE) for name in result.detectors
    }


def _detector(result: CampaignResult, name: str) -> dict[str, Any]:
    """Return the results of one detector for JSON."""
    nominal = result.at_nominal_threshold(name)
    minutes = nominal.minutes()
    alarms: dict[str, dict[str, Any]] = {}

    for cause, count in nominal.alarms().items():
        if cause != "slip":
            duration = round(minutes.get(cause, 0.0), 3)
            is_separate = cause in REPORTED_SEPARATELY
            alarms[cause] = {
                "count": count,
                "minutes": duration,
                "reported_separately": is_separate,
            }

    return {
        **summarise(nominal),
        "below_30_ms": round(nominal.share_within_30_ms, 4),
        "surfaces": _delays_by_group(nominal, surface),
        "speeds_m_s": _delays_by_group(nominal, speed_m_s),
        "alarms": alarms,
        "trial_minutes": round(minutes.get("slip", 0.0), 3),
        "delays_s": [round(d, 7) for d in nominal.delays_s],
        "trade_off": [summarise(r) for r in result.detectors[name]],
    }


def summarise(result: DetectorResult) -> dict[str, Any]:
    """Return the results at one threshold for JSON."""
    return {
        "scale": result.scale,
        "found_share": round(result.found_share, 5),
        "found_share_95": [round(share, 5) for share in result.found_interval],
        "median_s": to_number(result.delay_s(0.5)),
        "p90_s": to_number(result.delay_s(0.9)),
        "median_s_95": [to_number(s) for s in result.delay_interval(0.5)],
        "p90_s_95": [to_number(s) for s in result.delay_interval(0.9)],
        "worst_s": to_number(result.worst_s),
        "median_since_motion_s": to_number(result.motion_delay_s(0.5)),
        "p90_since_motion_s": to_number(result.motion_delay_s(0.9)),
        "p90_since_motion_by_encoders_s": [
            to_number(s) for s in encoder_delay_band_s(result.motion_delay_s(0.9))
        ],
        "on_share": round(result.on_share, 4),
        "alarms_per_minute": round(result.alarms_per_minute, 4),
        "alarms_per_minute_95": [to_number(rate) for rate in result.alarm_interval],
    }


def _delays_by_group(
    result: DetectorResult, key: Callable[[TrialResult], object]
) -> dict[str, dict[str, Any]]:
    return {
        str(group): {
            "mean_s": to_number(mean_s),
            "deviation_s": to_number(deviation_s),
            "found": count,
        }
        for group, (mean_s, deviation_s, count) in result.group_delays(key).items()
    }


_ms = partial(format_ms, otherwise="  missed ", form="6.1f")


def as_text(result: CampaignResult, closed_loop: Sequence[ClosedLoopSummary]) -> str:
    return "\n".join(
        [
            *_delay_table(result),
            *_alarm_table(result),
            *_matched_table(result),
            *_closed_loop_table(closed_loop),
        ]
    )


def _delay_table(result: CampaignResult) -> Iterator[str]:
    yield f"{'':17}{'since gross slip':>27} {'since motion':>21} {'p90 since motion,':>18}"
    yield (
        f"{'detector':8} {'found':>7} {'median':>9} {'p90':>9} {'worst':>9} {'median':>9} "
        f"{'p90':>9} "
        f"{f'encoders {ENCODER_HZ:g} Hz':>18} {'< 30 ms':>7}"
    )
    for name in result.detectors:
        nominal = result.at_nominal_threshold(name)
        p90_s = nominal.motion_delay_s(0.9)
        band = format_delay_band(p90_s) if math.isfinite(p90_s) else "missed"
        yield (
            f"{name:8} {100 * nominal.found_share:6.1f}% {_ms(nominal.delay_s(0.5))} "
            f"{_ms(nominal.delay_s(0.9))} "
            f"{_ms(nominal.worst_s)} {_ms(nominal.motion_delay_s(0.5))} {_ms(p90_s)} "
            f"{band:>18} {100 * nominal.share_within_30_ms:6.1f}%"
        )

    yield (
        f"{'95 %':8} {'found':>13} {'median':>13} {'p90':>13} {'motion median':>14} "
        f"{'motion p90':>13}   from - to"
    )
    for name in result.detectors:
        nominal = result.at_nominal_threshold(name)
        low, high = (100 * share for share in nominal.found_interval)
        intervals = (
            nominal.delay_interval(0.5),
            nominal.delay_interval(0.9),
            nominal.motion_delay_interval(0.5),
            nominal.motion_delay_interval(0.9),
        )
        delays = " ".join(f"{format_interval(interval):>13}" for interval in intervals)
        yield f"{name:8} {f'{low:.1f}-{high:.1f}%':>13} {delays}"

    yield "found, median, p90, worst: slips found, percentiles of the delay, longest found."
    yield "Since gross slip: the pad slides at 1 mm/s. Since motion: the robot moved;"
    yield f"{ENCODER_NOTE}."
    yield "< 30 ms: slips found within 30 ms of gross slip."
    yield ""


def _alarm_table(result: CampaignResult) -> Iterator[str]:
    yield f"{'detector':8} {'ON':>7} {'alarms/min (95 %)':>20}   " + "   ".join(REPORTED_SEPARATELY)
    for name in result.detectors:
        nominal = result.at_nominal_threshold(name)
        alarms = nominal.alarms()
        minutes = nominal.minutes()
        separate = "   ".join(
            f"{alarms[c] / minutes[c]:{len(c)}.1f}" for c in REPORTED_SEPARATELY if c in minutes
        )
        low, high = nominal.alarm_interval
        rate = f"{nominal.alarms_per_minute:.2f} ({low:.2f}-{high:.2f})"
        yield f"{name:8} {100 * nominal.on_share:6.1f}% {rate:>20}   {separate}".rstrip()

    yield "ON: share of a slip, after its detection, in which the detector is ON."
    yield f"{', '.join(REPORTED_SEPARATELY)}: false alarms per minute in these scenes;"
    yield "alarms/min excludes them."
    yield ""


def _matched_table(result: CampaignResult) -> Iterator[str]:
    yield (
        f"each detector at its lowest threshold with at most {MATCHED_ALARMS_PER_MINUTE:g} "
        "alarms per minute:"
    )
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
    yield (
        "Slipped: median way of the object. Force: at the end, over the planned one, of objects "
        "held."
    )
    yield (
        f"{'detector':18} {'held':>9} {'slipped':>9} {'force':>6}   "
        f"{'reaction median, slowest':>24} "
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


def as_markdown(
    result: CampaignResult, missed: Sequence[str], closed_loop: Sequence[ClosedLoopTrial]
) -> str:
    """Write the page; `missed` are the messages of requirements."""
    return render(
        "validation/omissions.md",
        **STATED,
        missed=missed,
        failures=[
            _collect_failures(name, result.at_nominal_threshold(name)) for name in result.detectors
        ],
        manipulations=list(_list_manipulations(closed_loop)),
        all_held=all(trial.held for trial in closed_loop),
        part_to_part=PART_TO_PART,
    )


def _collect_failures(name: str, nominal: DetectorResult) -> dict[str, Any]:
    """Collect the slips that a detector missed by surface, and its false alarms by cause."""
    missed: Counter[str] = Counter()
    slips: Counter[str] = Counter()
    for trial in nominal.trials:
        missed[surface(trial)] += trial.slips - len(trial.delays_s)
        slips[surface(trial)] += trial.slips

    minutes = nominal.minutes()
    alarms = []
    for cause, count in nominal.alarms().items():
        if count:
            duration = f" in {minutes[cause]:.1f} min" if cause in minutes else ""
            note = " (reported separately)" if cause in REPORTED_SEPARATELY else ""
            alarms.append(f"{cause} {count}{duration}{note if duration else ''}")

    return {
        "detector": name,
        "missed": [
            f"{count} of {slips[where]} on {where}" for where, count in missed.items() if count
        ],
        "alarms": alarms,
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
                failures.append(
                    f"{trial.suppressed_true} true detections suppressed before the first grip "
                    "increase"
                )

        if failures:
            yield f"{trial.detector}, {trial.name}, seed {trial.seed}", failures
