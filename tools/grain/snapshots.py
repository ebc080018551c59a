"""Modules and pages of the checkout as it stands, and of a commit, read without the work tree."""

from __future__ import annotations

import io
import subprocess
import tarfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from tools.grain import GrainError

FOLDERS = ("src/fingertip", "tools", "benchmarks", "tests")
"""Folders whose modules are counted."""
PAGES = ("README.md", "docs")
"""Page, and folder of pages, whose words are counted."""
LIST_FILES = ("ls-files", "-z", "--cached", "--others", "--exclude-standard")
"""Words of git that list the files it knows or would add."""


@dataclass(frozen=True)
class Snapshot:
    """Modules and pages at one time."""

    name: str
    texts: Mapping[str, str]
    """Path from the top of the checkout -> text."""

    def select(self, place: str) -> dict[str, str]:
        """Select the texts in a folder and below it, or the one at a path."""
        return {path: text for path, text in self.texts.items() if is_in(path, place)}


def is_in(path: str, place: str) -> bool:
    """Return whether a path is a place, or lies below it."""
    return PurePosixPath(path).is_relative_to(place)


def is_counted(path: str) -> bool:
    """Return whether a file is a module or a page that is counted."""
    places = FOLDERS if path.endswith(".py") else PAGES
    return path.endswith((".py", ".md")) and any(is_in(path, place) for place in places)


def read_checkout(root: Path) -> Snapshot:
    """Read the files that git knows or would add, as they stand."""
    listed = run_git(root, LIST_FILES)
    paths = sorted(path for path in listed.decode().split("\0") if is_counted(path))
    files = {path: root / path for path in paths}
    return Snapshot(
        name="now",
        texts={path: file.read_text("utf-8") for path, file in files.items() if file.is_file()},
    )


def read_commit(root: Path, commit: str) -> Snapshot:
    """Read the files of a commit or a tag."""
    try:
        archive = run_git(root, ["archive", "--format=tar", "--end-of-options", commit])
    except GrainError as error:
        remedy = "name one that `git log` lists, as in --beside HEAD"
        raise GrainError(f"this checkout has no commit {commit!r}; {remedy}") from error

    texts = {}
    with tarfile.open(fileobj=io.BytesIO(archive)) as files:
        for member in files:
            if member.isfile() and is_counted(member.name):
                content = files.extractfile(member)
                texts[member.name] = content.read().decode("utf-8") if content else ""
    return Snapshot(commit, texts)


def find_last_release(root: Path) -> str | None:
    """Find the newest tag of a release; None if there is none."""
    tags = run_git(root, ["tag", "--list", "v*", "--sort=-creatordate"]).decode().split()
    return tags[0] if tags else None


def run_git(root: Path, words: Sequence[str]) -> bytes:
    """Return what git prints."""
    done = subprocess.run(["git", *words], cwd=root, capture_output=True, check=False)
    if done.returncode != 0:
        said = done.stderr.decode(errors="replace").strip()
        raise GrainError(f"`git {' '.join(words)}` failed: {said}")
    return done.stdout
