"""`fingertip params`: the parameters of a design with values, units, bounds and descriptions."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from fingertip.cli.console import Console, JsonOption, QuietOption, SetOption, command
from fingertip.cli.options import OptionalDesignArgument
from fingertip.cli.output_files import find_file_issues, find_idle_issues


@command
def params(
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
    as_json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Print every parameter with its value, unit, bounds and description."""
    from fingertip.cli.load import load_design
    from fingertip.design import export
    from fingertip.design.export import format_parameter_table, format_value
    from fingertip.errors import OutputError

    console = Console(as_json, quiet)
    issues = list(find_file_issues("--html", html, ".html"))
    if schema or toml:
        issues += find_idle_issues("--schema" if schema else "--toml", {"--html": html, "--toml": schema and toml})
    if issues:
        raise OutputError(issues)
    loaded, _ = load_design(design, changes, console.progress)
    if schema:  # The schema is JSON with and without --json.
        console.write(json.dumps(export.json_schema(), indent=2))
        return
    if toml:
        text = export.to_toml(loaded)
        console.result({"toml": text}, text.removesuffix("\n"))
        return
    if html:
        from fingertip.page_files import write_atlas

        pictures = write_atlas(loaded, html, console.progress)
        said = f"parameters: {html}, {pictures} pictures; open it in a browser, no network is needed"
        console.result({"html": str(html), "pictures": pictures}, said)
        return
    parameters = [(parameter, loaded.value(parameter.path)) for parameter in export.list_parameters()]
    data = [
        {"name": p.path, "value": value, "default": p.default, "unit": p.unit, "bounds": p.bounds,
         "description": p.description}
        for p, value in parameters
    ]  # fmt: skip
    rows = [(p.path, format_value(value), p.unit, p.bounds, p.description) for p, value in parameters]
    console.result({"parameters": data}, format_parameter_table(rows))
