"""Findings of `fingertip check` and `build --check` in folders and mesh files."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fingertip.cli.check_reports import CheckResult, Finding, NamedDesign, message
from fingertip.cli.check_tables import format_checks
from fingertip.cli.console import Console
from fingertip.foundation.errors import InputFileError, Issue

if TYPE_CHECKING:
    from fingertip.design import Design


# Mesh files
# ----------


def check_mesh(
    path: Path, designs: Sequence[NamedDesign], tolerance_mm: float, verbose: bool
) -> CheckResult:
    """Check a mesh file, and compare it with the part of the same name if a design is given.

    Raises InputFileError if there is no such part, or more than one design.
    """
    from fingertip.cad.verification.mesh_files import check_mesh_file, describe_mesh_cause

    design = _find_one_design(path, designs) if designs else None
    file = check_mesh_file(path, design, max(tolerance_mm, _read_tolerance_beside(path)))

    label = path.as_posix()
    compared = f"{label}, compared with {file.part} of {design.name}" if design else label
    causes = {check.name: describe_mesh_cause(file, check) for check in file.checks}
    data = {
        "file": label,
        "part": file.part,
        "passed": file.passed,
        "checks": [check.to_dict() for check in file.checks],
    }
    findings = tuple(
        Finding.make(path, Issue(check.name, f"{message(check)}; {causes[check.name]}"))
        for check in file.checks
        if not check.passed
    )

    return CheckResult(
        label=label,
        data=data,
        text=format_checks(compared, file.checks, verbose, causes),
        cases=file.checks,
        findings=findings,
    )


def _find_one_design(path: Path, references: Sequence[NamedDesign]) -> Design:
    """Find the design that a mesh is compared with, which must have a part of its name."""
    from fingertip.cad.verification.mesh_files import name_part
    from fingertip.design import Design
    from fingertip.models.parts import parts_by_name

    designs = [named.design for named in references if isinstance(named.design, Design)]

    if len(references) != 1 or not designs:
        raise InputFileError(
            Issue(str(path), "is compared with the design of one finger; give one, or none.")
        )

    names = list(parts_by_name(designs[0]))
    if name_part(path) not in names:
        message = (
            f"has the name of no part of {designs[0].name}; name it after its part "
            f"({', '.join(names)})."
        )
        raise InputFileError(Issue(str(path), message))

    return designs[0]


def _read_tolerance_beside(path: Path) -> float:
    """Read the tolerance of the parts beside a mesh [mm]; 0 if no report states one."""
    from fingertip.catalogues.output_files import PRINT_FOLDER, REPORT
    from fingertip.tasks.report_file import read_json_file

    folder = path.parent.parent if path.parent.name == PRINT_FOLDER else path.parent

    try:
        tolerance_mm = read_json_file(folder / REPORT, folder).get("tolerance_mm")
    except InputFileError:
        return 0.0

    return tolerance_mm if isinstance(tolerance_mm, float) and 0.0 < tolerance_mm <= 1.0 else 0.0


# Folders
# -------


def check_folder(
    folder: Path,
    designs: Sequence[NamedDesign],
    words: Sequence[str],
    remake: bool,
    console: Console,
) -> CheckResult:
    """Check a folder of recordings, or another with its manifests and the designs.

    `words` are the options of the command line that change the designs.
    """
    from fingertip.recorded_trials.trials import DESIGN, list_trials

    if list_trials(folder) and (folder / DESIGN).exists():
        return _check_recordings(folder)
    if designs:
        return compare_with_designs(
            folder,
            designs=designs,
            words=words,
            remake=remake,
            console=console,
        )

    return _compare_checksums(folder)


def _check_recordings(folder: Path) -> CheckResult:
    from fingertip.recorded_trials.trials import check_recordings

    trials, faults, notes = check_recordings(folder)
    verdict = "must be mended before it is given away" if faults else "may be given away"
    text = "\n".join([*faults, *notes, f"{folder}: {trials} trials; the folder {verdict}"])

    return _find_in_folder(
        folder, faults, text, {"trials": trials, "faults": faults, "notes": notes}
    )


def _compare_checksums(folder: Path) -> CheckResult:
    from fingertip.catalogues.output_files import REPORT
    from fingertip.foundation.output_set import MANIFEST
    from fingertip.tasks.manifest_comparison import verify_sets

    files, differences = verify_sets(folder)

    if (folder / REPORT).exists() and not (folder / MANIFEST).exists():
        differences.append(
            f"{folder}: has a {REPORT} and no {MANIFEST}, which lists the parts; make them again."
        )

    verdict = count(len(differences), "difference") if differences else "all are as written"
    text = "\n".join([*differences, f"{folder}: {count(files, 'file')} compared, {verdict}"])
    return _find_in_folder(folder, differences, text, {"files": files, "differences": differences})


def compare_with_designs(
    folder: Path,
    designs: Sequence[NamedDesign],
    words: Sequence[str],
    remake: bool,
    console: Console,
    parts: Sequence[str] | None = None,
) -> CheckResult:
    """Compare a folder with the design that it was made from, of those given.

    With `remake`, the STL and 3MF files are made again and compared byte by byte. A folder of parts
    must hold these `parts`, or all of the design.
    """
    from fingertip.design import Design
    from fingertip.tasks.part_folder import compare_folder

    comparison = compare_folder([named.design for named in designs], folder, parts)
    design = comparison.design
    faults = [*comparison.faults]
    is_made_again = False

    if remake and not faults and comparison.command and isinstance(design, Design):
        from fingertip.tasks.remade_parts import compare_made_again

        is_made_again = True
        console.progress("making the parts again")
        faults += compare_made_again(design, folder)
    elif comparison.doubt:
        faults.append(comparison.doubt)

    name = design.name if design else ""
    data: dict[str, Any] = {"design": name, "files": comparison.files, "differences": faults}
    files = count(comparison.files, "file")
    compared = f"{folder}: {files} compared with {name or 'the designs given'}"

    if not faults:
        how = "STL and 3MF are the same, made again" if is_made_again else "all are as written"
        return _find_in_folder(folder, faults, f"{compared}, {how}", data)

    lines = [*faults, f"{compared}, {count(len(faults), 'difference')}"]
    file = next((named.file for named in designs if named.design is design), None)
    if comparison.command and file:
        command = ["fingertip", comparison.command, str(file)]
        options = [*words, *comparison.words, "--out", str(folder)]
        data["make_again"] = shlex.join([*command, *options])
        lines.append(f"next: {data['make_again']}")

    return _find_in_folder(folder, faults, "\n".join(lines), data)


def _find_in_folder(
    folder: Path, faults: Sequence[str], text: str, data: dict[str, Any]
) -> CheckResult:
    """Collect the faults of a folder; without any, the reports have one case that passes."""
    from fingertip.cad.verification.check import Check

    label = folder.as_posix()
    issues = tuple(Issue("difference", fault) for fault in faults)
    cases = issues or (
        Check(
            name="differences",
            value=0,
            limit=0,
            unit="",
            relation="exactly",
        ),
    )
    findings = tuple(Finding.make(folder, issue) for issue in issues)

    return CheckResult(
        label=label,
        data={"folder": label, "passed": not faults, **data},
        text=text,
        cases=cases,
        findings=findings,
    )


def count(number: int, noun: str) -> str:
    """Write a number with its noun."""
    return f"{number} {noun}{'' if number == 1 else 's'}"
