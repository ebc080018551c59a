"""Signal with everything that is known about it, and what a detector made of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.arrays import Array
from fingertip.campaign.evaluate import separate_events
from fingertip.slip.intervals import Interval, intervals

EARLY_S = 0.005
"""Time before gross slip from which a detection counts as one of this slip [s]: the pad creeps already."""
REACTION_S = 0.2
"""Time after the end of an event in which an alarm counts as caused by it [s]."""


@dataclass(frozen=True)
class Slide:
    """One slip: the moments of its motion."""

    motion_s: float
    """Moment at which the robot begins to move [s], or the burst begins."""
    onset_s: float
    """Onset of gross slip [s]."""
    end_s: float
    """End of gross slip [s]."""


@dataclass(frozen=True, eq=False)
class LabelledSignal:
    """Sampled voltage, the slips in it, and the events in it that are not slip."""

    kind: str
    """Name of the group that it belongs to."""
    rate_hz: float
    voltage_v: Array
    """Tactile voltage [V]."""
    slides: tuple[Slide, ...] = ()
    events: tuple[Interval, ...] = ()
    """Events that are not slip, such as changes of grip."""
    alarms_from_s: float = 0.0
    """Moment from which alarms count [s]: a detector may need time to learn the noise."""
    strength_v: float = 0.0
    """RMS voltage of the slip [V], where it is known."""
    filtered_v: Array | None = None
    """Filtered signal of the board, where it gives one [V]."""

    @property
    def duration_s(self) -> float:
        """Time in which alarms count [s]."""
        return len(self.voltage_v) / self.rate_hz - self.alarms_from_s


@dataclass(frozen=True)
class Outcome:
    """Result of a detector on one signal."""

    kind: str
    strength_v: float
    minutes: float
    slides: int
    delays_s: tuple[float, ...]
    """Delays of the slips that were found, from gross slip [s]."""
    motion_delays_s: tuple[float, ...]
    """The same delays from the start of the motion [s]."""
    on_shares: tuple[float, ...]
    """Share of each slip, from its onset to its end, that is ON."""
    alarms: int
    """Number of alarms without slip."""
    alarms_s: tuple[float, ...]
    """Moments of these alarms [s]."""
    events: int
    disturbed: int
    """Number of events that caused an alarm."""
    false_on_share: float
    """Share of the time without slip that is ON, where alarms count."""


def assess(signal: LabelledSignal, on: NDArray[np.bool_], memory_s: float) -> Outcome:
    """Compare the flags of a detector with what is known about a signal.

    A slip is found if the detector turns ON between its onset, less `EARLY_S`, and its end. An alarm is a transition to
    ON outside the slips, their creep, and the detector's memory after them. Alarms closer together than
    `fingertip.campaign.evaluate.SAME_EVENT_S` count once.

    Parameters
    ----------
    signal
        The signal.
    on
        Flag of the detector at each sample.
    memory_s
        Longest time that the detector's ON outlasts a slip [s].
    """
    time_s = np.arange(len(on)) / signal.rate_hz
    found = intervals(time_s, on)
    delays, motion_delays, shares = [], [], []
    is_slip = np.zeros(len(on), dtype=bool)
    for slide in signal.slides:
        inside = [i for i in found if slide.onset_s - EARLY_S <= i.onset_s < slide.end_s]
        if inside:
            delays.append(max(0.0, inside[0].onset_s - slide.onset_s))
            motion_delays.append(max(0.0, inside[0].onset_s - slide.motion_s))
        during = (time_s >= slide.onset_s) & (time_s < slide.end_s)
        shares.append(float(np.mean(on[during])) if during.any() else 0.0)
        is_slip |= (time_s >= slide.motion_s) & (time_s < slide.end_s + memory_s)
    alarms = separate_events(
        i
        for i in found
        if i.onset_s >= signal.alarms_from_s
        and not any(s.onset_s - EARLY_S <= i.onset_s < s.end_s + memory_s for s in signal.slides)
    )
    disturbed = sum(
        any(event.onset_s <= i.onset_s < event.end_s + REACTION_S for i in found) for event in signal.events
    )
    counted = ~is_slip & (time_s >= signal.alarms_from_s)
    return Outcome(
        signal.kind,
        signal.strength_v,
        signal.duration_s / 60,
        len(signal.slides),
        tuple(delays),
        tuple(motion_delays),
        tuple(shares),
        len(alarms),
        tuple(alarm.onset_s for alarm in alarms),
        len(signal.events),
        disturbed,
        float(np.mean(on[counted])) if counted.any() else 0.0,
    )
