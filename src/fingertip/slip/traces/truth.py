"""True slip and motion: intervals scored against them, and what is known of a trace's origin."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fingertip.catalogues.output_files import DETECTION, SIGNAL, TRACE
from fingertip.foundation.input_files import PARSED_LIMIT, read_input
from fingertip.foundation.numerics import Array
from fingertip.foundation.output_set import has_hash, read_manifest

STICK_S = 0.05
"""Gap up to which two slips count as one [s]: no hand responds within it."""

INCIPIENT_S = 0.007
"""Duration of incipient slip [s].

A pad creeps faster and faster before its slip is gross. On the article's trials, as simulated, it
exceeds 1 mm/s 4 to 6 ms before. A detector that turns ON in that time and remains ON has detected
this slip; it was not ON already.
"""


@dataclass(frozen=True)
class Interval:
    """Time from the first sample with a true flag to the first with a false one, or the last."""

    onset_s: float
    end_s: float

    def overlaps(self, other: Interval, slack_s: float = 0.0) -> bool:
        """Return whether two intervals overlap; one of length 0 overlaps one around it."""
        begin = max(self.onset_s, other.onset_s)
        end = min(self.end_s + slack_s, other.end_s)
        has_zero_length = self.onset_s == self.end_s or other.onset_s == other.end_s

        return begin < end or (has_zero_length and begin == end)


@dataclass(frozen=True)
class Score:
    """Result of scoring detected intervals against true slips."""

    slips: tuple[Interval, ...]
    """True slips; those no further apart than `STICK_S` are merged."""
    delays_s: tuple[float | None, ...]
    """Time from each slip's onset to the onset of the first interval that overlaps it [s].

    None: missed. Negative: the detector was ON before; from ``-INCIPIENT_S`` on it detected the
    incipient slip.
    """
    false_intervals: tuple[Interval, ...]
    """Detected intervals that overlap no slip."""

    @property
    def missed(self) -> tuple[Interval, ...]:
        """Slips that no detected interval overlaps."""
        return tuple(
            slip for slip, delay in zip(self.slips, self.delays_s, strict=True) if delay is None
        )


def intervals(time_s: Array, flags: NDArray[np.bool_]) -> tuple[Interval, ...]:
    """Find the intervals in which `flags` is true."""
    collector = SlipCollector()
    collector.add(time_s, flags)
    return collector.close()


class SlipCollector:
    """Intervals in which a flag is true, collected chunk by chunk."""

    def __init__(self) -> None:
        self._found: list[Interval] = []
        self._onset_s: float | None = None
        self._last_s = 0.0

    def add(self, time_s: Array, flags: NDArray[np.bool_]) -> None:
        if not len(time_s):
            return

        was_true = self._onset_s is not None
        edges = np.flatnonzero(flags[1:] != flags[:-1]) + 1
        begins = [0] if flags[0] != was_true else []

        for moment in [*time_s[begins].tolist(), *time_s[edges].tolist()]:
            if self._onset_s is None:
                self._onset_s = moment
            else:
                self._found.append(Interval(self._onset_s, moment))
                self._onset_s = None

        self._last_s = float(time_s[-1])

    def close(self) -> tuple[Interval, ...]:
        """Return all intervals; one that is still open ends at the last sample."""
        if self._onset_s is not None:
            self._found.append(Interval(self._onset_s, self._last_s))
            self._onset_s = None

        return tuple(self._found)


def merge(parts: Sequence[Interval], gap_s: float) -> tuple[Interval, ...]:
    """Merge intervals, given in order of time, that are no further apart than `gap_s` [s]."""
    merged: list[Interval] = []
    for part in parts:
        if merged and part.onset_s - merged[-1].end_s <= gap_s:
            merged[-1] = Interval(merged[-1].onset_s, part.end_s)
        else:
            merged.append(part)

    return tuple(merged)


def score(detected: Sequence[Interval], truth: Sequence[Interval], memory_s: float) -> Score:
    slips = merge(truth, STICK_S)
    delays = []
    for slip in slips:
        first = next((interval for interval in detected if slip.overlaps(interval)), None)
        delays.append(None if first is None else first.onset_s - slip.onset_s)

    false = tuple(
        interval
        for interval in detected
        if not any(slip.overlaps(interval, memory_s) for slip in slips)
    )
    return Score(slips, tuple(delays), false)


def measure_false_on_s(detected: Sequence[Interval], slips: Sequence[Interval]) -> float:
    """Return the time of ON outside all slips [s]."""
    on_s = sum(interval.end_s - interval.onset_s for interval in detected)
    in_slips_s = sum(
        max(0.0, min(interval.end_s, slip.end_s) - max(interval.onset_s, slip.onset_s))
        for interval, slip in itertools.product(detected, slips)
    )
    return on_s - in_slips_s


@dataclass(frozen=True)
class Origin:
    """Facts about a trace beside its columns."""

    is_simulated: bool = False
    motion_s: float | None = None
    """Start of the robot's slide [s]; None without a slide, or if unknown."""
    clip_share: float | None = None
    """Share of the true slip in which the filter's output is clipped; None if unknown."""

    @property
    def truth(self) -> str:
        """Name of the true slip in texts: simulated, or a column of the recording."""
        return f"true slip ({'simulated' if self.is_simulated else 'column slip'})"


UNKNOWN = Origin()


def read_origin(path: Path) -> Origin:
    """Read the origin of a trace from the manifest and the detection beside it."""
    manifest = read_manifest(path.parent)
    if (
        manifest is None
        or manifest.kind != SIGNAL.kind
        or not has_hash(path, manifest.files.get(path.name))
    ):
        return UNKNOWN

    detection = path.parent / DETECTION
    if path.name != TRACE or not has_hash(detection, manifest.files.get(DETECTION)):
        return Origin(is_simulated=True)

    return parse_origin(read_input(detection, PARSED_LIMIT, below=path.parent))


def parse_origin(detection: bytes | None) -> Origin:
    """Read the origin of a simulated trial from the detection beside it; None if there is none."""
    try:
        motion_s = json.loads(detection)["motion_s"] if detection else None
    except (ValueError, KeyError, TypeError, RecursionError):
        motion_s = None

    return Origin(
        True, motion_s if isinstance(motion_s, float) and math.isfinite(motion_s) else None
    )


# Start of a robot's motion, and how well encoders know it: the article reads its robot's at 100 Hz
# (section III.C).

ENCODER_HZ = 100.0
"""Rate at which the encoders are read [Hz] (article, section III.C)."""


def encoder_band_s(motion_s: float) -> tuple[float, float]:
    """Return the interval in which encoders first show a motion [s]: one of their periods."""
    return motion_s, motion_s + 1 / ENCODER_HZ


def encoder_delay_band_s(delay_s: float) -> tuple[float, float]:
    """Return the shortest and longest delay that encoders show for a true one [s]."""
    return delay_s - 1 / ENCODER_HZ, delay_s


def format_delay_band(delay_s: float) -> str:
    """Format the delays that encoders show, such as ``15.5-25.5 ms``."""
    low_s, high_s = encoder_delay_band_s(delay_s)
    return f"{1000 * low_s:.1f}-{1000 * high_s:.1f} ms"


ENCODER_NOTE = (
    f"encoders at {ENCODER_HZ:g} Hz, as the article's, know when it moved to "
    f"{1000 / ENCODER_HZ:g} ms: their delays "
    "are up to so much shorter"
)
"""Note of tables below delays since the robot moved."""
BAND_LABEL = f"robot starts, known to {1000 / ENCODER_HZ:g} ms (encoders, {ENCODER_HZ:g} Hz)"
