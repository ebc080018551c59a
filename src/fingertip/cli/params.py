"""`fingertip params`: what can be set, in which unit, within which bounds."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from fingertip.cli.console import Console, JsonOption, QuietOption, SetOption, command


@command
def params(
    design: Annotated[Path | None, typer.Argument(help="Show this design's values; without it, the defaults.")] = None,
    changes: SetOption = None,
    toml: Annotated[bool, typer.Option("--toml", help="Print a complete, commented design file.")] = False,
    schema: Annotated[
        bool, typer.Option("--schema", help="Print the JSON schema of design files, for editors.")
    ] = False,
    as_json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Print every parameter: value, unit, bounds, meaning."""
    from fingertip.cli.load import load_design
    from fingertip.design import export

    console = Console(as_json, quiet)
    loaded, _ = load_design(design, changes)
    if schema:  # one JSON object by itself
        console.write(json.dumps(export.json_schema(), indent=2))
        return
    if toml:
        text = export.to_toml(loaded)
        console.result({"toml": text}, text.removesuffix("\n"))
        return
    values = {p.path: _value(loaded, p.path) for p in export.list_parameters()}
    data = [
        {"name": p.path, "value": values[p.path], "default": p.default, "unit": p.unit, "bounds": p.bounds,
         "description": p.description}
        for p in export.list_parameters()
    ]  # fmt: skip
    lines = [
        f"{p.path:32} {values[p.path]!s:>10} {p.unit:8} {p.bounds:24} {p.description}" for p in export.list_parameters()
    ]
    console.result({"parameters": data}, "\n".join(lines))


def _value(design: object, path: str) -> object:
    for step in path.split("."):
        design = getattr(design, step)
    return design
