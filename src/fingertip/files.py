"""Outputs appear whole or not at all: everything is written aside and renamed into place at the end."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Mapping
from pathlib import Path

from fingertip.errors import Fault, OutputError


def write_whole(folder: Path, contents: Mapping[str, bytes]) -> None:
    """Write several files into one folder so that each appears whole, and none before all could be written.

    Parameters
    ----------
    folder
        Made if missing, with its parents.
    contents
        File name -> bytes. Existing files of these names are replaced, others are left alone.

    Raises
    ------
    OutputError
        If the folder or a file cannot be written; nothing that was there has changed then.
    """
    _write(folder, contents, str(folder), "choose another folder with --out")


def write_file(path: Path, data: bytes, option: str = "--out") -> None:
    """Write one file whole; `option` is the command's word for where it goes, for the error's remedy.

    Raises
    ------
    OutputError
        If it cannot be written; what was there has not changed then.
    """
    if path.is_dir():
        raise OutputError(Fault(str(path), f"is a folder; give {option} the name of a file."))
    _write(path.parent, {path.name: data}, str(path), f"choose another file with {option}")


def _write(folder: Path, contents: Mapping[str, bytes], field: str, remedy: str) -> None:
    made = _missing_folders(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        # Written aside on the same file system: a rename across two is not atomic.
        with tempfile.TemporaryDirectory(prefix=".fingertip-", dir=folder) as name:
            aside = Path(name)
            for file, data in contents.items():
                (aside / file).write_bytes(data)
            for file in contents:
                os.replace(aside / file, folder / file)
    except OSError as error:
        for path in made:
            with contextlib.suppress(OSError):
                path.rmdir()
        reason = error.strerror or str(error)
        raise OutputError(Fault(field, f"cannot be written ({reason}); {remedy}.")) from error


def _missing_folders(folder: Path) -> list[Path]:
    """The folders that have to be made for `folder` to exist, innermost first."""
    return [path for path in (folder, *folder.parents) if not path.exists()]
