"""A part of a sweep as it travels to a worker, and what comes back. Nothing heavy is imported before it is needed."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

from fingertip.sweep.engines import NOBODY, mark
from fingertip.sweep.watch import limited

Outcome: TypeAlias = tuple[int, str, str, str, tuple[float, ...]]
"""Point, status, field, reason, outputs in the plan's order."""


@dataclass(frozen=True)
class Part:
    """Some points of a sweep."""

    text: str
    """The sweep's canonical text."""
    points: tuple[int, ...]
    columns: dict[str, list[Any]]
    """Swept parameter -> a value for each point."""

    def single(self, i: int) -> Part:
        """One of its points, as a part of its own."""
        return Part(self.text, (self.points[i],), {name: [column[i]] for name, column in self.columns.items()})


@dataclass(frozen=True)
class Done:
    """The rows of a part."""

    outcomes: list[Outcome]
    took_s: float


Work: TypeAlias = Callable[[Part], Done]
_one_at_a_time = threading.Lock()
"""A worker may be given several threads; limits, caches and Python's own lock allow one point at a time."""


def work(part: Part) -> Done:
    """Compute a part of a sweep, in a worker."""
    from fingertip.sweep.evaluate import bench_of

    with _one_at_a_time:
        start = time.perf_counter()
        outcomes = bench_of(part.text).outcomes(part)
        return Done(outcomes, time.perf_counter() - start)


def each_limited(
    part: Part, limit_s: float, together: int, outcome: Callable[[int, dict[str, Any]], Outcome]
) -> list[Outcome]:
    """Outcomes of a part's points, one after the other, each within its limit [s] or this worker ends.

    `together` points share a limit, because setting one takes longer than a quick point does.
    """
    names, given = list(part.columns), list(zip(*part.columns.values(), strict=True))
    found: list[Outcome] = []
    try:
        for first in range(0, len(part.points), together):
            with limited(limit_s):
                for i in range(first, min(first + together, len(part.points))):
                    mark(part.points[i])
                    found.append(outcome(part.points[i], dict(zip(names, given[i], strict=True))))
    finally:
        mark(NOBODY)
    return found


def too_long(point: int, limit_s: float, outputs: int) -> Outcome:
    """The row of a point that was given up."""
    reason = f"took longer than {limit_s:g} s (time_limit_s), twice."
    return point, "timeout", "", reason, (math.nan,) * outputs


def died(point: int, outputs: int) -> Outcome:
    """The row of a point that ended its worker."""
    return point, "failed", "", "its worker died while it was computed, twice.", (math.nan,) * outputs
