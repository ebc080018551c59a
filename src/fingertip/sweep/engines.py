"""Engines that evaluate the chunks of a sweep: worker processes on this machine, or those of a Dask cluster."""

from __future__ import annotations

import contextlib
import logging
import multiprocessing
import os
import signal
import socket
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import BrokenExecutor, Executor, ProcessPoolExecutor
from multiprocessing.connection import Connection
from multiprocessing.context import SpawnContext
from multiprocessing.process import BaseProcess
from typing import Any, TypeAlias

import numpy as np

from fingertip.foundation import extras
from fingertip.foundation.errors import Issue, SweepError
from fingertip.foundation.version import __version__

NO_POINT = -1
"""Point number of a worker that is idle."""
EXIT_TIMEOUT_S = 5.0
"""Time allowed for the processes of a broken pool to end [s]."""
_CONNECT_TIMEOUT_S = 4.0
"""Time allowed for the scheduler to answer, and for the first worker to appear [s]."""
_ANSWER_TIMEOUT_S = 20.0
"""Time allowed for all workers to tell their versions [s]."""
_RECONNECT_TIMEOUT_S = 10.0
"""Time for which a lost scheduler is searched for [s]."""
_COUNT_INTERVAL_S = 2.0
"""Interval between two counts of the workers [s]."""


class WorkerStatus:
    """Current point of every worker, in shared memory: it tells what the workers that died were computing."""

    def __init__(self, context: SpawnContext, workers: int) -> None:
        self.slots_taken = context.Value("i", 0)
        self.pids = context.RawArray("q", workers)
        self.points = context.RawArray("q", [NO_POINT] * workers)
        self.since_s = context.RawArray("d", workers)


# State of a worker process: its entry in the shared memory.
_status: WorkerStatus | None = None
_slot = -1


class ProcessEngine:
    """Worker processes on this machine, spawned, because a fork after a kernel has started threads hangs."""

    def __init__(self, jobs: int) -> None:
        self.workers = jobs
        self.description = "processes"
        self.attempts = 1
        """Number of workers that may die on one chunk before the engine itself gives the chunk up."""
        self._context = multiprocessing.get_context("spawn")
        self._pool: ProcessPoolExecutor | None = None
        self._status: WorkerStatus | None = None
        self._processes: list[BaseProcess] = []
        self._result_writer: Connection | None = None

    def executor(self) -> Executor:
        """Start a new pool, after closing the previous one. Raises SweepError."""
        self.close()
        self._status = WorkerStatus(self._context, self.workers)
        with _block_interrupts():
            self._pool = ProcessPoolExecutor(self.workers, self._context, _start_worker, (self._status,))
            # One task per worker starts them all, because none of them is idle yet.
            first = [self._pool.submit(int) for _ in range(self.workers)]
            self._processes = list(self._pool._processes.values())
        self._result_writer = self._pool._result_queue._writer  # type: ignore[attr-defined]
        try:
            first[0].result()  # start-up must not count against the time limit of a point
        except BrokenExecutor:
            remedy = 'check the free memory, and guard a script\'s entry point with if __name__ == "__main__".'
            raise SweepError(Issue("--jobs", f"no worker process can be started; {remedy}")) from None
        return self._pool

    def find_crashed_points(self) -> Mapping[int, float] | None:
        """Find the points of workers that died by themselves, each with its time [s]; a broken pool ends the others."""
        if self._status is None:
            return None
        now, status = time.monotonic(), self._status
        # The pool's own thread waits for the same processes. Polling until all have ended works for either of them.
        while any(p.exitcode is None for p in self._processes) and time.monotonic() < now + EXIT_TIMEOUT_S:
            time.sleep(0.005)
        dead = {p.pid for p in self._processes if p.exitcode not in (None, 0, -signal.SIGTERM)}
        # A worker terminated from outside looks like those that the pool terminated. Then every worker counts as dead.
        return {
            point: now - since_s
            for pid, point, since_s in zip(status.pids, status.points, status.since_s, strict=True)
            if point != NO_POINT and (pid in dead or not dead)
        }

    def end_if_stuck(self) -> None:
        """End a pool of which a worker died while it sent a result: the pool waits for the rest of the message."""
        if self._pool is not None and any(process.exitcode is not None for process in self._processes):
            self._stop_workers()

    def close(self) -> None:
        """Terminate the workers; unfinished points are discarded."""
        if self._pool is None:
            return
        late = (self._pool._processes or {}).values()  # in case the pool started a process after all
        self._processes += [process for process in late if process not in self._processes]
        thread: threading.Thread | None = self._pool._executor_manager_thread  # type: ignore[assignment]
        self._pool.shutdown(wait=False, cancel_futures=True)
        self._stop_workers()
        self._pool = None
        # Python wakes the thread when it ends, and fails if it ends in that moment.
        if thread is not None:
            thread.join()

    def _stop_workers(self) -> None:
        for process in self._processes:
            process.terminate()
        for process in self._processes:
            process.join()
        # A worker may have died in the middle of a message. The pool's thread, for which Python waits at its end, reads
        # on until no process can write the rest, and this process is the last that could.
        if self._result_writer is not None:
            self._result_writer.close()


def set_current_point(point: int) -> None:
    """Record the point that this worker is computing (`NO_POINT` if none)."""
    if _status is not None:
        _status.since_s[_slot] = time.monotonic()
        _status.points[_slot] = point


@contextlib.contextmanager
def _block_interrupts() -> Iterator[None]:
    """Block SIGINT: processes started within never receive it, and this process receives it at the end."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _start_worker(status: WorkerStatus) -> None:
    """Set up a worker process: ignore interrupts, end with the parent, take a slot of the shared status."""
    global _status, _slot
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _exit_with_parent()
    with status.slots_taken.get_lock():
        _slot = status.slots_taken.value
        status.slots_taken.value += 1
    status.pids[_slot] = os.getpid()
    _status = status


def _exit_with_parent() -> None:
    """End this process as soon as its parent ends, even by a kill: no worker outlives its sweep."""
    parent = multiprocessing.parent_process()
    if parent is None:
        return

    def wait() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=wait, daemon=True).start()


class DaskEngine:
    """Dask workers on any machine; Dask replaces lost ones. Raises MissingLibraryError or SweepError."""

    def __init__(self, address: str) -> None:
        import asyncio  # noqa: PLC0415

        distributed = extras.load("distributed", "--cluster", alternative="leave --cluster out")
        dask = extras.load("dask", "--cluster", alternative="leave --cluster out")
        for name in ("distributed", "distributed.client"):  # an error is reported once, as this class's own message
            logging.getLogger(name).setLevel(logging.CRITICAL)
        _check_listening(address)
        try:
            asyncio.run(asyncio.wait_for(_check_scheduler(address), _CONNECT_TIMEOUT_S))
            self._client = distributed.Client(address, timeout=_RECONNECT_TIMEOUT_S, set_as_default=False)
        except (OSError, ValueError, EOFError, TimeoutError):
            problem = f"the process listening at {address} is not a Dask scheduler"
            raise _make_error(f"{problem}; start dask scheduler there") from None
        self.description = f"workers of {address}"
        # This is a setting of the scheduler. It is known here only if both machines are configured alike, as they are
        # by default.
        self.attempts = 1 + int(dask.config.get("distributed.scheduler.allowed-failures", 3))
        self._worker_count, self._counted_at_s = 0, 0.0
        try:
            self._check_workers(address)
        except BaseException:
            self.close()
            raise

    @property
    def workers(self) -> int:
        """Number of workers connected now; a cluster may grow while it works."""
        if time.monotonic() - self._counted_at_s > _COUNT_INTERVAL_S and self._client.status == "running":
            # The scheduler lists nothing once it is lost.
            workers = self._client.scheduler_info(n_workers=-1).get("workers", ())
            self._worker_count, self._counted_at_s = max(1, len(workers)), time.monotonic()
        return self._worker_count

    def executor(self) -> Executor:
        """Get the cluster's executor; the cluster replaces workers by itself."""
        executor: Executor = self._client.get_executor(pure=False)
        return executor

    def find_crashed_points(self) -> Mapping[int, float] | None:
        """Return None: Dask itself reports the tasks that were lost."""
        return None

    def end_if_stuck(self) -> None:
        """Do nothing: the scheduler notices workers that are lost."""

    def close(self) -> None:
        """Leave the cluster; it discards the unfinished tasks."""
        self._client.close()

    def _check_workers(self, address: str) -> None:
        """Wait for a worker, then require the same versions on every worker: others give other rows."""
        try:
            self._client.wait_for_workers(1, timeout=_CONNECT_TIMEOUT_S)
        except TimeoutError:
            raise _make_error(f"{address} has no workers; start some there with dask worker {address}") from None

        def version() -> str:
            # Dask sends this nested function by value. A worker may not have this module.
            import fingertip  # noqa: PLC0415

            return fingertip.__version__

        # A function can be sent only between equal versions of Python, so Dask's own answers come first.
        versions = self._ask(self._client._get_versions, [])
        for worker, found in sorted(versions["workers"].items()):
            _compare_versions(worker, found)
        answers = self._ask(self._client._run, version, on_error="return")
        for worker, answer in sorted(answers.items()):
            if answer != __version__:
                found = f"fingertip {answer}" if isinstance(answer, str) else f"no fingertip ({answer})"
                raise _make_version_error(worker, found, __version__)

    def _ask(self, question: Callable[..., Any], *arguments: Any, **options: Any) -> dict[str, Any]:
        """Ask all workers; Dask itself waits for ever for a worker that hangs."""
        try:
            answers: dict[str, Any] = self._client.sync(
                question, *arguments, callback_timeout=_ANSWER_TIMEOUT_S, **options
            )
        except TimeoutError:
            message = f"a worker has not answered for {_ANSWER_TIMEOUT_S:g} s; end the workers that hang, or start them"
            raise _make_error(f"{message} again, then run this command again") from None
        return answers


def _compare_versions(worker: str, found: Mapping[str, Any]) -> None:
    """Refuse a worker whose Python or numpy could give other rows."""
    here = {"Python": "{}.{}".format(*sys.version_info[:2]), "numpy": np.__version__}
    python = str(found.get("host", {}).get("python", "none"))
    there = {"Python": ".".join(python.split(".")[:2]), "numpy": str(found.get("packages", {}).get("numpy"))}
    for name, version in here.items():
        if there[name] != version:
            raise _make_version_error(worker, f"{name} {there[name]}", version)


def _make_version_error(worker: str, found: str, here: str) -> SweepError:
    return _make_error(f"worker {worker} has {found}, but this is {here}; install the same version everywhere")


def _check_listening(address: str) -> None:
    """Refuse a malformed address, or one at which nothing listens; Dask's own timeout is long."""
    host, _, port = address.rpartition("://")[2].rpartition(":")
    if not host or not port.isdecimal():
        raise _make_error(f"{address!r} is not an address; write it as tcp://HOST:8786, as dask scheduler prints it")
    try:
        socket.create_connection((host.strip("[]"), int(port)), timeout=_CONNECT_TIMEOUT_S).close()
    except (OSError, OverflowError, UnicodeError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise _make_error(f"nothing answers at {address} ({reason}); start dask scheduler there") from None


async def _check_scheduler(address: str) -> None:
    """Ask the listener for its identity; `Client` waits for ever if the listener is silent or not a scheduler."""
    from distributed.comm import connect  # noqa: PLC0415

    comm = await connect(address)
    try:
        await comm.write({"op": "identity", "reply": True})
        if (await comm.read())["type"] != "Scheduler":
            raise ValueError(address)
    finally:
        comm.abort()


def _make_error(message: str) -> SweepError:
    return SweepError(Issue("--cluster", f"{message}."))


Engine: TypeAlias = ProcessEngine | DaskEngine
"""Source of executors that also knows what it can about workers that died."""
