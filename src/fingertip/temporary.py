"""Temporary folders that do not outlive their use by long.

A folder is removed when its `with` block ends, at an interruption too. What a process that was killed has left is
removed by the next one that makes a folder. Each process holds a lock on its folders, which ends with it; a number of
a process in the name would mislead where containers share the folder of temporary files.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import stat
import tempfile
from pathlib import Path
from types import TracebackType

from fingertip.errors import Issue, OutputError

_PREFIX = "fingertip-tmp-"


class TemporaryFolder:
    """Folder for files that only this process and its children need; a context manager that gives its path.

    Raises
    ------
    OutputError
        If no folder for temporary files can be written.
    """

    def __init__(self) -> None:
        self.path, self._lock = _make_locked()

    def __enter__(self) -> Path:
        return self.path

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.remove()

    def remove(self) -> None:
        """Remove the folder with all that is in it."""
        shutil.rmtree(self.path, ignore_errors=True)
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None


def find_temporary_place() -> Path:
    """Return the system's folder for temporary files.

    Raises
    ------
    OutputError
        If none can be written.
    """
    try:
        return Path(tempfile.gettempdir())
    except OSError as error:
        message = "no folder for temporary files can be written; set it to one that can be."
        raise OutputError(Issue("TMPDIR", message)) from error


def _make_locked() -> tuple[Path, int | None]:
    place = find_temporary_place()
    remove_leftovers(place)
    while True:
        try:
            path = Path(tempfile.mkdtemp(prefix=_PREFIX, dir=place))
        except OSError as error:
            reason = error.strerror or str(error)
            message = f"cannot be written ({reason}); free some space there, or set TMPDIR to another folder."
            raise OutputError(Issue(str(place), message)) from error
        lock = _lock(path)
        if path.is_dir() if lock is None else _is_at(path, lock):
            return path, lock
        if lock is not None:  # another process took the new folder for a leftover before it was locked
            os.close(lock)


def remove_leftovers(place: Path) -> None:
    """Remove the folders of this user whose processes have ended."""
    with contextlib.suppress(OSError):
        for entry in list(os.scandir(place)):
            if entry.name.startswith(_PREFIX):
                with contextlib.suppress(OSError):
                    _remove_leftover(Path(entry.path))


def _remove_leftover(path: Path) -> None:
    status = os.lstat(path)
    if not stat.S_ISDIR(status.st_mode) or not hasattr(os, "getuid") or status.st_uid != os.getuid():
        return
    lock = _lock(path, wait=False)
    if lock is not None:
        try:
            shutil.rmtree(path, ignore_errors=True)
        finally:
            os.close(lock)


def _lock(path: Path, *, wait: bool = True) -> int | None:
    """Lock a folder until the handle is closed; None where that is not possible, or another process holds it."""
    try:
        import fcntl
    except ImportError:  # Windows: leftovers stay there
        return None
    try:
        handle = os.open(path, os.O_RDONLY)
    except OSError:
        return None
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
    except OSError:
        os.close(handle)
        return None
    return handle


def _is_at(path: Path, handle: int) -> bool:
    """Return whether an open folder is still the one at a path."""
    try:
        return os.path.samestat(os.stat(path), os.fstat(handle))
    except OSError:
        return False
