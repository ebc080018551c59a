"""A sweep from its plan to its rows: parts handed to workers, rows written as they come, the lost ones tried again.

A point is suspected when its worker died or its time ran out. All suspects are computed once more at the end, each
alone, so that whoever breaks down then is known; it is recorded with its reason, and nobody else's row is lost.
"""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Executor, Future, wait
from dataclasses import dataclass, field

import numpy as np

from fingertip.errors import Issue, SweepError
from fingertip.sweep import chunk as parts
from fingertip.sweep.engines import Engine
from fingertip.sweep.chunk import Done, Part, Work
from fingertip.sweep.plan import Plan
from fingertip.sweep.database import Store, Stored
from fingertip.sweep.work import work as work_on

PART_S = 0.5
"""About how long a worker computes before it reports."""
MAX_IN_PART = 8192
WRITE_S, WRITE_ROWS = 0.5, 50_000
"""Rows are committed this often; what a kill -9 costs is computed again."""
LATE_S = 30.0
"""The pace is that of so long."""
AHEAD = 2
"""Parts in flight for each worker: one computed, one waiting."""
_BLOCK = 65_536
BARREN = 5
"""So many breakdowns that accuse no point are borne, in a row."""


@dataclass
class State:
    """How far a sweep is."""

    size: int
    before: int
    """Rows that were there when it began."""
    written: int = 0
    """Rows since then."""
    failures: int = 0
    """Failed points and timeouts among them."""
    refused: int = 0
    moments: deque[tuple[float, int]] = field(default_factory=lambda: deque([(time.perf_counter(), 0)]))
    """When how many rows were written, of late."""

    @property
    def done(self) -> int:
        """All rows."""
        return self.before + self.written

    @property
    def points_per_s(self) -> float:
        """Of late: workers that start, or compile, are forgotten soon."""
        (start_s, before), now = self.moments[0], time.perf_counter()
        return (self.written - before) / max(1e-9, now - start_s)

    @property
    def left_s(self) -> float:
        """Until it is done, at this pace [s]; infinite while no row comes."""
        pace = self.points_per_s
        return (self.size - self.done) / pace if pace else math.inf

    def wrote(self, rows: int) -> None:
        """Rows were committed."""
        self.written += rows
        now = time.perf_counter()
        self.moments.append((now, self.written))
        while len(self.moments) > 2 and self.moments[1][0] < now - LATE_S:
            self.moments.popleft()


def run(
    plan: Plan, store: Store, engine: Engine, told: Callable[[State], None] = lambda _: None, work: Work = work_on
) -> State:
    """Compute every point of a plan that has no row yet.

    Parameters
    ----------
    plan, store
        What, and where its rows go.
    engine
        Who computes.
    told
        Called as rows are written, and while nothing comes.
    work
        What workers do with a part.

    Raises
    ------
    OutputError
        If rows cannot be written any more; those before are safe.
    SweepError
        If the cluster is gone, or workers die without having computed anything.
    """
    missing = store.missing()
    state = State(plan.size, int(plan.size - missing.sum()))
    sweep = _Sweep(plan, store, engine, told, work, state)
    try:
        sweep.all_of(_parts(plan, missing, sweep))
    finally:
        engine.close()
        sweep.write(at_once=True)
    return state


def _parts(plan: Plan, missing: np.ndarray, sweep: _Sweep) -> Iterator[Part]:
    """The missing points in the plan's order, in parts of the size that suits just then."""
    text = plan.to_toml()
    for start in range(0, plan.size, _BLOCK):
        points = plan.in_order(start, start + _BLOCK)
        points = points[missing[points]]
        while len(points):
            now, points = points[: sweep.part_size], points[sweep.part_size :]
            columns = {name: column.tolist() for name, column in plan.columns(now).items()}
            yield Part(text, tuple(now.tolist()), columns)


class _Sweep:
    """The loop's state: parts in flight, rows not yet written, suspects."""

    def __init__(
        self, plan: Plan, store: Store, engine: Engine, told: Callable[[State], None], work: Work, state: State
    ) -> None:
        self.plan, self.store, self.engine, self.told, self.work, self.state = plan, store, engine, told, work, state
        self.part_size = 1
        self._executor: Executor | None = None
        self._flying: dict[Future[Done], Part] = {}
        self._again: deque[Part] = deque()
        self._suspects: list[Part] = []
        self._barren = 0
        """Breakdowns in a row that accuse no point."""
        self._rows: list[Stored] = []
        self._written_at = -math.inf  # the first row at once: it shows that the folder can be written

    def all_of(self, todo: Iterator[Part]) -> None:
        """Compute everything, then the suspects one by one."""
        exhausted = False
        while not exhausted or self._flying or self._again:
            while not exhausted and len(self._flying) < AHEAD * self.engine.workers:
                part = self._again.popleft() if self._again else next(todo, None)
                if part is None:
                    exhausted = True
                else:
                    self._send(part)
            while self._again and len(self._flying) < AHEAD * self.engine.workers:
                self._send(self._again.popleft())
            self._receive()
        for part in self._suspects:
            self._alone(part)

    def _send(self, part: Part) -> None:
        try:
            self._flying[self._submit(part)] = part
        except BrokenExecutor:
            self._again.appendleft(part)
            self._broken([])

    def _submit(self, part: Part) -> Future[Done]:
        if self._executor is None:
            self._executor = self.engine.executor()
        return self._executor.submit(self.work, part)

    def _receive(self) -> None:
        done, _ = wait(self._flying, timeout=0.5, return_when=FIRST_COMPLETED)
        lost: list[Part] = []
        broken = False
        for future in done:
            part = self._flying.pop(future)
            error = future.exception() if not future.cancelled() else CancelledError()
            if error is None:
                self._barren = 0
                self._take(part, future.result())
            elif isinstance(error, BrokenExecutor):
                lost.append(part)
                broken = True
            else:
                self._lost(part, error)
        if broken:
            self._broken(lost)
        self.write()
        self.told(self.state)

    def _take(self, part: Part, done: Done) -> None:
        self._keep(part, done)
        pace = done.took_s / len(chunk.points)
        wanted = round(PART_S / pace) if pace > 0 else MAX_IN_PART
        self.part_size = max(1, min(wanted, 4 * self.part_size, MAX_IN_PART))

    def _keep(self, part: Part, done: Done) -> None:
        values = zip(*chunk.columns.values(), strict=True)
        for (point, status, field_, reason, outputs), axes in zip(done.outcomes, values, strict=True):
            self._rows.append((point, status, field_, reason, *axes, *outputs))
            self.state.failures += status in ("failed", "timeout")
            self.state.refused += status == "refused"

    def _broken(self, lost: list[Part]) -> None:
        """The pool broke: everything in flight is lost, what was being computed is suspected."""
        lost += self._flying.values()
        self._flying.clear()
        accused = self.engine.suspects()
        self._executor = None
        self._barren = 0 if accused is None or accused else self._barren + 1
        if self._barren > BARREN:
            sentence = f"workers died {self._barren} times without being at a point; is there memory for them?"
            raise SweepError(
                Issue("--jobs", f"{sentence} What was written is safe, go on with --resume and fewer jobs.")
            )
        for part in lost:
            at = range(len(chunk.points))
            guilty = [i for i in at if accused is None or chunk.points[i] in accused]
            self._suspects += (chunk.single(i) for i in guilty)
            rest = [i for i in at if i not in set(guilty)]
            if rest:
                columns = {name: [column[i] for i in rest] for name, column in chunk.columns.items()}
                self._again.append(Part(chunk.text, tuple(chunk.points[i] for i in rest), columns))

    def _lost(self, part: Part, error: BaseException) -> None:
        if isinstance(error, CancelledError):
            raise SweepError(Issue("--cluster", "is gone; what was written is safe, go on with --resume.")) from None
        self._suspects += (chunk.single(i) for i in range(len(chunk.points)))

    def _alone(self, part: Part) -> None:
        """Compute one suspect with nobody beside it."""
        try:
            future = self._submit(part)
        except BrokenExecutor:  # one of those that had nothing to do died; the next is the part's own
            self._executor = None
            future = self._submit(part)
        start = time.perf_counter()
        while not wait([future], timeout=0.5).done:
            self.told(self.state)
        limit, outputs = self.plan.file.time_limit_s, len(self.plan.outputs)
        error = future.exception() if not future.cancelled() else CancelledError()
        if error is None:
            done = future.result()
        elif isinstance(error, CancelledError):
            self._lost(part, error)
            return
        else:
            accused = self.engine.suspects() if isinstance(error, BrokenExecutor) else None
            took_s = time.perf_counter() - start
            if accused is not None:
                took_s = accused.get(chunk.points[0], 0.0)
            late = took_s >= limit * self.engine.tries
            row = parts.too_long(chunk.points[0], limit, outputs) if late else parts.died(chunk.points[0], outputs)
            done = Done([row], 0.0)
            if isinstance(error, BrokenExecutor):
                self._executor = None
        self._keep(part, done)
        self.write()
        self.told(self.state)

    def write(self, at_once: bool = False) -> None:
        """Commit the rows that wait, if it is time."""
        now = time.perf_counter()
        if self._rows and (at_once or now - self._written_at > WRITE_S or len(self._rows) >= WRITE_ROWS):
            rows, self._rows = self._rows, []
            self.store.add(rows)
            self.state.wrote(len(rows))
            self._written_at = now
