"""Chunk of a sweep: the points sent to a worker in one task, and the result that comes back.

Every worker imports this module first. It imports nothing heavy.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

PointResult: TypeAlias = tuple[int, str, str, str, tuple[float, ...]]
"""Point number, status, field, reason, and the outputs in the plan's order."""


@dataclass(frozen=True)
class Chunk:
    """Points of a sweep that one worker evaluates in one task."""

    text: str
    """Canonical TOML text of the sweep."""
    points: tuple[int, ...]
    """Numbers of the points."""
    columns: dict[str, list[Any]]
    """Swept parameter -> one value for each point."""

    def select(self, indices: Sequence[int]) -> Chunk:
        """Build a chunk of some of these points, given their indices in `points`."""
        columns = {name: [column[i] for i in indices] for name, column in self.columns.items()}
        return Chunk(self.text, tuple(self.points[i] for i in indices), columns)


@dataclass(frozen=True)
class ChunkResult:
    """Results of the points of a chunk."""

    results: list[PointResult]
    elapsed_s: float
    """Time that the worker spent on the chunk [s]."""


ChunkFunction: TypeAlias = Callable[[Chunk], ChunkResult]
"""Function that a worker runs for each chunk."""


def make_timeout_result(point: int, limit_s: float, outputs: int) -> PointResult:
    """Build the result of a point that exceeded its time limit [s] twice."""
    reason = f"took longer than {limit_s:g} s (time_limit_s), twice."
    return point, "timeout", "", reason, (math.nan,) * outputs


def make_crash_result(point: int, outputs: int) -> PointResult:
    """Build the result of a point whose worker process died twice."""
    return point, "failed", "", "its worker died while it was computed, twice.", (math.nan,) * outputs
