"""Processes that this program starts for a while: none of them outlives the one that started it.

What runs in one has limits of time and memory, and takes nothing from the current folder, which may be a stranger's.
"""

from __future__ import annotations

import contextlib
import ctypes
import io
import os
import pickle
import signal
import subprocess
import sys
import threading
import warnings
from collections.abc import Callable, Iterator
from typing import Any, BinaryIO, NoReturn, TypeVar

from fingertip.foundation.errors import FingertipError, Issue

T = TypeVar("T")
MAX_JOBS = 1024
_PR_SET_PDEATHSIG = 1
_SLOWEST = 4.0
"""Time on the clock that a busy machine may take for each second of computing."""


def end_with_parent() -> None:
    """Let Linux kill this process when the one that started it ends; elsewhere it ends when its job is done."""
    if sys.platform == "linux":
        with contextlib.suppress(OSError, AttributeError):
            ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)


def python_command(module: str, *arguments: str) -> list[str]:
    """Return the command that runs a module of this program, and imports nothing from the current folder (-P).

    Start it in a folder of its own where libraries look for settings in the current one, as those of cadquery do.
    """
    return [sys.executable, "-P", "-m", module, *arguments]


def python_environment() -> dict[str, str]:
    """Return the variables of such a process: its modules are found wherever it is started."""
    paths = os.environ.get("PYTHONPATH")
    found = os.pathsep.join(os.path.abspath(path) for path in paths.split(os.pathsep) if path) if paths else ""
    return {**os.environ, "PYTHONPATH": found}


def call_within_limits(limit_s: float, memory_bytes: int, function: Callable[..., T], *arguments: Any) -> T:
    """Call a function in a process of its own, for what a library makes of a stranger's file.

    Raises what the function raises, MemoryError where it reaches the limit of memory, and ValueError where the process
    ends by itself or by the limit of time. Windows knows no limit of memory, and counts time on the clock.
    """
    job = pickle.dumps((limit_s, memory_bytes, function, arguments))
    with contextlib.suppress(subprocess.TimeoutExpired):
        done = subprocess.run(
            python_command(__name__), input=job, capture_output=True, timeout=_SLOWEST * limit_s, check=False
        )
        if done.returncode == 0:
            result, error = pickle.loads(done.stdout)
            if error is not None:
                raise error
            return result  # type: ignore[no-any-return]
    raise ValueError(f"it cannot be read in {limit_s:g} s of computing")


def count_processors() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def find_workers(jobs: int | None) -> int:
    """Return the number of processes that is asked for, one for each processor by default. Raises FingertipError."""
    if jobs is not None and not 1 <= jobs <= MAX_JOBS:
        raise FingertipError(Issue("--jobs", f"{jobs} is out of range; choose 1 to {MAX_JOBS}, or leave it out."))
    return count_processors() if jobs is None else jobs


@contextlib.contextmanager
def in_background(function: Callable[..., T], *arguments: Any) -> Iterator[Callable[[], T]]:
    """Call a function in another process, which ends with this block; what is provided waits for the result.

    With one processor, or where the process fails for any reason, the function is called when the result is wanted.
    """
    start = _fork if sys.platform == "linux" and threading.active_count() == 1 else _start

    def wait() -> T:
        if answer and (data := answer.read()) and not (found := pickle.loads(data))[1]:
            return found[0]  # type: ignore[no-any-return]
        return function(*arguments)

    call = None, None, function, arguments
    with start(pickle.dumps(call)) if count_processors() > 1 else contextlib.nullcontext() as answer:
        yield wait


@contextlib.contextmanager
def start_worker() -> Iterator[subprocess.Popen[bytes]]:
    """Start a process that answers calls, one after the other, and ends with the block."""
    pipe = subprocess.PIPE
    # A session of its own: Ctrl-C reaches this process alone, which ends the other one.
    with subprocess.Popen(
        python_command(__name__), stdin=pipe, stdout=pipe, stderr=subprocess.DEVNULL, start_new_session=True
    ) as process:
        try:
            yield process
        finally:
            process.kill()
            with contextlib.suppress(BrokenPipeError):  # of a call that it has not read
                process.stdin.close()  # type: ignore[union-attr]


@contextlib.contextmanager
def _start(call: bytes) -> Iterator[BinaryIO]:
    """Answer a call by another process, which ends with the block; provides where the answer is read."""
    with start_worker() as process:
        assert process.stdin
        with contextlib.suppress(BrokenPipeError), process.stdin:
            process.stdin.write(call)
        yield process.stdout  # type: ignore[misc]


@contextlib.contextmanager
def _fork(call: bytes) -> Iterator[BinaryIO]:
    """Let a copy of this process do the same: importing all modules once more would take half a second.

    Without threads of Python that is safe: those of numpy's BLAS stop for it.
    """
    reading, writing = os.pipe()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # which counts the threads of BLAS too
        process = os.fork()
    if not process:
        _answer_in_copy(call, writing)
    os.close(writing)
    try:
        with os.fdopen(reading, "rb") as answer:
            yield answer
    finally:
        os.kill(process, signal.SIGKILL)
        os.waitpid(process, 0)


def _answer_in_copy(call: bytes, writing: int) -> NoReturn:
    try:
        os.setsid()
        null = os.open(os.devnull, os.O_RDWR)
        for stream in range(3):
            os.dup2(null, stream)
        # Whatever else is open belongs to the other process, which closes pipes to say that it is done.
        os.closerange(3, writing)
        os.closerange(writing + 1, os.sysconf("SC_OPEN_MAX"))
        _answer_call(io.BytesIO(call), os.fdopen(writing, "wb"))
    finally:
        os._exit(0)


def _answer_call(call: BinaryIO, answer: BinaryIO) -> None:
    end_with_parent()
    limit_s, memory_bytes, function, arguments = pickle.load(call)  # imports what the function needs
    if sys.platform != "win32" and limit_s is not None:
        import resource  # noqa: PLC0415

        for kind, limit in ((resource.RLIMIT_CPU, round(limit_s)), (resource.RLIMIT_DATA, memory_bytes)):
            resource.setrlimit(kind, (limit, resource.getrlimit(kind)[1]))
    result, error = None, None
    try:
        result = function(*arguments)
    except Exception as raised:
        error = raised.with_traceback(None)
    answer.write(pickle.dumps((result, error)))
    answer.flush()


if __name__ == "__main__":
    answer = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # libraries print there
    with contextlib.suppress(EOFError):
        while True:
            _answer_call(sys.stdin.buffer, answer)
    os._exit(0)  # unloading the libraries of the B-rep kernel would take a third of a second
