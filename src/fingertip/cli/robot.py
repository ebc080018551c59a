"""Command `fingertip robot`: the model of a fingertip for simulators of robots."""

from __future__ import annotations

from pathlib import Path

import typer

from fingertip.cli.console import Console
from fingertip.cli.options import DesignArgument, ForceOption, SetOption, command, load_design


@command
def robot(
    console: Console,
    design: DesignArgument,
    file_format: str = typer.Option("mjcf", "--format", help="mjcf (MuJoCo) or urdf (ROS and many simulators)."),
    out: Path | None = typer.Option(None, metavar="PATH", help="Output folder; out/NAME/robot by default."),
    force: ForceOption = False,
    changes: SetOption = None,
) -> None:
    """Write a model of a finger, or of a set, for simulators: meshes, inertia, frames, collision pieces and contact.

    The README beside it states the frames, the errors of collision pieces and contact, and how to attach a finger.
    """
    from fingertip.design.finger_set import is_set, load_set
    from fingertip.tasks.robot import write_robot

    loaded = load_set(design, changes or ()) if is_set(design) else load_design(design, changes, console)
    made = write_robot(loaded, out, file_format=file_format, force=force, progress=console.progress)
    lines = [
        f"{form['design']}: {1e3 * form['mass_kg']:.2f} g in {len(form['parts'])} parts. {form['errors']}"
        for form in made.get("forms", {"": made}).values()
    ]
    written = f"{len(made['files'])} files in {made['folder']}; its README.md explains them"
    console.result(made, "\n".join([*lines, written]))
