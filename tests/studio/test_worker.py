"""Worker of the studio: one job at a time, and of each client the newest one."""

from __future__ import annotations

import threading
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any

import pytest

from fingertip.studio.worker import NewestWinsWorker, StillWanted, SupersededError


class Gate:
    """Job that runs until it is let go, and asks then whether it is still wanted."""

    def __init__(self, result: str) -> None:
        self.started, self.go, self.result = threading.Event(), threading.Event(), result

    def __call__(self, still_wanted: StillWanted) -> str:
        self.started.set()
        assert self.go.wait(10)
        still_wanted()
        return self.result


def start(pool: ThreadPoolExecutor, worker: NewestWinsWorker, client: str, gate: Gate) -> Future[str]:
    newest = worker._newest.get(client)
    future = pool.submit(worker.run, client, gate, never)
    while worker._newest.get(client) is newest:  # until it has joined the queue
        pass
    return future


def never() -> bool:
    return False


def test_newest_of_each_client_wins() -> None:
    worker, gates = NewestWinsWorker(), {name: Gate(name) for name in ("a1", "b1", "a2", "a3")}
    with ThreadPoolExecutor(8) as pool:
        running = {}
        for name in gates:
            running[name] = start(pool, worker, name[0], gates[name])
            if name == "a1":
                assert gates[name].started.wait(10)
        with pytest.raises(SupersededError):  # it never began
            running["a2"].result(10)
        assert not gates["a2"].started.is_set()
        for gate in gates.values():
            gate.go.set()
        with pytest.raises(SupersededError):  # it learned so between two steps
            running["a1"].result(10)
        assert running["b1"].result(10) == "b1"
        assert running["a3"].result(10) == "a3"
    assert not worker._newest
    worker.close()


def test_an_error_goes_to_who_asked_and_the_worker_goes_on() -> None:
    worker = NewestWinsWorker()

    def fail(still_wanted: StillWanted) -> Any:
        raise ZeroDivisionError("here")

    with pytest.raises(ZeroDivisionError, match="here"):
        worker.run("a", fail, never)
    assert worker.run("a", lambda wanted: 2, never) == 2
    worker.close()
    with pytest.raises(SupersededError):
        worker.run("a", lambda wanted: 2, never)
