"""File of a sweep's database: opened, locked, and its errors told in sentences."""

from __future__ import annotations

import contextlib
import os
import sqlite3
from collections.abc import Iterator
from pathlib import Path

from fingertip.foundation.errors import Issue, OutputError, SweepError
from fingertip.foundation.files import lock_folder
from fingertip.foundation.input_files import check_regular

FILE = "sweep.sqlite"
_BUSY_TIMEOUT_S = 30.0
"""Time for which a reader and the writer wait for each other [s]."""


def connect(path: Path, mode: str) -> sqlite3.Connection:
    if os.path.lexists(path):
        check_regular(path, below=path.parent)

    try:
        uri = path.absolute().as_posix().replace("%", "%25").replace("?", "%3f").replace("#", "%23")
        connection = sqlite3.connect(
            f"file:{uri}?mode={mode}", uri=True, timeout=_BUSY_TIMEOUT_S, isolation_level=None
        )
    except sqlite3.Error as error:
        raise _make_write_error(path.parent, str(error)) from error

    with translated_errors(path.parent):
        connection.execute("PRAGMA synchronous = FULL")

    return connection


def lock_sweep(folder: Path) -> int | None:
    """Lock the folder until this process ends.

    Without such locks, the primary key still keeps rows unique.
    """
    try:
        return lock_folder(folder)
    except BlockingIOError:
        problem = (
            "is being written by another sweep; wait for it, or choose another folder with --out."
        )
        raise make_error(folder, problem) from None
    except OSError as error:
        raise _make_write_error(folder, error.strerror or str(error)) from error


@contextlib.contextmanager
def translated_errors(folder: Path) -> Iterator[None]:
    """Run database operations; errors of SQLite become errors with a message for the user."""
    try:
        yield
    except sqlite3.IntegrityError as error:
        raise OutputError(
            Issue(str(folder), f"already has a row that was to be written ({error}).")
        ) from error
    except sqlite3.DatabaseError as error:
        text = str(error)
        if "disk is full" in text or "disk I/O error" in text:
            remedy = (
                "free some space, then continue with --resume. The rows written so far are safe"
            )
            raise OutputError(
                Issue(str(folder), f"cannot be written any further ({text}); {remedy}.")
            ) from error

        if "locked" in text:
            raise make_error(
                folder, f"is in use by another program ({text}); ask again when it has ended."
            ) from error

        if "not a database" in text or "malformed" in text or "no such table" in text:
            problem = f"is not the database of a sweep ({text}); choose another folder with --out."
            raise make_error(folder / FILE, problem) from error

        if "Could not decode" in text:
            raise make_damage_error(folder, f"a text in it cannot be read ({text})") from error

        raise _make_write_error(folder, text) from error


def make_error(path: Path, message: str) -> SweepError:
    return SweepError(Issue(str(path), message))


def make_damage_error(folder: Path, what: str) -> SweepError:
    remedy = "restore it from a copy, or run the sweep again in another folder."
    return make_error(folder / FILE, f"is damaged: {what}; {remedy}")


def _make_write_error(folder: Path, reason: str) -> OutputError:
    return OutputError(
        Issue(str(folder), f"cannot be written ({reason}); choose another folder with --out.")
    )
