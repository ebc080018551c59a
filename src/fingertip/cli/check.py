"""Command `fingertip check`: verify designs, folders and meshes without writing parts, in a terminal or in CI."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from fingertip.cli import options
from fingertip.cli.check_reports import Finding, message, to_junit, to_sarif
from fingertip.cli.check_tables import describe_cause, format_checks, offer_fit
from fingertip.cli.console import BAD_INPUT, Console, align_columns
from fingertip.foundation.errors import DesignError, Issue, gather, join_words
from fingertip.foundation.files import write_file
from fingertip.foundation.input_files import is_safe_name
from fingertip.foundation.progress import Work

if TYPE_CHECKING:
    from fingertip.cad.verification.check import Check
    from fingertip.design import Design


_MARGIN = ("name", "value", "limit", "unit", "relation", "margin_percent")
_MESHES = (".stl", ".3mf", ".obj", ".ply")
_NO_DESIGN = (
    f"is no design; check takes design files (.toml), bundled names, folders that a command wrote, and meshes "
    f"({', '.join(_MESHES)})."
)
_NEAREST = 10
"""Number of margins that are listed."""
FINE_MM = 0.01
"""Tolerance of meshes with which the bundled designs pass all checks [mm]."""


@options.command
def check(
    console: Console,
    designs: list[Path] = options.DESIGN_FILES,
    tolerance_mm: float = typer.Option(FINE_MM, help="Largest distance of a facet from the exact surface, in mm."),
    junit: Path | None = typer.Option(None, metavar="FILE.xml", help="JUnit report, for CI servers."),
    sarif: Path | None = typer.Option(None, metavar="FILE.sarif", help="SARIF report, for code scanning and editors."),
    verify: bool = options.flag(
        "Let trimesh read the STL files too, as a second opinion; make the parts of a folder again and compare them."
    ),
    margins: bool = options.flag("List the checks and rules that are nearest to their limits."),
    verbose: bool = options.VERBOSE,
    changes: list[str] | None = options.CHANGES,
) -> None:
    """Check designs and folders. Exit code 0: no check failed, 1: a check failed, 2: a design is not valid.

    The checks read the STL file that each part would have. A wall must reach printer.min_wall_mm and the skin
    skin.min_thickness_mm, both less the tolerance of the mesh. The genus of a part is the number of its through holes.
    A check that passes may warn of what is expected to go wrong.
    Every valid design is checked. One that is refused is an error in the reports, and the exit code is 2. Where
    GITHUB_ACTIONS is true, each finding is an annotation of its line too.

    A folder that build, board or another command wrote is compared with its manifests: every file must be as written.
    Beside a design, a folder of parts must be that design's. Nothing in it is changed. A folder of recordings is
    checked for what others need to use it, and for consent.

    A mesh (.stl, .3mf, .obj, .ply) of any program is checked too, and the half of a mold with the other beside it.
    Beside one design, a mesh that has the name of a part is compared with that part.
    """
    given = _sort(designs, console)
    _refuse_what_cannot_be_checked(given, junit, sarif)

    settings = changes or ()
    loaded, refused = _load(given.files, settings, console) if given.files else ({}, {})
    data: dict[str, Any] = {"passed": True}
    texts: list[str] = []

    if given.files:
        data, texts, checks = _check_designs(loaded, tolerance_mm, console, verbose, margins, settings, verify)
        findings = list(_list_findings(loaded, checks, refused))
        data |= {"passed": not findings, "issues": [vars(finding) for finding in findings]}
        _report(findings, checks, refused, junit, sarif)

    if given.folders or given.meshes:
        _check_files(given, loaded, tolerance_mm, settings, verify, verbose, console, data, texts)

    if refused:
        if texts and not console.as_json:
            console.write("\n\n".join(texts))
        console.print_issues(DesignError(_name_refusals(refused)), data)
        raise typer.Exit(BAD_INPUT)
    console.result(data, "\n\n".join(texts), data["passed"])


# --- what is given ----------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Given:
    """Arguments of the command by their kind."""

    files: list[Path]
    """Files and bundled names of designs and sets."""
    folders: list[Path]
    meshes: list[Path]


def _sort(paths: Sequence[Path], console: Console) -> _Given:
    folders = options.find_folders(paths, console)
    meshes = [path for path in paths if path.suffix.lower() in _MESHES and path not in folders]
    files = [path for path in paths if path not in folders and path not in meshes]
    return _Given(files, folders, meshes)


def _refuse_what_cannot_be_checked(given: _Given, junit: Path | None, sarif: Path | None) -> None:
    """Refuse files that are no designs, names that are no file names, and reports that cannot be written."""
    reports = {"--junit": (junit, ".xml"), "--sarif": (sarif, ".sarif")}
    options.refuse(
        (Issue(str(path), _NO_DESIGN) for path in given.files if path.suffix not in ("", ".toml") and path.exists()),
        _find_unsafe_names([*given.files, *given.meshes]),
        *(options.find_file_issues(option, *pair) for option, pair in reports.items()),
        (
            Issue(option, "reports on designs, but only folders or meshes are given; give a design too.")
            for option, (report, _) in reports.items()
            if report and not given.files
        ),
    )


def _find_unsafe_names(paths: Sequence[Path]) -> Iterator[Issue]:
    """Find files whose names a report or another system would read as something else."""
    for path in paths:
        if path.exists() and not is_safe_name(path.name):
            yield Issue(str(path), "has a name that not every system can store or print; rename it.")


def _load(
    files: Sequence[Path], changes: Sequence[str], console: Console
) -> tuple[dict[str, tuple[Path, Design]], dict[Path, list[Issue]]]:
    """Load the designs by name, or by file where two have the same name; return them, and what refuses the others."""
    from fingertip.design.files import load_tables
    from fingertip.design.finger_set import is_set

    load_tables((), changes)  # reports invalid changes once instead of once per file

    loaded: list[tuple[str, Path, Design]] = []
    refused: dict[Path, list[Issue]] = {}
    for file in dict.fromkeys(files):
        issues: list[Issue] = []
        with gather(issues):
            if is_set(file):
                forms = options.load_fingers(file, changes, console).forms
                loaded += ((f"{file.as_posix()}: {form.design.name}", file, form.design) for form in forms)
            else:
                loaded.append((file.as_posix(), file, options.load_design(file, changes, console, may_be_empty=False)))
        if issues:
            refused[file] = issues

    names = [design.name for _, _, design in loaded]
    designs = {
        design.name if names.count(design.name) == 1 else label: (file, design) for label, file, design in loaded
    }
    return designs, refused


# --- designs ----------------------------------------------------------------------------------------------------------


def _check_designs(
    loaded: Mapping[str, tuple[Path, Design]],
    tolerance_mm: float,
    console: Console,
    verbose: bool,
    margins: bool,
    changes: Sequence[str],
    verify: bool,
) -> tuple[dict[str, Any], list[str], dict[str, tuple[Check, ...]]]:
    from fingertip.cad.verification.second_opinion import second_opinions
    from fingertip.cad.verification.verify import check, list_margins

    checks_by_design: dict[str, tuple[Check, ...]] = {}
    designs = {label: design for label, (_, design) in loaded.items()}
    work = Work("checking", dict.fromkeys(designs, 1.0), console.progress)
    for label, design in designs.items():
        work.begin(label)
        console.warn(f"{label}: {doubt}" for doubt in design.force_curve.find_doubt(design.sensor.model))
        made = check(design, tolerance_mm=tolerance_mm)
        opinions = second_opinions(made.contents, made.meshes) if verify else ()
        checks_by_design[label] = (*made.checks, *opinions)

    found = [
        {
            "design": label,
            "file": loaded[label][0].as_posix(),
            "passed": all(c.passed for c in checks),
            "checks": [c.to_dict() for c in checks],
        }
        for label, checks in checks_by_design.items()
    ]
    data = {"passed": all(one["passed"] for one in found), "tolerance_mm": tolerance_mm, "designs": found}

    texts: list[str] = []
    for one, (label, checks) in zip(found, checks_by_design.items(), strict=True):
        offer = offer_fit(designs[label], checks, changes, console)
        one |= offer
        offered = [f"  or add --fit, which moves {join_words(offer['fit_moves'])}"] if offer else []
        texts.append("\n".join([format_checks(label, checks, verbose), *offered]))

    if margins:
        for i, (label, design) in enumerate(designs.items()):
            nearest = list_margins(design, checks_by_design[label])[:_NEAREST]
            found[i]["margins"] = [{key: getattr(one, key) for key in _MARGIN} for one in nearest]
            rows = [
                (f"{one.margin_percent:.1f} %", one.name, f"{one.value:.5g} {one.sign} {one.limit:.5g} {one.unit}")
                for one in nearest
            ]
            texts.append("\n".join([f"{label}: nearest to their limits", *align_columns(rows)]))

    if not data["passed"] and tolerance_mm > FINE_MM:
        texts.append(f"The meshes are coarse, which alone may fail a check: try --tolerance-mm {FINE_MM:g} first.")
    return data, texts, checks_by_design


# --- folders and meshes -----------------------------------------------------------------------------------------------


def _check_files(
    given: _Given,
    loaded: Mapping[str, tuple[Path, Design]],
    tolerance_mm: float,
    changes: Sequence[str],
    verify: bool,
    verbose: bool,
    console: Console,
    data: dict[str, Any],
    texts: list[str],
) -> None:
    """Check folders and meshes, and add what is found to the data and texts of the command."""
    from fingertip.cli.check_files import check_folders, check_meshes

    by_file: dict[Path, list[Design]] = {}
    for file, design in loaded.values():
        by_file.setdefault(file, []).append(design)
    designs = [design for designs in by_file.values() for design in designs]

    found = {
        "folders": check_folders(given.folders, by_file, changes, verify, console),
        "meshes": check_meshes(given.meshes, designs, tolerance_mm, verbose),
    }
    for kind, results in found.items():
        if results:
            data[kind] = [result.data for result in results]
            texts += (result.text for result in results)
            data["passed"] = data["passed"] and all(result.passed for result in results)


# --- reports ----------------------------------------------------------------------------------------------------------


def _report(
    findings: Sequence[Finding],
    checks: Mapping[str, tuple[Check, ...]],
    refused: Mapping[Path, Sequence[Issue]],
    junit: Path | None,
    sarif: Path | None,
) -> None:
    """Write the reports that are asked for, and annotations where GitHub runs the command."""
    if junit is not None:
        refusals = {path.as_posix(): issues for path, issues in refused.items()}
        write_file(junit, to_junit(checks, refusals), "--junit")
    if sarif is not None:
        write_file(sarif, to_sarif(findings), "--sarif")
    if os.environ.get("GITHUB_ACTIONS") == "true":
        print(*(finding.to_annotation() for finding in findings), sep="\n", file=sys.stderr)


def _list_findings(
    loaded: Mapping[str, tuple[Path, Design]],
    checks: Mapping[str, Sequence[Check]],
    refused: Mapping[Path, Sequence[Issue]],
) -> Iterator[Finding]:
    for path, issues in refused.items():
        yield from (Finding.make(path, issue) for issue in issues)
    for label, each in checks.items():
        for one in each:
            if not one.passed:
                issue = Issue(one.name, f"{message(one)}; {describe_cause(one)}")
                yield Finding.make(loaded[label][0], issue, one.change[0] if one.change else "")


def _name_refusals(refused: Mapping[Path, Sequence[Issue]]) -> Iterator[Issue]:
    """Name the file of each issue that refuses a design."""
    for path, issues in refused.items():
        for issue in issues:
            yield issue if issue.field == str(path) else Issue(f"{path}: {issue.field}", issue.message)
