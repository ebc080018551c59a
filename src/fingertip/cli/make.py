"""Command `fingertip make`: everything of a design in one folder."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fingertip.cli.console import CHECK_FAILED, Console, ForceOption, JsonOption, QuietOption, SetOption, command
from fingertip.cli.options import DesignArgument


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
    from fingertip.cli.build import format_build, split_names
    from fingertip.cli.load import load_design
    from fingertip.make_files import make as make_everything
    from fingertip.slip.format import as_data, as_text

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
