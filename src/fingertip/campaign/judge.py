"""One trace through one detector at several thresholds: delays, alarms by cause, share of the slip that is ON."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.campaign.plan import Case
from fingertip.campaign.record import samples
from fingertip.design import Design
from fingertip.slip import Trace, make
from fingertip.slip.intervals import INCIPIENT_S, Interval, intervals, score

TOGETHER_S = 0.1
"""Alarms closer together are one: it is one event that a hand would react to once. Assumption."""


@dataclass(frozen=True)
class Verdict:
    """What a detector made of one case."""

    case: Case
    duration_s: float
    force_n: float
    slips: int
    delays_s: tuple[float, ...]
    """Of the slips that were found; 0 in incipient slip. One before which it was ON already is an alarm, not found."""
    on_share: float
    """Of the time from the first finding to the slip's end; 0 if there is none."""
    alarms: tuple[str, ...]
    """Causes, one for each false alarm."""


def judge(
    case: Case, trace: Trace, force_n: float, detector: str, design: Design, scales: Sequence[float]
) -> list[Verdict]:
    """Verdicts, one for each factor of the threshold.

    Where the bar never moves, the level is the same for every factor, and is computed once.
    """
    whole, signal = make(detector, design), samples(trace, detector)
    output = whole.process(signal)
    fixed = float(np.ptp(output.bar_v)) == 0.0
    found = []
    for scale in scales:
        if scale == 1.0:
            on = output.on
        elif fixed:
            on = output.level_v > scale * output.bar_v
        else:
            on = make(detector, design, scale=scale).process(signal).on
        found.append(_verdict(case, trace, force_n, on, whole.memory_s))
    return found


def _verdict(case: Case, trace: Trace, force_n: float, on: NDArray[np.bool_], memory_s: float) -> Verdict:
    assert trace.slip is not None
    judged = score(intervals(trace.time_s, on), intervals(trace.time_s, trace.slip), memory_s)
    # What hears incipient slip is not sooner for that: its delay is 0.
    counted = [0.0 if d is not None and -INCIPIENT_S <= d < 0.0 else d for d in judged.delays_s]
    delays = tuple(d for d in counted if d is not None and d >= 0.0)
    early = [d for d in counted if d is not None and d < 0.0]
    share = 0.0
    if delays:
        slip, delay = next((s, d) for s, d in zip(judged.slips, counted, strict=True) if d in delays)
        since = (trace.time_s >= slip.onset_s + (delay or 0.0)) & (trace.time_s < slip.end_s)
        share = float(np.mean(on[since])) if since.any() else 0.0
    alarms = [_cause(case, alarm, judged.slips) for alarm in _apart(judged.false_intervals)]
    alarms += ["before slip"] * len(early)
    duration = float(trace.time_s[-1] - trace.time_s[0])
    return Verdict(case, duration, force_n, len(judged.slips), delays, share, tuple(alarms))


def _apart(alarms: Sequence[Interval]) -> list[Interval]:
    kept: list[Interval] = []
    end = -np.inf
    for alarm in alarms:
        if alarm.onset_s - end > TOGETHER_S:
            kept.append(alarm)
        end = alarm.end_s
    return kept


def _cause(case: Case, alarm: Interval, slips: Sequence[Interval]) -> str:
    """In a trial: what came before the slip is the contact or the grasp, what came after it the release."""
    if case.cause != "slip":
        return case.cause
    return "contact" if slips and alarm.onset_s < slips[0].onset_s else "release"
