"""Runs of cases as processes of their own, with limits on memory, time and open files."""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tools.fuzz.cases import PARSED_S, Case
from tools.fuzz.outcome import MEMORY_LIMIT_BYTES, WAIT_LIMIT_S, Outcome, read_delay_s

ADDRESS_SPACE_BYTES = 4 * MEMORY_LIMIT_BYTES
"""Limit of the address space, of which libraries take more than they use."""
START_S = 5
"""Processor time that the start of Python may take beside that of the case [s]."""


def _limit() -> None:
    seconds = int(PARSED_S) + START_S
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
    resource.setrlimit(resource.RLIMIT_AS, (ADDRESS_SPACE_BYTES, ADDRESS_SPACE_BYTES))
    resource.setrlimit(resource.RLIMIT_FSIZE, (MEMORY_LIMIT_BYTES, MEMORY_LIMIT_BYTES))


def run(case: Case, folder: Path) -> Outcome:
    """Run a case in a folder as `python -m fingertip`."""
    words = [word.encode("utf-8", "surrogateescape")[:100_000] for word in case.words]
    command = [os.fsencode(sys.executable), b"-m", b"fingertip", *words]

    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        start_s = time.monotonic()
        process = subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=out,
            stderr=err,
            cwd=folder,
            preexec_fn=_limit,
        )
        status = None
        used = None

        while time.monotonic() - start_s - read_delay_s(process.pid) < WAIT_LIMIT_S:
            pid, status, used = os.wait4(process.pid, os.WNOHANG)
            if pid:
                break

            time.sleep(0.02)
        else:
            os.kill(process.pid, signal.SIGKILL)  # Popen.kill would wait for the process itself
            _, _, used = os.wait4(process.pid, 0)
            status = None

        process.returncode = 0  # it was waited for
        texts = []
        for stream in (out, err):
            stream.seek(0)
            texts.append(stream.read().decode("utf-8", "backslashreplace"))

    code = None if status is None else os.waitstatus_to_exitcode(status)
    if code in (-signal.SIGXCPU, -signal.SIGKILL):
        code = None

    seconds = used.ru_utime + used.ru_stime
    return Outcome(
        code=code,
        stdout=texts[0],
        stderr=texts[1],
        peak_bytes=1024 * used.ru_maxrss,
        seconds=seconds,
    )
