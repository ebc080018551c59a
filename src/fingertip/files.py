"""Outputs appear whole or not at all: everything is written aside and renamed into place at the end."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Iterator, Mapping
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
    with _aside(folder) as aside:
        for name, data in contents.items():
            (aside / name).write_bytes(data)
        for name in contents:
            os.replace(aside / name, folder / name)


@contextlib.contextmanager
def _aside(folder: Path) -> Iterator[Path]:
    """A folder on the same file system as `folder` (a rename across two is not atomic), gone afterwards."""
    made = _missing_folders(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=".fingertip-", dir=folder) as name:
            yield Path(name)
    except OSError as error:
        for path in made:
            with contextlib.suppress(OSError):
                path.rmdir()
        reason = error.strerror or str(error)
        raise OutputError(
            Fault(str(folder), f"cannot be written ({reason}); choose another folder with --out.")
        ) from error


def _missing_folders(folder: Path) -> list[Path]:
    """The folders that have to be made for `folder` to exist, innermost first."""
    return [path for path in (folder, *folder.parents) if not path.exists()]
