"""Command `fingertip new`: begin a design of one's own."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated, Any

import typer

from fingertip.cli.console import (
    Console,
    JsonOption,
    QuietOption,
    SetOption,
    command,
)
from fingertip.cli.output_files import find_file_issues

_TOLERANCE_MM = 0.05
"""Tolerance of the mesh on which the strength is assessed [mm]."""


@command
def new(
    name: Annotated[str, typer.Argument(help="Name of the design: up to 40 letters, digits, - and _.")],
    sensor: Annotated[
        str | None,
        typer.Option(
            "--sensor",
            help="Sensor: fsr400, fsr400_short, fsr402, fsr402_short or custom (see the file); fsr400 by default.",
        ),
    ] = None,
    preset: Annotated[
        str | None,
        typer.Option(
            "--preset",
            help="Anatomical size, with a joint: adult_finger, adult_thumb, youth_finger, youth_thumb, child_finger or "
            "child_thumb.",
        ),
    ] = None,
    hand: Annotated[
        str | None,
        typer.Option(
            "--hand",
            metavar="FILE",
            help="File with the sizes of your hand's joint, or a bundled hand: flexible_flyer or david_finger.",
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", "-o", metavar="FILE", help="File to write; NAME.toml by default.")
    ] = None,
    changes: SetOption = None,
    as_json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Write a design file with comments, to be edited: the main parameters, and all others as comments.

    The bundled design of the sensor is the base, or the preset. With a preset or a hand, lengths that nobody measures
    are fitted until the design can be made; what is changed with --set stays. An existing file is never overwritten.
    """
    from fingertip.bundled import list_bundled_files
    from fingertip.design.new_design import write_new_design
    from fingertip.errors import FingertipError, Issue
    from fingertip.files import write_file
    from fingertip.toml_files import DESIGN

    console = Console(as_json, quiet)
    issues = list(find_file_issues("--out", out, ".toml", kept="give another name"))
    if name in list_bundled_files(DESIGN):
        issues.append(Issue("NAME", f"{name} is the name of a bundled design; choose another, such as my_{name}."))
    made = None
    try:
        made = write_new_design(name, sensor, preset, hand, changes or (), console.progress)
    except FingertipError as error:
        options = {"name": "NAME", "sensor": "--sensor", "preset": "--preset"}
        issues += (Issue(options.get(issue.field, issue.field), issue.message) for issue in error.issues)
    path = out or Path(f"{name}.toml")
    if made and out is None:
        issues += find_file_issues("--out", path, ".toml", kept="give another name")
    if issues:
        raise FingertipError(issues)
    assert made
    following = f"fingertip make {shlex.quote(path.as_posix())}"
    data: dict[str, Any] = {
        "design": path.as_posix(), "name": name, "sensor": made.design.sensor.model, "base": made.base,
        "fitted": {name: list(values) for name, values in made.fitted.items()}, "reasons": dict(made.reasons),
        "next": following,
    }  # fmt: skip
    lines = [f"fitted: {name} {before:g} -> {after:g}" for name, (before, after) in made.fitted.items()]
    lines += [f"note: {reason}: a measured value was changed" for reason in made.reasons.values()]
    if preset or hand:
        from fingertip.cad.kernel.mesh import MeshEvaluator
        from fingertip.cad.strength.assess import assess_strength, describe_strength, strength_data
        from fingertip.cad.verification.check import list_warnings
        from fingertip.cad.verification.strength import check_strength

        strength = assess_strength(made.design, MeshEvaluator(_TOLERANCE_MM))
        data["strength"] = strength_data(strength)
        lines += describe_strength(strength)
        lines += (f"warning: {text}" for text in list_warnings(check_strength(made.design, strength)))
    write_file(path, made.text.encode())
    console.result(data, "\n".join([*lines, f"wrote {path}; edit it, then run: {following}"]))
