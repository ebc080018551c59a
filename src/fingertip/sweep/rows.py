"""Rows of a sweep, one by one and as a table of columns."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fingertip.sweep.axes import Value

Status: TypeAlias = Literal["ok", "refused", "failed", "timeout"]
STATUSES: tuple[Status, ...] = ("ok", "refused", "failed", "timeout")
"""ok: computed. refused: the design breaks a rule, which is a valid result. failed: an error, or the worker died.
timeout: the point took longer than the sweep's time limit."""


@dataclass(frozen=True)
class SweepRow:
    """Row of one point: its parameters, its outputs and its status."""

    point: int
    axes: dict[str, Value]
    """Swept parameter -> value."""
    outputs: dict[str, float]
    """Output -> value; NaN where it was not computed."""
    status: Status
    field: str
    """Parameter or check that `reason` is about; "" if there is none."""
    reason: str
    """Reason why the point is not ok, or names of the failed checks; "" otherwise."""


@dataclass(frozen=True, eq=False)
class SweepTable:
    """All rows as columns of one length n, ordered by point number."""

    point: NDArray[np.int64]
    """(n,) number of the point in the plan. Points without a row are left out."""
    axes: dict[str, NDArray[Any]]
    """Swept parameter, dotted (`skin.width_mm`, `scene.slide.speed_m_s`) -> (n,) values: float, int, bool or str."""
    outputs: dict[str, NDArray[np.float64]]
    """Output, with the unit in its name -> (n,) values. NaN where it was not computed, infinite where it is unbounded
    (the median delay where fewer than half of the slips were detected)."""
    status: NDArray[np.str_]
    """(n,) one of `STATUSES`."""
    field: NDArray[np.str_]
    """(n,) first parameter that a refused point's broken rule names, or first failed check of a computed point; ""
    otherwise."""
    reason: NDArray[np.object_]
    """(n,) of str: why a row is not ok, or which checks failed; "" otherwise."""

    def __len__(self) -> int:
        return len(self.point)


# Chunk of a sweep: the points sent to a worker in one task, and the result that comes back.
#
# Every worker imports this module first. It imports nothing heavy.


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
