"""Calls in other processes: results in order and with the same bits,
errors, deaths, and no process that stays.
"""

from __future__ import annotations

import itertools
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from benchmarks.slip.mix import MixSize, generate_mix
from fingertip.design import Design
from fingertip.foundation import jit, workers
from fingertip.foundation.errors import FingertipError
from fingertip.foundation.workers import (
    Pool,
    Worker,
    WorkerDiedError,
    call_each,
    in_background,
    side_by_side,
)
from fingertip.lab.campaign.campaign import CampaignPlan
from fingertip.lab.campaign.closed_loop import run_closed_loop
from fingertip.lab.campaign.run import run_campaign


@pytest.fixture(params=["fork", "start"])
def way(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """A copy of this process, or where it has other threads, one that imports what it needs."""
    monkeypatch.setattr(threading, "active_count", lambda: 1 + (request.param == "start"))
    return str(request.param)


@pytest.mark.usefixtures("way")
def test_a_call_in_the_background_gives_the_result_of_another_process(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with in_background(os.getpid) as wait:
        assert (wait() == os.getpid()) == (workers.count_processors() == 1)
    with in_background(print, "what a library prints is no part of the answer") as wait:
        assert wait() is None
    monkeypatch.setattr(workers, "count_processors", lambda: 1)
    with in_background(os.getpid) as wait:
        assert wait() == os.getpid()


@pytest.mark.usefixtures("way")
def test_a_process_that_fails_is_made_up_for_here() -> None:
    with in_background(Design.load, "fsr4") as wait, pytest.raises(FingertipError) as caught:
        wait()
    assert caught.value.issues[0].field == "fsr4"
    with in_background(sys.exit, 3) as wait, pytest.raises(SystemExit):
        wait()


@pytest.mark.usefixtures("way")
def test_a_block_that_is_left_ends_its_process() -> None:
    begun = time.monotonic()
    with in_background(time.sleep, 60.0):
        pass
    assert time.monotonic() - begun < 30.0


def report_and(end: str) -> tuple[Callable[..., None], str, dict[str, Any]]:
    """Return a call that reports two steps, says something and ends in some way."""
    code = (
        "import os, sys, time; from fingertip.foundation.workers import report_step; "
        "report_step('first');"
    )
    return (
        exec,
        f"{code} report_step('second'); print('last words', file=sys.stderr, flush=True); {end}",
        {},
    )


def test_steps_tell_what_a_worker_did_until_its_end(tmp_path: Path) -> None:
    with Worker(tmp_path) as worker:
        worker.send(os.getcwd)
        assert worker.receive() == str(tmp_path)
        worker.send(eval, "__import__('sys').path[-1]")
        assert worker.receive() == str(Path(workers.__file__).parents[2]), (
            "where a script finds this package"
        )
        worker.send(*report_and("time.sleep(0.1); os._exit(3)"))
        assert worker.receive(until="first") is None
        time.sleep(0.3)  # as on a busy machine: the report and the end are taken together
        with pytest.raises(WorkerDiedError, match="last words") as caught:
            worker.receive()
        assert (caught.value.step, worker.steps) == ("second", ["first", "second"])
        assert caught.value.elapsed_s >= 0.1
    with Worker() as worker:
        worker.send(os._exit, 3)
        with pytest.raises(WorkerDiedError, match="no message") as caught:
            worker.receive()
        assert caught.value.step is None


def test_a_limit_of_time_ends_a_worker_that_hangs() -> None:
    looks: list[list[str]] = []
    with Worker() as worker:
        worker.send(abs, -3)
        assert worker.receive_within(60.0) == 3
        worker.send(*report_and("time.sleep(60.0)"))
        worker.receive(until="second")
        with pytest.raises(TimeoutError):
            worker.receive_within(0.1, lambda: looks.append(list(worker.steps)))
        assert looks == [["first", "second"]]
        with pytest.raises(ProcessLookupError):
            os.kill(worker.pid, 0)


@pytest.mark.parametrize(
    ("limit_s", "memory_bytes", "call", "error"),
    [
        (9.0, 2**30, partial(int, "x"), ValueError),
        (9.0, 2**28, partial(bytearray, 2**29), MemoryError),
        pytest.param(
            1.0, 2**30, partial(max, itertools.repeat(0)), ValueError, marks=pytest.mark.full
        ),
    ],
)
@pytest.mark.skipif(sys.platform == "win32", reason="Windows knows no limit of memory")
def test_a_call_within_limits_ends_at_them(
    limit_s: float, memory_bytes: int, call: Callable[[], object], error: type[Exception]
) -> None:
    with pytest.raises(error):
        workers.call_within_limits(limit_s, memory_bytes, call)


@pytest.mark.skipif(sys.platform != "linux", reason="processes are listed on Linux alone")
@pytest.mark.parametrize(
    ("number", "threads", "call"),
    [
        (
            signal.SIGKILL,
            1,
            "with workers.in_background(time.sleep, 60.0): tell(); time.sleep(60.0)",
        ),
        (
            signal.SIGTERM,
            2,
            "with workers.in_background(time.sleep, 60.0): tell(); time.sleep(60.0)",
        ),
        (
            signal.SIGINT,
            1,
            "with workers.side_by_side(2): tell(); list(workers.call_each([sleep] * 2))",
        ),
        (
            signal.SIGKILL,
            1,
            "with workers.side_by_side(2): tell(); list(workers.call_each([sleep] * 2))",
        ),
    ],
)
@pytest.mark.every_case
def test_no_process_outlives_an_interruption(number: int, threads: int, call: str) -> None:
    code = (
        "import gc, threading, time\n"
        "from functools import partial\n"
        "from fingertip.foundation import interruption, workers\n"
        "interruption.raise_interruptions()\n"
        "workers.count_processors = lambda: 2\n"
        f"threading.active_count = lambda: {threads}\n"
        "def tell(): print(*(one.pid for one in gc.get_objects() if isinstance(one, "
        "workers.Worker)), flush=True)\n"
        "sleep = partial(time.sleep, 60.0)\n"
        f"{call}\n"
    )
    command = [sys.executable, "-c", code]
    started = subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        start_new_session=True,
    )
    assert started.stdout
    others = [int(word) for word in started.stdout.readline().split()]
    assert len(others) == 1 + ("side" in call)
    time.sleep(0.5)  # until the workers have begun
    started.send_signal(number)
    started.wait(timeout=30.0)
    started.stdout.close()
    until = time.monotonic() + 10.0
    while left := [pid for pid in others if is_alive(pid)]:
        assert time.monotonic() < until, f"processes {left} outlive {number}"
        time.sleep(0.1)


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere it ends when its pipe is closed")
def test_a_worker_whose_parent_ended_before_it_began_ends_too() -> None:
    code = "from fingertip.foundation.workers import serve_parent; serve_parent(0)"
    with subprocess.Popen([sys.executable, "-c", code], stdin=subprocess.PIPE) as process:
        assert process.wait(60.0) == 0, "its pipe is open still"


def is_alive(pid: int) -> bool:
    """Return whether a process is there, and not only its entry that nobody has taken note of."""
    try:
        return (
            Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rpartition(")")[2].split()[0]
            != "Z"
        )
    except (ProcessLookupError, FileNotFoundError):
        return False


# Several workers


def test_results_of_several_processes_come_in_the_order_of_the_calls() -> None:
    with side_by_side(2):
        assert list(call_each(partial(divmod, number, 7) for number in range(40))) == [
            divmod(n, 7) for n in range(40)
        ]
        pids = set(call_each([os.getpid] * 40))
        assert os.getpid() not in pids
        with side_by_side(1):
            assert list(call_each([os.getpid])) == [os.getpid()]
        assert set(call_each([os.getpid])) <= pids
    assert list(call_each([os.getpid])) == [os.getpid()]
    for pid in pids:
        with pytest.raises(ProcessLookupError):
            os.kill(pid, 0)


def call_one() -> int:
    return next(call_each([os.getpid]))


@pytest.mark.skipif(
    sys.platform != "linux" or workers.count_processors() == 1, reason="no process is forked"
)
def test_a_copy_of_this_process_leaves_its_workers_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(threading, "active_count", lambda: 1)
    with side_by_side(2), in_background(call_one) as wait:
        pid = wait()
        assert pid not in {os.getpid(), *call_each([os.getpid] * 40)}


def test_an_error_of_a_call_is_raised_here_and_ends_no_worker() -> None:
    with side_by_side(2):
        pids = set(call_each([os.getpid] * 40))
        with pytest.raises(FingertipError) as caught:
            list(call_each([partial(Design.load, "fsr4")]))
        assert caught.value.issues[0].field == "fsr4"
        assert (
            list(call_each([partial(print, "what a library prints is no part of the answer")] * 4))
            == [None] * 4
        )
        assert set(call_each([os.getpid] * 40)) <= pids


def test_a_worker_that_ends_by_itself_is_reported_with_a_remedy_and_replaced() -> None:
    with side_by_side(2):
        for _ in range(3):
            with pytest.raises(FingertipError, match=r"jobs: .* ended by itself.*choose jobs=1"):
                list(call_each([partial(os._exit, 3)]))
        for pid in set(call_each([os.getpid] * 40)):
            os.kill(pid, signal.SIGKILL)
        with pytest.raises(FingertipError, match="ended by itself"):
            list(call_each([partial(len, 1_000_000 * "x")] * 2))  # which no dead worker reads
        assert len(list(call_each([os.getpid] * 4))) == 4


def test_only_the_call_of_a_worker_that_dies_is_lost() -> None:
    pool = Pool(2)
    lost = pool.submit(*report_and("os._exit(3)"))
    others = [pool.submit(abs, -number) for number in range(20)]
    assert [other.result(60.0) for other in others] == list(range(20))
    error = lost.exception(60.0)
    assert isinstance(error, WorkerDiedError)
    assert error.step == "second"
    hangs = pool.submit(time.sleep, 60.0)
    pool.close()
    assert isinstance(hangs.exception(1.0), WorkerDiedError)


def test_calls_whose_results_nobody_takes_are_not_made() -> None:
    with side_by_side(2):
        begun = time.monotonic()
        results = call_each([os.getpid, *[partial(time.sleep, 1.0)] * 60])
        next(results)
        results.close()
        list(call_each([os.getpid]))
        assert time.monotonic() - begun < 20.0


def test_every_loop_runs_compiled() -> None:
    assert list(call_each([lambda: jit._always_compile])) == [jit.available()]
    with side_by_side(1):
        assert jit._always_compile == jit.available()
    assert not jit._always_compile


@pytest.mark.full
def test_campaign_closed_loop_and_mix_have_the_same_bits_side_by_side() -> None:
    design = Design()
    size = MixSize(4, 2)

    def run() -> list[object]:
        signals = [
            (signal.kind, signal.voltage_v.tobytes())
            for signal in generate_mix(design, size, 5_500_000)
        ]
        return [
            run_campaign(design, CampaignPlan(6, 1.0)),
            repr(run_closed_loop(design, ("fast",), 1)),
            signals,
        ]

    one_by_one = run()
    with side_by_side(3):
        assert run() == one_by_one
