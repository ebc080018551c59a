"""Signals that ask a command to end: Ctrl-C, the end of the terminal, and SIGTERM of whoever started it.

Each becomes an exception, so that temporary folders are removed and unfinished files undone on the way out. It is no
`Exception`, and no `KeyboardInterrupt` either, which the command line's library would turn into the exit code of a
failed check.
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
from types import FrameType
from typing import Any, TypeVar

SIGNALS = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))


class Interruption(BaseException):
    """A signal asks this process to end."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number


INTERRUPTIONS = (KeyboardInterrupt, Interruption)
"""Exceptions of an interruption: where Python's own handler is in place, and within the command line."""
_received: int | None = None
_holding = False


def raise_interruptions() -> None:
    """Let the signals raise `Interruption` from now on; one that the starting process ignores stays ignored."""
    for number in SIGNALS:
        if signal.getsignal(number) not in (signal.SIG_IGN, None):
            signal.signal(number, _raise)


def end_by_default() -> None:
    """Let the signals end this process at once: nothing is left to undo."""
    for number in SIGNALS:
        if signal.getsignal(number) is _raise:
            signal.signal(number, signal.SIG_DFL)


def forget_signal() -> None:
    """Take the signal as handled: what fails from now on fails for another reason."""
    global _received
    _received = None


def find_signal(error: BaseException) -> int | None:
    """Return the signal that is the cause of an exception, or None; imports turn it into other exceptions."""
    if isinstance(error, Interruption):
        return error.number
    return int(signal.SIGINT) if isinstance(error, KeyboardInterrupt) else _received


def exit_code(error: BaseException) -> int:
    return 128 + (find_signal(error) or signal.SIGINT)


def report(error: BaseException) -> int:
    """Report an interruption on stderr in one line, and return the exit code."""
    number = exit_code(error) - 128
    # Sets of files are swapped in whole, so an interrupted command leaves the former set or the new one.
    by = "" if number == signal.SIGINT else f" by {signal.Signals(number).name}"
    with contextlib.suppress(OSError):
        print(f"interrupted{by}; no file is half-written", file=sys.stderr)
    return exit_code(error)


@contextlib.contextmanager
def hold_interruptions() -> Iterator[None]:
    """Hold back the exceptions until the block ends: a mask of signals would not bind the threads of libraries."""
    global _holding
    _holding = True
    try:
        yield
    finally:
        _holding = False
        if _received is not None:
            raise Interruption(_received)


def _raise(number: int, frame: FrameType | None) -> None:
    global _received
    _received = number
    if not _holding:
        raise Interruption(number)


# Processes that this program starts for a while: none of them outlives the one that started it.

_PR_SET_PDEATHSIG = 1


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


T = TypeVar("T")
_SLOWEST = 4.0
"""Time on the clock that a busy machine may take for each second of computing."""


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


def _answer_call() -> None:
    end_with_parent()
    limit_s, memory_bytes, function, arguments = pickle.load(sys.stdin.buffer)  # imports what the function needs
    if sys.platform != "win32":
        import resource  # noqa: PLC0415

        for kind, limit in ((resource.RLIMIT_CPU, round(limit_s)), (resource.RLIMIT_DATA, memory_bytes)):
            resource.setrlimit(kind, (limit, resource.getrlimit(kind)[1]))
    result, error = None, None
    try:
        result = function(*arguments)
    except Exception as raised:
        error = raised.with_traceback(None)
    sys.stdout.buffer.write(pickle.dumps((result, error)))


if __name__ == "__main__":
    _answer_call()
