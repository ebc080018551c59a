"""Scores of detectors over a set of recordings: delay against
alarms, at each factor of the threshold.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from benchmarks.slip.competitors import Competitor
from benchmarks.slip.mix import Outcome, assess
from benchmarks.slip.mix_signals import REACTION_S
from benchmarks.slip.recordings import UNLABELLED, UNSURE, Recording
from fingertip.design import Design
from fingertip.foundation.jit import compiled
from fingertip.foundation.numerics import poisson_interval
from fingertip.lab.campaign.run import quantile_s

RATES = (0.1, 1.0)
"""Rates of alarms at which delays are compared [1/min]."""
FOUND_S = 0.2
"""Time after gross slip within which ON finds it [s]: one that rises
later in a long slide did not find its start.
"""


@dataclass
class Point:
    """Result of one detector with one factor of its threshold."""

    factor: float
    slips: int = 0
    delays_s: list[float] = field(default_factory=list)
    """Delays of the slips that were found, from gross slip [s]."""
    motion_delays_s: list[float] = field(default_factory=list)
    """The same from the start of the motion [s]."""
    on_shares: list[float] = field(default_factory=list)
    alarms: dict[str, int] = field(default_factory=dict)
    """Alarms by the kind of stretch in which they began."""
    minutes: dict[str, float] = field(default_factory=dict)
    """Time by kind of stretch [min]."""
    stretches: dict[str, int] = field(default_factory=dict)

    def add(self, recording: Recording, outcome: Outcome) -> None:
        """Add what was found in a recording."""
        signal = recording.signal
        self.slips += outcome.slides
        kept = [delay_s <= FOUND_S for delay_s in outcome.delays_s]
        self.delays_s += itertools.compress(outcome.delays_s, kept)
        self.motion_delays_s += itertools.compress(outcome.motion_delays_s, kept)
        self.on_shares += outcome.on_shares

        for alarm_s in outcome.alarms_s:
            kind = _find_kind(recording, alarm_s)
            self.alarms[kind] = self.alarms.get(kind, 0) + 1

        left = signal.duration_s - sum(slide.end_s - slide.motion_s for slide in signal.slides)
        for stretch in recording.stretches:
            length_s = max(0.0, stretch.end_s - max(stretch.start_s, signal.alarms_from_s))
            left -= length_s
            self.minutes[stretch.kind] = self.minutes.get(stretch.kind, 0.0) + length_s / 60
            self.stretches[stretch.kind] = self.stretches.get(stretch.kind, 0) + 1

        self.minutes[UNLABELLED] = self.minutes.get(UNLABELLED, 0.0) + max(0.0, left) / 60

    def quantile_ms(self, fraction: float, since_motion: bool = False) -> float:
        """Delay by which a fraction of all slips was found [ms]; infinite if fewer were."""
        delays = self.motion_delays_s if since_motion else self.delays_s
        return 1000 * quantile_s(delays, self.slips, fraction)

    @property
    def found_share(self) -> float:
        return len(self.delays_s) / self.slips if self.slips else math.nan

    @property
    def on_share(self) -> float:
        """Mean share of the slips' time that is ON."""
        return float(np.mean(self.on_shares)) if self.on_shares else math.nan

    @property
    def counted(self) -> int:
        """Number of alarms, without those where the labels are not sure."""
        return sum(count for kind, count in self.alarms.items() if kind != UNSURE)

    @property
    def counted_minutes(self) -> float:
        return sum(minutes for kind, minutes in self.minutes.items() if kind != UNSURE)

    @property
    def alarms_per_minute(self) -> float:
        return self.counted / self.counted_minutes if self.counted_minutes else math.nan

    @property
    def alarm_interval(self) -> tuple[float, float]:
        """Interval that contains the rate of alarms with 95 % probability [1/min]."""
        low, high = poisson_interval(self.counted)
        return (
            (low / self.counted_minutes, high / self.counted_minutes)
            if self.counted_minutes
            else (0.0, math.inf)
        )


def _find_kind(recording: Recording, alarm_s: float) -> str:
    """Find the stretch that an alarm belongs to: the one that it
    began in, or that ended right before.
    """
    inside = [one for one in recording.stretches if one.start_s <= alarm_s < one.end_s + REACTION_S]
    return max(inside, key=lambda one: one.start_s).kind if inside else UNLABELLED


def measure(
    design: Design,
    recordings: Iterable[Recording],
    competitors: Mapping[str, Competitor],
    advance: Callable[[Recording], None] = lambda _: None,
) -> dict[str, tuple[Point, ...]]:
    """Run detectors over recordings, and pool what they find at each factor of their thresholds."""
    found = {
        name: tuple(map(Point, competitor.factors)) for name, competitor in competitors.items()
    }
    with compiled():
        for recording in recordings:
            for name, points in found.items():
                competitor = competitors[name]
                memory_s = competitor.memory_s(design)
                for point, on in zip(
                    points, competitor.run(design, recording, competitor.factors), strict=True
                ):
                    point.add(recording, assess(recording.signal, on, memory_s))

            advance(recording)

    return found


def at_rate(points: Sequence[Point], rate_per_minute: float) -> Point | None:
    """Find the threshold with the shortest 90th percentile of the delay that keeps a rate of
    alarms, if any does.

    Recordings in which this rate means less than one alarm show none.
    """
    kept = [
        point
        for point in points
        if point.counted_minutes * rate_per_minute >= 1.0
        and point.alarms_per_minute <= rate_per_minute
        and point.delays_s
    ]
    return min(
        kept, key=lambda point: (point.quantile_ms(0.9), point.quantile_ms(0.5)), default=None
    )


def best_points(points: Sequence[Point], fraction: float) -> list[Point]:
    """Select the thresholds that no other one of the detector beats
    in both delay and alarms, by rate of alarms.
    """
    ranked = sorted(
        points, key=lambda point: (point.alarms_per_minute, point.quantile_ms(fraction))
    )
    best: list[Point] = []

    for point in ranked:
        if math.isfinite(point.quantile_ms(fraction)) and (
            not best or point.quantile_ms(fraction) < best[-1].quantile_ms(fraction)
        ):
            best.append(point)

    return best


def at_own_threshold(points: Sequence[Point]) -> Point:
    """Find what a detector reaches at its own threshold."""
    return next(point for point in points if point.factor == 1.0)
