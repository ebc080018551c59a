"""Engine that uses the workers of a running Dask cluster through `distributed`'s executor."""

from __future__ import annotations

import asyncio
import logging
import socket
import sys
import time
from collections.abc import Callable, Mapping
from concurrent.futures import Executor
from typing import Any

from fingertip.foundation import extras
from fingertip.foundation.errors import Issue, SweepError
from fingertip.foundation.version import __version__

_CONNECT_TIMEOUT_S = 4.0
"""Time allowed for the scheduler to answer, and for the first worker to appear [s]."""
_ANSWER_TIMEOUT_S = 20.0
"""Time allowed for all workers to tell their versions [s]."""
_RECONNECT_TIMEOUT_S = 10.0
"""Time for which a lost scheduler is searched for [s]."""
_COUNT_INTERVAL_S = 2.0
"""Interval between two counts of the workers [s]."""


class DaskEngine:
    """Engine (see `engines.Engine`) whose workers may run on any machine; Dask replaces lost workers.

    Raises MissingLibraryError or SweepError.
    """

    def __init__(self, address: str) -> None:
        distributed = extras.load("distributed", "--cluster", alternative="leave --cluster out")
        dask = extras.load("dask", "--cluster", alternative="leave --cluster out")
        for name in ("distributed", "distributed.client"):  # an error is reported once, as this class's own message
            logging.getLogger(name).setLevel(logging.CRITICAL)
        _check_listening(address)
        try:
            asyncio.run(asyncio.wait_for(_check_scheduler(address), _CONNECT_TIMEOUT_S))
            self._client = distributed.Client(address, timeout=_RECONNECT_TIMEOUT_S, set_as_default=False)
        except (OSError, ValueError, EOFError, TimeoutError):
            raise _make_error(
                f"the process listening at {address} is not a Dask scheduler; start dask scheduler there"
            ) from None
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

    def find_crashed_points(self) -> None:
        """Find nothing: Dask itself reports the tasks that were lost."""
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
            import fingertip

            return fingertip.__version__

        # A function can be sent only between equal versions of Python, so Dask's own answers come first.
        versions = self._ask(self._client._get_versions, [])
        for worker, found in sorted(versions["workers"].items()):
            _compare_versions(worker, found)
        answers = self._ask(self._client._run, version, on_error="return")
        for worker, answer in sorted(answers.items()):
            if answer != __version__:
                found = f"fingertip {answer}" if isinstance(answer, str) else f"no fingertip ({answer})"
                raise _make_error(
                    f"worker {worker} has {found}, but this is {__version__}; install the same version everywhere"
                )

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
    import numpy as np

    here = {"Python": "{}.{}".format(*sys.version_info[:2]), "numpy": np.__version__}
    python = str(found.get("host", {}).get("python", "none"))
    there = {"Python": ".".join(python.split(".")[:2]), "numpy": str(found.get("packages", {}).get("numpy"))}
    for name, version in here.items():
        if there[name] != version:
            raise _make_error(
                f"worker {worker} has {name} {there[name]}, but this is {version}; install the same version everywhere"
            )


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
    from distributed.comm import connect

    comm = await connect(address)
    try:
        await comm.write({"op": "identity", "reply": True})
        if (await comm.read())["type"] != "Scheduler":
            raise ValueError(address)
    finally:
        comm.abort()


def _make_error(message: str) -> SweepError:
    return SweepError(Issue("--cluster", f"{message}."))
