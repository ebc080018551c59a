"""Who computes the parts of a sweep: workers behind `concurrent.futures.Executor`, of this machine or a cluster."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
from collections.abc import Collection, Iterator
from concurrent.futures import BrokenExecutor, Executor, ProcessPoolExecutor
from typing import Any, Protocol

from fingertip.errors import Fault, SweepError
from fingertip.sweep.watch import end_with_parent

_slots: Any = None
_slot = -1
NOBODY = -1


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

    def suspects(self) -> Collection[int] | None:
        """Points that were being computed when the workers broke down; None if nobody knows."""

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
        self._marks: Any = None

    def executor(self) -> Executor:
        """A pool; after a breakdown, a new one.

        Raises
        ------
        SweepError
            If its processes do not come up.
        """
        self.close()
        # Each worker marks the point it is at: a breakdown then accuses as many points as there are workers.
        self._marks = self._context.RawArray("q", [NOBODY] * self.workers)
        free = self._context.Value("i", 0)
        with _uninterrupted():
            self._pool = ProcessPoolExecutor(self.workers, self._context, _begin, (self._marks, free))
            first = self._pool.submit(int)  # starts all workers
        try:
            first.result()  # a point's time must not count their start
        except BrokenExecutor:
            raise SweepError(
                Fault("--jobs", "no process can be started; is there memory for them? A script needs its main guard.")
            ) from None
        return self._pool

    def suspects(self) -> Collection[int] | None:
        """Where the workers were when the pool broke."""
        return {point for point in self._marks if point != NOBODY} if self._marks is not None else None

    def close(self) -> None:
        """End the workers; what they compute is lost, and nobody waits for it."""
        if self._pool is None:
            return
        started = list((self._pool._processes or {}).values())
        self._pool.shutdown(wait=False, cancel_futures=True)
        for process in started:
            process.terminate()
        for process in started:
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


def _begin(marks: Any, free: Any) -> None:
    """A worker's first act: an interrupt is the parent's business, and nobody outlives it."""
    global _slots, _slot
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    end_with_parent()
    with free.get_lock():
        _slot = free.value
        free.value += 1
    _slots = marks


def mark(point: int) -> None:
    """Say which point this worker is at (`NOBODY`: none)."""
    if _slots is not None and 0 <= _slot < len(_slots):
        _slots[_slot] = point


def default_jobs() -> int:
    """Processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
