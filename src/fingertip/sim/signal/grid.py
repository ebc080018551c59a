"""Time grid of the simulation, and the instants at which a converter samples what happens on it.

Contact, sensor and board are computed at the points of one grid, whose step does not depend on the
sampling rate. So the rate changes the samples and nothing else. An instant between two points gets
the straight line between them.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.foundation.numerics import Array
from fingertip.foundation.progress import ReportProgress, Work

BASE_HZ = 10_000.0
"""Points per second."""
TARGETS = {"force_n": 5e-5, "tactile_v": 5e-5, "envelope_v": 8e-4}
"""Signal -> difference from vanishing steps [N, V] that at least 95 % of runs on this grid keep;
envelopes of the board `article` are excepted, whose amplifier reverses (docs/accuracy.md).
"""
_SNAP = 1e-6
"""Distance from a point, in steps, at which an instant counts as that point."""


@dataclass(frozen=True)
class Grid:
    """Equidistant points in time, the first at 0."""

    refinement: int = 1
    """Number of steps per step of the base grid.
    Noise is drawn on the base grid, so it stays the same.
    """

    @property
    def rate_hz(self) -> float:
        return BASE_HZ * self.refinement

    @property
    def step_s(self) -> float:
        return 1 / self.rate_hz

    def time_s(self, first: int, count: int) -> Array:
        return np.arange(first, first + count) / self.rate_hz

    def count_points(self, duration_s: float, sample_rate_hz: float) -> int:
        """Number of points up to the last sample of a recording."""
        last = count_samples(duration_s, sample_rate_hz) - 1
        return math.ceil(last * self.rate_hz / sample_rate_hz - _SNAP) + 1


def count_samples(duration_s: float, sample_rate_hz: float) -> int:
    """Number of samples of a recording, the one at time 0 included."""
    return math.ceil(duration_s * sample_rate_hz - _SNAP) + 1


@dataclass(frozen=True, eq=False)
class Instants:
    """Samples in a chunk of points, by their positions from the last point before the chunk."""

    first: int
    """Number of samples before the chunk."""
    index: NDArray[np.int64]
    """Position of the last point at or before each instant."""
    fraction: Array
    """Fraction of the step from there to the next point."""
    sample_rate_hz: float

    @functools.cached_property
    def between(self) -> NDArray[np.intp]:
        """Numbers of the instants that lie between two points."""
        return np.flatnonzero(self.fraction)

    @property
    def time_s(self) -> Array:
        return np.arange(self.first, self.first + len(self.index)) / self.sample_rate_hz


class SampleClock:
    """Instants of a converter, chunk by chunk."""

    def __init__(self, grid: Grid, sample_rate_hz: float) -> None:
        self._ratio = grid.rate_hz / sample_rate_hz
        self._rate = sample_rate_hz
        self._points = self._samples = 0

    def advance(self, points: int) -> Instants:
        origin = max(self._points - 1, 0)
        last = self._points + points - 1
        end = self.count_until(last)
        at = np.arange(self._samples, end) * self._ratio
        whole = np.floor(at + _SNAP)
        fraction = at - whole
        fraction[np.abs(fraction) <= _SNAP] = 0.0
        instants = Instants(self._samples, whole.astype(np.int64) - origin, fraction, self._rate)
        self._points = last + 1
        self._samples = end

        return instants

    def count_until(self, point: int) -> int:
        """Number of samples up to a point of the grid."""
        return math.floor((point + _SNAP) / self._ratio) + 1


class Sampler:
    """One signal of the grid at the instants of a converter, chunk by chunk."""

    def __init__(self) -> None:
        self._last = np.zeros(0)

    def process(self, values: Array, at: Instants) -> Array:
        """Return the signal at the instants within a chunk."""
        known = np.concatenate((self._last, values)) if len(self._last) else values
        self._last = values[-1:].copy()
        picked = known[at.index]
        between = at.between

        if len(between):
            before = at.index[between]
            picked[between] += at.fraction[between] * (known[before + 1] - known[before])

        return picked


# Random numbers of the simulation: one independent stream for each seed and purpose.
#
# The generator is numpy's `RandomState`, whose streams are frozen, so that the same seed gives the
# same numbers with any version (NEP 19).

Stream = np.random.RandomState
OpenStream = Callable[[str], Stream]


def open_stream(seed: int, *purpose: str) -> Stream:
    """Open the stream of a seed and a purpose, so that one purpose never changes the numbers of
    another.
    """
    name = ":".join((str(seed), *purpose))
    return np.random.RandomState(np.frombuffer(hashlib.sha256(name.encode()).digest(), dtype="<u4"))


def draw_noise(stream: Stream, deviation: float, count: int) -> Array:
    return np.asarray(deviation * stream.standard_normal(count))


# Cost of each stage of a simulation: integrated states, evaluations of right-hand sides, CPU time.

STAGES = (
    "load",
    "hand",
    "object",
    "disturbances",
    "carriage",
    "friction",
    "coupled contact",
    "profile",
    "contact",
    "force",
    "sensor",
    "bridge",
    "interference",
    "ADC",
    "board noise",
    "filter board",
    "comparator",
    "ADC of the envelope",
    "ADC of the filtered signal",
    "no motion",
    "slip",
    "shear",
)
"""Names of all stages, in the order from hand to voltages.
Each finger of a hand adds to the same stages.
"""


@dataclass(frozen=True)
class StageCost:
    name: str
    states: int
    evaluations: int
    cpu_s: float
    """CPU time; 0 if it was not measured."""


_NOT_TIMED = contextlib.nullcontext()


class CostMeter:
    """Sum of the cost of each stage over all chunks. A stage that never ran is not listed.

    CPU time is measured where a clock is given. A hand enters 50 stages every 10 ms, and asking the
    system each time takes a twelfth of a validation.
    """

    def __init__(self, clock: Callable[[], float] | None = None) -> None:
        self._costs: dict[str, tuple[int, int, float]] = {}
        self._clock = clock

    def stage(
        self, name: str, states: int = 0, evaluations: int = 0
    ) -> contextlib.AbstractContextManager[None]:
        """Count a block and its evaluations, and measure its CPU time."""
        if self._clock is None:
            self.add(name, states, evaluations)
            return _NOT_TIMED

        return self._time(self._clock, name, states, evaluations)

    @contextlib.contextmanager
    def _time(
        self,
        clock: Callable[[], float],
        name: str,
        states: int,
        evaluations: int,
    ) -> Iterator[None]:
        start_s = clock()
        yield
        self.add(name, states, evaluations, clock() - start_s)

    def add(
        self,
        name: str,
        states: int,
        evaluations: int,
        cpu_s: float = 0.0,
    ) -> None:
        assert name in STAGES
        _, evaluated, spent_s = self._costs.get(name, (0, 0, 0.0))
        self._costs[name] = states, evaluated + evaluations, spent_s + cpu_s

    @property
    def costs(self) -> tuple[StageCost, ...]:
        """Costs of the stages that ran, in the order of `STAGES`."""
        return tuple(StageCost(name, *self._costs[name]) for name in STAGES if name in self._costs)


# Progress of long simulations.

LONG_S = 15.0
"""Duration above which a simulation reports its progress [s]."""


def report_share(
    name: str, duration_s: float, progress: ReportProgress | None
) -> Callable[[float], None]:
    """Return what takes the time that has been simulated [s] and reports the share that is done, if
    it takes long.
    """
    label = f"simulating {duration_s:.1f} s of {name}"
    work = Work("", {label: 1.0}, progress if duration_s > LONG_S else None)
    work.begin(label)

    return lambda simulated_s: work.advance(simulated_s / duration_s)
