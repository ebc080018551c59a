"""Time limit of a point, enforced inside the worker: when it expires, the worker process exits.

An exception raised in the running code would leave half-imported modules and half-filled caches behind, and later
points would suffer from them. faulthandler ends the process from its own thread. That thread needs no Python lock, so
it also ends a compiled kernel stuck in an endless loop. The engine notices the exit and starts another worker.
"""

from __future__ import annotations

import contextlib
import faulthandler
import os
from collections.abc import Iterator
from typing import IO

_null_file: IO[str] | None = None


@contextlib.contextmanager
def limit_time(limit_s: float) -> Iterator[None]:
    """Run the block for at most `limit_s` seconds; this process exits if the block takes longer."""
    global _null_file
    if _null_file is None:
        # faulthandler writes its traceback there. The file stays open until the process ends.
        _null_file = open(os.devnull, "w")  # noqa: SIM115
    faulthandler.dump_traceback_later(limit_s, exit=True, file=_null_file)
    try:
        yield
    finally:
        faulthandler.cancel_dump_traceback_later()
