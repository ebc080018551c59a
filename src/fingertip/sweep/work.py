"""What a worker is given to do. Nothing heavy is imported before it is needed."""

from __future__ import annotations

import threading
import time

from fingertip.sweep.part import Done, Part

_one_at_a_time = threading.Lock()
"""A worker may be given several threads; limits, caches and Python's own lock allow one point at a time."""


def work(part: Part) -> Done:
    """Compute a part of a sweep, in a worker."""
    from fingertip.sweep.evaluate import bench_of

    with _one_at_a_time:
        start = time.perf_counter()
        outcomes = bench_of(part.text).outcomes(part)
        return Done(outcomes, time.perf_counter() - start)
