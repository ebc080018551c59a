"""Command `fingertip robot`: the model of a fingertip for simulators of robots."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fingertip.cli.console import Console
from fingertip.cli.options import DesignArgument, ForceOption, SetOption, command, load_design


@command
def robot(
    console: Console,
    design: DesignArgument,
    file_format: Annotated[
        str, typer.Option("--format", help="mjcf (MuJoCo) or urdf (ROS and many simulators).")
    ] = "mjcf",
    out: Annotated[Path | None, typer.Option(metavar="PATH", help="Output folder; out/NAME/robot by default.")] = None,
    force: ForceOption = False,
    changes: SetOption = None,
) -> None:
    """Write a model of one finger for simulators: meshes, mass and inertia, frames, collision pieces and contact.

    The README beside it states the frames, the errors of collision pieces and contact, and how to attach the finger.
    """
    from fingertip.tasks.robot import write_robot

    made = write_robot(
        load_design(design, changes, console), out, file_format=file_format, force=force, progress=console.progress
    )
    mass, written = f"{1e3 * made['mass_kg']:.2f} g in {len(made['parts'])} parts", f"{len(made['files'])} files"
    console.result(made, f"{mass}. {made['errors']}\n{written} in {made['folder']}; its README.md explains them")
