"""Tables of the wider mix, and of the alarms over several ranges of seeds."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from fingertip.foundation.numerics import poisson_interval
from fingertip.lab.campaign.mix import MixSummary
from fingertip.lab.campaign.run import DetectorResult
from fingertip.slip.traces.origin import ENCODER_NOTE


def format_rate(result: DetectorResult) -> str:
    """Alarms per minute with their interval, such as ``0.02 (0.00-0.11)``."""
    low, high = result.alarm_interval
    return f"{result.alarms_per_minute:.2f} ({low:.2f}-{high:.2f})"


def pool_ranges(ranges: Sequence[DetectorResult]) -> tuple[int, float, float, float]:
    """Pool the alarms of all ranges: their number, the time [min], and the interval of the rate [1/min]."""
    alarms, minutes = sum(r.limited_alarms for r in ranges), sum(r.limited_minutes for r in ranges)
    low, high = poisson_interval(alarms)
    return (alarms, minutes, low / minutes, high / minutes) if minutes else (alarms, minutes, 0.0, math.inf)


def ranges_as_data(ranges: Sequence[DetectorResult]) -> dict[str, Any]:
    """Return the alarms of all ranges for JSON."""
    alarms, minutes, low, high = pool_ranges(ranges)
    return {
        "ranges": [{"alarms": r.limited_alarms, "minutes": round(r.limited_minutes, 3)} for r in ranges],
        "alarms": alarms,
        "minutes": round(minutes, 3),
        "alarms_per_minute_95": [round(low, 5), _number(high)],
    }


def as_data(mix: Mapping[str, MixSummary]) -> dict[str, Any]:
    """Return the wider mix for JSON; what a kind does not have is null."""
    return {
        kind: {
            "slips": summary.slides,
            "found_share": _number(summary.found_share),
            "median_s": _number(summary.delay_s(0.5)),
            "p90_s": _number(summary.delay_s(0.9)),
            "worst_s": _number(summary.worst_s),
            "p90_since_motion_s": _number(summary.motion_delay_s(0.9)),
            "smallest_on_share": _number(summary.on_share),
            "events": summary.events,
            "disturbed_share": _number(summary.disturbed_share),
            "alarms": summary.alarms,
            "minutes": round(summary.minutes, 3),
        }
        for kind, summary in mix.items()
        if summary.outcomes
    }


def as_lines(ranges: Sequence[DetectorResult], mix: Mapping[str, MixSummary], detector: str) -> list[str]:
    """Format both tables as text."""
    alarms, minutes, low, high = pool_ranges(ranges)
    counts = ", ".join(f"{r.limited_alarms} in {r.limited_minutes:.1f} min" for r in ranges)
    lines = [
        "",
        f"alarms of {detector} over {len(ranges)} ranges of seeds: {counts};",
        f"together {alarms} in {minutes:.1f} min, with 95 % probability {low:.3f} to {high:.3f} per minute",
        "",
        f"{detector} on the wider mix; delays since gross slip, p90 also since motion; disturbed: events with alarm;",
        f"{ENCODER_NOTE}:",
        f"{'':26} {'found':>7} {'median':>9} {'p90':>9} {'worst':>9} {'p90 motion':>10} {'disturbed':>12} "
        f"{'alarms/min':>10}",
    ]
    for kind, summary in mix.items():
        if not summary.outcomes:
            continue
        found = f"{100 * summary.found_share:6.1f}%" if summary.slides else ""
        delays = (summary.delay_s(0.5), summary.delay_s(0.9), summary.worst_s, summary.motion_delay_s(0.9))
        cells = [_ms(delay) if summary.slides else "" for delay in delays]
        events = f"{100 * summary.disturbed_share:.1f}% of {summary.events}" if summary.events else ""
        lines.append(
            f"{kind:26} {found:>7} {cells[0]:>9} {cells[1]:>9} {cells[2]:>9} {cells[3]:>10} {events:>12} "
            f"{summary.alarms_per_minute:10.2f}"
        )
    return lines


def _ms(seconds: float) -> str:
    return f"{1000 * seconds:.1f} ms" if math.isfinite(seconds) else "missed"


def _number(value: float) -> float | None:
    return round(value, 7) if math.isfinite(value) else None
