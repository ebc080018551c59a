"""Who computes the parts of a sweep: workers behind `concurrent.futures.Executor`, of this machine or a cluster."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import time
from collections.abc import Iterator, Mapping
from concurrent.futures import BrokenExecutor, Executor, ProcessPoolExecutor
from multiprocessing.context import SpawnContext
from multiprocessing.process import BaseProcess
from typing import Protocol

from fingertip.errors import Issue, SweepError
from fingertip.sweep.time_limit import end_with_parent

NOBODY = -1
PATIENCE_S = 5.0
"""How long the processes of a broken pool may take to end."""


class Marks:
    """Where each worker is, in memory that all share: a breakdown then accuses those alone that died by themselves."""

    def __init__(self, context: SpawnContext, workers: int) -> None:
        self.taken = context.Value("i", 0)
        self.pids = context.RawArray("q", workers)
        self.points = context.RawArray("q", [NOBODY] * workers)
        self.since_s = context.RawArray("d", workers)


_marks: Marks | None = None
_slot = -1


class Engine(Protocol):
    """Gives executors, and says what it knows of workers that died."""

    what: str
    """What its workers are, for people."""
    tries: int
    """How many workers it lets die of one part before it gives that up by itself."""

    @property
    def workers(self) -> int:
        """How many there are."""

    def executor(self) -> Executor:
        """Workers that are ready; after a breakdown, new ones."""

    def suspects(self) -> Mapping[int, float] | None:
        """Points that were being computed by the workers that died, and for how long [s]; None if nobody knows."""

    def close(self) -> None:
        """Let the workers go, busy or not."""


class Processes:
    """Processes of this machine, started afresh (never forked: a fork after a geometry kernel's threads hangs)."""

    def __init__(self, jobs: int) -> None:
        self.workers = jobs
        self.what = "processes"
        self.tries = 1
        self._context = multiprocessing.get_context("spawn")
        self._pool: ProcessPoolExecutor | None = None
        self._marks: Marks | None = None
        self._started: list[BaseProcess] = []

    def executor(self) -> Executor:
        """A pool; after a breakdown, a new one.

        Raises
        ------
        SweepError
            If its processes do not come up.
        """
        self.close()
        self._marks = Marks(self._context, self.workers)
        with _uninterrupted():
            self._pool = ProcessPoolExecutor(self.workers, self._context, _begin, (self._marks,))
            # A task for each worker starts them all, while none of them is idle yet.
            first = [self._pool.submit(int) for _ in range(self.workers)]
            self._started = list(self._pool._processes.values())
        try:
            first[0].result()  # a point's time must not count their start
        except BrokenExecutor:
            raise SweepError(
                Issue("--jobs", "no process can be started; is there memory for them? A script needs its main guard.")
            ) from None
        return self._pool

    def suspects(self) -> Mapping[int, float] | None:
        """Where those workers were that ended by themselves; a broken pool terminates the others."""
        if self._marks is None:
            return None
        now, marks = time.monotonic(), self._marks
        # The pool's own thread waits for the same processes; asking until all have ended, either finds out.
        while any(process.exitcode is None for process in self._started) and time.monotonic() < now + PATIENCE_S:
            time.sleep(0.005)
        died = {process.pid for process in self._started if process.exitcode not in (None, 0, -signal.SIGTERM)}
        at = [(pid, p, now - s) for pid, p, s in zip(marks.pids, marks.points, marks.since_s, strict=True)]
        accused = {point: took_s for pid, point, took_s in at if point != NOBODY and pid in died}
        # If somebody else terminated a worker, it cannot be told from the others.
        return accused if died else {point: took_s for _, point, took_s in at if point != NOBODY}

    def close(self) -> None:
        """End the workers; what they compute is lost, and nobody waits for it."""
        if self._pool is None:
            return
        late = (self._pool._processes or {}).values()  # should one have been started later after all
        self._started += [process for process in late if process not in self._started]
        self._pool.shutdown(wait=False, cancel_futures=True)
        for process in self._started:
            process.terminate()
        for process in self._started:
            process.join()
        self._pool = None


@contextlib.contextmanager
def _uninterrupted() -> Iterator[None]:
    """Processes started within this block never see an interrupt, not even before their first line; ours waits."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _begin(marks: Marks) -> None:
    """A worker's first act: an interrupt is the parent's business, and nobody outlives it."""
    global _marks, _slot
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    end_with_parent()
    with marks.taken.get_lock():
        _slot = marks.taken.value
        marks.taken.value += 1
    marks.pids[_slot] = os.getpid()
    _marks = marks


def mark(point: int) -> None:
    """Say which point this worker is at (`NOBODY`: none)."""
    if _marks is not None:
        _marks.since_s[_slot] = time.monotonic()
        _marks.points[_slot] = point


def default_jobs() -> int:
    """Processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
