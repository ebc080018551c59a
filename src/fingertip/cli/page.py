"""Command `fingertip page`: one page that shows everything of a design."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fingertip.cli.console import Console, ForceOption, JsonOption, QuietOption, SetOption, command
from fingertip.cli.options import DesignArgument


@command
def page(
    design: DesignArgument,
    out: Annotated[
        Path | None, typer.Option(metavar="PATH", help="Folder of the design's files; out/NAME by default.")
    ] = None,
    force: ForceOption = False,
    changes: SetOption = None,
    as_json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Write index.html beside a design's files: 3D view, checks, casting guide, board and trial in one offline page."""
    from fingertip.cli.load import load_design
    from fingertip.page_files import write_page

    console = Console(as_json, quiet)
    loaded, _ = load_design(design, changes, console.progress)
    path, size, remarks = write_page(loaded, out, force=force)
    for remark in remarks:
        console.progress(f"note: {remark}")
    console.result(
        {"page": str(path), "bytes": size, "remarks": list(remarks)},
        f"page: {path}, {size / 1e6:.1f} MB; open it in a browser, no network is needed",
    )
