"""A part of a sweep as it travels to a worker, and what comes back. Nothing heavy is imported before it is needed."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

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


def too_long(point: int, limit_s: float, outputs: int) -> Outcome:
    """The row of a point that was given up."""
    reason = f"took longer than {limit_s:g} s (time_limit_s), twice."
    return point, "timeout", "", reason, (math.nan,) * outputs


def died(point: int, outputs: int) -> Outcome:
    """The row of a point that ended its worker."""
    return point, "failed", "", "its worker died while it was computed, twice.", (math.nan,) * outputs
