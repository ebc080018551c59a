"""Comparison of sets of files with their manifests, which changes nothing."""

from __future__ import annotations

import itertools
import os
from collections.abc import Mapping
from pathlib import Path

from fingertip.catalogues.output_files import PART_FILES, SET_FILES
from fingertip.foundation.errors import InputFileError, Issue, OutputError
from fingertip.foundation.folder_swap import (
    find_output_folder,
    is_folder,
    lock,
    read_plan,
    staging_folder,
)
from fingertip.foundation.input_files import OUTPUT_LIMIT, read_input
from fingertip.foundation.output_set import (
    MANIFEST,
    Manifest,
    fold_lines,
    has_hash,
    hash_file,
    read_manifest,
)

_OF_ONE_DESIGN = ("parts", "print", "steps", "board", "fabrication", "signal", "firmware", "robot")
"""Kinds of sets in a design's folder, which must have the same parameters."""
_MAX_DEPTH = 5
"""Depth of the search: from `out` to the board's models in a set of fingers."""
_MAX_ENTRIES = 50_000
"""Maximum number of files and folders in them."""


def verify_sets(folder: Path) -> tuple[int, list[str]]:
    """Compare the sets in a folder and its subfolders with their manifests.

    No link is followed. Raises OutputError.
    """
    outside = Path(os.path.realpath(folder)).parent
    try:
        for place in _look_through(folder)[1].values():
            # A command that is still at work ends first.
            with lock(outside if place == folder else place.parent, shared=True):
                pass

        with lock(outside, shared=True):
            return _compare(folder)
    except OSError as error:
        reason = error.strerror or str(error)
        message = f"cannot be read ({reason}); name a folder that a command wrote."
        raise OutputError(Issue(str(error.filename or folder), message)) from error


def compare_with_design(folder: Path, expected: Mapping[str, bytes]) -> list[str]:
    """Describe how files of a folder differ from those that a design gives; empty if equal."""
    differences: list[str] = []
    for name, data in expected.items():
        try:
            file_data = read_input(folder / name, OUTPUT_LIMIT, below=folder)
            if fold_lines(file_data) != fold_lines(data):
                differences.append(f"{folder / name}: differs from what this design gives.")
        except InputFileError as error:
            differences += (issue.typed for issue in error.issues)

    return differences


def _look_through(top: Path) -> tuple[list[Path], dict[Path, Path], list[Issue]]:
    """List a folder with those below it, outer ones first.

    With them come the folders that commands have left unfinished, each with the output folder that
    it belongs to, and issues of what cannot be read.
    """
    staging = staging_folder(Path(os.path.realpath(top)))
    unfinished = {staging: top} if is_folder(staging) else {}
    folders = list[Path]()
    issues = list[Issue]()
    deeper = [top]
    remaining = _MAX_ENTRIES

    for _ in range(_MAX_DEPTH + 1):
        level = deeper
        deeper = []
        for place in level:
            folders.append(place)
            try:
                with os.scandir(place) as entries:
                    some = itertools.islice(entries, remaining + 1)
                    listing = sorted(some, key=lambda entry: entry.name)
            except OSError as error:
                issues.append(
                    Issue(str(place), f"cannot be read ({error.strerror}); change its mode.")
                )
                continue

            remaining -= len(listing)
            if remaining < 0:
                message = (
                    f"holds more than {_MAX_ENTRIES} files and folders; name a folder that "
                    "a command wrote."
                )
                raise OutputError(Issue(str(top), message))

            for entry in listing:
                path = place / entry.name
                if entry.is_symlink() and (entry.name in _OF_ONE_DESIGN or path.is_dir()):
                    message = (
                        "is a link, not a folder, and is not followed; put the folder in "
                        "its place, or remove it."
                    )
                    issues.append(Issue(str(path), message))
                elif entry.is_dir(follow_symlinks=False):
                    output_folder = find_output_folder(path)
                    if output_folder:
                        unfinished[path] = output_folder
                    elif not entry.name.startswith("."):
                        deeper.append(path)

    return folders, unfinished, issues


def _compare(folder: Path) -> tuple[int, list[str]]:
    folders, unfinished, issues = _look_through(folder)
    issues += map(_describe_unfinished, unfinished)
    manifests = dict[Path, Manifest]()
    for place in folders:
        manifest = read_manifest(place) if os.path.lexists(place / MANIFEST) else None
        if manifest:
            manifests[place] = manifest
        elif os.path.lexists(place / MANIFEST):
            message = "was not written by fingertip, or was changed since; the set is not compared."
            issues.append(Issue(str(place / MANIFEST), message))

    if not manifests:
        message = (
            f"has no {MANIFEST} of fingertip; name a design file, or a folder that a command wrote."
        )
        raise OutputError([Issue(str(folder), message), *issues])

    for place, manifest in manifests.items():
        for name, digest in manifest.files.items():
            path = place / name
            try:
                if hash_file(path) != digest and not has_hash(path, digest):
                    issues.append(Issue(str(path), "was changed after it was written."))
            except InputFileError as error:
                missing = [Issue(str(path), "is missing.")]
                issues += error.issues if os.path.lexists(path) else missing

    for place, manifest in manifests.items():
        owner = _find_owner(place, folder, manifests)
        if owner and manifest.parameters != manifests[owner].parameters:
            message = f"was made from other parameters than {owner}; make both again."
            issues.append(Issue(str(place), message))

    count = sum(len(manifest.files) for manifest in manifests.values())
    return count, [issue.typed for issue in issues]


def _find_owner(place: Path, folder: Path, manifests: Mapping[Path, Manifest]) -> Path | None:
    """Return the set whose parameters another one must have: its design's; None without."""
    if manifests[place].kind not in _OF_ONE_DESIGN:
        return None

    for parent in place.parents:
        if parent in manifests and manifests[parent].kind == PART_FILES.kind:
            return parent

    if folder in manifests and manifests[folder].kind != SET_FILES.kind:
        return folder

    return None


def _describe_unfinished(path: Path) -> Issue:
    try:
        read_plan(path)
    except OutputError as error:
        return error.issues[0]

    message = (
        "was left by a command that was ended before it was done; the next command that "
        "writes there completes it."
    )
    return Issue(str(path), message)
