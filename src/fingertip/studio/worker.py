"""Worker of the studio: one thread that makes parts and checks.

Of each client the newest job counts.
"""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from typing import Any, TypeVar

T = TypeVar("T")

StillWanted = Callable[[], None]
"""Raises `SupersededError` if the result is no longer wanted."""
_LOOK_S = 0.1
"""Time after which a job that is not done looks whether somebody still waits for it [s]."""


class SupersededError(Exception):
    """The result is no longer wanted: a newer request came, or the client has gone."""


class NewestWinsWorker:
    """Thread that runs one job at a time; a newer job of a client replaces its older one."""

    def __init__(self) -> None:
        self._thread = ThreadPoolExecutor(1, "studio worker")
        self._lock = threading.Lock()
        self._newest: dict[str, _Job] = {}

    def run(
        self, client: str, function: Callable[[StillWanted], T], has_gone: Callable[[], bool]
    ) -> T:
        """Run a function after those that wait, and return its result. Raises SupersededError."""
        job = _Job()
        with self._lock:
            try:
                result: Future[T] = self._thread.submit(function, job.ask)
            except RuntimeError:  # it was closed
                raise SupersededError from None

            job.result = result
            older = self._newest.get(client)
            if older:
                older.drop()

            self._newest[client] = job

        try:
            while not result.done():
                with contextlib.suppress(TimeoutError):
                    result.exception(_LOOK_S)

                if has_gone():
                    job.drop()

            return result.result()
        except CancelledError:
            raise SupersededError from None
        finally:
            with self._lock:
                if self._newest.get(client) is job:  # so that the names of clients do not pile up
                    del self._newest[client]

    def close(self) -> None:
        """Drop what waits, and end after the running job's present step."""
        with self._lock:
            for job in self._newest.values():
                job.drop()

            self._thread.shutdown(wait=False)


class _Job:
    result: Future[Any]
    is_dropped = False

    def ask(self) -> None:
        if self.is_dropped:
            raise SupersededError

    def drop(self) -> None:
        self.is_dropped = True
        self.result.cancel()
