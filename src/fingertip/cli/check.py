"""Command `fingertip check`: verify designs, folders and meshes, in a terminal or in CI."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from fingertip.cli import options
from fingertip.cli.check_reports import (
    CheckResult,
    Finding,
    NamedDesign,
    message,
    to_junit,
    to_sarif,
)
from fingertip.cli.check_tables import describe_cause, format_checks, offer_fit
from fingertip.cli.console import BAD_INPUT, Console, align_columns
from fingertip.foundation.errors import DesignError, Issue, escape_control, gather, join_words
from fingertip.foundation.files import write_file
from fingertip.foundation.input_files import is_safe_name
from fingertip.foundation.progress import Work

if TYPE_CHECKING:
    from fingertip.cad.verification.check import Check
    from fingertip.design import Design
    from fingertip.foundation.validation import Comparison


_MARGIN = ("name", "value", "limit", "unit", "relation", "margin_percent")
_MESHES = (".stl", ".3mf", ".obj", ".ply")
_NO_DESIGN = (
    "is not a design; check takes design files (.toml), bundled names, folders that a command "
    f"wrote, and meshes ({', '.join(_MESHES)})."
)
_NEAREST = 10
"""Number of margins that are listed."""
FINE_MM = 0.01
"""Tolerance of meshes with which the bundled designs pass all checks [mm]."""


@options.command
def check(
    console: Console,
    designs: list[Path] = options.DESIGN_FILES,
    tolerance_mm: float = typer.Option(
        FINE_MM, help="Largest distance of a facet from the exact surface, in mm."
    ),
    junit: Path | None = typer.Option(
        None, metavar="FILE.xml", help="JUnit report, for CI servers."
    ),
    sarif: Path | None = typer.Option(
        None, metavar="FILE.sarif", help="SARIF report, for code scanning and editors."
    ),
    verify: bool = options.flag(
        "Let trimesh read the STL files too, as a second opinion; make the parts of a folder "
        "again and compare them."
    ),
    margins: bool = options.flag("List the checks and rules that are nearest to their limits."),
    verbose: bool = options.VERBOSE,
    changes: list[str] | None = options.CHANGES,
) -> None:
    """Check designs and folders. Exit code 0: no check failed, 1: a check failed, 2: a design is
    not valid.

    The checks read the STL file that each part would have. A wall must reach printer.min_wall_mm
    and the skin skin.min_thickness_mm, both less the tolerance of the mesh. The genus of a part is
    the number of its through holes. A check that passes may warn of what is expected to go wrong.
    Every valid design is checked. One that is refused is an error in the reports, and the exit code
    is 2. On GitHub Actions, each finding also annotates its line.

    A folder that build, board or another command wrote is compared with its manifests: every file
    must be as written. If you give designs too, the folder must be that of one of them. Nothing in
    it is changed. A folder of recordings is checked for what others need to use it, and for
    consent.

    A mesh (.stl, .3mf, .obj, .ply) of any program is checked too, and the half of a mold with the
    other beside it. Beside one design, a mesh that has the name of a part is compared with that
    part.
    """
    arguments = _sort(designs, console)
    _refuse_what_cannot_be_checked(arguments, junit, sarif, verify)

    settings = changes or ()
    refused: dict[Path, list[Issue]] = {}
    loaded = _load(arguments.files, settings, console, refused)
    checked = _check_designs(
        loaded,
        tolerance_mm=tolerance_mm,
        console=console,
        verbose=verbose,
        margins=margins,
        changes=settings,
        verify=verify,
    )
    folders, meshes = _check_files(
        arguments,
        loaded=loaded,
        tolerance_mm=tolerance_mm,
        changes=settings,
        verify=verify,
        verbose=verbose,
        console=console,
        refused=refused,
    )

    results = [*checked, *folders, *meshes]
    findings = list[Finding]()
    for path, issues in refused.items():
        findings += [Finding.make(path, issue) for issue in issues]
    for result in results:
        findings += result.findings

    _report(
        results,
        findings=findings,
        refused=refused,
        junit=junit,
        sarif=sarif,
    )

    passed = not findings and all(result.passed for result in results)
    data = {
        "passed": passed,
        "tolerance_mm": tolerance_mm,
        "issues": [vars(finding) for finding in findings],
    }

    data["designs"] = [result.data for result in checked]
    for kind, of_kind in {"folders": folders, "meshes": meshes}.items():
        if of_kind:
            data[kind] = [result.data for result in of_kind]

    texts = [result.text for result in results]
    if not all(result.passed for result in checked) and tolerance_mm > FINE_MM:
        texts.append(
            f"The meshes are coarse, which alone may fail a check: try --tolerance-mm {FINE_MM:g} "
            "first."
        )

    if refused:
        if texts and not console.as_json:
            console.write("\n\n".join(texts))

        console.print_issues(DesignError(_name_refusals(refused)), data)
        raise typer.Exit(BAD_INPUT)

    console.result(data, "\n\n".join(texts), passed)


# Arguments
# ---------


@dataclass(frozen=True)
class _Sorted:
    """Arguments of the command by their kind."""

    files: list[Path]
    """Files and bundled names of designs and sets."""
    folders: list[Path]
    meshes: list[Path]


def _sort(paths: Sequence[Path], console: Console) -> _Sorted:
    folders = options.find_folders(paths, console)
    meshes = [path for path in paths if path.suffix.lower() in _MESHES and path not in folders]
    files = [path for path in paths if path not in folders and path not in meshes]
    return _Sorted(files, list(dict.fromkeys(folders)), list(dict.fromkeys(meshes)))


def _refuse_what_cannot_be_checked(
    arguments: _Sorted, junit: Path | None, sarif: Path | None, verify: bool
) -> None:
    """Refuse files that are no designs, unsafe names, and options without effect."""
    reports = {"--junit": (junit, ".xml"), "--sarif": (sarif, ".sarif")}
    options.refuse(
        (
            Issue(str(path), _NO_DESIGN)
            for path in arguments.files
            if path.suffix not in ("", ".toml") and path.exists()
        ),
        _find_unsafe_names([*arguments.files, *arguments.folders, *arguments.meshes]),
        *(options.find_file_issues(option, *pair) for option, pair in reports.items()),
        [Issue("--verify", "makes the parts of a design; give a design too, or leave it out.")]
        if verify and not arguments.files
        else (),
    )


def _find_unsafe_names(paths: Sequence[Path]) -> Iterator[Issue]:
    """Find files whose path a report, a terminal or another system would read as something else."""
    for path in paths:
        is_plain = escape_control(str(path)) == str(path)
        if path.exists() and not (is_plain and (path.is_dir() or is_safe_name(path.name))):
            yield Issue(
                str(path), "has a name that not every system can store or print; rename it."
            )


def _load(
    files: Sequence[Path],
    changes: Sequence[str],
    console: Console,
    refused: dict[Path, list[Issue]],
) -> list[NamedDesign]:
    """Load designs and sets, and add what refuses one to `refused`."""
    from fingertip.design.design_file import load_tables
    from fingertip.design.finger_set import is_set

    if files:
        load_tables((), changes)  # reports invalid changes once instead of once per file

    loaded: list[NamedDesign] = []
    for file in dict.fromkeys(files):
        issues: list[Issue] = []
        with gather(issues):
            if is_set(file):
                loaded.append(NamedDesign(file, options.load_fingers(file, changes, console)))
            else:
                design = options.load_design(file, changes, console, may_be_empty=False)
                loaded.append(NamedDesign(file, design))

        if issues:
            refused[file] = issues

    return loaded


def _label_designs(loaded: Sequence[NamedDesign]) -> dict[str, tuple[Path, Design]]:
    """Label each design by its name, or by its file where two have the same name."""
    from fingertip.design import Design

    designs: list[tuple[str, Path, Design]] = []
    for named in loaded:
        label = named.file.as_posix()
        if isinstance(named.design, Design):
            designs.append((label, named.file, named.design))
        else:
            forms = [form.design for form in named.design.forms]
            designs += [(f"{label}: {design.name}", named.file, design) for design in forms]

    names = [design.name for _, _, design in designs]
    return {
        design.name if names.count(design.name) == 1 else label: (file, design)
        for label, file, design in designs
    }


# Designs
# -------


def _check_designs(
    loaded: Sequence[NamedDesign],
    tolerance_mm: float,
    console: Console,
    verbose: bool,
    margins: bool,
    changes: Sequence[str],
    verify: bool,
) -> list[CheckResult]:
    designs = _label_designs(loaded)
    work = Work("checking", dict.fromkeys(designs, 1.0), console.progress)
    results = []

    for label, (file, design) in designs.items():
        work.begin(label)
        console.warn(
            f"{label}: {doubt}" for doubt in design.force_curve.find_doubt(design.sensor.model)
        )
        checks = _run_checks(design, tolerance_mm, verify)
        offer = offer_fit(design, checks, changes, console)
        nearest = _list_nearest(design, checks) if margins else []

        data = {
            "design": label,
            "file": file.as_posix(),
            "passed": all(check.passed for check in checks),
            "checks": [check.to_dict() for check in checks],
            **offer,
        }
        if margins:
            data["margins"] = [
                {key: getattr(comparison, key) for key in _MARGIN} for comparison in nearest
            ]

        text = "\n".join([format_checks(label, checks, verbose), *_format_offer(offer)])
        if nearest:
            text += "\n\n" + _format_margins(label, nearest)

        results.append(
            CheckResult(
                label=label,
                data=data,
                text=text,
                cases=checks,
                findings=tuple(_list_findings(file, checks)),
            )
        )

    return results


def _run_checks(design: Design, tolerance_mm: float, verify: bool) -> tuple[Check, ...]:
    from fingertip.cad.verification.second_opinion import second_opinions
    from fingertip.cad.verification.verify import check as check_design

    verification = check_design(design, tolerance_mm=tolerance_mm)
    if not verify:
        return tuple(verification.checks)

    opinions = second_opinions(verification.contents, verification.meshes)
    return (*verification.checks, *opinions)


def _list_nearest(design: Design, checks: Sequence[Check]) -> list[Comparison]:
    from fingertip.cad.verification.margins import list_margins

    return list_margins(design, checks)[:_NEAREST]


def _format_margins(label: str, nearest: Sequence[Comparison]) -> str:
    rows = [
        (
            f"{comparison.margin_percent:.1f} %",
            comparison.name,
            f"{comparison.value:.5g} {comparison.sign} {comparison.limit:.5g} {comparison.unit}",
        )
        for comparison in nearest
    ]
    return "\n".join([f"{label}: nearest to their limits", *align_columns(rows)])


def _format_offer(offer: Mapping[str, Sequence[str]]) -> list[str]:
    return [f"  or add --fit, which moves {join_words(moved)}" for moved in offer.values()]


def _list_findings(file: Path, checks: Sequence[Check]) -> Iterator[Finding]:
    for check in checks:
        if not check.passed:
            issue = Issue(check.name, f"{message(check)}; {describe_cause(check)}")
            yield Finding.make(file, issue, check.change[0] if check.change else "")


# Folders and meshes
# ------------------


def _check_files(
    arguments: _Sorted,
    loaded: Sequence[NamedDesign],
    tolerance_mm: float,
    changes: Sequence[str],
    verify: bool,
    verbose: bool,
    console: Console,
    refused: dict[Path, list[Issue]],
) -> tuple[list[CheckResult], list[CheckResult]]:
    """Check folders and meshes, and add what cannot be read to `refused`."""
    from fingertip.cli.check_files import check_folder, check_mesh

    words = options.list_words(changes, console)
    folders: list[CheckResult] = []
    meshes: list[CheckResult] = []

    for folder in arguments.folders:
        with _refusing(folder, refused):
            folders.append(
                check_folder(
                    folder,
                    designs=loaded,
                    words=words,
                    remake=verify,
                    console=console,
                )
            )

    for mesh in arguments.meshes:
        with _refusing(mesh, refused):
            meshes.append(check_mesh(mesh, loaded, tolerance_mm, verbose))

    return folders, meshes


@contextlib.contextmanager
def _refusing(path: Path, refused: dict[Path, list[Issue]]) -> Iterator[None]:
    """Add the issues of an error to those that refuse a file."""
    issues: list[Issue] = []
    with gather(issues):
        yield

    if issues:
        refused[path] = issues


# Reports
# -------


def _report(
    results: Sequence[CheckResult],
    findings: Sequence[Finding],
    refused: Mapping[Path, Sequence[Issue]],
    junit: Path | None,
    sarif: Path | None,
) -> None:
    """Write the reports that are asked for, and annotations where GitHub runs the command."""
    if junit is not None:
        cases = {result.label: result.cases for result in results}
        refusals = {path.as_posix(): issues for path, issues in refused.items()}
        write_file(junit, to_junit(cases, refusals), "--junit")

    if sarif is not None:
        write_file(sarif, to_sarif(findings), "--sarif")

    if os.environ.get("GITHUB_ACTIONS") == "true":
        for finding in findings:
            print(finding.to_annotation(), file=sys.stderr)


def _name_refusals(refused: Mapping[Path, Sequence[Issue]]) -> Iterator[Issue]:
    """Name the file of each issue that refuses a design, a folder or a mesh."""
    for path, issues in refused.items():
        for issue in issues:
            is_named = issue.field.startswith(str(path))
            yield issue if is_named else Issue(f"{path}: {issue.field}", issue.message)
