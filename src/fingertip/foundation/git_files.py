"""Files as they were at a revision of git."""

from __future__ import annotations

import subprocess
from pathlib import Path

from fingertip.foundation.errors import InputFileError, Issue

_LIMIT_S = 30.0


def read_at_revision(revision: str, path: Path) -> bytes:
    """Read a file of a git repository as it was at a revision, such as `main` or `HEAD~1`.

    Raises InputFileError.
    """
    folder = path.parent
    options = ("--verify", "--quiet", "--end-of-options")
    commit = _run_git(folder, "rev-parse", *options, f"{revision}^{{commit}}")

    if commit is None:
        message = (
            "is no design file, no folder, no bundled name, and no revision that git knows in "
            f"{folder}; give one of "
            "these."
        )
        raise InputFileError(Issue(revision, message))

    data = _run_git(folder, "show", f"{commit.decode().strip()}:./{path.name}")
    if data is None:
        message = f"has no file {path}; commit it first, or give a revision in which it exists."
        raise InputFileError(Issue(revision, message))

    return data


def _run_git(folder: Path, *words: str) -> bytes | None:
    """Run git in a folder; None if it fails. Raises InputFileError if git cannot be run."""
    command = ["git", "-C", str(folder), *words]
    try:
        done = subprocess.run(command, capture_output=True, check=False, timeout=_LIMIT_S)
    except (OSError, subprocess.TimeoutExpired) as error:
        message = f"cannot be run ({error}); install git, or compare two design files."
        raise InputFileError(Issue("git", message)) from None

    return done.stdout if done.returncode == 0 else None
