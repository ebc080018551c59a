"""Command `fingertip firmware`: the slip detector of a design as a C library for a controller."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fingertip.cli.console import CHECK_FAILED, Console
from fingertip.cli.options import DesignArgument, ForceOption, JsonOption, QuietOption, SetOption, command


@command
def firmware(
    design: DesignArgument,
    out: Annotated[
        Path | None, typer.Option(metavar="PATH", help="Output folder; out/NAME/firmware by default.")
    ] = None,
    check: Annotated[
        bool, typer.Option("--check", help="Write nothing; compare the folder with the design; exit 1 if they differ.")
    ] = False,
    force: ForceOption = False,
    changes: SetOption = None,
    as_json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Write the slip detector of a design as a C99 library for a controller, for Arduino, PlatformIO or plain C.

    The README beside it states the wiring to the board's output connector, and what the detector costs in instructions
    and memory.
    """
    from fingertip.cli.options import load_design
    from fingertip.firmware.packaging import cost_table, find_warnings, read_costs
    from fingertip.tasks.firmware import firmware_differences, write_firmware

    console = Console(as_json, quiet)
    loaded, _ = load_design(design, changes, console.progress)
    folder = out or firmware_folder(loaded)
    if check:
        found = firmware_differences(loaded, folder)
        text = "\n".join(found) or f"{folder} is up to date with this design"
        console.result({"current": not found, "differences": found}, text)
        if found:
            raise typer.Exit(CHECK_FAILED)
        return
    paths = write_firmware(loaded, folder, force=force)
    warnings = list(find_warnings(loaded))
    for warning in warnings:
        console.progress(f"warning: {warning}")
    data = {"files": [path.as_posix() for path in paths], "warnings": warnings, "costs": read_costs()}
    console.result(data, f"{cost_table()}\n{len(paths)} files in {folder}; its README.md states use and wiring")
