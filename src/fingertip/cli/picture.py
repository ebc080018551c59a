"""Command `fingertip picture`: draw a design before it is printed."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fingertip.cli.console import (
    Console,
    ForceOption,
    JsonOption,
    QuietOption,
    SetOption,
    command,
)
from fingertip.cli.options import DesignArgument
from fingertip.cli.output_files import find_file_issues

MIN_WIDTH_PX = 400
MAX_WIDTH_PX = 6000


@command
def picture(
    design: DesignArgument,
    out: Annotated[
        Path | None, typer.Option(help="Output PNG; out/NAME/exploded.png or filling.png by default.")
    ] = None,
    filling: Annotated[
        bool,
        typer.Option("--filling", help="Draw when the silicone arrives where, with vents and last points."),
    ] = False,
    width_px: Annotated[int, typer.Option(help="Width of the picture, in pixels: 400 to 6000.")] = 1600,
    force: ForceOption = False,
    changes: SetOption = None,
    as_json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Draw an exploded view of the fingertip and a section through the closed mold, or how the mold fills."""
    from fingertip.build_files import parts_writer
    from fingertip.cli.load import load_design
    from fingertip.errors import Issue, OutputError
    from fingertip.files import write_file
    from fingertip.view.filling_picture import draw_mold_filling
    from fingertip.view.picture import draw

    console = Console(as_json, quiet)
    issues = list(find_file_issues("--out", out, ".png"))
    if not MIN_WIDTH_PX <= width_px <= MAX_WIDTH_PX:
        issues.append(Issue("--width-px", f"{width_px} is out of range; choose {MIN_WIDTH_PX} to {MAX_WIDTH_PX}."))
    if issues:
        raise OutputError(issues)
    loaded, _ = load_design(design, changes, console.progress)
    path = out or Path("out") / loaded.name / ("filling.png" if filling else "exploded.png")
    if out is None:
        parts_writer(loaded, path.parent, force).check_addition((path.name,))
    data = draw_mold_filling(loaded) if filling else draw(loaded, width_px, console.progress)
    if out is None:
        parts_writer(loaded, path.parent, force).add({path.name: data})
    else:
        write_file(out, data)
    console.result({"picture": str(path)}, f"drawn to {path}")
