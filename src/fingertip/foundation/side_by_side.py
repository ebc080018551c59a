"""Independent calls side by side, one in each of several worker processes. The results are those of calls one by one.

Whole calls are divided, such as the trials of a campaign, and not their loops. Each runs the same code on the same
numbers wherever it runs, so no bit depends on the number of workers, and calls of different lengths cost no padding.
"""

from __future__ import annotations

import contextlib
import itertools
import pickle
import queue
import subprocess
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import TypeAlias, TypeVar

from fingertip.foundation.errors import FingertipError, Issue
from fingertip.foundation.jit import compiled
from fingertip.foundation.processes import start_worker

T = TypeVar("T")
_AHEAD = 256
"""Number of calls that are computed ahead of the result that is taken: results may be large."""
Idle: TypeAlias = "queue.SimpleQueue[subprocess.Popen[bytes]]"
_workers: tuple[ThreadPoolExecutor, Idle] | None = None
"""Threads that hand calls to worker processes, and those that have none, within a block of `side_by_side`."""


@contextlib.contextmanager
def side_by_side(workers: int) -> Iterator[None]:
    """Let `call_each` use so many worker processes; with one, calls run in this process. Every loop runs compiled."""
    global _workers
    with compiled(), contextlib.ExitStack() as stack:
        before, _workers = _workers, None
        if workers > 1:
            idle: Idle = queue.SimpleQueue()
            for _ in range(workers):
                idle.put(stack.enter_context(start_worker()))
            _workers = ThreadPoolExecutor(workers), idle
            stack.callback(_workers[0].shutdown, wait=False)
        try:
            yield
        finally:
            _workers = before


def call_each(calls: Iterable[Callable[[], T]]) -> Iterator[T]:
    """Call each with compiled loops, and yield the results in their order. Calls are pickled: partials of functions.

    Raises what a call raises, and FingertipError where a worker ends by itself.
    """
    if _workers is None:
        yield from map(_call, calls)
        return
    pool, idle = _workers
    submitted = (pool.submit(_ask, idle, call) for call in calls)
    futures = deque(itertools.islice(submitted, _AHEAD))
    try:
        while futures:
            result = futures.popleft().result()
            futures.extend(itertools.islice(submitted, 1))
            yield result
    finally:
        for future in futures:
            future.cancel()


def _call(call: Callable[[], T]) -> T:
    with compiled():
        return call()


def _ask(idle: Idle, call: Callable[[], T]) -> T:
    """Let the next worker that is idle answer a call."""
    worker = idle.get()
    try:
        worker.stdin.write(pickle.dumps((None, None, _call, (call,))))  # type: ignore[union-attr]
        worker.stdin.flush()  # type: ignore[union-attr]
        result, error = pickle.load(worker.stdout)  # type: ignore[arg-type]
    except (OSError, EOFError, pickle.UnpicklingError):
        message = "a worker process ended by itself, as it does where memory is full; choose --jobs 1."
        raise FingertipError(Issue("--jobs", message)) from None
    finally:
        idle.put(worker)
    if error is not None:
        raise error
    return result  # type: ignore[no-any-return]
