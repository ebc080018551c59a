"""`fingertip check`: prove designs without exporting them, for a terminal or for a CI server."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fingertip.cli.console import CHECK_FAILED, Console, JsonOption, QuietOption, SetOption, command

if TYPE_CHECKING:
    from fingertip.cad.verification.checks import Check
    from fingertip.design import Design


@command
def check(
    designs: Annotated[list[Path], typer.Argument(metavar="DESIGN...", help="Design files.")],
    tolerance_mm: Annotated[float, typer.Option(help="Most a facet strays from the exact surface.")] = 0.01,
    junit: Annotated[Path | None, typer.Option(metavar="FILE.xml", help="JUnit report, for CI servers.")] = None,
    changes: SetOption = None,
    as_json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Check designs without writing parts: exit code 0 all hold, 1 a check failed, 2 a design was refused.

    The checks read the STL each part would have. If any file is refused, all its issues and those of the other files
    are told, no design is checked and no report is written.
    """
    from fingertip.cad.kernel.mesh import MeshEvaluator
    from fingertip.cad.shapes.parts import parts_by_name
    from fingertip.cad.verification.verify import as_data, refuse_tolerance, verify

    console = Console(as_json, quiet)
    loaded = _load(designs, changes or ())
    refuse_tolerance(tolerance_mm)
    found: dict[str, tuple[Check, ...]] = {}
    for label, design in loaded.items():
        console.progress(f"checking {label}")
        found[label] = verify(design, parts_by_name(design), ("stl",), MeshEvaluator(tolerance_mm), console.progress).checks
    if junit is not None:
        from fingertip.cad.files.junit import to_bytes
        from fingertip.files import write_file

        write_file(junit, to_bytes(found), "--junit")
    passed = all(c.passed for checks in found.values() for c in checks)
    data: dict[str, Any] = {
        "passed": passed,
        "tolerance_mm": tolerance_mm,
        "designs": [
            {"design": label, "passed": all(c.passed for c in checks), "checks": [as_data(c) for c in checks]}
            for label, checks in found.items()
        ],
    }
    console.result(data, "\n\n".join(_table(label, checks) for label, checks in found.items()))
    if not passed:
        raise typer.Exit(CHECK_FAILED)


def _load(files: Sequence[Path], changes: Sequence[str]) -> dict[str, Design]:
    """Each design by its name; by its file where two share a name (files that leave it out share the default's)."""
    from fingertip.cli.load import load_design
    from fingertip.design.load import load_tables
    from fingertip.errors import DesignError, Issue

    load_tables((), changes)  # what is wrong with a change itself is told once, not once for each file
    loaded: dict[Path, Design] = {}
    issues: list[Issue] = []
    for file in dict.fromkeys(files):
        try:
            loaded[file], _ = load_design(file, changes)
        except DesignError as error:
            issues += (f if f.field == str(file) else Issue(f"{file}: {f.field}", f.message) for f in error.issues)
    if issues:
        raise DesignError(issues)
    names = [design.name for design in loaded.values()]
    return {
        design.name if names.count(design.name) == 1 else file.as_posix(): design for file, design in loaded.items()
    }


def _table(label: str, checks: Sequence[Check]) -> str:
    width, unit = max(len(c.name) for c in checks), max(4, *(len(c.unit) for c in checks))
    failed = sum(not c.passed for c in checks)
    lines = [label, f"  {'check':{width}} {'value':>12} {'limit':>12} {'unit':{unit}} verdict"]
    lines += [
        f"  {c.name:{width}} {c.value:12.6g} {c.sign:2} {c.limit:>9.6g} {c.unit:{unit}} {verdict}"
        for c, verdict in zip(checks, ("ok" if c.passed else "FAILED" for c in checks), strict=True)
    ]
    return "\n".join([*lines, f"  {len(checks) - failed} of {len(checks)} checks passed"])
