"""Loop that a worker runs over the points of a chunk, each within the time limit.

The engine reads from shared memory which point a worker is computing, so it can tell which point a crash belongs to.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any

from fingertip.sweep.chunk import Chunk, ChunkResult, PointResult
from fingertip.sweep.engines import NO_POINT, set_current_point
from fingertip.sweep.time_limit import limit_time

_one_chunk_at_a_time = threading.Lock()
"""A Dask worker may have several threads. Time limits and caches are made for one point at a time."""


def evaluate_chunk(chunk: Chunk) -> ChunkResult:
    """Evaluate every point of a chunk; this is the task that engines send to workers."""
    # Imported here, because a process that only submits tasks does not need the evaluator
    from fingertip.sweep.point_evaluator import load_evaluator

    with _one_chunk_at_a_time:
        start = time.perf_counter()
        evaluator = load_evaluator(chunk.text)
        limit_s = evaluator.plan.file.time_limit_s
        results = evaluate_points(chunk, limit_s, evaluator.points_per_limit, evaluator.evaluate)
        return ChunkResult(results, time.perf_counter() - start)


def evaluate_points(
    chunk: Chunk,
    limit_s: float,
    points_per_limit: int,
    evaluate: Callable[[int, dict[str, Any]], PointResult],
) -> list[PointResult]:
    """Evaluate the points of a chunk one after the other; this process exits if one exceeds its time limit.

    Parameters
    ----------
    chunk
        The points.
    limit_s
        Time limit of a group of points [s].
    points_per_limit
        Number of points that share a time limit. Starting a limit takes longer than computing a quick point.
    evaluate
        Function of a point's number and its swept parameters.
    """
    names, values = list(chunk.columns), list(zip(*chunk.columns.values(), strict=True))
    results: list[PointResult] = []
    try:
        for first in range(0, len(chunk.points), points_per_limit):
            with limit_time(limit_s):
                for i in range(first, min(first + points_per_limit, len(chunk.points))):
                    set_current_point(chunk.points[i])
                    results.append(evaluate(chunk.points[i], dict(zip(names, values[i], strict=True))))
    finally:
        set_current_point(NO_POINT)
    return results
