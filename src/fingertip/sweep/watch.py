"""A point's time limit, kept inside the worker: when it has passed, the worker ends, and with it the point.

No exception is thrown into the running code instead: it would leave half-imported modules and half-made caches behind,
from which the next points would suffer. faulthandler's own thread ends the process; it needs no Python, so that it
ends a kernel in an endless loop too. Whoever runs the workers notices, and starts another.
"""

from __future__ import annotations

import contextlib
import faulthandler
import os
import threading
from collections.abc import Iterator
from typing import IO

_nowhere: IO[str] | None = None


@contextlib.contextmanager
def limited(limit_s: float) -> Iterator[None]:
    """Run a block for at most this long [s]; this process ends if it takes longer."""
    global _nowhere
    if _nowhere is None:
        _nowhere = open(os.devnull, "w")  # noqa: SIM115 (faulthandler writes there until the process ends)
    faulthandler.dump_traceback_later(limit_s, exit=True, file=_nowhere)
    try:
        yield
    finally:
        faulthandler.cancel_dump_traceback_later()


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
