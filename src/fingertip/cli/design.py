"""Command `fingertip new`: begin a design of one's own."""

from __future__ import annotations

import contextlib
import json
import math
import shlex
from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fingertip.catalogues.sensors import CATALOGUE
from fingertip.cli.completion import SHELLS, read_script
from fingertip.cli.console import Console
from fingertip.cli.options import (
    OptionalDesignArgument,
    QuietOption,
    SetOption,
    command,
    find_file_issues,
    find_idle_issues,
    load_design,
    refuse,
)
from fingertip.foundation.errors import DesignError, FingertipError, Issue, gather

if TYPE_CHECKING:
    from fingertip.cad.verification.check import Check
    from fingertip.design import Design
    from fingertip.design.new_design import NewDesign

_LOADS = ("grip", "shock")
_LARGER_MM = (1.0, 2.0, 3.0, 4.0)
"""Widths by which a finger that fails is made larger, and its height by half of them, until one passes [mm]."""


@command
def new(
    console: Console,
    name: Annotated[str, typer.Argument(help="Name of the design: up to 40 letters, digits, - and _.")],
    sensor: Annotated[
        str | None, typer.Option(help=f"Sensor: {', '.join(CATALOGUE)} or custom (see the file); fsr400 by default.")
    ] = None,
    preset: Annotated[
        str | None,
        typer.Option(
            help="Anatomical size, with a joint: adult_finger, adult_thumb, youth_finger, youth_thumb, child_finger or "
            "child_thumb."
        ),
    ] = None,
    hand: Annotated[
        str | None,
        typer.Option(
            metavar="FILE",
            help="File with the sizes of your hand's joint, or a bundled hand: amazing_hand, david_finger, "
            "flexible_flyer, inmoov or orca_hand.",
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", "-o", metavar="FILE", help="File to write; NAME.toml by default.")
    ] = None,
    allow_shorter_travel: Annotated[
        bool,
        typer.Option("--allow-shorter-travel", help="Let the finger bend less, or its tendon lie nearer the joint."),
    ] = False,
    changes: SetOption = None,
) -> None:
    """Write a design file with comments, to be edited: the main parameters, and all others as comments.

    The bundled design of the sensor is the base, or the preset. With a preset or a hand, lengths that nobody measures
    are fitted until the design can be made, and its parts are checked; what is changed with --set stays. An existing
    file is never overwritten.
    """
    from fingertip.catalogues.bundled import list_bundled_files
    from fingertip.catalogues.file_kinds import DESIGN
    from fingertip.design.new_design import write_new_design
    from fingertip.foundation.files import write_file

    issues = list(find_file_issues("--out", out, ".toml", kept="give another name"))
    if name in list_bundled_files(DESIGN):
        issues.append(Issue("NAME", f"{name} is the name of a bundled design; choose another, such as my_{name}."))
    made = None
    found: list[Issue] = []
    with gather(found):
        made = write_new_design(name, sensor, preset, hand, changes or (), console.progress)
        if not allow_shorter_travel:
            found += _find_lost_travel(made)
    options = {"name": "NAME", "sensor": "--sensor", "preset": "--preset"}
    issues += (Issue(options.get(issue.field, issue.field), issue.message) for issue in found)
    path = out or Path(f"{name}.toml")
    if made and out is None:
        issues += find_file_issues("--out", path, ".toml", kept="give another name")
    if issues or made is None:
        raise FingertipError(issues)
    following = f"fingertip make {shlex.quote(path.as_posix())}"
    data: dict[str, Any] = {
        "design": path.as_posix(), "name": name, "sensor": made.design.sensor.model, "base": made.base,
        "fitted": {name: list(values) for name, values in made.fitted.items()}, "reasons": dict(made.reasons),
        "next": following,
    }  # fmt: skip
    lines = [f"fitted: {name} {before:g} -> {after:g}" for name, (before, after) in made.fitted.items()]
    lines += [f"note: {reason}: a measured value was changed" for reason in made.reasons.values()]
    if preset or hand:
        from fingertip.cad.verification.check import list_causes, list_warnings
        from fingertip.cad.verification.strength import describe_strength, strength_data
        from fingertip.cad.verification.verify import check as check_design

        verified = check_design(made.design, progress=console.progress)
        if failed := [check for check in verified.checks if not check.passed]:
            remedy = _find_passing(
                lambda more: write_new_design(name, sensor, preset, hand, [*(changes or ()), *more], console.progress),
                made.design, failed, changes or (), allow_shorter_travel, console.progress,
            )  # fmt: skip
            issues = [
                Issue(check.name, f"{check.value:.3g} {check.unit} must be {check.relation} {check.limit:g}, or `make` "
                      f"fails; {remedy or 'change ' + ' or '.join(list_causes(check.name)) + ' with --set'}")
                for check in failed
            ]  # fmt: skip
            raise FingertipError(issues)
        assert verified.strength
        data["strength"] = strength_data(verified.strength)
        lines += describe_strength(verified.strength)
        lines += (f"warning: {text}" for text in list_warnings(verified.checks))
    write_file(path, made.text.encode())
    console.result(data, "\n".join([*lines, f"wrote {path}; edit it, then run: {following}"]))


def _find_passing(
    make: Callable[[list[str]], NewDesign],
    design: Design,
    failed: Sequence[Check],
    given: Sequence[str],
    allow_shorter_travel: bool,
    progress: Callable[[str], None],
) -> str:
    """Find the first larger finger that passes every check, as options to be typed; else loads that this one holds."""
    from fingertip.cad.verification.verify import check as check_design

    for larger_mm in _LARGER_MM:
        sizes = {"skin.width_mm": larger_mm, "skin.semi_axis_dorsal_mm": larger_mm / 2}
        free = {name: by for name, by in sizes.items() if not any(change.startswith(name) for change in given)}
        settings = [f"{name}={design.value(name) + by:g}" for name, by in free.items()]
        progress(f"trying a larger finger: {' '.join(settings)}")
        with contextlib.suppress(DesignError):
            made = make(settings)
            may_lose = allow_shorter_travel or not _find_lost_travel(made)
            if free and may_lose and all(check.passed for check in check_design(made.design, progress=progress).checks):
                return "it passes with " + " ".join(f"--set {setting}" for setting in settings)
    settings = [
        f"strength.{load}_force_n={math.floor(design.value(f'strength.{load}_force_n') * check.value / check.limit):g}"
        for check in failed
        for load in _LOADS
        if check.name == f"bone.safety_factor.{load}"
    ]
    if len(settings) < len(failed):
        return ""
    return "it holds lighter loads: " + " ".join(f"--set {setting}" for setting in settings)


def _find_lost_travel(made: NewDesign) -> list[Issue]:
    """Find what the fit has taken from the joint: travel, or distance of the tendon."""
    issues = []
    for name, reason in made.reasons.items():
        before, after = made.fitted[name]
        if after < before:
            lost = f"{before:g} would become {after:g}: {reason}"
            issues.append(Issue(name, f"{lost}; allow it with --allow-shorter-travel"))
    return issues


# `fingertip params`: the parameters of a design with values, units, bounds and descriptions.


@command
def params(
    console: Console,
    design: OptionalDesignArgument = None,
    changes: SetOption = None,
    toml: Annotated[bool, typer.Option("--toml", help="Print a complete design file with comments.")] = False,
    schema: Annotated[
        bool, typer.Option("--schema", help="Print the JSON schema of design files, for editors.")
    ] = False,
    html: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.html", help="Write them as a page with a picture of what each changes; takes minutes."
        ),
    ] = None,
) -> None:
    """Print every parameter with its value, unit, bounds and description."""
    from fingertip.design import files as export

    issues = list(find_file_issues("--html", html, ".html"))
    if schema or toml:
        issues += find_idle_issues("--schema" if schema else "--toml", {"--html": html, "--toml": schema and toml})
    refuse(issues)
    loaded = load_design(design, changes, console)
    if schema:  # The schema is JSON with and without --json.
        console.write(json.dumps(export.json_schema(), indent=2))
    elif toml:
        text = export.to_toml(loaded)
        console.result({"toml": text}, text.removesuffix("\n"))
    elif html:
        from fingertip.page.atlas import write_atlas

        pictures = write_atlas(loaded, html, console.progress)
        said = f"parameters: {html}, {pictures} pictures; open it in a browser, no network is needed"
        console.result({"html": str(html), "pictures": pictures}, said)
    else:
        parameters = [(parameter, loaded.value(parameter.path)) for parameter in export.list_parameters()]
        data = [
            {"name": p.path, "value": value, "default": p.default, "unit": p.unit, "bounds": p.bounds,
             "description": p.description}
            for p, value in parameters
        ]  # fmt: skip
        rows = [(p.path, export.format_value(value), p.unit, p.bounds, p.description) for p, value in parameters]
        console.result({"parameters": data}, export.format_parameter_table(rows))


# Commands `fingertip schema` and `fingertip completion`, for editors and shells.

_MODELS = {
    "design": "design.parameters:Tables", "set": "design.finger_set:SetFile", "scene": "sim:SceneFile",
    "manipulation": "sim:ManipulationFile", "surface": "sim.contact.materials:SurfaceFile",
    "sweep": "sweep.sweep_file:SweepFile",
}  # fmt: skip
KINDS = tuple(_MODELS)
"""Kinds of TOML files that have a schema."""


@command
def schema(
    kind: Annotated[str, typer.Argument(help=f"Kind of file: {', '.join(KINDS)}.")], quiet: QuietOption = False
) -> None:
    """Print the JSON schema of a kind of TOML file, for editors. Bundled files name theirs in their first line."""
    Console(False, quiet).write(json.dumps(make_schema(kind), indent=2))


def make_schema(kind: str) -> dict[str, Any]:
    """Make the JSON schema of a kind of TOML file. Raises DesignError."""
    from fingertip.design.parameters.declaration import suggest_name

    if kind not in _MODELS:
        raise DesignError(Issue("KIND", f"{kind!r} is no kind of file; {suggest_name(kind, KINDS)}"))
    module, _, name = _MODELS[kind].partition(":")
    found = getattr(import_module(f"fingertip.{module}"), name).model_json_schema()
    if kind == "sweep":
        for base in ("design", "scene"):  # the file of a base may be named in place of its tables
            found["properties"][base] = {
                "anyOf": [{"type": "string"}, {"type": "object"}],
                "description": found["properties"][base]["description"],
            }
    schema: dict[str, Any] = _normalise(found)
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}


def _normalise(value: Any) -> Any:
    """Write 1 for 1.0, and leave out that further properties are free: releases of pydantic differ in both."""
    if isinstance(value, dict):
        free = ("additionalProperties", True)
        return {key: _normalise(item) for key, item in value.items() if (key, item) != free}
    if isinstance(value, list):
        return [_normalise(item) for item in value]
    return int(value) if isinstance(value, float) and value.is_integer() else value


@command
def completion(
    shell: Annotated[str, typer.Argument(help="Shell: bash, zsh or fish.")], quiet: QuietOption = False
) -> None:
    """Print a completion script for a shell: commands, options, bundled names and parameters after --set.

    For bash, add this line to ~/.bashrc: eval "$(fingertip completion bash)". For zsh, add eval "$(fingertip completion
    zsh)" to ~/.zshrc, after compinit. For fish, write the script to ~/.config/fish/completions/fingertip.fish.
    """
    from fingertip.design.parameters.declaration import suggest_name

    if shell not in SHELLS:
        raise DesignError(Issue("SHELL", f"{shell!r} has no completion; {suggest_name(shell, SHELLS)}"))
    Console(False, quiet).write(read_script(shell))
