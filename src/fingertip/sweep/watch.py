"""A point's time limit, kept inside the worker: an exception where Python runs, the worker's end where it does not.

The alarm interrupts Python code in a worker's main thread and gives up that point only. Code that never comes back
to Python (a kernel in an endless loop) is ended a little later by faulthandler's own thread, which needs no Python: the
worker dies, and whoever runs the workers notices.
"""

from __future__ import annotations

import contextlib
import faulthandler
import os
import signal
import threading
from collections.abc import Iterator
from typing import IO

GRACE_SHARE, GRACE_S = 0.25, 1.0
"""The worker is ended this much of the limit, and this long, after the alarm."""
_nowhere: IO[str] | None = None
_armed = False


class OutOfTimeError(BaseException):
    """A point took longer than it may. No `Exception`, so that no library takes it for one of its own."""


@contextlib.contextmanager
def limited(limit_s: float) -> Iterator[None]:
    """Run a block for at most this long [s].

    Raises
    ------
    OutOfTimeError
        In a main thread, once the limit has passed. The process ends soon after if that does not stop the block.
    """
    global _nowhere, _armed
    if _nowhere is None:
        _nowhere = open(os.devnull, "w")  # noqa: SIM115 (faulthandler writes there until the process ends)
    alarmed = hasattr(signal, "setitimer") and threading.current_thread() is threading.main_thread()
    before = signal.signal(signal.SIGALRM, _out_of_time) if alarmed else None
    faulthandler.dump_traceback_later(limit_s * (1.0 + GRACE_SHARE) + GRACE_S, exit=True, file=_nowhere)
    try:
        try:
            if alarmed:
                _armed = True
                signal.setitimer(signal.ITIMER_REAL, limit_s)
            yield
        finally:
            _armed = False  # an alarm after this is late and ignored; one before it is raised, and rings only once
    finally:
        if alarmed:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
            signal.signal(signal.SIGALRM, before)
        faulthandler.cancel_dump_traceback_later()


def _out_of_time(*_: object) -> None:
    if _armed:
        raise OutOfTimeError


def end_with_parent() -> None:
    """End this process when the one that started it ends, however that ends: no worker outlives a killed sweep."""
    from multiprocessing import parent_process

    parent = parent_process()
    if parent is None:
        return

    def wait() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=wait, daemon=True).start()
