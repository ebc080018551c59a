"""Processes that this program starts for a while: none of them outlives the one that started it.

What runs in one has limits of time and memory, and takes nothing from the current folder, which may be a stranger's.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from typing import Any, TypeVar

T = TypeVar("T")
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


@contextlib.contextmanager
def in_background(function: Callable[..., T], *arguments: Any) -> Iterator[Callable[[], T]]:
    """Call a function in another process, which ends with this block; what is provided waits for the result.

    With one processor, or where the process fails for any reason, the function is called when the result is wanted.
    """

    def wait() -> T:
        answer, _ = process.communicate() if process else (b"", None)
        if process and process.returncode == 0 and not (found := pickle.loads(answer))[1]:
            return found[0]  # type: ignore[no-any-return]
        return function(*arguments)

    process, pipe = None, subprocess.PIPE
    try:
        if count_processors() > 1:
            # A session of its own: Ctrl-C reaches this process alone, which ends the other one.
            process = subprocess.Popen(
                python_command(__name__), stdin=pipe, stdout=pipe, stderr=subprocess.DEVNULL, start_new_session=True
            )
            assert process.stdin
            with contextlib.suppress(BrokenPipeError):
                process.stdin.write(pickle.dumps((None, None, function, arguments)))
                process.stdin.flush()
        yield wait
    finally:
        if process:
            process.kill()
            process.communicate()


def _answer_call() -> None:
    end_with_parent()
    answer = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # libraries print there
    limit_s, memory_bytes, function, arguments = pickle.load(sys.stdin.buffer)  # imports what the function needs
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
    answer.close()


if __name__ == "__main__":
    _answer_call()
    os._exit(0)  # unloading the libraries of the B-rep kernel would take a third of a second
