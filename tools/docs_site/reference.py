"""Generated reference: every parameter of a design, and the help page of every command."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import typer.main

from fingertip.cli import app
from fingertip.design.design import Design
from fingertip.design.design_file import Parameter, format_value, list_parameters

WIDTH = 80
"""Width of the help pages [columns]."""


def list_all_parameters() -> str:
    """List all parameters: one table for each table of a design file."""
    lines: list[str] = []
    table = None

    for parameter in list_parameters():
        name, _, _ = parameter.path.rpartition(".")
        if name != table:
            table = name
            header = [
                "| parameter | default | unit | bounds | kind | meaning |",
                "|---|---|---|---|---|---|",
            ]
            lines += ["", *_heading(name), "", *header]

        lines.append(_row(parameter))

    return "\n".join([*lines, ""])


def list_all_commands() -> str:
    """List all commands with their help pages."""
    root: Any = typer.main.get_command(app)
    context = root.make_context("fingertip", [], resilient_parsing=True, terminal_width=WIDTH)
    lines: list[str] = []
    lines += ["```text", root.get_help(context), "```"]
    for name, text in _pages(root, context):
        lines += ["", f"## {name}", "", "```text", text.rstrip(), "```"]

    return "\n".join([*lines, ""])


def _pages(group: Any, parent: Any) -> Iterator[tuple[str, str]]:
    """Name and help page of each command of a group."""
    for name in group.list_commands(parent):
        command = group.get_command(parent, name)
        context = command.make_context(name, [], parent=parent, resilient_parsing=True)
        words = context.command_path.removeprefix("fingertip ")
        yield words, command.get_help(context)
        if hasattr(command, "list_commands"):
            yield from _pages(command, context)


def _heading(table: str) -> list[str]:
    """Heading of a table with its own description."""
    if not table:
        return ["## Name"]

    described = Design.model_fields[table].annotation
    return [f"## {table}", "", " ".join((described.__doc__ or "").split())]


def _row(parameter: Parameter) -> str:
    """Row of one parameter."""
    cells = (
        f"`{parameter.path.rpartition('.')[2]}`",
        f"`{format_value(parameter.default)}`",
        parameter.unit,
        parameter.bounds,
        parameter.kind,
        parameter.description,
    )
    return f"| {' | '.join(_escape(cell) for cell in cells)} |"


def _escape(text: str) -> str:
    """Escape what Markdown would read in a cell of a table."""
    return text.replace("|", "\\|").replace("<", "&lt;").replace(">", "&gt;").replace("[", "\\[")
