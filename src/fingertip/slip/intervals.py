"""Flags to intervals, and intervals against the truth: delays, missed slips, false intervals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

STICK_S = 0.05
"""True slips closer together are one that sticks for a moment, whoever judges: no hand could answer between them, and
every detector is judged by as many slips."""

INCIPIENT_S = 0.007
"""A pad creeps faster and faster before its slip is gross: on the article's trials, as simulated, it passes 1 mm/s 4 to
7 ms before. What goes ON in that time, and stays, has heard this slip, and was not ON already."""


@dataclass(frozen=True)
class Interval:
    """From the first sample that holds to the first that no longer does (or the trace's last)."""

    onset_s: float
    end_s: float

    def overlaps(self, other: Interval, slack_s: float = 0.0) -> bool:
        """Whether they share time, with `slack_s` [s] added to this one's end. A last sample shares its moment."""
        begin, end = max(self.onset_s, other.onset_s), min(self.end_s + slack_s, other.end_s)
        momentary = self.onset_s == self.end_s or other.onset_s == other.end_s
        return begin < end or (momentary and begin == end)


@dataclass(frozen=True)
class Score:
    """Detected intervals against true ones."""

    slips: tuple[Interval, ...]
    """True slips, those closer together than `STICK_S` taken as one."""
    delays_s: tuple[float | None, ...]
    """Per slip, from its onset to the first interval that meets it [s]; None: missed. Negative: it was ON before, by
    less than `INCIPIENT_S` in the slip's own beginning."""
    false_intervals: tuple[Interval, ...]
    """Intervals that meet no slip."""

    @property
    def missed(self) -> tuple[Interval, ...]:
        """Slips without any interval."""
        return tuple(slip for slip, delay in zip(self.slips, self.delays_s, strict=True) if delay is None)


def intervals(time_s: NDArray[np.float64], flags: NDArray[np.bool_]) -> tuple[Interval, ...]:
    """The stretches where `flags` holds."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], flags, [False])).astype(np.int8)))
    last = len(time_s) - 1
    return tuple(
        Interval(float(time_s[start]), float(time_s[min(stop, last)]))
        for start, stop in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)
    )


def merged(parts: Sequence[Interval], gap_s: float) -> tuple[Interval, ...]:
    """Intervals in order, those not further apart than `gap_s` [s] made one (stick-slip is one slip)."""
    out: list[Interval] = []
    for part in parts:
        if out and part.onset_s - out[-1].end_s <= gap_s:
            out[-1] = Interval(out[-1].onset_s, part.end_s)
        else:
            out.append(part)
    return tuple(out)


def score(detected: Sequence[Interval], truth: Sequence[Interval], memory_s: float) -> Score:
    """Judge detected intervals.

    Parameters
    ----------
    detected, truth
        In order of time.
    memory_s
        How long a detector still rests on its samples [s]: an interval that begins less than this after a slip's end
        rests on the slip's own, so it is not false.
    """
    slips = merged(truth, STICK_S)
    delays = []
    for slip in slips:
        met = next((interval for interval in detected if slip.overlaps(interval)), None)
        delays.append(None if met is None else met.onset_s - slip.onset_s)
    false = tuple(d for d in detected if not any(slip.overlaps(d, memory_s) for slip in slips))
    return Score(slips, tuple(delays), false)
