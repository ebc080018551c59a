"""Command `fingertip drawing`: dimensioned drawings of the printed parts."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fingertip.cli.console import Console, ForceOption, JsonOption, QuietOption, SetOption, command
from fingertip.cli.options import DesignArgument


@command
def drawing(
    design: DesignArgument,
    out: Annotated[Path | None, typer.Option(metavar="PATH", help="Output folder; out/NAME by default.")] = None,
    force: ForceOption = False,
    changes: SetOption = None,
    as_json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Draw each printed part to scale with its dimensions, tolerances and sizes to check, as SVG and as one PDF."""
    from fingertip.build_files import parts_writer
    from fingertip.cli.load import load_design
    from fingertip.drawing.draw import draw_files, file_names, require_packages

    console = Console(as_json, quiet)
    require_packages("fingertip drawing")
    loaded, _ = load_design(design, changes, console.progress)
    folder = out or Path("out") / loaded.name
    writer = parts_writer(loaded, folder, force)
    writer.check_addition(file_names(loaded))
    files = draw_files(loaded, console.progress)
    writer.add(files)
    paths = [str(folder / name) for name in files]
    console.result({"drawings": paths}, f"{len(files) - 1} sheets drawn to {paths[-1]}, and each to an SVG file")
