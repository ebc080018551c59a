"""Comparison of an output folder with a design: its parameters, program and checksums.

Checksums and parameters are compared in a fraction of a second. Where another version of the
program made the parts, only making them again can tell whether they would be the same.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fingertip.cad.files.part_formats import PART_FORMATS
from fingertip.cad.program import digest_program
from fingertip.catalogues.output_files import (
    DESIGN,
    PART_FILES,
    REPORT,
    SET_FILES,
    SIGNAL_FOLDER,
)
from fingertip.design import Design
from fingertip.design.design_file import flatten, format_value, load_tables
from fingertip.design.finger_set import FingerSet
from fingertip.foundation.errors import FingertipError, InputFileError, Issue, OutputError
from fingertip.foundation.output_set import (
    MANIFEST,
    Manifest,
    has_hash,
    hash_parameters,
    read_manifest,
)
from fingertip.models.parts import parts_by_name
from fingertip.tasks.manifest_comparison import verify_sets
from fingertip.tasks.report_file import read_json_file

DEFAULT_TOLERANCE_MM = 0.01
"""Tolerance of the meshes of a build that names none [mm]."""
_SHOWN = 5
"""Number of changed parameters that are named."""


@dataclass(frozen=True)
class FolderComparison:
    """Result of the comparison of a folder."""

    files: int
    """Number of files whose checksums were compared."""
    faults: tuple[str, ...]
    """Problems and their remedies; empty if these are the design's files."""
    design: Design | FingerSet | None = None
    """Design or set that the folder was compared with; None if it is that of none."""
    command: str = ""
    """Command that makes the folder again; empty if no single one does."""
    words: tuple[str, ...] = ()
    """Options with which the folder was made, and --force if files in it were changed."""
    doubt: str = ""
    """Reason why this program might make other parts despite equal checksums; empty if none."""


def compare_folder(
    candidates: Sequence[Design | FingerSet], folder: Path, parts: Collection[str] | None = None
) -> FolderComparison:
    """Compare a folder with the design or set, of those given, that it was made from.

    A folder of parts must hold these parts, or all of the design. Raises OutputError if no command
    wrote the folder.
    """
    manifest = read_manifest(folder)
    if manifest is None:
        raise OutputError(Issue(str(folder), _describe_no_manifest(folder)))

    count, changed = verify_sets(folder)
    design = _choose(candidates, manifest)
    if design is None:
        names = " and ".join(candidate.name for candidate in candidates)
        fault = (
            f"{folder}: holds the {manifest.kind} of {manifest.design!r}, not of {names}; give "
            "its own design."
        )
        return FolderComparison(count, (*changed, fault))

    faults = [
        *changed,
        *(issue.typed for issue in _find_other_parameters(design, folder, manifest)),
    ]
    words = ("--force",) if changed else ()
    if isinstance(design, FingerSet):
        faults += _compare_forms(design, folder)
        return FolderComparison(
            files=count,
            faults=tuple(faults),
            design=design,
            command="make",
            words=words,
        )

    if manifest.kind != PART_FILES.kind:
        command = manifest.kind if manifest.kind in ("board", "firmware", "robot") else ""
        return FolderComparison(
            files=count,
            faults=tuple(faults),
            design=design,
            command=command,
            words=words,
        )

    faults += _find_missing_parts(design, folder, manifest, parts)
    faults += _find_other_prints(folder)
    command = "make" if (folder / SIGNAL_FOLDER / MANIFEST).is_file() else "build"
    doubt = _doubt(folder) if manifest.program != digest_program() else ""

    return FolderComparison(
        files=count,
        faults=tuple(faults),
        design=design,
        command=command,
        words=(*_list_options(folder, manifest, command, parts), *words),
        doubt=doubt,
    )


def _describe_no_manifest(folder: Path) -> str:
    if not folder.is_dir():
        return "does not exist; build the design there, or give the folder that holds its files."
    if (folder / MANIFEST).exists():
        return (
            f"has a {MANIFEST} that fingertip did not write, or that was changed since; make "
            "the files again."
        )

    return (
        f"has no {MANIFEST} of fingertip; give the folder that build, make or another command "
        "wrote."
    )


def _choose(
    candidates: Sequence[Design | FingerSet], manifest: Manifest
) -> Design | FingerSet | None:
    """Choose the design of a folder: that of the same parameters, else that of the same name."""
    is_set = manifest.kind == SET_FILES.kind
    designs = list[Design | FingerSet](candidates)
    for candidate in candidates:
        if isinstance(candidate, FingerSet):
            designs += [form.design for form in candidate.forms]

    of_kind = [design for design in designs if isinstance(design, FingerSet) == is_set]
    for design in of_kind:
        if hash_parameters(design.identity()) == manifest.parameters:
            return design

    return next((design for design in of_kind if design.name == manifest.design), None)


def _find_missing_parts(
    design: Design, folder: Path, manifest: Manifest, parts: Collection[str] | None
) -> Iterator[str]:
    """Yield a sentence if required parts of a design are missing."""
    required = [name for name in parts_by_name(design) if parts is None or name in parts]
    missing = [
        name for name in required if not any(file.startswith(f"{name}.") for file in manifest.files)
    ]

    if missing:
        present = [name for name in parts_by_name(design) if name not in missing]
        some = f", or give --parts {','.join(present)} to build --check" if present else ""
        yield f"{folder}: was made without {', '.join(missing)}; make the parts again{some}."


def _list_options(
    folder: Path, manifest: Manifest, command: str, parts: Collection[str] | None
) -> tuple[str, ...]:
    """List the options of `build` or `make` with which the parts in a folder were made."""
    formats = [
        name
        for name, part_format in PART_FORMATS.items()
        if any(file.endswith(part_format.suffix) for file in manifest.files)
    ]
    words = ["--formats", ",".join(formats)] if formats else []
    if command == "make":
        return tuple(words)

    if parts is not None:
        words += ["--parts", ",".join(parts)]

    try:
        tolerance_mm = read_json_file(folder / REPORT, folder).get("tolerance_mm")
    except InputFileError:
        tolerance_mm = None

    if isinstance(tolerance_mm, float) and tolerance_mm != DEFAULT_TOLERANCE_MM:
        words += ["--tolerance-mm", f"{tolerance_mm:g}"]

    return tuple(words)


def _compare_forms(fingers: FingerSet, folder: Path) -> Iterator[str]:
    """Compare the folder of each form of a set."""
    for form in fingers.forms:
        place = folder / form.design.name
        if not place.is_dir():
            yield f"{place}: is missing; make the set again."
            continue

        comparison = compare_folder([form.design], place)
        yield from comparison.faults
        if comparison.doubt:
            yield comparison.doubt


def _doubt(folder: Path) -> str:
    return (
        f"{folder}: was made by another version of this program or of its libraries; add --verify, "
        "which makes STL and 3MF again and compares them, or make the parts again."
    )


# Parameters
# ----------


def _find_other_parameters(
    design: Design | FingerSet, folder: Path, manifest: Manifest
) -> Iterator[Issue]:
    """Yield an issue with the parameters that differ from those of the folder."""
    if manifest.parameters == hash_parameters(design.identity()):
        return

    before = _read_parameters(folder)
    changed = [
        f"{name}: {format_value(value)} in the design, {format_value(before[name])} in the folder"
        for name, value in flatten(design.identity())
        if name in before and before[name] != value
    ]
    if not changed:
        yield Issue(
            str(folder), f"was made from other parameters of {manifest.design!r}; make it again."
        )
        return

    more = f", and {len(changed) - _SHOWN} more" if len(changed) > _SHOWN else ""
    names = "; ".join(changed[:_SHOWN]) + more
    yield Issue(str(folder), f"was made from other parameters ({names}); make it again.")


def _read_parameters(folder: Path) -> Mapping[str, Any]:
    """Read the parameters of a folder; none without a design file of this release."""
    try:
        loaded = load_tables([folder / DESIGN], (), below=folder)
        return dict(flatten(Design.from_tables(loaded.tables).identity()))
    except FingertipError:
        return {}


# Files as they lie on the bed
# ----------------------------


def _find_other_prints(folder: Path) -> Iterator[str]:
    """Yield the files for the printer that differ from the folder's report."""
    try:
        report = read_json_file(folder / REPORT, folder)
    except InputFileError:
        return  # the manifest says so already

    prints = report.get("print")
    for name, entry in prints.items() if isinstance(prints, dict) else ():
        digest = entry.get("sha256") if isinstance(entry, dict) else None
        if not has_hash(folder / name, digest):
            yield f"{folder / name}: is not the file of {folder / REPORT}; make the parts again."
