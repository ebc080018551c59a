"""Command `fingertip build`: make the printable parts of a design."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from fingertip.cli.console import CHECK_FAILED, Console, ForceOption, JsonOption, QuietOption, SetOption, command
from fingertip.cli.options import DesignArgument, MaterialOption

if TYPE_CHECKING:
    from fingertip.build_result import Build


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

    from fingertip.build_files import build as build_parts
    from fingertip.build_result import REPORT
    from fingertip.cli.load import load_design

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
        from fingertip.cad.strength.assess import describe_strength

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
