"""Output files: atomic writing, and rounding of the numbers written.

Files are written to a temporary folder and renamed into place at the end, so that each appears complete or not at all.
"""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import BinaryIO

from fingertip.errors import Issue, OutputError


def atomic_write(folder: Path, contents: Mapping[str, bytes], remove: Iterable[str] = ()) -> None:
    """Write several files to one folder: each appears complete, and none before all have been written.

    Parameters
    ----------
    folder
        Output folder. It is created if missing, with its parents.
    contents
        File name -> bytes. Existing files of these names are replaced, all others are left alone.
    remove
        Names of files that the new ones make obsolete. They are deleted once the new files are in place.

    Raises
    ------
    OutputError
        If the folder or a file cannot be written. Existing files are then unchanged.
    """
    _write(folder, contents, str(folder), "choose another folder with --out", remove)


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
    if path.is_dir():
        raise OutputError(Issue(str(path), f"is a folder; give {option} the name of a file."))
    _write(path.parent, {path.name: data}, str(path), f"choose another file with {option}")


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
    with _temporary_folder(path.parent, str(path), f"choose another file with {option}") as temporary:
        with (temporary / path.name).open("wb") as file:
            yield file
        os.replace(temporary / path.name, path)


def round_for_output(value: float) -> float:
    """Round a number to six decimals before it is written to a report or table.

    The last bits of a sum differ between processors; six decimals do not. Negative zero becomes zero; infinity and NaN
    are returned as they are.
    """
    return round(float(value), 6) + 0.0


def _write(folder: Path, contents: Mapping[str, bytes], field: str, remedy: str, remove: Iterable[str] = ()) -> None:
    with _temporary_folder(folder, field, remedy) as temporary:
        for file, data in contents.items():
            (temporary / file).write_bytes(data)
        for file in contents:
            os.replace(temporary / file, folder / file)
        for file in remove:
            (folder / file).unlink(missing_ok=True)


@contextlib.contextmanager
def _temporary_folder(folder: Path, field: str, remedy: str) -> Iterator[Path]:
    """Create a temporary folder inside `folder` for unfinished files.

    `folder` is created if missing. After an error the temporary folder and all folders created here are removed, and an
    `OSError` becomes an `OutputError` with `field` and `remedy`.
    """
    created = _missing_folders(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        # It lies in the output folder because a rename is atomic only within one file system.
        with tempfile.TemporaryDirectory(prefix=".fingertip-", dir=folder) as name:
            yield Path(name)
    except BaseException as error:
        for path in created:
            with contextlib.suppress(OSError):
                path.rmdir()
        if not isinstance(error, OSError):
            raise
        reason = error.strerror or str(error)
        raise OutputError(Issue(field, f"cannot be written ({reason}); {remedy}.")) from error


def _missing_folders(folder: Path) -> list[Path]:
    """List the folders that must be created for `folder` to exist, innermost first."""
    return [path for path in (folder, *folder.parents) if not path.exists()]
