"""The points of a part in turn, each marked while it is computed and held to its time."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fingertip.sweep.engines import NOBODY, mark
from fingertip.sweep.part import Outcome, Part
from fingertip.sweep.watch import limited


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
