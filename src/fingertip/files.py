"""Outputs appear whole or not at all: everything is written aside and renamed into place at the end."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import BinaryIO

from fingertip.errors import Issue, OutputError


def write_whole(folder: Path, contents: Mapping[str, bytes], outdated: Iterable[str] = ()) -> None:
    """Write several files into one folder so that each appears whole, and none before all could be written.

    Parameters
    ----------
    folder
        Made if missing, with its parents.
    contents
        File name -> bytes. Existing files of these names are replaced, others are left alone.
    outdated
        Names of files that the new ones make wrong: removed once those are in place.

    Raises
    ------
    OutputError
        If the folder or a file cannot be written; nothing that was there has changed then.
    """
    _write(folder, contents, str(folder), "choose another folder with --out", outdated)


def write_file(path: Path, data: bytes, option: str = "--out") -> None:
    """Write one file whole; `option` is the command's word for where it goes, for the error's remedy.

    Raises
    ------
    OutputError
        If it cannot be written; what was there has not changed then.
    """
    if path.is_dir():
        raise OutputError(Issue(str(path), f"is a folder; give {option} the name of a file."))
    _write(path.parent, {path.name: data}, str(path), f"choose another file with {option}")


@contextlib.contextmanager
def open_whole(path: Path, option: str = "--out") -> Iterator[BinaryIO]:
    """A file to write piece by piece, for what does not fit in memory; it appears whole when the block ends.

    An error within the block leaves what was there. `option` as in `write_file`.

    Raises
    ------
    OutputError
        If it cannot be written.
    """
    if path.is_dir():
        raise OutputError(Issue(str(path), f"is a folder; give {option} the name of a file."))
    with _aside(path.parent, str(path), f"choose another file with {option}") as aside:
        with (aside / path.name).open("wb") as file:
            yield file
        os.replace(aside / path.name, path)


def _write(folder: Path, contents: Mapping[str, bytes], field: str, remedy: str, outdated: Iterable[str] = ()) -> None:
    with _aside(folder, field, remedy) as aside:
        for file, data in contents.items():
            (aside / file).write_bytes(data)
        for file in contents:
            os.replace(aside / file, folder / file)
        for file in outdated:
            (folder / file).unlink(missing_ok=True)


@contextlib.contextmanager
def _aside(folder: Path, field: str, remedy: str) -> Iterator[Path]:
    """A place within `folder`, which is made, for what is not done yet. After an error nothing is left of it, nor of
    folders that were made; the system's errors become one sentence."""
    made = _missing_folders(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        # On the same file system: a rename across two is not atomic.
        with tempfile.TemporaryDirectory(prefix=".fingertip-", dir=folder) as name:
            yield Path(name)
    except BaseException as error:
        for path in made:
            with contextlib.suppress(OSError):
                path.rmdir()
        if not isinstance(error, OSError):
            raise
        reason = error.strerror or str(error)
        raise OutputError(Issue(field, f"cannot be written ({reason}); {remedy}.")) from error


def _missing_folders(folder: Path) -> list[Path]:
    """The folders that have to be made for `folder` to exist, innermost first."""
    return [path for path in (folder, *folder.parents) if not path.exists()]
