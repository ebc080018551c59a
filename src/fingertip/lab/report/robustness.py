"""Tables of what the results of a validation depend on: several ranges of seeds, and the wider mix."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from fingertip.lab.campaign.mix import MixSummary
from fingertip.lab.campaign.run import DetectorResult
from fingertip.lab.report.numbers import format_ms, to_number
from fingertip.slip.traces.truth import ENCODER_NOTE


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
