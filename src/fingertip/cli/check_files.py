"""What `fingertip check` and `build --check` find in folders and mesh files, as data and as text."""

from __future__ import annotations

import shlex
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fingertip.cli.check_tables import format_checks
from fingertip.cli.console import Console

if TYPE_CHECKING:
    from fingertip.design import Design


@dataclass(frozen=True)
class Found:
    """What was found in one folder or file."""

    data: Mapping[str, Any]
    text: str

    @property
    def passed(self) -> bool:
        """Return whether nothing was wrong."""
        return bool(self.data["passed"])


# --- mesh files -------------------------------------------------------------------------------------------------------


def check_meshes(paths: Sequence[Path], designs: Iterable[Design], tolerance_mm: float, verbose: bool) -> list[Found]:
    """Check mesh files, each against the part of the same name if one design is given."""
    from fingertip.cad.verification.mesh_files import check_mesh_files, describe_mesh_cause

    found = []
    for file in check_mesh_files(paths, designs, tolerance_mm):
        data = {
            "file": file.path.as_posix(),
            "part": file.part,
            "passed": file.passed,
            "checks": [check.to_dict() for check in file.checks],
        }
        causes = {check.name: describe_mesh_cause(file, check) for check in file.checks}
        found.append(Found(data, format_checks(file.path.as_posix(), file.checks, verbose, causes)))
    return found


# --- folders ----------------------------------------------------------------------------------------------------------


def check_folders(
    folders: Sequence[Path],
    designs: Mapping[Path, Sequence[Design]],
    changes: Sequence[str],
    remake: bool,
    console: Console,
) -> list[Found]:
    """Check folders: recordings for what they must hold, all others with their manifests and with their design.

    A folder of parts must be that of one of the designs, given by their files, if there are any.
    """
    return [_check_folder(folder, designs, changes, remake, console) for folder in folders]


def _check_folder(
    folder: Path, designs: Mapping[Path, Sequence[Design]], changes: Sequence[str], remake: bool, console: Console
) -> Found:
    from fingertip.bench.trials import DESIGN, list_trials
    from fingertip.catalogues.output_files import PART_FILES
    from fingertip.foundation.output_set import read_manifest

    if list_trials(folder) and (folder / DESIGN).exists():
        return _check_recordings(folder)

    manifest = read_manifest(folder)
    if manifest and manifest.kind == PART_FILES.kind and designs:
        pairs = [(file, design) for file, given in designs.items() for design in given]
        of_name = [pair for pair in pairs if pair[1].name == manifest.design]
        file, design = (of_name or pairs)[0]
        return compare_parts(design, folder, file, changes, remake, console)

    return _compare_sums(folder)


def _check_recordings(folder: Path) -> Found:
    from fingertip.bench.trials import check_recordings

    trials, faults, notes = check_recordings(folder)
    verdict = "must be mended before it is given away" if faults else "may be given away"
    data = {"folder": folder.as_posix(), "passed": not faults, "trials": trials, "faults": faults, "notes": notes}
    return Found(data, "\n".join([*faults, *notes, f"{folder}: {trials} trials; the folder {verdict}"]))


def _compare_sums(folder: Path) -> Found:
    from fingertip.tasks.verification import verify_sets

    files, differences = verify_sets(folder)
    verdict = f"{_count(len(differences), 'difference')}" if differences else "all are as written"
    data = {"folder": folder.as_posix(), "passed": not differences, "files": files, "differences": differences}
    return Found(data, "\n".join([*differences, f"{folder}: {files} files compared, {verdict}"]))


def compare_parts(
    design: Design, folder: Path, file: Path, changes: Sequence[str], remake: bool, console: Console
) -> Found:
    """Compare a folder of parts with the design of a file, and tell the command that makes it anew.

    With `remake`, the STL and 3MF files are made again and compared byte by byte.
    """
    from fingertip.tasks.part_folder import compare_folder

    found = compare_folder(design, folder)
    faults = [*found.faults]
    if remake and not faults:
        from fingertip.tasks.parts_again import compare_made_again

        console.progress("making the parts again")
        faults += compare_made_again(design, folder)
    elif found.doubt:
        faults.append(found.doubt)

    data: dict[str, Any] = {
        "folder": folder.as_posix(),
        "design": design.name,
        "passed": not faults,
        "files": found.files,
        "differences": faults,
    }
    if not faults:
        how = "STL and 3MF are the same, made again" if remake else "all are as written"
        return Found(data, f"{folder}: the parts of {design.name}; {found.files} files compared, {how}")

    settings = [word for change in changes for word in ("--set", change)]
    command = shlex.join(["fingertip", found.made_by, str(file), *settings, "--out", str(folder)])
    data["make_again"] = command
    verdict = f"{folder}: {found.files} files compared with {design.name}, {_count(len(faults), 'difference')}"
    return Found(data, "\n".join([*faults, verdict, f"next: {command}"]))


def _count(number: int, thing: str) -> str:
    return f"{number} {thing}{'' if number == 1 else 's'}"
