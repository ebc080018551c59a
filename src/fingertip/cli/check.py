"""Command `fingertip check`: verify designs without writing their parts, in a terminal or on a CI server."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from fingertip.catalogues.electronics import split_finger
from fingertip.cli import options
from fingertip.cli.check_reports import Finding, message, to_junit, to_sarif
from fingertip.cli.console import BAD_INPUT, Console, align_columns
from fingertip.foundation.errors import DesignError, Issue, gather, join_words
from fingertip.foundation.files import write_file
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
    verify: bool = options.flag("Let trimesh read the STL files too, as a second opinion."),
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
    Nothing in it is changed. A folder of recordings is checked for what whoever takes it needs, and for consent.

    A mesh (.stl, .3mf, .obj, .ply) of any program is checked too, and the half of a mold with the other beside it.
    """
    folders = options.find_folders(designs, console)
    meshes = [path for path in designs if path.suffix.lower() in _MESHES and path not in folders]
    files = [path for path in designs if path not in (*folders, *meshes)]
    options.refuse(Issue(str(path), _NO_DESIGN) for path in files if path.suffix not in ("", ".toml") and path.exists())
    reports = {"--junit": (junit, ".xml"), "--sarif": (sarif, ".sarif")}
    options.refuse(*(options.find_file_issues(option, *pair) for option, pair in reports.items()), (
        Issue(option, "reports on designs, but only folders or meshes are given; give a design too.")
        for option, (report, _) in reports.items() if report and not files
    ))  # fmt: skip
    data: dict[str, Any] = {"passed": True}
    texts, refused = list[str](), dict[Path, list[Issue]]()
    if files:
        loaded, refused = _load(files, changes or (), console)
        data, texts, checks = _check_designs(loaded, tolerance_mm, console, verbose, margins, changes or (), verify)
        findings = list(_list_findings(loaded, checks, refused))
        data |= {"passed": not findings, "issues": [vars(finding) for finding in findings]}
        for option, path, content in (
            ("--junit", junit, to_junit(checks, {path.as_posix(): found for path, found in refused.items()})),
            ("--sarif", sarif, to_sarif(findings)),
        ):
            if path is not None:
                write_file(path, content, option)
        if os.environ.get("GITHUB_ACTIONS") == "true":
            print(*(found.to_annotation() for found in findings), sep="\n", file=sys.stderr)
    if folders:
        data["folders"], folder_texts = _check_folders(folders)
        texts += folder_texts
        data["passed"] = data["passed"] and all(folder["passed"] for folder in data["folders"])
    if meshes:
        data["meshes"], mesh_texts = _check_meshes(meshes, verbose)
        texts += mesh_texts
        data["passed"] = data["passed"] and all(mesh["passed"] for mesh in data["meshes"])
    if refused:
        if texts and not console.as_json:
            console.write("\n\n".join(texts))
        named = (
            one if one.field == str(path) else Issue(f"{path}: {one.field}", one.message)
            for path, found in refused.items()
            for one in found
        )
        console.print_issues(DesignError(named), data)
        raise typer.Exit(BAD_INPUT)
    console.result(data, "\n\n".join(texts), data["passed"])


def _check_meshes(paths: Sequence[Path], verbose: bool) -> tuple[list[dict[str, Any]], list[str]]:
    from fingertip.cad.verification.second_opinion import check_file

    checks = {path: check_file(path) for path in dict.fromkeys(paths)}
    results = [
        {"file": path.as_posix(), "passed": all(c.passed for c in found), "checks": [c.to_dict() for c in found]}
        for path, found in checks.items()
    ]
    return results, [_format_table(path.as_posix(), found, verbose, "mend the mesh") for path, found in checks.items()]


def _check_folders(folders: Sequence[Path]) -> tuple[list[dict[str, Any]], list[str]]:
    from fingertip.bench.trials import DESIGN, check_recordings, list_trials
    from fingertip.tasks.verification import verify_sets

    results, texts = [], []
    for folder in folders:
        if list_trials(folder) and (folder / DESIGN).exists():
            trials, faults, notes = check_recordings(folder)
            found = {"passed": not faults, "trials": trials, "faults": faults, "notes": notes}
            results.append({"folder": folder.as_posix(), **found})
            verdict = "must be mended before it is given away" if faults else "may be given away"
            texts.append("\n".join([*faults, *notes, f"{folder}: {trials} trials; the folder {verdict}"]))
            continue
        count, differences = verify_sets(folder)
        result = {"passed": not differences, "files": count, "differences": differences}
        results.append({"folder": folder.as_posix(), **result})
        number = len(differences)
        verdict = f"{number} difference{'s' if number > 1 else ''}" if differences else "all are as written"
        texts.append("\n".join([*differences, f"{folder}: {count} files compared, {verdict}"]))
    return results, texts


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
        checks_by_design[label] = (*made.checks, *(second_opinions(made.contents, made.meshes) if verify else ()))
    found = [
        {"design": label, "file": loaded[label][0].as_posix(), "passed": all(c.passed for c in checks),
         "checks": [c.to_dict() for c in checks]}
        for label, checks in checks_by_design.items()
    ]  # fmt: skip
    data = {"passed": all(one["passed"] for one in found), "tolerance_mm": tolerance_mm, "designs": found}
    texts = list[str]()
    for one, (label, checks) in zip(found, checks_by_design.items(), strict=True):
        one |= (offer := offer_fit(designs[label], checks, changes, console))
        offered = [f"  or add --fit, which moves {join_words(offer['fit_moves'])}"] if offer else []
        texts.append("\n".join([_format_table(label, checks, verbose), *offered]))
    if margins:
        for i, (label, design) in enumerate(designs.items()):
            nearest = list_margins(design, checks_by_design[label])[:_NEAREST]
            found[i]["margins"] = [{key: getattr(one, key) for key in _MARGIN} for one in nearest]
            rows = [(f"{one.margin_percent:.1f} %", one.name, f"{one.value:.5g} {one.sign} {one.limit:.5g} {one.unit}")
                    for one in nearest]  # fmt: skip
            texts.append("\n".join([f"{label}: nearest to their limits", *align_columns(rows)]))
    if not data["passed"] and tolerance_mm > FINE_MM:
        texts.append(f"The meshes are coarse, which alone may fail a check: try --tolerance-mm {FINE_MM:g} first.")
    return data, texts, checks_by_design


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


def _format_table(label: str, checks: Sequence[Check], verbose: bool, cause: str = "") -> str:
    """Verdict on a design, then the checks that failed, or all of them."""
    from fingertip.cad.verification.check import count_checks
    from fingertip.foundation.files import round_for_output

    verdict = f"{label}: {count_checks(checks)}"
    shown = [c for c in checks if verbose or not c.passed]
    if not shown:
        return verdict
    rows = [("check", "value", "", "limit", "unit", "")]
    for c in shown:
        value, limit = f"{round_for_output(c.value):.5g}", f"{c.limit:.5g}"
        compared = (f">{value}", "", "") if c.is_beyond else (value, c.sign, limit)
        rows.append((c.name, *compared, c.unit, "ok" if c.passed else "FAILED"))
    widths = [max(len(row[i]) for row in rows) for i in range(6)]
    aligned = ((f"{text:{'>' if i in (1, 3) else ''}{widths[i]}}" for i, text in enumerate(row)) for row in rows)
    lines = [verdict, *(" ".join(row).rstrip() for row in aligned)]
    return "\n".join([*lines, *(f"  {c.name}: {cause or describe_cause(c)}" for c in shown if not c.passed)])


def describe_cause(check: Check, with_remedy: bool = True) -> str:
    remedy = f"it passes with --set {check.remedy}; or " if check.remedy and with_remedy else ""
    return remedy + (f"change {', '.join(check.change)}" if check.change else f"this is a bug in {check.source}")


def offer_fit(design: Design, checks: Iterable[Check], changes: Iterable[str], console: Console) -> dict[str, Any]:
    """Name, as data, what a fit moves for checks that failed, if it mends them all and was not asked for."""
    from fingertip.cad.verification.fitting import find_mend

    if console.fits or not any(check.change for check in checks if not check.passed):
        return {}
    moved = find_mend(design, [split_finger(change.partition("=")[0].strip())[1] for change in changes])
    return {"fit_moves": list(moved)} if moved else {}
