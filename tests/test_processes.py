"""Calls in another process: same result, errors of the function, and no process that stays."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time

import pytest

from fingertip.design import Design
from fingertip.foundation import processes
from fingertip.foundation.errors import FingertipError
from fingertip.foundation.processes import in_background
from tests.conftest import ROOT


@pytest.fixture(params=["fork", "start"])
def way(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """A copy of this process, or where it has other threads, one that imports what it needs."""
    monkeypatch.setattr(threading, "active_count", lambda: 1 + (request.param == "start"))
    return str(request.param)


@pytest.mark.usefixtures("way")
def test_a_call_in_the_background_gives_the_result_of_another_process(monkeypatch: pytest.MonkeyPatch) -> None:
    with in_background(os.getpid) as wait:
        assert (wait() == os.getpid()) == (processes.count_processors() == 1)
    with in_background(print, "what a library prints is no part of the answer") as wait:
        assert wait() is None
    monkeypatch.setattr(processes, "count_processors", lambda: 1)
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


@pytest.mark.skipif(sys.platform != "linux", reason="processes are listed on Linux alone")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
@pytest.mark.parametrize("way", ["fork", "start", "side by side"])
@pytest.mark.every_case
def test_no_process_outlives_an_interruption(number: int, way: str) -> None:
    code = (
        "from fingertip.foundation import interruption, processes\n"
        "import subprocess, time\n"
        "interruption.raise_interruptions()\n"
        "processes.count_processors = lambda: 2\n"
        "import functools, os, threading\n"
        f"threading.active_count = lambda: {1 + (way != 'fork')}\n"
        "fork, begin = os.fork, subprocess.Popen\n"
        "def tell(child):\n"
        "    if child: print(child, flush=True)\n"
        "    return child\n"
        "os.fork = lambda: tell(fork())\n"
        "class Popen(begin):\n"
        "    def __init__(self, *a, **k):\n"
        "        super().__init__(*a, **k)\n"
        "        print(self.pid, flush=True)\n"
        "subprocess.Popen = Popen\n"
        "from fingertip.foundation.side_by_side import call_each, side_by_side\n"
    )
    if way == "side by side":
        code += "with side_by_side(2): list(call_each([functools.partial(time.sleep, 60.0)] * 2))\n"
    else:
        code += "with processes.in_background(time.sleep, 60.0): time.sleep(60.0)\n"
    command = [sys.executable, "-c", code]
    environment = os.environ | {"PYTHONPATH": str(ROOT / "src")}
    started = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, env=environment, start_new_session=True
    )
    assert started.stdout
    other = int(started.stdout.readline())
    time.sleep(1.0)
    started.send_signal(number)
    started.wait(timeout=30.0)
    started.stdout.close()
    for _ in range(100):
        try:
            os.kill(other, 0)
            with open(f"/proc/{other}/stat", encoding="ascii") as file:
                if file.read().rpartition(")")[2].split()[0] == "Z":
                    return  # dead, and nobody has taken note
        except (ProcessLookupError, FileNotFoundError):
            return
        time.sleep(0.1)
    pytest.fail(f"process {other} outlives {number}")
