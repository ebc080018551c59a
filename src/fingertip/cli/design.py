"""Commands `fingertip params`, `schema` and `completion`, for users, editors and shells."""

from __future__ import annotations

import json
from importlib import import_module
from pathlib import Path
from typing import Any

import typer

from fingertip.cli import options
from fingertip.cli.completion import SHELLS, read_script
from fingertip.cli.console import Console
from fingertip.cli.options import command, flag, load_design
from fingertip.foundation.errors import DesignError, Issue, join_words


@command
def params(
    console: Console,
    design: Path | None = options.OPTIONAL_DESIGN,
    changes: list[str] | None = options.CHANGES,
    toml: bool = flag("Print a complete design file with comments."),
) -> None:
    """Print every parameter with its value, unit, bounds, kind (wish, measurement or derived) and
    description.
    """
    from fingertip.design import design_file as export

    loaded = load_design(design, changes, console)

    if toml:
        text = export.to_toml(loaded)
        console.result({"toml": text}, text.removesuffix("\n"))
    else:
        data = []
        rows = []
        for parameter in export.list_parameters():
            value = loaded.value(parameter.path)
            facts = (parameter.unit, parameter.bounds, parameter.kind, parameter.description)
            unit, bounds, kind, description = facts
            rows.append((parameter.path, export.format_value(value), *facts))
            data.append(
                {
                    "name": parameter.path,
                    "value": value,
                    "default": parameter.default,
                    "unit": unit,
                    "bounds": bounds,
                    "kind": kind,
                    "description": description,
                }
            )

        console.result({"parameters": data}, export.format_parameter_table(rows, "kind"))


_MODELS = {
    "design": "design.parameters:Tables",
    "set": "design.finger_set:SetFile",
    "scene": "sim.runs.scene_and_manipulation_files:SceneFile",
    "manipulation": "sim.runs.scene_and_manipulation_files:ManipulationFile",
    "surface": "sim.contact.surface_files:SurfaceFile",
    "sweep": "sweep.sweep_file:SweepFile",
}
KINDS = tuple(_MODELS)
"""Kinds of TOML files that have a schema."""


@command
def schema(
    kind: str = typer.Argument(
        help=f"Kind of file: {', '.join(KINDS)}.", autocompletion=lambda: KINDS
    ),
    quiet: bool = options.QUIET,
) -> None:
    """Print the JSON schema of a kind of TOML file, for editors. Bundled files name theirs in their
    first line.
    """
    Console(quiet=quiet).write(json.dumps(make_schema(kind), indent=2))


def make_schema(kind: str) -> dict[str, Any]:
    """Make the JSON schema of a kind of TOML file. Raises DesignError."""
    from fingertip.design.parameters.declaration import suggest_name

    if kind not in _MODELS:
        raise DesignError(
            Issue("KIND", f"{kind!r} is no kind of file; {suggest_name(kind, KINDS)}")
        )

    module, _, name = _MODELS[kind].partition(":")
    pydantic_schema = getattr(import_module(f"fingertip.{module}"), name).model_json_schema()
    if kind == "sweep":
        for base in ("design", "scene"):  # the file of a base may be named in place of its tables
            pydantic_schema["properties"][base] = {
                "anyOf": [{"type": "string"}, {"type": "object"}],
                "description": pydantic_schema["properties"][base]["description"],
            }

    schema: dict[str, Any] = _normalise(pydantic_schema)
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}


def _normalise(value: Any) -> Any:
    """Write 1 for 1.0, a paragraph in one line, and no further properties that are free.

    Releases of pydantic differ in the first and the last.
    """
    if isinstance(value, dict):
        free = ("additionalProperties", True)
        return {key: _normalise(item) for key, item in value.items() if (key, item) != free}

    if isinstance(value, list):
        return [_normalise(item) for item in value]
    if isinstance(value, str):
        return "\n\n".join(" ".join(paragraph.split()) for paragraph in value.split("\n\n"))

    if isinstance(value, str):  # a docstring is broken into lines where it stands
        return "\n\n".join(" ".join(text.split()) for text in value.split("\n\n"))

    return int(value) if isinstance(value, float) and value.is_integer() else value


@command
def completion(
    shell: str = typer.Argument(help=f"Shell: {join_words(SHELLS, 'or')}."),
    quiet: bool = options.QUIET,
) -> None:
    """Print a completion script for a shell: commands, options, bundled names and parameters after
    --set.

    For bash, add this line to ~/.bashrc: eval "$(fingertip completion bash)". For zsh, add eval
    "$(fingertip completion zsh)" to ~/.zshrc, after compinit. For fish, write the script to
    ~/.config/fish/completions/fingertip.fish.
    """
    from fingertip.design.parameters.declaration import suggest_name

    if shell not in SHELLS:
        raise DesignError(
            Issue("SHELL", f"{shell!r} has no completion; {suggest_name(shell, SHELLS)}")
        )

    Console(quiet=quiet).write(read_script(shell))
