"""Comparison of sets of files with their manifests."""

from __future__ import annotations

from pathlib import Path

from fingertip.errors import Issue, OutputError
from fingertip.output_set.lock import lock, output_errors
from fingertip.output_set.manifest import MANIFEST, hash_file, read_manifest
from fingertip.output_set.replacement import find_unfinished, recover

_OF_ONE_DESIGN = ("parts", "print", "steps", "board", "fabrication", "signal", "firmware")
"""Kinds of sets in the folder of a design, which belong together if they were made from the same parameters."""


def verify_sets(folder: Path) -> tuple[int, list[str]]:
    """Compare the sets in a folder and its subfolders with their manifests.

    Returns
    -------
    count
        Number of files that manifests list.
    differences
        Description of each file that is missing or was changed; empty if there is none.

    Raises
    ------
    OutputError
        If there is no manifest.
    """
    with output_errors(folder):
        for place in find_unfinished(folder.resolve()):
            with lock(place.parent):  # a command that is still at work keeps what it has begun
                recover(place)
        with lock(folder.resolve().parent):
            return _compare(folder)


def _compare(folder: Path) -> tuple[int, list[str]]:
    manifests = {path.parent: read_manifest(path.parent) for path in sorted(folder.rglob(MANIFEST))}
    found = {place: manifest for place, manifest in manifests.items() if manifest}
    if not found:
        message = f"has no {MANIFEST} of fingertip; name a design file, or a folder that a command wrote."
        raise OutputError(Issue(str(folder), message))
    differences = []
    for place, manifest in found.items():
        for name, digest in manifest.files.items():
            path = place / name
            if not path.is_file():
                differences.append(f"{path}: is missing.")
            elif hash_file(path) != digest:
                differences.append(f"{path}: was changed after it was written.")
    top = found.get(folder)
    for place, manifest in found.items():
        if top and manifest.kind in _OF_ONE_DESIGN and manifest.parameters != top.parameters:
            differences.append(f"{place}: was made from other parameters than {folder}; make both again.")
    return sum(len(manifest.files) for manifest in found.values()), differences
