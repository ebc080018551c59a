"""Worker: one thread that makes parts and checks. Of each client's requests only the newest counts."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any, TypeVar

T = TypeVar("T")

StillWanted = Callable[[], None]
"""Raises `SupersededError` if the result is no longer wanted."""


class SupersededError(Exception):
    """A newer request of the same client came before this one was answered."""


class NewestWinsWorker:
    """Thread that runs jobs one at a time.

    A job that waits is dropped when a newer one of the same client comes. One that runs learns of it where it asks.
    """

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._waiting: OrderedDict[str, tuple[int, Callable[[StillWanted], Any], Future[Any]]] = OrderedDict()
        self._newest: dict[str, int] = {}
        self._count = 0
        self._is_closed = False
        self._thread = threading.Thread(target=self._run, name="studio worker", daemon=True)
        self._thread.start()

    def run(self, client: str, job: Callable[[StillWanted], T]) -> T:
        """Run a job after those that wait, and return its result.

        Parameters
        ----------
        client
            Name of who asks; an earlier job of the same client is superseded.
        job
            Function to run in the worker's thread. It is given a function to call between its steps.

        Raises
        ------
        SupersededError
            If a newer job of the same client came, or the worker was closed.
        """
        result: Future[T] = Future()
        with self._changed:
            if self._is_closed:
                raise SupersededError
            self._count += 1
            self._newest[client] = self._count
            dropped = self._waiting.pop(client, None)
            self._waiting[client] = (self._count, job, result)
            self._changed.notify()
        if dropped:
            dropped[2].set_exception(SupersededError())
        return result.result()

    def close(self) -> None:
        """Drop what waits, and end after the running job's present step."""
        with self._changed:
            self._is_closed = True
            waiting, self._waiting = self._waiting, OrderedDict()
            self._newest.clear()
            self._changed.notify()
        for _, _, result in waiting.values():
            result.set_exception(SupersededError())

    def _run(self) -> None:
        while True:
            with self._changed:
                while not self._waiting and not self._is_closed:
                    self._changed.wait()
                if self._is_closed:
                    return
                client, (number, job, result) = self._waiting.popitem(last=False)

            def still_wanted(client: str = client, number: int = number) -> None:
                if self._newest.get(client) != number:
                    raise SupersededError

            try:
                result.set_result(job(still_wanted))
            except BaseException as error:  # it belongs to who asked
                result.set_exception(error)
            with self._changed:
                if self._newest.get(client) == number:  # so that the names of clients do not pile up
                    del self._newest[client]
