"""Comparison of a folder of parts with a design: were these files made from it, by this program, and are they whole?

Sums of files and parameters are compared in a fraction of a second. Where another version of the program made the
parts, only making them again can tell whether they would be the same.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fingertip.cad.program import digest_program
from fingertip.catalogues.output_files import DESIGN, PART_FILES, SIGNAL_FOLDER
from fingertip.design import Design
from fingertip.design.files import format_value, load_tables
from fingertip.design.parameters import PARAMETERS
from fingertip.foundation.errors import FingertipError, Issue, OutputError
from fingertip.foundation.output_set import MANIFEST, Manifest, hash_parameters, read_manifest
from fingertip.tasks.verification import verify_sets

_SHOWN = 5
"""Number of changed parameters that are named."""


@dataclass(frozen=True)
class FolderComparison:
    """What was found in a folder of parts."""

    folder: Path
    files: int
    """Number of files that were compared with their sums."""
    faults: tuple[str, ...]
    """What is wrong, in sentences that end with what to do; empty if these are the parts of the design."""
    doubt: str
    """Why equal sums do not tell that this program would make the same parts; empty if they do."""
    made_by: str
    """Command that makes the folder: `build` or `make`."""


def compare_folder(design: Design, folder: Path) -> FolderComparison:
    """Compare a folder that `build` or `make` wrote with a design. Raises OutputError if it holds no parts."""
    manifest = read_manifest(folder)
    if manifest is None or manifest.kind != PART_FILES.kind:
        message = f"holds no parts, for want of a {MANIFEST} that says so; build the design there first."
        raise OutputError(Issue(str(folder), message))

    count, faults = verify_sets(folder)
    faults += [issue.typed for issue in _find_other_design(design, folder, manifest)]

    doubt = ""
    if not faults and manifest.program != digest_program():
        message = (
            f"was made by another version of this program ({manifest.fingertip}), or with other versions of its "
            "libraries; add --verify, which makes STL and 3MF again and compares them, or make the parts again."
        )
        doubt = Issue(str(folder), message).typed

    made_by = "make" if (folder / SIGNAL_FOLDER / MANIFEST).is_file() else "build"
    return FolderComparison(folder, count, tuple(faults), doubt, made_by)


def _find_other_design(design: Design, folder: Path, manifest: Manifest) -> Iterator[Issue]:
    """Find the parameters in which the design differs from the one that the folder was made from."""
    if manifest.parameters == hash_parameters(design.identity()):
        return

    before = _read_values(folder)
    changed = [
        f"{name} is {format_value(value)}, and was {format_value(before[name])}"
        for name, value in _list_values(design).items()
        if name in before and before[name] != value
    ]
    if not changed:
        yield Issue(str(folder), f"holds the parts of another {manifest.design!r}; make them again.")
        return

    more = f", and {len(changed) - _SHOWN} more" if len(changed) > _SHOWN else ""
    listed = "; ".join(changed[:_SHOWN]) + more
    yield Issue(str(folder), f"holds parts that were made from other parameters ({listed}); make them again.")


def _read_values(folder: Path) -> dict[str, Any]:
    """Read the parameters that a folder states; none if its design file cannot be used any more."""
    try:
        loaded = load_tables([folder / DESIGN], (), below=folder)
        return _list_values(Design.from_tables(loaded.tables))
    except FingertipError:
        return {}


def _list_values(design: Design) -> dict[str, Any]:
    return {path: design.value(path) for path in PARAMETERS}
