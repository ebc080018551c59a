"""Loop of a sweep with scripted workers and a clock that stands still:
sizes of chunks, writes, failures, retries.
"""

from __future__ import annotations

import itertools
import math
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any, cast

import numpy as np
import pytest

from fingertip.cli.console import format_state
from fingertip.foundation.errors import SweepError
from fingertip.foundation.workers import WorkerDiedError
from fingertip.sweep import run
from fingertip.sweep.database import StoredRow, SweepDatabase
from fingertip.sweep.engines import ProcessEngine
from fingertip.sweep.point_evaluator import Chunk, ChunkResult
from fingertip.sweep.run import RunState, compute_rows
from tests.sweep.examples import InlineEngine, make_plan
from tests.sweep.worker_functions import make_result

POINTS = 72
LIMIT_S = 3.0


class Clock:
    """Stand-in for the module `time`, set by hand; `tick_s` is added by every reading."""

    def __init__(self, tick_s: float = 0.0) -> None:
        self.now_s = 100.0
        self.tick_s = tick_s

    def perf_counter(self) -> float:
        self.now_s += self.tick_s
        return self.now_s


class Database:
    """Database that remembers what was written, one list of rows for each commit."""

    def __init__(self, missing: int = POINTS) -> None:
        self.missing = np.arange(POINTS) < missing
        self.commits: list[list[StoredRow]] = []

    def find_missing_points(self) -> np.ndarray:
        return self.missing

    def add(self, rows: list[StoredRow]) -> None:
        self.commits.append(list(rows))

    @property
    def rows(self) -> list[StoredRow]:
        return sorted(itertools.chain.from_iterable(self.commits))


class Breaking(InlineEngine):
    """Engine whose worker dies whenever a chunk holds one of some
    points, and says so of that point or of none.
    """

    def __init__(
        self, bad: set[int], elapsed_s: float = 0.0, attempts: int = 1, *, is_known: bool = True
    ) -> None:
        self.bad = bad
        self.elapsed_s = elapsed_s
        self.attempts = attempts
        self.is_known = is_known
        self.deaths = 0

    def submit(self, function: Callable[..., Any], *arguments: Any) -> Future[Any]:
        found = self.bad.intersection(arguments[0].points)
        if not found:
            return super().submit(function, *arguments)
        self.deaths += 1
        future: Future[Any] = Future()
        future.set_exception(
            WorkerDiedError(tuple(found) if self.is_known else None, self.elapsed_s)
        )
        return future


def worker(per_point_s: float, sizes: list[int] | None = None) -> Callable[[Chunk], ChunkResult]:
    """Worker that says it took this time for each point [s]."""

    def evaluate(chunk: Chunk) -> ChunkResult:
        if sizes is not None:
            sizes.append(len(chunk.points))
        return ChunkResult(
            [make_result(point) for point in chunk.points], per_point_s * len(chunk.points)
        )

    return evaluate


def compute(
    engine: InlineEngine,
    database: Database,
    per_point_s: float = 0.01,
    sizes: list[int] | None = None,
) -> RunState:
    plan = make_plan(time_limit_s=LIMIT_S)
    assert plan.size == POINTS
    return compute_rows(
        plan, cast(SweepDatabase, database), engine, evaluate=worker(per_point_s, sizes)
    )


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    found = Clock()
    monkeypatch.setattr(run, "time", found)
    return found


def test_rate_and_remaining_time_are_those_of_the_last_half_minute(clock: Clock) -> None:
    state = RunState(100, 10)
    assert (state.points_per_s, state.remaining_s) == (0.0, math.inf)
    clock.now_s += 0.5
    few, enough = (
        RunState(100, 0, written=rows, history=deque([(clock.now_s - 0.5, 0)])) for rows in (9, 10)
    )
    assert enough.points_per_s == 20.0
    assert ("left" in format_state(few), "left" in format_state(enough)) == (False, True)
    clock.now_s += 1.5
    state.add_written(20)
    clock.now_s += 2.0
    assert (state.done, state.points_per_s) == (30, 5.0)
    assert state.remaining_s == (100 - 30) / 5.0
    for later_s in (16.0, 20.0):
        clock.now_s += later_s
        state.add_written(20)
    # 40 s after the start: what was written within the first 2 s no longer counts.
    assert state.points_per_s == pytest.approx((60 - 20) / (40 - 2))
    assert len(state.history) == 3
    # After a pause of a minute, two commits are left to measure a rate between.
    clock.now_s += 60.0
    state.add_written(20)
    assert state.points_per_s == pytest.approx(20 / 60)
    assert len(state.history) == 2


@pytest.mark.parametrize(
    ("per_point_s", "expected"),
    [
        (0.05, [1, 1, 10, 10, 10, 10, 10, 10, 10]),  # half a second each
        (0.01, [1, 1, 16, 16, 38]),  # each result may make the chunks four times as large
        (0.0, [1, 1, 16, 16, 38]),
        (1.0, [1] * POINTS),
    ],
)
def test_chunks_take_half_a_second(clock: Clock, per_point_s: float, expected: list[int]) -> None:
    sizes: list[int] = []
    database = Database()
    state = compute(InlineEngine(), database, per_point_s, sizes)
    assert sizes == expected
    assert [row[0] for row in database.rows] == list(range(POINTS))
    assert (state.written, state.failures) == (POINTS, 0)


def test_only_missing_points_are_computed(clock: Clock) -> None:
    database = Database(missing=5)
    state = compute(InlineEngine(), database)
    assert [row[0] for row in database.rows] == list(range(5))
    assert (state.existing, state.written, state.done) == (POINTS - 5, 5, POINTS)


@pytest.mark.parametrize(
    ("begin_s", "tick_s", "max_pending", "expected"),
    [
        (100.0, 0.0, 50_000, [2, 70]),
        (0.0, 0.0, 50_000, [2, 70]),  # the first rows at once, whatever the clock shows
        (100.0, 2 * run.WRITE_INTERVAL_S, 50_000, [2, 32, 38]),
        (100.0, 0.0, 32, [2, 32, 38]),
        (100.0, 0.0, 33, [2, 70]),
    ],
)
def test_rows_are_written_at_once_then_at_intervals_or_when_many_wait(
    clock: Clock,
    monkeypatch: pytest.MonkeyPatch,
    begin_s: float,
    tick_s: float,
    max_pending: int,
    expected: list[int],
) -> None:
    clock.now_s = begin_s
    clock.tick_s = tick_s
    monkeypatch.setattr(run, "MAX_PENDING_ROWS", max_pending)
    database = Database()
    compute(InlineEngine(), database)
    assert [len(rows) for rows in database.commits] == expected


@pytest.mark.parametrize(
    ("attempts", "limits", "in_time"),
    [
        (ProcessEngine.attempts, 0.99, True),
        (ProcessEngine.attempts, 1, False),
        (3, 2.9, True),
        (3, 3, False),
    ],
)
def test_point_whose_worker_dies_is_tried_again_alone_and_recorded(
    clock: Clock, attempts: int, limits: float, in_time: bool
) -> None:
    sizes: list[int] = []
    engine = Breaking({40}, limits * LIMIT_S, attempts)
    database = Database()
    state = compute(engine, database, sizes=sizes)
    assert [row[0] for row in database.rows] == list(range(POINTS))
    assert [row[0] for row in database.rows if row[1] != make_result(int(row[0]))[1]] == [40]
    assert database.rows[40][1] == ("failed" if in_time else "timeout")
    assert (state.failures, state.refused, engine.deaths) == (1, 0, 2)
    assert max(sizes) > 1
    assert sum(sizes) == POINTS - 1


def test_worker_that_dies_before_it_begins_is_no_fault_of_its_points(clock: Clock) -> None:
    """Neither at the first attempt nor alone: five such deaths in a
    row may precede a result, and follow it.
    """

    class Flaky(Breaking):
        def submit(self, function: Callable[..., Any], *arguments: Any) -> Future[Any]:
            self.is_known = self.deaths in (5, 11)
            self.bad = set() if self.deaths == 17 else {40}
            return super().submit(function, *arguments)

    engine = Flaky({40})
    database = Database()
    state = compute(engine, database)
    assert engine.deaths == 12, "five, a known one, five, and the second known one"
    assert [row[1] for row in database.rows] == [
        "failed" if point == 40 else "ok" for point in range(POINTS)
    ]
    assert state.failures == 1


@pytest.mark.parametrize("results", [0, 2])
def test_six_workers_in_a_row_that_die_before_they_begin_end_the_run(
    clock: Clock, results: int
) -> None:
    engine = Breaking(set(range(results, POINTS)), is_known=False)
    with pytest.raises(SweepError, match="workers died 6 times without computing a point"):
        compute(engine, Database())
    assert engine.deaths == run.MAX_CONSECUTIVE_FAILURES + 1


def test_refused_points_and_failed_ones_are_counted_apart(clock: Clock) -> None:
    status = {0: "refused", 1: "refused", 2: "failed", 3: "timeout", 4: "failed"}

    def evaluate(chunk: Chunk) -> ChunkResult:
        results = [make_result(point) for point in chunk.points]
        return ChunkResult([(r[0], status.get(r[0], "ok"), *r[2:]) for r in results], 0.1)

    database = Database()
    state = compute_rows(
        make_plan(), cast(SweepDatabase, database), InlineEngine(), evaluate=evaluate
    )
    assert (state.refused, state.failures) == (2, 3)


def test_lost_cluster_ends_the_run_with_a_sentence(clock: Clock) -> None:
    class Lost(InlineEngine):
        def submit(self, function: Callable[..., Any], *arguments: Any) -> Future[Any]:
            future: Future[Any] = Future()
            future.cancel()
            future.set_running_or_notify_cancel()
            return future

    with pytest.raises(SweepError, match="cluster: is lost"):
        compute(Lost(), Database())


class Slow(InlineEngine):
    """Engine with one worker for two points, whose results come when a test says so."""

    def __init__(self) -> None:
        self.waiting: list[tuple[Chunk, Future[ChunkResult]]] = []

    def submit(self, function: Callable[..., Any], *arguments: Any) -> Future[Any]:
        future: Future[ChunkResult] = Future()
        self.waiting.append((arguments[0], future))
        return future

    def answer(self) -> None:
        chunk, future = self.waiting.pop(0)
        future.set_result(worker(1.0)(chunk))


def test_silence_of_the_workers_is_measured_from_the_last_result(
    clock: Clock, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A worker answers at 3 s, then one 9 s later."""
    engine = Slow()
    seen = []
    script = iter([3.0, 0.0, 5.0, 0.5, 3.5, 0.0])

    def progress(state: RunState) -> None:
        seen.append((state.silent_s, state.hang_s))
        clock.now_s += next(script, 0.0)
        if len(seen) in (1, 5):
            engine.answer()

    monkeypatch.setattr(run, "_POLL_INTERVAL_S", 1e-3)
    plan = make_plan(time_limit_s=LIMIT_S)
    compute_rows(plan, cast(SweepDatabase, Database(missing=2)), engine, progress, worker(1.0))
    assert [silent_s for silent_s, _ in seen] == [0.0, 0.0, 0.0, 5.0, 5.5, 0.0]
    assert {hang_s for _, hang_s in seen} == {3 * LIMIT_S}
    assert RunState(1, 0).silent_s == 0.0


def test_every_worker_has_a_chunk_to_compute_and_one_that_waits(
    clock: Clock, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(run, "_POLL_INTERVAL_S", 1e-3)
    engine = Slow()
    waiting = list[int]()
    engine.workers = 3

    def progress(_: RunState) -> None:
        waiting.append(len(engine.waiting))
        while engine.waiting:
            engine.answer()

    compute_rows(
        make_plan(), cast(SweepDatabase, Database(missing=14)), engine, progress, worker(1.0)
    )
    assert waiting[0] == max(waiting) == 6


@pytest.mark.parametrize(("elapsed_s", "status"), [(2.9, "failed"), (3.0, "timeout")])
def test_chunk_that_the_engine_gives_up_is_tried_point_by_point(
    clock: Clock, elapsed_s: float, status: str
) -> None:
    """Of a cluster nobody knows which point it was, nor its time, which is that of its retry."""
    sizes: list[int] = []

    def evaluate(chunk: Chunk) -> ChunkResult:
        if 40 not in chunk.points:
            return worker(0.01, sizes)(chunk)
        clock.now_s += elapsed_s if chunk.points == (40,) else 60.0
        raise ValueError

    database = Database()
    plan = make_plan(time_limit_s=LIMIT_S)
    compute_rows(plan, cast(SweepDatabase, database), InlineEngine(), evaluate=evaluate)
    assert [row[1] for row in database.rows] == [
        status if point == 40 else "ok" for point in range(POINTS)
    ]
    assert sum(sizes) == POINTS - 1
