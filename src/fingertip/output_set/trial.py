"""Trial of a place: whether a file can be written there is found out by writing one, before any work starts."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from fingertip.errors import Issue
from fingertip.output_set.lock import lock
from fingertip.output_set.replacement import try_to_write

_NAME = "trial"


def find_place_issues(folder: Path, remedy: str, name: str = _NAME) -> Iterator[Issue]:
    """Find out whether a file can be written to a folder, and leave nothing behind.

    A mode says little: root may write everywhere, but to `/proc` or a disk that is mounted read-only nobody can.

    Parameters
    ----------
    folder
        The folder, which may be missing, and its parents too.
    remedy
        End of the sentence, such as "choose another folder with --out".
    name
        Name of the file, which may be longer than the disk permits.
    """
    target = Path(os.path.realpath(folder))
    try:
        place = _find_existing(target)
        # Another command may be about to swap this folder, and would take what is made here for somebody's files.
        with lock(place.parent):
            try_to_write(place, target.relative_to(place) / name)
    except PermissionError:
        yield Issue(str(_find_existing(folder)), f"may not be written; change its mode, or {remedy}.")
    except OSError as error:
        path = folder if name == _NAME else folder / name
        yield Issue(str(path), f"cannot be written ({error.strerror or error}); {remedy}.")


def _find_existing(folder: Path) -> Path:
    """Find a folder, or the nearest one above it that exists."""
    return next((path for path in (folder, *folder.parents) if os.path.lexists(path)), folder)
