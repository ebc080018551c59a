"""Signals that ask a command to end: Ctrl-C, the end of the terminal, and SIGTERM.

Each becomes an exception, so that temporary folders are removed and unfinished files undone. It is
no `Exception`. It is no `KeyboardInterrupt` either, which the command line's library would turn
into the exit code of a failed check.
"""

from __future__ import annotations

import contextlib
import signal
import sys
from collections.abc import Iterator
from types import FrameType

SIGNALS = tuple(
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)
)


class Interruption(BaseException):
    """A signal asks this process to end."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number


INTERRUPTIONS = (KeyboardInterrupt, Interruption)
"""Exceptions of an interruption: that of Python's own handler, and that of the command line."""
_received: int | None = None
_holding = False


def raise_interruptions() -> None:
    """Let the signals raise `Interruption` from now on, except those that are ignored already."""
    for number in SIGNALS:
        if signal.getsignal(number) not in (signal.SIG_IGN, None):
            signal.signal(number, _raise)


def end_by_default() -> None:
    """Let the signals end this process at once: nothing is left to undo."""
    for number in SIGNALS:
        if signal.getsignal(number) is _raise:
            signal.signal(number, signal.SIG_DFL)


def forget_signal() -> None:
    """Forget a signal that was handled: later failures have another reason."""
    global _received
    _received = None


def find_signal(error: BaseException) -> int | None:
    """Return the signal that caused an exception, or None.

    During an import, an interruption may turn into another exception.
    """
    if isinstance(error, Interruption):
        return error.number

    return int(signal.SIGINT) if isinstance(error, KeyboardInterrupt) else _received


def exit_code(error: BaseException) -> int:
    """Return the exit code of a process that a signal has ended."""
    return 128 + (find_signal(error) or signal.SIGINT)


def report(error: BaseException) -> int:
    """Report an interruption on stderr in one line, and return the exit code."""
    number = exit_code(error) - 128
    # Sets of files are swapped in whole, so an interrupted command leaves the former set or the new
    # one.
    by = "" if number == signal.SIGINT else f" by {signal.Signals(number).name}"
    with contextlib.suppress(OSError):
        print(f"interrupted{by}; no file is half-written", file=sys.stderr)

    return exit_code(error)


@contextlib.contextmanager
def hold_interruptions() -> Iterator[None]:
    """Hold back the exceptions until the block ends.

    A mask of signals would not hold for the threads of libraries.
    """
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
