"""Runs of cases in this process, each within a time limit and with its own peak of memory."""

from __future__ import annotations

import contextlib
import io
import os
import signal
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from types import FrameType

from tools.fuzz.cases import Case
from tools.fuzz.outcome import WAIT_LIMIT_S, Outcome, read_delay_s

LOADED_BYTES = 150 * 2**20
"""Resident memory of a new process that has imported what the commands need, as measured once."""


class TimeIsUpError(BaseException):
    """The time limit of a case was reached. No command catches it, as it is no Exception."""


@contextlib.contextmanager
def _time_limit(limit_s: float) -> Iterator[None]:
    start_s = time.monotonic()
    delay_s = read_delay_s()

    def stop(number: int, frame: FrameType | None) -> None:
        # On a loaded machine most of the time is spent in waiting for a processor, which is no
        # fault of the case.
        waited_s = time.monotonic() - start_s - (read_delay_s() - delay_s)
        if number == signal.SIGALRM and waited_s < WAIT_LIMIT_S:
            signal.setitimer(signal.ITIMER_REAL, WAIT_LIMIT_S - waited_s)
        else:
            raise TimeIsUpError

    timers = (
        (signal.ITIMER_PROF, signal.SIGPROF, limit_s),
        (signal.ITIMER_REAL, signal.SIGALRM, WAIT_LIMIT_S),
    )
    before = [signal.signal(number, stop) for _, number, _ in timers]
    for timer, _, seconds in timers:
        signal.setitimer(timer, seconds)

    try:
        yield
    finally:
        for timer, _, _ in timers:
            signal.setitimer(timer, 0)

        for (_, number, _), handler in zip(timers, before, strict=True):
            signal.signal(number, handler)


def _forget_peak() -> None:
    """Let the system count the peak of memory anew, where it can."""
    with contextlib.suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5")


def _read_memory(field: str) -> int:
    """Read the resident memory (VmRSS) or its peak (VmHWM)
    [bytes]; 0 where the system does not tell.
    """
    with contextlib.suppress(OSError):
        for line in Path("/proc/self/status").read_text().splitlines():
            if line.startswith(f"{field}:"):
                return 1024 * int(line.split()[1])

    return 0


def run(case: Case, folder: Path) -> Outcome:
    """Run a case in a folder."""
    from fingertip.cli import app

    streams = [
        io.TextIOWrapper(io.BytesIO(), "utf-8", errors=how)
        for how in ("strict", "backslashreplace")
    ]
    code: int | None = None
    before = sys.stdout, sys.stderr, sys.stdin, os.getcwd()

    with open(os.devnull, encoding="utf-8") as nothing:
        sys.stdout = streams[0]
        sys.stderr = streams[1]
        sys.stdin = nothing
        os.chdir(folder)
        _forget_peak()
        before_bytes = _read_memory("VmRSS")
        start_s = time.process_time()

        try:
            with _time_limit(case.limit_s):
                app(list(case.words), prog_name="fingertip")

            code = 0
        except SystemExit as end:
            if isinstance(end.code, int):
                code = end.code
            elif end.code is None:
                code = 0
            else:
                code = 1
        except TimeIsUpError:
            code = None
        except Exception as error:  # what the last resort of the command line does not reach
            print(
                f"Traceback (most recent call last): {type(error).__name__}: {error}",
                file=streams[1],
            )
            code = 70
        finally:
            seconds = time.process_time() - start_s
            sys.stdout, sys.stderr, sys.stdin = before[:3]
            os.chdir(before[3])

    texts = []
    for stream in streams:
        stream.flush()
        texts.append(stream.buffer.getvalue().decode("utf-8", "backslashreplace"))

    # What earlier cases left in this process is not this one's, but for what a new process would
    # have to load too.
    peak_bytes = _read_memory("VmHWM") - max(0, before_bytes - LOADED_BYTES)
    return Outcome(
        code=code,
        stdout=texts[0],
        stderr=texts[1],
        peak_bytes=peak_bytes,
        seconds=seconds,
    )
