"""Loop of a sweep with scripted workers and a clock that stands still: sizes of chunks, writes, failures, retries."""

from __future__ import annotations

import itertools
import math
from collections import deque
from collections.abc import Callable, Mapping
from concurrent.futures import BrokenExecutor, Future
from typing import Any, cast

import numpy as np
import pytest

from fingertip.foundation.errors import SweepError
from fingertip.sweep import run
from fingertip.sweep.database import StoredRow, SweepDatabase
from fingertip.sweep.point_evaluator import Chunk, ChunkResult
from fingertip.sweep.run import RunState, run_sweep
from tests.sweep.examples import InlineEngine, make_plan
from tests.sweep.worker_functions import make_result

POINTS = 72
LIMIT_S = 3.0


class Clock:
    """Stand-in for the module `time`, set by hand; `tick_s` is added by every reading."""

    def __init__(self, tick_s: float = 0.0) -> None:
        self.now_s, self.tick_s = 100.0, tick_s

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
    """Engine whose pool breaks whenever a chunk holds one of some points."""

    def __init__(self, bad: set[int], crashed: Mapping[int, float] | None, attempts: int = 1) -> None:
        super().__init__()
        self.bad, self.crashed, self.attempts = bad, crashed, attempts

    def submit(self, fn: Callable[..., Any], /, *arguments: Any) -> Future[Any]:
        if self.bad.isdisjoint(arguments[0].points):
            return super().submit(fn, *arguments)
        future: Future[Any] = Future()
        future.set_exception(BrokenExecutor())
        return future

    def find_crashed_points(self) -> Mapping[int, float] | None:
        return self.crashed


def worker(per_point_s: float, sizes: list[int] | None = None) -> Callable[[Chunk], ChunkResult]:
    """Worker that says it took this time for each point [s]."""

    def evaluate(chunk: Chunk) -> ChunkResult:
        if sizes is not None:
            sizes.append(len(chunk.points))
        return ChunkResult([make_result(point) for point in chunk.points], per_point_s * len(chunk.points))

    return evaluate


def compute(
    engine: InlineEngine, database: Database, per_point_s: float = 0.01, sizes: list[int] | None = None
) -> RunState:
    plan = make_plan(time_limit_s=LIMIT_S)
    assert plan.size == POINTS
    return run_sweep(plan, cast(SweepDatabase, database), engine, evaluate=worker(per_point_s, sizes))


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    found = Clock()
    monkeypatch.setattr(run, "time", found)
    return found


def test_rate_and_remaining_time_are_those_of_the_last_half_minute(clock: Clock) -> None:
    state = RunState(100, 10)
    assert (state.points_per_s, state.remaining_s) == (0.0, math.inf)
    clock.now_s += 0.5
    assert RunState(100, 0, written=10, history=deque([(clock.now_s - 0.5, 0)])).points_per_s == 20.0
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
    clock: Clock, monkeypatch: pytest.MonkeyPatch, begin_s: float, tick_s: float, max_pending: int, expected: list[int]
) -> None:
    clock.now_s, clock.tick_s = begin_s, tick_s
    monkeypatch.setattr(run, "MAX_PENDING_ROWS", max_pending)
    database = Database()
    compute(InlineEngine(), database)
    assert [len(rows) for rows in database.commits] == expected


@pytest.mark.parametrize(
    ("attempts", "after_s", "status"),
    [(1, 0.99 * LIMIT_S, "failed"), (1, LIMIT_S, "timeout"), (3, 2.9 * LIMIT_S, "failed"), (3, 3 * LIMIT_S, "timeout")],
)
def test_point_whose_worker_dies_is_tried_again_alone_and_recorded(
    clock: Clock, attempts: int, after_s: float, status: str
) -> None:
    database = Database()
    state = compute(Breaking({40}, {40: after_s}, attempts), database)
    assert [row[0] for row in database.rows] == list(range(POINTS))
    assert [row[0] for row in database.rows if row[1] != make_result(int(row[0]))[1]] == [40]
    assert database.rows[40][1] == status
    assert (state.failures, state.refused) == (1, 0)


def test_every_point_of_a_lost_chunk_is_tried_alone_if_nobody_knows_which_one_it_was(clock: Clock) -> None:
    sizes: list[int] = []
    database = Database()
    state = compute(Breaking({40}, None), database, sizes=sizes)
    assert [row[1] == "failed" for row in database.rows] == [point == 40 for point in range(POINTS)]
    assert state.failures == 1
    assert sum(sizes) == POINTS - 1


def test_pool_that_breaks_while_it_is_given_work_is_started_again(clock: Clock) -> None:
    """An idle worker died: the pool refuses work. The chunk is sent to a new pool, and no point is to blame."""

    class Refusing(Breaking):
        def submit(self, fn: Callable[..., Any], /, *arguments: Any) -> Future[Any]:
            if self.started == 1:
                raise BrokenExecutor
            return super().submit(fn, *arguments)

    engine, database = Refusing(set(), {}), Database()
    state = compute(engine, database)
    assert engine.started == 2
    assert [row[1] for row in database.rows] == ["ok"] * POINTS
    assert state.failures == 0


def test_retry_that_an_idle_pool_refuses_is_sent_to_a_new_one(clock: Clock) -> None:
    class Refusing(Breaking):
        def submit(self, fn: Callable[..., Any], /, *arguments: Any) -> Future[Any]:
            if self.started == 2 and arguments[0].points == (40,):
                self.bad = set()
                raise BrokenExecutor
            return super().submit(fn, *arguments)

    engine, database = Refusing({40}, {40: 2 * LIMIT_S}), Database()
    state = compute(engine, database)
    assert engine.started == 3
    assert [row[1] for row in database.rows] == ["ok"] * POINTS
    assert state.failures == 0


def test_breakdowns_count_only_in_a_row(clock: Clock) -> None:
    """A breakdown with a culprit starts the count again: five without one may precede it, and five may follow."""

    class Flaky(Breaking):
        breakdowns = 0

        def find_crashed_points(self) -> Mapping[int, float] | None:
            self.breakdowns += 1
            return {} if self.breakdowns != run.MAX_CONSECUTIVE_FAILURES + 1 else {0: LIMIT_S / 2}

    engine = Flaky(set(range(POINTS)), {})
    with pytest.raises(SweepError, match="workers died 6 times without computing a point"):
        compute(engine, Database())
    assert engine.breakdowns == 2 * (run.MAX_CONSECUTIVE_FAILURES + 1)


def test_breakdowns_after_a_result_are_counted_from_the_first(clock: Clock) -> None:
    engine = Breaking(set(), {})

    def evaluate(chunk: Chunk) -> ChunkResult:
        engine.bad = set(range(POINTS))
        return worker(0.01)(chunk)

    with pytest.raises(SweepError, match="workers died 6 times without computing a point"):
        run_sweep(make_plan(), cast(SweepDatabase, Database()), engine, evaluate=evaluate)
    assert engine.started == run.MAX_CONSECUTIVE_FAILURES + 1


def test_refused_points_and_failed_ones_are_counted_apart(clock: Clock) -> None:
    status = {0: "refused", 1: "refused", 2: "failed", 3: "timeout", 4: "failed"}

    def evaluate(chunk: Chunk) -> ChunkResult:
        results = [make_result(point) for point in chunk.points]
        return ChunkResult([(r[0], status.get(r[0], "ok"), *r[2:]) for r in results], 0.1)

    database = Database()
    state = run_sweep(make_plan(), cast(SweepDatabase, database), InlineEngine(), evaluate=evaluate)
    assert (state.refused, state.failures) == (2, 3)


def test_lost_cluster_ends_the_run_with_a_sentence(clock: Clock) -> None:
    class Lost(InlineEngine):
        def submit(self, fn: Callable[..., Any], /, *arguments: Any) -> Future[Any]:
            future: Future[Any] = Future()
            future.cancel()
            future.set_running_or_notify_cancel()
            return future

    with pytest.raises(SweepError, match="cluster: is lost"):
        compute(Lost(), Database())


class Slow(InlineEngine):
    """Engine with one worker for two points, whose results come when a test says so."""

    def __init__(self) -> None:
        super().__init__()
        self.asked = 0
        self.waiting: list[tuple[Chunk, Future[ChunkResult]]] = []

    def submit(self, fn: Callable[..., Any], /, *arguments: Any) -> Future[Any]:
        future: Future[ChunkResult] = Future()
        self.waiting.append((arguments[0], future))
        return future

    def end_if_stuck(self) -> None:
        self.asked += 1

    def answer(self) -> None:
        chunk, future = self.waiting.pop(0)
        future.set_result(worker(1.0)(chunk))


def test_silence_of_the_workers_is_measured_from_the_last_result(clock: Clock, monkeypatch: pytest.MonkeyPatch) -> None:
    """A worker answers at 3 s, then one 9 s later: from more than 5 s on, the engine is asked whether it is stuck."""
    engine, seen = Slow(), []
    script = iter([3.0, 0.0, 5.0, 0.5, 3.5, 0.0])

    def progress(state: RunState) -> None:
        seen.append((state.silent_s, engine.asked, state.hang_s))
        clock.now_s += next(script, 0.0)
        if len(seen) in (1, 5):
            engine.answer()

    monkeypatch.setattr(run, "_POLL_INTERVAL_S", 1e-3)
    plan = make_plan(time_limit_s=LIMIT_S)
    run_sweep(plan, cast(SweepDatabase, Database(missing=2)), engine, progress, worker(1.0))
    silences = [(silent_s, asked) for silent_s, asked, _ in seen]
    assert silences == [(0.0, 0), (0.0, 0), (0.0, 0), (5.0, 0), (5.5, 1), (0.0, 1)]
    assert {hang_s for *_, hang_s in seen} == {3 * LIMIT_S}
    assert RunState(1, 0).silent_s == 0.0


def test_every_worker_has_a_chunk_to_compute_and_one_that_waits(clock: Clock, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(run, "_POLL_INTERVAL_S", 1e-3)
    engine, waiting = Slow(), list[int]()
    engine.workers = 3

    def progress(_: RunState) -> None:
        waiting.append(len(engine.waiting))
        while engine.waiting:
            engine.answer()

    run_sweep(make_plan(), cast(SweepDatabase, Database(missing=14)), engine, progress, worker(1.0))
    assert waiting[0] == max(waiting) == 6


def test_only_commits_of_the_last_half_minute_count(clock: Clock) -> None:
    state = RunState(100, 0)
    clock.now_s += 10.0
    state.add_written(5)
    clock.now_s += run.RATE_WINDOW_S
    state.add_written(10)
    assert len(state.history) == 3, "one of exactly 30 s ago still begins the window"
    clock.now_s += 1.0
    state.add_written(0)
    assert len(state.history) == 3
    assert state.points_per_s == pytest.approx(10 / 31)


@pytest.mark.parametrize(
    ("limit_s", "second", "status"),
    [
        (LIMIT_S, {40: 2 * LIMIT_S}, "timeout"),
        (0.5, {}, "failed"),
        (0.5, {41: 9.0}, "failed"),
        (0.5, {40: 0.6}, "timeout"),
    ],
)
def test_time_of_the_second_death_decides_between_timeout_and_failure(
    clock: Clock, limit_s: float, second: dict[int, float], status: str
) -> None:
    """A point that the engine does not name had not begun."""

    class Twice(Breaking):
        found = iter([{40: 99.0}, second])

        def find_crashed_points(self) -> Mapping[int, float] | None:
            return next(self.found)

    database = Database()
    plan = make_plan(time_limit_s=limit_s)
    run_sweep(plan, cast(SweepDatabase, database), Twice({40}, None), evaluate=worker(0.01))
    assert database.rows[40][1] == status


@pytest.mark.parametrize(("tick_s", "status"), [(1.4, "failed"), (1.5, "timeout")])
def test_time_of_a_point_nobody_measured_is_that_of_its_retry(clock: Clock, tick_s: float, status: str) -> None:
    """From the start of the retry to its end, the clock is read twice."""
    seen: list[Chunk] = []

    def evaluate(chunk: Chunk) -> ChunkResult:
        if 40 not in chunk.points:
            return worker(0.01)(chunk)
        seen.append(chunk)
        clock.tick_s = tick_s * (len(seen) == 2)
        raise ValueError

    database = Database()
    run_sweep(make_plan(time_limit_s=LIMIT_S), cast(SweepDatabase, database), InlineEngine(), evaluate=evaluate)
    assert database.rows[40][1] == status
    assert sum(row[1] != "ok" for row in database.rows) == 1
