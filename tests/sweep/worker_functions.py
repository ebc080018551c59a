"""Functions that workers run in the tests of failing workers:
most points are quick, some never finish.
"""

from __future__ import annotations

import collections
import itertools
import os
import pickle
import signal
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from fingertip.foundation import workers
from fingertip.sweep.point_evaluator import Chunk, ChunkResult, PointResult, evaluate_points

LIMIT_S = 0.4
FAILING_POINTS = (3, 17)
FLAG_VARIABLE = "FINGERTIP_TEST_FLAG"
"""Environment variable with the path of the file in which `crash_once` counts."""


def make_result(point: int) -> PointResult:
    return point, "ok", "", "", (float(point), 2.0 * point, 3.0)


def _evaluate(chunk: Chunk, fail: Callable[[], None]) -> ChunkResult:
    def evaluate_point(point: int, changes: dict[str, Any]) -> PointResult:
        if point in FAILING_POINTS:
            fail()
        time.sleep(0.002)
        return make_result(point)

    start = time.perf_counter()
    return ChunkResult(
        evaluate_points(chunk, LIMIT_S, 1, evaluate_point), time.perf_counter() - start
    )


def succeed(chunk: Chunk) -> ChunkResult:
    return _evaluate(chunk, lambda: None)


def crash(chunk: Chunk) -> ChunkResult:
    return _evaluate(chunk, lambda: os.kill(os.getpid(), signal.SIGKILL))


def crash_once(chunk: Chunk) -> ChunkResult:
    def kill_at_first_attempt() -> None:
        flag = Path(os.environ[FLAG_VARIABLE])
        if len(flag.read_text()) < len(FAILING_POINTS):
            with flag.open("a") as file:
                file.write("x")
            os.kill(os.getpid(), signal.SIGKILL)

    return _evaluate(chunk, kill_at_first_attempt)


def die_while_sending(chunk: Chunk) -> ChunkResult:
    """Kill the first worker that gets the first failing point while it sends its result."""
    flag = Path(os.environ[FLAG_VARIABLE])
    if FAILING_POINTS[0] in chunk.points and not flag.read_text():
        flag.write_text("x")
        assert workers._answers
        workers._answers.write(pickle.dumps(("result", 1000 * "begin"))[:-1000])
        workers._answers.flush()
        os.kill(os.getpid(), signal.SIGKILL)
    return succeed(chunk)


def sleep(chunk: Chunk) -> ChunkResult:
    return _evaluate(chunk, lambda: time.sleep(60))


def loop_in_c(chunk: Chunk) -> ChunkResult:
    """Loop for ever in C at each failing point, with Python's lock
    held and signals ignored, as a kernel might.
    """
    return _evaluate(chunk, lambda: collections.deque(itertools.repeat(0), maxlen=0))
