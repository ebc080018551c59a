"""Single output files: atomic writing, and rounding of the numbers written.

A file is written under a temporary name and renamed at the end, so that it appears complete or not at all. What one
command writes as several files is a set (`fingertip.output_set`).
"""

from __future__ import annotations

import contextlib
import itertools
import os
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from fingertip.errors import Issue, OutputError

_PREFIX = ".fingertip-"
"""Beginning of the name of an unfinished file; the number of its process and its own follow."""
_numbers = itertools.count()


def write_file(path: Path, data: bytes, option: str = "--out") -> None:
    """Write one file atomically.

    Parameters
    ----------
    path
        Output file.
    data
        Content of the file.
    option
        Command-line option that names the file. The error message refers to it.

    Raises
    ------
    OutputError
        If the file cannot be written. An existing file is then unchanged.
    """
    with open_atomic(path, option) as file:
        file.write(data)


@contextlib.contextmanager
def open_atomic(path: Path, option: str = "--out") -> Iterator[BinaryIO]:
    """Open a file to write piece by piece, for data that does not fit in memory.

    The file appears when the `with` block ends. After an error within the block an existing file is unchanged.

    Parameters
    ----------
    path
        Output file.
    option
        Command-line option that names the file. The error message refers to it.

    Raises
    ------
    OutputError
        If the file cannot be written.
    """
    if path.is_dir():
        raise OutputError(Issue(str(path), f"is a folder; give {option} the name of a file."))
    created = [folder for folder in (path.parent, *path.parent.parents) if not folder.exists()]
    temporary = path.with_name(f"{_PREFIX}{os.getpid()}-{next(_numbers)}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        _remove_leftovers(path.parent)
        try:
            temporary.unlink(missing_ok=True)
            with temporary.open("xb") as file:  # never through a link of that name
                yield file
            os.replace(temporary, path)
        finally:
            temporary.unlink(missing_ok=True)
    except BaseException as error:
        for folder in created:
            with contextlib.suppress(OSError):
                folder.rmdir()
        if not isinstance(error, OSError):
            raise
        reason = error.strerror or str(error)
        message = f"cannot be written ({reason}); choose another file with {option}."
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

    The last bits of a sum differ between processors; six decimals do not. Negative zero becomes zero; infinity and NaN
    are returned as they are.
    """
    return round(float(value), 6) + 0.0
