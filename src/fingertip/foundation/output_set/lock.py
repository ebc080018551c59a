"""Lock of a folder, and errors of the operating system as sentences."""

from __future__ import annotations

import contextlib
import errno
import os
import time
from collections.abc import Iterator
from pathlib import Path

from fingertip.foundation.errors import Issue, OutputError

LOCK_S = 60.0
"""Time for which a command waits for another one that writes to the same place."""


@contextlib.contextmanager
def lock(folder: Path, *, shared: bool = False) -> Iterator[None]:
    """Hold a lock on a folder while a set in it is replaced, or a shared one while it is read.

    The lock ends with the process, however it ends.
    """
    try:
        import fcntl
    except ImportError:  # Windows: sets are not locked there
        yield
        return
    try:
        handle = os.open(folder, os.O_RDONLY)
    except PermissionError:  # a folder that may not be listed cannot be locked either
        yield
        return
    try:
        deadline = time.monotonic() + LOCK_S
        while True:
            try:
                fcntl.flock(handle, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)
                break
            except OSError as error:
                if error.errno not in (errno.EWOULDBLOCK, errno.EACCES):
                    break  # a file system without locks
                if time.monotonic() > deadline:
                    message = f"another command has been writing here for {LOCK_S:g} s; wait for it and try again."
                    raise OutputError(Issue(str(folder), message)) from error
                time.sleep(0.02)
        yield
    finally:
        os.close(handle)


@contextlib.contextmanager
def output_errors(folder: Path) -> Iterator[None]:
    """Turn errors of the operating system into an OutputError with a remedy."""
    try:
        yield
    except OSError as error:
        reason = error.strerror or str(error)
        message = f"cannot be written ({reason}); choose another folder with --out."
        raise OutputError(Issue(str(folder), message)) from error
