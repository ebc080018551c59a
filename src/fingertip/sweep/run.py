"""Run of a sweep: chunks are sent to workers, rows are written as results arrive, and failed chunks
are retried.

A point is retried if its worker died or its time ran out. All retries are computed at the end, one
at a time, so that a second failure can be attributed to its point on any engine. That point is then
recorded with its reason; every other point keeps its row.
"""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Callable, Collection, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, CancelledError, Future, wait
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fingertip.design.design_file import Changes, list_changes
from fingertip.foundation.errors import Issue, SweepError, shorten
from fingertip.foundation.extras import load
from fingertip.foundation.workers import WorkerDiedError, find_workers
from fingertip.sweep.database import MAX_REASON_LENGTH, StoredRow, SweepDatabase
from fingertip.sweep.engines import Engine, ProcessEngine
from fingertip.sweep.point_evaluator import Chunk, ChunkFunction, ChunkResult, evaluate_chunk
from fingertip.sweep.sweep_plan import SweepPlan

if TYPE_CHECKING:
    import pandas

CHUNK_DURATION_S = 0.5
"""Time that a worker should spend on a chunk [s]."""
MAX_CHUNK_POINTS = 8192
WRITE_INTERVAL_S = 0.5
"""Minimum time between two commits [s]. Rows that a kill -9 loses are computed again."""
MAX_PENDING_ROWS = 50_000
"""Number of rows after which they are committed at once."""
RATE_WINDOW_S = 30.0
"""Time over which the rate of points is averaged [s]."""
HANG_LIMITS = 3.0
"""Number of a point's time limits without any result after which the progress says that a worker
may hang.
"""
CHUNKS_PER_WORKER = 2
"""Chunks in flight per worker: one is computed, one waits."""
MAX_CONSECUTIVE_FAILURES = 5
"""Number of breakdowns in a row, none of which can be attributed to a point, before the run gives
up.
"""
_POLL_INTERVAL_S = 0.5
_BLOCK = 65_536
"""Number of points whose parameters are generated at a time."""


@dataclass
class RunState:
    size: int
    existing: int
    """Number of rows when the run began."""
    written: int = 0
    failures: int = 0
    """Number of points since then that failed or ran out of time."""
    refused: int = 0
    """Number of points since then that break a design rule."""
    hang_s: float = math.inf
    """Silence from which a worker is suspected to hang [s]: several points' time limits."""
    silent_s: float = 0.0
    """Time since the last result of any worker, while some are awaited [s]."""
    history: deque[tuple[float, int]] = field(
        default_factory=lambda: deque([(time.perf_counter(), 0)])
    )
    """Times of the latest commits [s] and the number of rows written by then."""

    @property
    def done(self) -> int:
        return self.existing + self.written

    @property
    def points_per_s(self) -> float:
        """Rate of the last `RATE_WINDOW_S` [1/s]; the slow start of the workers drops out soon."""
        start_s, before = self.history[0]
        now = time.perf_counter()
        return (self.written - before) / max(1e-9, now - start_s)

    @property
    def remaining_s(self) -> float:
        """Estimated time to the end at the current rate [s]; infinite while the rate is zero."""
        rate = self.points_per_s
        return (self.size - self.done) / rate if rate else math.inf

    def add_written(self, rows: int) -> None:
        self.written += rows
        now = time.perf_counter()
        self.history.append((now, self.written))
        while len(self.history) > 2 and self.history[1][0] < now - RATE_WINDOW_S:
            self.history.popleft()


def run_sweep(
    file: str | Path | Mapping[str, Any],
    changes: Changes = (),
    out: str | Path | None = None,
    *,
    jobs: int | None = None,
    progress: Callable[[str], None] = lambda message: None,
) -> pandas.DataFrame:
    """Compute outputs of many designs, or read those that were computed before, as a table with a
    row for each.

    `file` is a sweep file, a bundled sweep, such as "board", or the tables of one, with the design
    as a table; the changes are those of the sweep, of its design or of its scene. In `out`, by
    default `out/sweeps/<name>`, an interrupted sweep goes on. `jobs` is the number of processes, by
    default one for each processor.

    Raises SweepError if the sweep is refused, or the folder holds another one, and
    MissingLibraryError without pandas.
    """
    frames = load("pandas", "run_sweep")
    if isinstance(file, Mapping) and changes:
        raise SweepError(Issue("changes", "change a file; state them in the tables."))

    if isinstance(file, Mapping):
        plan = SweepPlan.from_tables(file)
    else:
        plan = SweepPlan.load(Path(file), list_changes(changes))

    folder = Path("out", "sweeps", plan.file.name) if out is None else Path(out)
    begin = SweepDatabase.resume if SweepDatabase.exists(folder) else SweepDatabase.create
    engine = ProcessEngine(find_workers(jobs))

    with begin(folder, plan) as database:
        compute_rows(
            plan, database, engine, lambda state: progress(f"{state.done} of {plan.size} designs")
        )
        rows = [
            {
                "point": row.point,
                **row.axes,
                **row.outputs,
                "status": row.status,
                "field": row.field,
                "reason": row.reason,
            }
            for row in database.rows()
        ]

    return frames.DataFrame(rows).set_index("point")


def compute_rows(
    plan: SweepPlan,
    database: SweepDatabase,
    engine: Engine,
    progress: Callable[[RunState], None] = lambda _: None,
    evaluate: ChunkFunction = evaluate_chunk,
) -> RunState:
    """Compute every point of a plan that has no row yet. Raises OutputError or SweepError."""
    missing = database.find_missing_points()
    state = RunState(
        plan.size, int(plan.size - missing.sum()), hang_s=HANG_LIMITS * plan.file.time_limit_s
    )
    run = _Run(
        plan=plan,
        database=database,
        engine=engine,
        progress=progress,
        evaluate=evaluate,
        state=state,
    )

    try:
        run.compute(_split_into_chunks(plan, missing, run))
    finally:
        engine.close()
        run.write_rows(at_once=True)

    return state


def _split_into_chunks(plan: SweepPlan, missing: NDArray[np.bool_], run: _Run) -> Iterator[Chunk]:
    """Split the missing points, in computing order, into chunks of the size that the run asks for
    at that time.
    """
    text = plan.to_toml()
    for start in range(0, plan.size, _BLOCK):
        points = plan.computing_order(start, start + _BLOCK)
        points = points[missing[points]]
        while len(points):
            selected = points[: run.chunk_size]
            points = points[run.chunk_size :]
            columns = {name: column.tolist() for name, column in plan.columns(selected).items()}
            yield Chunk(text, tuple(selected.tolist()), columns)


@dataclass
class _Run:
    """State of the run loop: chunks in flight, chunks to send again, points to retry, rows not yet
    written.
    """

    plan: SweepPlan
    database: SweepDatabase
    engine: Engine
    progress: Callable[[RunState], None]
    evaluate: ChunkFunction
    state: RunState
    chunk_size: int = 1
    _in_flight: dict[Future[ChunkResult], tuple[Chunk, float]] = field(default_factory=dict)
    """Chunks that are computed or wait for a worker, and when they were sent [s]."""
    _resend_queue: deque[Chunk] = field(default_factory=deque)
    """Chunks that were lost although none of their points is to blame."""
    _retry_queue: list[Chunk] = field(default_factory=list)
    """Single points whose worker died or whose time ran out."""
    _is_retrying: bool = False
    _consecutive_failures: int = 0
    """Breakdowns in a row that could not be attributed to a point."""
    _pending_rows: list[StoredRow] = field(default_factory=list)
    _answered_at_s: float = field(default_factory=lambda: time.perf_counter())
    # The first row is written at once, to show that the folder is writable.
    _written_at_s: float = -math.inf

    def compute(self, chunks: Iterator[Chunk]) -> None:
        """Compute all chunks, then the points of the retry queue one by one."""
        self._compute_each(chunks, lambda: CHUNKS_PER_WORKER * self.engine.workers)
        self._is_retrying = True
        self._compute_each(iter(self._retry_queue), lambda: 1)

    def write_rows(self, at_once: bool = False) -> None:
        """Commit the pending rows if the interval has passed, if there are many, or `at_once`."""
        now = time.perf_counter()
        due = (
            at_once
            or now - self._written_at_s > WRITE_INTERVAL_S
            or len(self._pending_rows) >= MAX_PENDING_ROWS
        )

        if self._pending_rows and due:
            rows = self._pending_rows
            self._pending_rows = []
            self.database.add(rows)
            self.state.add_written(len(rows))
            self._written_at_s = now

    def _compute_each(self, chunks: Iterator[Chunk], find_limit: Callable[[], int]) -> None:
        """Keep a number of chunks in flight until all are computed.

        Lost chunks come before new ones.
        """
        while True:
            while len(self._in_flight) < find_limit():
                chunk = self._resend_queue.popleft() if self._resend_queue else next(chunks, None)
                if chunk is None:
                    break

                self._in_flight[self.engine.submit(self.evaluate, chunk)] = (
                    chunk,
                    time.perf_counter(),
                )

            if not self._in_flight:
                return

            done, _ = wait(self._in_flight, timeout=_POLL_INTERVAL_S, return_when=FIRST_COMPLETED)
            now = time.perf_counter()
            if done:
                self._answered_at_s = now

            self.state.silent_s = now - self._answered_at_s
            for future in done:
                self._receive(future, *self._in_flight.pop(future))

            self.write_rows()
            self.progress(self.state)

    def _receive(self, future: Future[ChunkResult], chunk: Chunk, sent_at_s: float) -> None:
        try:
            result = future.result()
        except CancelledError:
            message = "is lost; the rows written so far are safe, continue with --resume."
            raise SweepError(Issue("--cluster", message)) from None
        except WorkerDiedError as death:
            self._handle_death(chunk, death.step, death.elapsed_s)
        except Exception:  # the engine gave the chunk up; any of its points may be the cause
            self._handle_death(chunk, chunk.points, time.perf_counter() - sent_at_s)
        else:
            self._consecutive_failures = 0
            self._add_rows(chunk, result)
            # The next chunk should take `CHUNK_DURATION_S` at the pace of this one.
            per_point_s = result.elapsed_s / len(chunk.points)
            size = round(CHUNK_DURATION_S / per_point_s) if per_point_s > 0 else MAX_CHUNK_POINTS
            self.chunk_size = max(1, min(size, 4 * self.chunk_size, MAX_CHUNK_POINTS))

    def _handle_death(self, chunk: Chunk, points: Collection[int] | None, elapsed_s: float) -> None:
        """Retry the points that a dead worker was computing, or record them, and send the others
        again.

        Without any, the worker died before it began to compute. A timeout is told from a crash by
        the time since then.
        """
        self._consecutive_failures = 0 if points else self._consecutive_failures + 1
        if self._consecutive_failures > MAX_CONSECUTIVE_FAILURES:
            problem = f"workers died {self._consecutive_failures} times without computing a point"
            remedy = (
                "check the free memory. The rows written so far are safe: continue with "
                "--resume and fewer jobs."
            )
            raise SweepError(Issue("--jobs", f"{problem}; {remedy}"))

        indices = range(len(chunk.points))
        points = frozenset(points or ())
        other_points = [i for i in indices if chunk.points[i] not in points]
        if other_points:
            self._resend_queue.append(chunk.select(other_points))

        blamed = [chunk.select([i]) for i in indices if chunk.points[i] in points]
        if not self._is_retrying:
            self._retry_queue += blamed
            return

        limit_s = self.plan.file.time_limit_s
        status = "failed"
        reason = "its worker died while it was computed, twice."

        if elapsed_s >= limit_s * self.engine.attempts:
            status = "timeout"
            reason = f"took longer than {limit_s:g} s (time_limit_s), twice."

        for single in blamed:
            outputs = (math.nan,) * len(self.plan.recorded)
            self._add_rows(
                single, ChunkResult([(single.points[0], status, "", reason, outputs)], 0.0)
            )

    def _add_rows(self, chunk: Chunk, result: ChunkResult) -> None:
        values = zip(*chunk.columns.values(), strict=True)
        for (point, status, field_, reason, outputs), axes in zip(
            result.results, values, strict=True
        ):
            self._pending_rows.append(
                (point, status, field_, shorten(reason, MAX_REASON_LENGTH), *axes, *outputs)
            )
            self.state.failures += status in ("failed", "timeout")
            self.state.refused += status == "refused"
