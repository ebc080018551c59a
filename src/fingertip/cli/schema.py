"""Command `fingertip schema`: JSON schemas of the TOML files, for editors and checkers."""

from __future__ import annotations

import json
from typing import Annotated, Any

import typer

from fingertip.cli.console import Console, QuietOption, command

KINDS = ("design", "scene", "manipulation", "sweep")
"""Kinds of TOML files that have a schema."""


@command
def schema(
    kind: Annotated[str, typer.Argument(help=f"Kind of file: {', '.join(KINDS)}.")],
    quiet: QuietOption = False,
) -> None:
    """Print the JSON schema of a kind of TOML file, for editors. Bundled files name theirs in their first line."""
    Console(False, quiet).write(format_schema(kind))


def format_schema(kind: str) -> str:
    """Format the JSON schema of a kind of TOML file.

    Raises
    ------
    DesignError
        If there is no such kind.
    """
    return json.dumps(make_schema(kind), indent=2)


def make_schema(kind: str) -> dict[str, Any]:
    """Make the JSON schema of a kind of TOML file.

    Raises
    ------
    DesignError
        If there is no such kind.
    """
    from fingertip.design.issues import suggest_name
    from fingertip.errors import DesignError, Issue

    if kind == "design":
        from fingertip.design.export import json_schema

        found = json_schema()
    elif kind == "scene":
        from fingertip.sim import SceneFile

        found = SceneFile.model_json_schema()
    elif kind == "manipulation":
        from fingertip.sim import ManipulationFile

        found = ManipulationFile.model_json_schema()
    elif kind == "sweep":
        from fingertip.sweep.sweep_file import SweepFile

        found = SweepFile.model_json_schema()
        for base in ("design", "scene"):  # the file of a base may be named in place of its tables
            found["properties"][base] = {
                "anyOf": [{"type": "string"}, {"type": "object"}],
                "description": found["properties"][base]["description"],
            }
    else:
        raise DesignError(Issue("KIND", f"{kind!r} is no kind of file; {suggest_name(kind, KINDS)}"))
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
