"""File of a sweep's database: opened, locked, and its errors told in sentences.

A folder may come from a stranger, and SQLite does what a file says: a journal may name a file that is removed once it
was read, and definitions of tables may take all memory. A sweep has neither, so both are refused.
"""

from __future__ import annotations

import contextlib
import os
import sqlite3
from collections.abc import Iterator
from pathlib import Path

from fingertip.foundation.errors import InputFileError, Issue, OutputError, SweepError
from fingertip.foundation.files import lock_folder
from fingertip.foundation.input_files import check_regular

FILE = "sweep.sqlite"
_JOURNAL_MARK = bytes.fromhex("d9d505f920a163d7")
"""End of a journal that names another file: the journals of several databases that were written at once."""
_BUSY_TIMEOUT_S = 30.0
"""Time for which a reader and the writer wait for each other [s]."""
MAX_TEXT_BYTES = 2**16
"""Maximum length of a text in a row or of a table's definition [bytes]. `MAX_REASON_LENGTH` characters are fewer."""
_MAX_SCHEMA_STEPS = 2000
"""Maximum number of steps of SQLite's machine in which the tables' definitions are read. Those of a sweep take 60."""


def connect(path: Path, mode: str) -> sqlite3.Connection:
    _refuse_odd_files(path)
    try:
        uri = path.absolute().as_posix().replace("%", "%25").replace("?", "%3f").replace("#", "%23")
        connection = sqlite3.connect(f"file:{uri}?mode={mode}", uri=True, timeout=_BUSY_TIMEOUT_S, isolation_level=None)
    except sqlite3.Error as error:
        raise _make_write_error(path.parent, str(error)) from error
    connection.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, MAX_TEXT_BYTES)  # of the tables' definitions, which come first
    connection.set_progress_handler(lambda: 1, _MAX_SCHEMA_STEPS)  # the first statement reads the definitions
    with translated_errors(path.parent):
        connection.execute("PRAGMA synchronous = FULL")
    connection.set_progress_handler(None, 0)
    return connection


def _refuse_odd_files(path: Path) -> None:
    """Refuse a database that is a link or no file, and a journal that would remove another file."""
    journal = path.with_name(f"{path.name}-journal")
    for side in (path, journal, path.with_name(f"{path.name}-wal"), path.with_name(f"{path.name}-shm")):
        try:
            check_regular(side, below=path.parent)
        except InputFileError:
            if os.path.lexists(side):
                raise
    with contextlib.suppress(FileNotFoundError), journal.open("rb") as file:  # a running sweep may remove it meanwhile
        file.seek(max(0, file.seek(0, os.SEEK_END) - len(_JOURNAL_MARK)))
        if file.read() == _JOURNAL_MARK:
            remedy = "restore the folder from a copy, or run the sweep in another folder"
            raise make_error(journal, f"names another file, which would be removed; {remedy}.")


def lock_sweep(folder: Path) -> int | None:
    """Lock the folder until this process ends; without such locks, the primary key still keeps rows unique."""
    try:
        return lock_folder(folder)
    except BlockingIOError:
        problem = "is being written by another sweep; wait for it, or choose another folder with --out."
        raise make_error(folder, problem) from None
    except OSError as error:
        raise _make_write_error(folder, error.strerror or str(error)) from error


@contextlib.contextmanager
def translated_errors(folder: Path) -> Iterator[None]:
    """Run database operations; errors of SQLite become errors with a message for the user."""
    try:
        yield
    except sqlite3.IntegrityError as error:
        raise OutputError(Issue(str(folder), f"already has a row that was to be written ({error}).")) from error
    except sqlite3.DatabaseError as error:
        text = str(error)
        if "disk is full" in text or "disk I/O error" in text:
            remedy = "free some space, then continue with --resume. The rows written so far are safe"
            raise OutputError(Issue(str(folder), f"cannot be written any further ({text}); {remedy}.")) from error
        if "locked" in text:
            raise make_error(folder, f"is in use by another program ({text}); ask again when it has ended.") from error
        if "not a database" in text or "malformed" in text or "no such table" in text:
            problem = f"is not the database of a sweep ({text}); choose another folder with --out."
            raise make_error(folder / FILE, problem) from error
        if isinstance(error, sqlite3.DataError) or "Could not decode" in text:
            raise make_damage_error(folder, f"a text in it cannot be read ({text})") from error
        if "interrupted" in text:  # by the handler of `connect`
            raise make_damage_error(folder, "it has more definitions than a sweep") from error
        raise _make_write_error(folder, text) from error


def make_error(path: Path, message: str) -> SweepError:
    return SweepError(Issue(str(path), message))


def make_damage_error(folder: Path, what: str) -> SweepError:
    remedy = "restore it from a copy, or run the sweep again in another folder."
    return make_error(folder / FILE, f"is damaged: {what}; {remedy}")


def _make_write_error(folder: Path, reason: str) -> OutputError:
    return OutputError(Issue(str(folder), f"cannot be written ({reason}); choose another folder with --out."))
