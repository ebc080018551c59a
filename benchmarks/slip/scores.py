"""Scores of a detector's flags: delays, share ON, alarms, and what is pooled over recordings.

The same rules hold for every detector. A slip is found if ON begins between its motion, less
`EARLY_S`, and `FOUND_S` after its onset; delays count from the onset, and are 0 before it. An alarm
is a begin of ON outside of every slip and of `AFTER_S` behind it; alarms of one event count once.
An event is taken for slip if ON begins between its start and `AFTER_S` after its end.
"""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.slip.mix_signals import LabelledSignal, Slide
from benchmarks.slip.recordings import UNLABELLED, UNSURE, Recording
from fingertip.foundation.numerics import poisson_interval
from fingertip.lab.campaign.run import quantile_s, separate_events
from fingertip.slip.traces.truth import Interval, intervals

Flags = NDArray[np.bool_]

EARLY_S = 0.005
"""Time before a motion from which ON is one of its slip [s]: the pad creeps already."""
FOUND_S = 0.2
"""Time after gross slip within which ON finds it [s]: a later one did not find its start."""
AFTER_S = 0.2
"""Time after a slip or an event in which ON belongs to it [s]."""
_NORMAL = 1.96
"""Deviations of a normal variable that hold 95 %."""


@dataclass
class Tally:
    """Counts over any number of recordings."""

    slips: int = 0
    delays_s: list[float] = field(default_factory=list)
    """Delays of the slips that were found, from gross slip [s]."""
    on_shares: list[float] = field(default_factory=list)
    """Share of each slip, from its onset to its end, that is ON."""
    alarms: Counter[str] = field(default_factory=Counter)
    """Alarms by the kind of stretch in which they began."""
    seconds: dict[str, float] = field(default_factory=lambda: defaultdict(float))
    """Time without slip in which alarms count, by kind of stretch [s]."""
    events: int = 0
    taken: int = 0
    windows: int = 0
    found_windows: int = 0
    """Windows of `FOUND_S` in recordings of rest, and those in which ON begins: the null test."""

    def add(self, other: Tally) -> None:
        self.slips += other.slips
        self.delays_s += other.delays_s
        self.on_shares += other.on_shares
        self.alarms.update(other.alarms)
        for kind, seconds in other.seconds.items():
            self.seconds[kind] += seconds

        self.events += other.events
        self.taken += other.taken
        self.windows += other.windows
        self.found_windows += other.found_windows

    def quantile_ms(self, fraction: float) -> float:
        """Delay by which a fraction of all slips was found [ms]; infinite if fewer were."""
        return 1000 * quantile_s(self.delays_s, self.slips, fraction)

    @property
    def found_share(self) -> float:
        return len(self.delays_s) / self.slips if self.slips else math.nan

    @property
    def on_share(self) -> float:
        """Mean share of the slips' time that is ON."""
        return float(np.mean(self.on_shares)) if self.on_shares else math.nan

    @property
    def taken_share(self) -> float:
        return self.taken / self.events if self.events else math.nan

    @property
    def counted(self) -> int:
        """Number of alarms, without those where the labels are not sure."""
        return self.alarms.total() - self.alarms[UNSURE]

    @property
    def minutes(self) -> float:
        """Time in which they are counted [min]."""
        return sum(s for kind, s in self.seconds.items() if kind != UNSURE) / 60

    @property
    def alarms_per_minute(self) -> float:
        return self.counted / self.minutes if self.minutes else math.nan

    @property
    def alarm_interval(self) -> tuple[float, float]:
        """Interval that contains the rate of alarms with 95 % probability [1/min]."""
        low, high = poisson_interval(self.counted)
        return (low / self.minutes, high / self.minutes) if self.minutes else (0.0, math.inf)

    def as_data(self) -> dict[str, Any]:
        """Convert it to plain data for JSON; None for what these recordings do not show."""
        return {
            "slips": self.slips,
            "found": len(self.delays_s),
            "found_95": share_interval(len(self.delays_s), self.slips),
            "median_ms": known(self.quantile_ms(0.5)),
            "p90_ms": known(self.quantile_ms(0.9)),
            "on_share": known(self.on_share),
            "alarms": self.counted,
            "minutes": known(self.minutes),
            "alarms_per_minute": known(self.alarms_per_minute),
            "alarms_per_minute_95": [known(bound) for bound in self.alarm_interval],
            "events": self.events,
            "taken": self.taken,
            "taken_95": share_interval(self.taken, self.events),
            "windows": self.windows,
            "found_windows": self.found_windows,
        }


def pool(tallies: Iterable[Tally]) -> Tally:
    whole = Tally()
    for one in tallies:
        whole.add(one)

    return whole


def share_interval(count: int, total: int) -> list[float]:
    """Return the interval that holds a share with 95 %; from 0 to 1 if nothing was tried.

    Source: E. B. Wilson, J. Am. Stat. Assoc. 22, 1927.
    """
    if not total:
        return [0.0, 1.0]

    share = count / total
    spread = _NORMAL**2 / total
    middle = share + spread / 2
    reach = _NORMAL * math.sqrt(share * (1 - share) / total + spread / (4 * total))
    bounds = ((middle + sign * reach) / (1 + spread) for sign in (-1.0, 1.0))
    return [round(min(1.0, max(0.0, bound)), 4) for bound in bounds]


def assess(recording: Recording, on: Flags) -> Tally:
    """Compare flags with what is known about a recording."""
    signal = recording.signal
    found = intervals(np.arange(len(on)) / signal.rate_hz, on)
    tally = Tally(slips=len(signal.slides))

    for slide in signal.slides:
        last_s = min(slide.onset_s + FOUND_S, slide.end_s)
        begins_s = [one.onset_s for one in found if slide.motion_s - EARLY_S <= one.onset_s]
        if begins_s and begins_s[0] < last_s:
            tally.delays_s.append(max(0.0, begins_s[0] - slide.onset_s))

        during = on[round(slide.onset_s * signal.rate_hz) : round(slide.end_s * signal.rate_hz)]
        tally.on_shares.append(float(np.mean(during)) if len(during) else 0.0)

    for alarm in separate_events(find_false(signal, found)):
        tally.alarms[find_kind(recording, alarm.onset_s)] += 1

    tally.seconds = count_seconds(recording)
    _count_events(tally, signal, found)
    _count_windows(tally, signal, found)
    return tally


def find_false(signal: LabelledSignal, found: Sequence[Interval]) -> list[Interval]:
    """Find the intervals of ON that no slip began, where alarms count."""
    return [
        one
        for one in found
        if one.onset_s >= signal.alarms_from_s
        and not any(_owns(slide, one.onset_s) for slide in signal.slides)
    ]


def _owns(slide: Slide, moment_s: float) -> bool:
    return slide.motion_s - EARLY_S <= moment_s < slide.end_s + AFTER_S


def find_kind(recording: Recording, alarm_s: float) -> str:
    """Find the stretch that an alarm belongs to: the one that it began in, or that ended before."""
    inside = [one for one in recording.stretches if one.start_s <= alarm_s < one.end_s + AFTER_S]
    return max(inside, key=lambda one: one.start_s).kind if inside else UNLABELLED


def count_seconds(recording: Recording) -> dict[str, float]:
    """Count the time without slip in which alarms count, by kind of stretch [s]."""
    signal = recording.signal
    seconds = defaultdict[str, float](float)
    left_s = signal.duration_s - sum(slide.end_s - slide.motion_s for slide in signal.slides)

    for stretch in recording.stretches:
        length_s = max(0.0, stretch.end_s - max(stretch.start_s, signal.alarms_from_s))
        left_s -= length_s
        seconds[stretch.kind] += length_s

    seconds[UNLABELLED] += max(0.0, left_s)
    return seconds


def _count_events(tally: Tally, signal: LabelledSignal, found: Sequence[Interval]) -> None:
    """Count the events, but for those beside a slip: there alarm and slip cannot be told apart."""
    for event in signal.events:
        end_s = event.end_s + AFTER_S
        if not any(event.onset_s < s.end_s and s.motion_s < end_s for s in signal.slides):
            tally.events += 1
            tally.taken += any(event.onset_s <= one.onset_s < end_s for one in found)


def _count_windows(tally: Tally, signal: LabelledSignal, found: Sequence[Interval]) -> None:
    """Count the windows of the null test, if the recording is nothing but rest."""
    if signal.slides or signal.events:
        return

    tally.windows = int(signal.duration_s / FOUND_S)
    begins = {
        int((one.onset_s - signal.alarms_from_s) / FOUND_S)
        for one in found
        if one.onset_s >= signal.alarms_from_s
    }
    tally.found_windows = sum(begin < tally.windows for begin in begins)


def known(value: float) -> float | None:
    """Round a number to four digits; None if it is not finite, which JSON has no word for."""
    return float(f"{value:.4g}") if math.isfinite(value) else None
