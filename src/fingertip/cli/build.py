"""Command `fingertip build`: make the printable parts of a design."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fingertip.cli.console import CHECK_FAILED, Console, ForceOption, JsonOption, QuietOption, SetOption, command
from fingertip.cli.options import DesignArgument, MaterialOption

if TYPE_CHECKING:
    from fingertip.cad.report import Build


@command
def build(
    design: DesignArgument,
    out: Annotated[str | None, typer.Option(metavar="PATH", help="Output folder; out/NAME by default.")] = None,
    parts: Annotated[
        str | None, typer.Option(help="Parts (bone, skin, ...), separated by commas; all by default.")
    ] = None,
    formats: Annotated[
        str | None,
        typer.Option(
            help="File formats (stl, 3mf, step), separated by commas; all by default, step if cadquery is installed."
        ),
    ] = None,
    tolerance_mm: Annotated[
        float, typer.Option(help="Largest distance of a facet from the exact surface, in mm.")
    ] = 0.01,
    material: MaterialOption = None,
    pictures: Annotated[
        bool, typer.Option("--pictures", help="Draw a picture of each casting step, for the casting sheet.")
    ] = False,
    force: ForceOption = False,
    changes: SetOption = None,
    as_json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Build bone, skin and mold as STL, 3MF and STEP files, check them, and write a report and a casting sheet."""
    import json

    from fingertip.cad.report import REPORT
    from fingertip.cli.options import load_design
    from fingertip.tasks.build import build as build_parts

    console = Console(as_json, quiet)
    loaded, _ = load_design(design, changes, console.progress)
    result = build_parts(
        loaded,
        out,
        parts=None if parts is None else split_names(parts),
        formats=None if formats is None else split_names(formats),
        tolerance_mm=tolerance_mm,
        material=material,
        pictures=pictures,
        force=force,
        progress=console.progress,
    )
    data = json.loads(result.contents[REPORT]) | {"folder": str(result.folder), "removed": list(result.removed)}
    console.result(data, "\n".join(format_build(result)))
    if not result.passed:
        raise typer.Exit(CHECK_FAILED)


def format_build(result: Build) -> list[str]:
    """Format the result of a build: volume and files of each part, failed checks, and a summary."""
    lines = [
        f"{built.part.name:12} {built.mesh.volume() / 1000:8.2f} cm3   {', '.join(built.files.values())}"
        for built in result.parts
    ]
    from fingertip.cad.printing.print_files import PRINT_FOLDER
    from fingertip.cad.verification.check import count_checks, list_warnings
    from fingertip.cli.check import describe_cause

    if result.prints.contents:
        lines.append(f"{f'{PRINT_FOLDER}/':28}{', '.join(result.prints.contents)}")

    failed = [check for check in result.checks if not check.passed]
    if result.strength:
        from fingertip.cad.verification.strength import describe_strength

        lines += describe_strength(result.strength)
    for check in failed:
        lines.append(f"FAILED {check.name}: {check.value:g} {check.unit}, must be {check.relation} {check.limit:g}")
        lines.append(describe_cause(check.name))
    lines += [f"warning: {text}" for text in list_warnings(result.checks)]
    lines.append(f"{count_checks(result.checks)}; written to {result.folder}")
    return lines


def split_names(text: str) -> list[str]:
    """Split a comma-separated option into names."""
    return [name.strip() for name in text.split(",") if name.strip()]


# Command `fingertip make`: everything of a design in one folder.


@command
def make(
    design: DesignArgument,
    out: Annotated[Path | None, typer.Option("--out", "-o", help="Output folder; out/NAME by default.")] = None,
    formats: Annotated[
        str | None,
        typer.Option(help="File formats of the parts (stl, 3mf, step), separated by commas; as for build."),
    ] = None,
    force: ForceOption = False,
    changes: SetOption = None,
    as_json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Make parts, drawings, board and a simulated trial with its slip. Exit code 1: a check of the parts failed."""
    from fingertip.cli.options import load_design
    from fingertip.slip.report import as_data, as_text
    from fingertip.tasks.make import make as make_everything

    console = Console(as_json, quiet)
    loaded, _ = load_design(design, changes, console.progress)
    names = None if formats is None else split_names(formats)
    made = make_everything(loaded, out, formats=names, force=force, progress=console.progress)
    for warning in made.detection.warnings:
        console.progress(f"warning: {warning}")
    data = {
        "folder": str(made.parts.folder),
        "parts": made.parts.report(),
        "drawings": [path.as_posix() for path in made.drawings],
        "board": [path.as_posix() for path in made.board],
        "signal": [path.as_posix() for path in made.signal],
        "page": None if made.page is None else str(made.page),
        "detection": as_data(made.detection.detection, made.detection.noise),
    }
    lines = [
        *format_build(made.parts),
        f"board: {made.board[0].parent}; bom.csv lists what to buy, README.md how to use it",
        f"simulated trial: {made.signal[0]}",
        as_text(made.detection.detection),
        f"next: {made.parts.folder / 'casting.md'} says what to print and how to cast it, acceptance.md how to test it",
    ]
    if made.page:
        lines.append(f"see: {made.page}, all of it in a browser, without a network")
    console.result(data, "\n".join(lines))
    if not made.parts.passed:
        raise typer.Exit(CHECK_FAILED)


# Command `fingertip coupon`: write a small print that shows how a printer makes the fits of a design.


@command
def coupon(
    design: DesignArgument,
    out: Annotated[str | None, typer.Option(metavar="PATH", help="Output folder; out/NAME/coupon by default.")] = None,
    formats: Annotated[str, typer.Option(help="File formats (stl, 3mf, step), separated by commas.")] = "stl,3mf",
    force: ForceOption = False,
    changes: SetOption = None,
    as_json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Write the fit coupon of a design, a file for caliper readings of it, and a page on both.

    The coupon is a frame and a loose piece with the fits of the real parts. It prints in some 20 minutes. `fingertip
    calibrate printer` turns the readings into parameters.
    """
    from fingertip.cli.check import describe_cause
    from fingertip.cli.options import load_design
    from fingertip.tasks.coupon import READINGS, write_coupon

    console = Console(as_json, quiet)
    loaded, _ = load_design(design, changes, console.progress)
    made = write_coupon(loaded, out, formats=split_names(formats), force=force, progress=console.progress)
    lines = [f"{name:12} {mesh.volume() / 1000:8.2f} cm3" for name, mesh in made.meshes.items()]
    failed = [check for check in made.checks if not check.passed]
    for check in failed:
        lines.append(f"FAILED {check.name}: {check.value:g} {check.unit}, must be {check.relation} {check.limit:g}")
        lines.append(describe_cause(check.name))
    passed = len(made.checks) - len(failed)
    lines.append(f"{passed} of {len(made.checks)} checks passed; written to {made.folder}; fill in {READINGS}")
    console.result(made.data(), "\n".join(lines))
    if failed:
        raise typer.Exit(CHECK_FAILED)
