"""Single output files and temporary folders: atomic writing, rounding of the numbers written, and
locks of folders.

A file is written under a temporary name and renamed at the end, so that it appears complete or not
at all. What one command writes as several files is a set (`fingertip.foundation.output_set`).

A temporary folder is removed when its `with` block ends, at an interruption too. The folders of a
process that was killed are removed by the next one that makes a folder. Each process holds a lock
on its folders, which ends with it. The number of a process in the name would mislead where
containers share the folder of temporary files.
"""

from __future__ import annotations

import contextlib
import csv
import io
import itertools
import json
import math
import os
import shutil
import tempfile
import zipfile
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, BinaryIO

from fingertip.foundation.errors import Issue, OutputError

_PREFIX = ".fingertip-"
"""Beginning of the name of an unfinished file; the number of its process and its own follow."""
_numbers = itertools.count()


def encode_json(data: object) -> bytes:
    """Write data as the text of a JSON file.

    Raises ValueError for numbers that JSON does not know.
    """
    return (json.dumps(data, indent=2, allow_nan=False) + "\n").encode()


def write_file(path: Path, data: bytes, option: str = "--out") -> None:
    """Write a file at once. Raises OutputError, whose remedy names the option."""
    with open_atomic(path, option) as file:
        file.write(data)


class _RawFile(io.FileIO):
    """File whose name stands in errors of writing; those of `io.FileIO` have no name."""

    def write(self, data: Any, /) -> int:
        try:
            return super().write(data)
        except OSError as error:
            error.filename = self.name
            raise


ZIP_DATE = 1980, 1, 1, 0, 0, 0
"""Date of what is packed, so that the same files give the same bytes."""


def write_zip(path: Path, folder: Path) -> None:
    """Write the files of a folder, but no links, as one ZIP archive without dates.

    Raises OutputError.
    """
    files = [
        file
        for file in sorted(folder.rglob("*"))
        if file.is_file() and not file.is_symlink() and file != path
    ]
    with open_atomic(path, "--zip") as opened, zipfile.ZipFile(opened, "w") as archive:
        for file in files:
            name = f"{folder.resolve().name}/{file.relative_to(folder).as_posix()}"
            member = zipfile.ZipInfo(name, ZIP_DATE)
            archive.writestr(member, file.read_bytes(), zipfile.ZIP_DEFLATED)


@contextlib.contextmanager
def open_atomic(path: Path, option: str = "--out") -> Iterator[BinaryIO]:
    """Open a file to write piece by piece, for data that does not fit in memory.

    The file appears when the `with` block ends. After an error within the block an existing file is
    unchanged.

    Raises OutputError.
    """
    if path.is_dir():
        raise OutputError(Issue(str(path), f"is a folder; give {option} the name of a file."))

    created = [folder for folder in (path.parent, *path.parent.parents) if not folder.exists()]
    temporary = path.with_name(f"{_PREFIX}{os.getpid()}-{next(_numbers)}")
    own = {temporary, *path.parents}

    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        _remove_leftovers(path.parent)
        try:
            temporary.unlink(missing_ok=True)
            # The mode "x" follows no link of that name.
            with io.BufferedWriter(_RawFile(temporary, "x")) as file:
                yield file

            os.replace(temporary, path)
        finally:
            temporary.unlink(missing_ok=True)
    except BaseException as error:
        for folder in created:
            with contextlib.suppress(OSError):
                folder.rmdir()

        is_of_this_file = (
            isinstance(error, OSError)
            and error.filename is not None
            and Path(error.filename) in own
        )
        if not isinstance(error, OSError) or not is_of_this_file:
            raise  # the error of the `with` block

        message = (
            f"cannot be written ({error.strerror or str(error)}); choose another file with "
            f"{option}."
        )
        raise OutputError(Issue(str(path), message)) from error


def _remove_leftovers(folder: Path) -> None:
    """Remove unfinished files of processes that were killed."""
    for path in folder.glob(f"{_PREFIX}*"):
        process = path.name.removeprefix(_PREFIX).partition("-")[0]
        if process.isascii() and process.isdecimal() and not _is_running(int(process)):
            with contextlib.suppress(OSError):
                path.unlink()


def _is_running(process: int) -> bool:
    try:
        os.kill(process, 0)
    except (ProcessLookupError, OverflowError):  # or no number of a process
        return False
    except OSError:  # it belongs to somebody else
        return True

    return True


def round_for_output(value: float) -> float:
    """Round a number to six decimals before it is written to a report or table.

    The last bits of a sum differ between processors; six decimals do not. Negative zero becomes
    zero; infinity and NaN are returned as they are.
    """
    return round(float(value), 6) + 0.0


def format_csv(columns: Iterable[str], rows: Iterable[Iterable[object]]) -> bytes:
    """Return a table as the content of a CSV file."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows((columns, *rows))
    return text.getvalue().encode()


_FOLDER_PREFIX = "fingertip-tmp-"


@contextlib.contextmanager
def temporary_folder() -> Iterator[Path]:
    """Make a folder for this process and its children. Raises OutputError."""
    path, lock = _make_locked()
    try:
        yield path
    finally:
        shutil.rmtree(path, ignore_errors=True)
        if lock is not None:
            os.close(lock)


def _make_locked() -> tuple[Path, int | None]:
    try:
        place = Path(tempfile.gettempdir())
    except OSError as error:
        message = "no folder for temporary files can be written; set it to one that can be."
        raise OutputError(Issue("TMPDIR", message)) from error

    remove_leftovers(place)
    while True:
        try:
            path = Path(tempfile.mkdtemp(prefix=_FOLDER_PREFIX, dir=place))
        except OSError as error:
            reason = error.strerror or str(error)
            message = (
                f"cannot be written ({reason}); free some space there, or set TMPDIR to "
                "another folder."
            )
            raise OutputError(Issue(str(place), message)) from error

        # Another process may take the new folder for a leftover before it is locked.
        with contextlib.suppress(FileNotFoundError, BlockingIOError):
            lock = lock_folder(path)
            if path.is_dir() if lock is None else _is_at(path, lock):
                return path, lock
            if lock is not None:
                os.close(lock)


def remove_leftovers(place: Path) -> None:
    """Remove the temporary folders that killed processes have left in a place."""
    with contextlib.suppress(OSError):
        for entry in list(os.scandir(place)):
            if entry.name.startswith(_FOLDER_PREFIX):
                with contextlib.suppress(OSError):
                    _remove_leftover(Path(entry.path))


def _remove_leftover(path: Path) -> None:
    if path.is_symlink() or not path.is_dir():
        return

    lock = lock_folder(path)
    if lock is not None:  # on Windows leftovers stay
        try:
            shutil.rmtree(path, ignore_errors=True)
        finally:
            os.close(lock)


def lock_folder(folder: Path, *, shared: bool = False) -> int | None:
    """Lock a folder until the handle is closed or the process ends.

    None where the system has no such locks.

    Raises BlockingIOError if another process holds a lock, and OSError if the folder cannot be
    opened.
    """
    try:
        import fcntl  # noqa: PLC0415
    except ImportError:  # Windows
        return None

    handle = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(handle, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(handle)
        raise
    except OSError:  # a file system without locks
        os.close(handle)
        return None

    return handle


def _is_at(path: Path, handle: int) -> bool:
    try:
        return os.path.samestat(os.stat(path), os.fstat(handle))
    except OSError:
        return False


def format_figure(value: float, digits: int = 4) -> str:
    """Format a number with so many significant digits and no exponent."""
    if not value or not math.isfinite(value):
        return f"{value + 0.0:g}"  # 0 has no sign

    decimals = digits - 1 - math.floor(math.log10(abs(float(f"{value:.{digits - 1}e}"))))
    return f"{round(value, decimals):.{max(decimals, 0)}f}"
