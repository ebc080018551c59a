"""Engines that evaluate the chunks of a sweep: worker processes on this machine, or those of a Dask
cluster.
"""

from __future__ import annotations

import asyncio
import logging
import pkgutil
import platform
import socket
import time
from collections.abc import Callable, Mapping
from concurrent.futures import Executor, Future
from typing import Any, Protocol

import numpy as np

from fingertip import __version__
from fingertip.foundation import extras
from fingertip.foundation.errors import Issue, SweepError
from fingertip.foundation.workers import Pool

_CONNECT_TIMEOUT_S = 4.0
"""Time allowed for the scheduler to answer, and for the first worker to appear [s]."""
_ANSWER_TIMEOUT_S = 20.0
"""Time allowed for all workers to tell their versions [s]."""
_RECONNECT_TIMEOUT_S = 10.0
"""Time for which a lost scheduler is searched for [s]."""
_COUNT_INTERVAL_S = 2.0
"""Interval between two counts of the workers [s]."""


class Engine(Protocol):
    """Engine that answers calls side by side.

    A future raises WorkerDiedError with the step that was computed, CancelledError if the engine is
    lost, or another error if nobody knows at which step the call was lost.
    """

    description: str
    attempts: int
    """Number of workers that may die on one chunk before the engine itself gives the chunk up."""

    @property
    def workers(self) -> int: ...

    def submit(self, function: Callable[..., Any], *arguments: Any) -> Future[Any]: ...

    def close(self) -> None: ...


class ProcessEngine:
    """Worker processes on this machine, which start with the first call."""

    description = "processes"
    attempts = 1

    def __init__(self, jobs: int) -> None:
        self.workers = jobs
        self._pool: Pool | None = None

    def submit(self, function: Callable[..., Any], *arguments: Any) -> Future[Any]:
        self._pool = self._pool or Pool(self.workers)
        return self._pool.submit(function, *arguments)

    def close(self) -> None:
        """End the workers; unfinished points are discarded."""
        if self._pool:
            self._pool.close()

        self._pool = None


class DaskEngine:
    """Dask workers on any machine; Dask replaces lost ones.

    Raises MissingLibraryError or SweepError.
    """

    def __init__(self, address: str) -> None:
        distributed = extras.load("distributed", "--cluster", alternative="leave --cluster out")
        dask = extras.load("dask", "--cluster", alternative="leave --cluster out")
        # An error is reported once, as this class's own message.
        for name in (
            "distributed",
            "distributed.client",
        ):
            logging.getLogger(name).setLevel(logging.CRITICAL)

        _check_listening(address)
        try:
            asyncio.run(asyncio.wait_for(_check_scheduler(address), _CONNECT_TIMEOUT_S))
            self._client = distributed.Client(
                address, timeout=_RECONNECT_TIMEOUT_S, set_as_default=False
            )
        except (OSError, ValueError, EOFError, TimeoutError):
            problem = f"the process listening at {address} is not a Dask scheduler"
            raise _make_error(f"{problem}; start dask scheduler there") from None

        self.description = f"workers of {address}"
        # This is a setting of the scheduler. It is known here only if both machines are configured
        # alike, as they are by default.
        self.attempts = 1 + int(dask.config.get("distributed.scheduler.allowed-failures", 3))
        self._worker_count = 0
        self._counted_at_s = 0.0

        try:
            self._check_workers(address)
        except BaseException:
            self.close()
            raise

        self._executor: Executor = self._client.get_executor(pure=False)

    @property
    def workers(self) -> int:
        """Number of workers connected now; a cluster may grow while it works."""
        if (
            time.monotonic() - self._counted_at_s > _COUNT_INTERVAL_S
            and self._client.status == "running"
        ):
            # The scheduler lists nothing once it is lost.
            self._worker_count = max(1, len(self._list_workers()))
            self._counted_at_s = time.monotonic()

        return self._worker_count

    def submit(self, function: Callable[..., Any], *arguments: Any) -> Future[Any]:
        return self._executor.submit(function, *arguments)

    def close(self) -> None:
        """Leave the cluster; it discards the unfinished tasks."""
        self._client.close()

    def _list_workers(self) -> list[str]:
        return sorted(self._client.scheduler_info(n_workers=-1).get("workers", ()))

    def _check_workers(self, address: str) -> None:
        """Wait for a worker, then require the same versions on every worker: others give other
        rows.
        """
        try:
            self._client.wait_for_workers(1, timeout=_CONNECT_TIMEOUT_S)
        except TimeoutError:
            raise _make_error(
                f"{address} has no workers; start some there with dask worker {address}"
            ) from None

        # Functions of the standard library are sent by name, which any version of Python
        # understands.
        questions: Mapping[str, tuple[Any, ...]] = {
            "Python": (platform.python_version,),
            "numpy": (pkgutil.resolve_name, "numpy:__version__"),
            "fingertip": (pkgutil.resolve_name, "fingertip:__version__"),
        }
        asked = []
        for worker in self._list_workers():
            for name, question in questions.items():
                answer = self._client.submit(*question, workers=[worker], pure=False)
                asked.append((worker, name, answer))
        until_s = time.monotonic() + _ANSWER_TIMEOUT_S

        for worker, name, answer in asked:
            try:
                compare_version(
                    worker, name, answer.result(timeout=max(0.0, until_s - time.monotonic()))
                )
            except TimeoutError:
                problem = (
                    f"a worker has not answered for {_ANSWER_TIMEOUT_S:g} s; end the "
                    "workers that hang, or start"
                )
                raise _make_error(f"{problem} them again, then run this command again") from None
            except ImportError as error:
                compare_version(worker, name, error)


def compare_version(worker: str, name: str, there: str | ImportError) -> None:
    """Refuse a worker whose Python or library could give other rows.

    The last number of Python's version does not.
    """
    here = {"Python": platform.python_version(), "numpy": np.__version__, "fingertip": __version__}[
        name
    ]
    if name == "Python" and isinstance(there, str):
        there, here = (version.rpartition(".")[0] for version in (there, here))

    if there != here:
        has = f"no {name} ({there})" if isinstance(there, ImportError) else f"{name} {there}"
        raise _make_error(
            f"worker {worker} has {has}, but this is {here}; install the same version everywhere"
        )


def _check_listening(address: str) -> None:
    """Refuse a malformed address, or one at which nothing listens; Dask's own timeout is long."""
    host, _, port = address.rpartition("://")[2].rpartition(":")
    if not host or not port.isdecimal():
        raise _make_error(
            f"{address!r} is not an address; write it as tcp://HOST:8786, as dask scheduler "
            "prints it"
        )

    try:
        socket.create_connection((host.strip("[]"), int(port)), timeout=_CONNECT_TIMEOUT_S).close()
    except (OSError, OverflowError, UnicodeError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise _make_error(
            f"nothing answers at {address} ({reason}); start dask scheduler there"
        ) from None


async def _check_scheduler(address: str) -> None:
    """Ask the listener for its identity; `Client` waits for ever if
    the listener is silent or not a scheduler.
    """
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
