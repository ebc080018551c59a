"""Export of a design: as commented TOML, as a list of parameters, and as a JSON schema for editors."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from pydantic.fields import FieldInfo

from fingertip.design.parameters import ParameterTable
from fingertip.design.parameters.declaration import find_bounds, find_unit, list_choices
from fingertip.design.parameters.tables import PARAMETERS, Tables

_MAX_COLUMN_WIDTH = 60
"""Maximum width of a column of the parameter table. A longer entry shifts the rest of its own row only."""


@dataclass(frozen=True)
class Parameter:
    """Entry of one parameter in the list of all parameters."""

    path: str
    """Dotted name, such as "mold.draft_deg"."""
    default: Any
    unit: str
    bounds: str
    """Bounds of a number, such as ">= 0, <= 15", or the words that are accepted."""
    description: str


def list_parameters() -> Iterator[Parameter]:
    """Yield every parameter of a design file, in its order."""
    for path, field in PARAMETERS.items():
        yield Parameter(path, field.default, find_unit(field), _format_bounds(field), field.description or "")


def format_parameter_table(rows: Iterable[Sequence[str]]) -> str:
    """Format rows of name, value, unit, bounds and description as a table with a header."""
    rows = [("parameter", "value", "unit", "bounds", "description"), *rows]
    widths = [max(len(row[i]) for row in rows if len(row[i]) <= _MAX_COLUMN_WIDTH) for i in range(4)]
    lines = (
        f"{name:{widths[0]}}  {value:>{widths[1]}}  {unit:{widths[2]}}  {bounds:{widths[3]}}  {description}"
        for name, value, unit, bounds, description in rows
    )
    return "\n".join(line.rstrip() for line in lines)


def format_value(value: Any) -> str:
    """Format a value as it is written in a TOML file, text without its quotes."""
    if isinstance(value, bool | list | tuple):
        return json.dumps(value)
    return str(value)


def json_schema() -> dict[str, Any]:
    """Return the JSON schema of a design file, which editors of TOML use too."""
    return Tables.model_json_schema()


def to_toml(design: Tables, heading: str = "") -> str:
    """Write a whole design as TOML, each parameter with its description and bounds in a comment.

    Reading the text gives an equal design.
    """
    import tomlkit

    described = {parameter.path: parameter for parameter in list_parameters()}
    document = tomlkit.document()
    for line in heading.splitlines():
        document.add(tomlkit.comment(line) if line else tomlkit.nl())
    for name in Tables.model_fields:
        value = getattr(design, name)
        if not isinstance(value, ParameterTable):
            document.add(name, value)
            continue
        table = tomlkit.table()
        for line in (type(value).__doc__ or "").splitlines():
            table.add(tomlkit.comment(line))
        for key in type(value).model_fields:
            parameter = described[f"{name}.{key}"]
            item = tomlkit.item(getattr(value, key))
            item.comment(parameter.description + (f" [{parameter.bounds}]" if parameter.bounds else ""))
            table.add(key, item)
        document.add(tomlkit.nl())
        document.add(name, table)
    return tomlkit.dumps(document)


def _format_bounds(field: FieldInfo) -> str:
    if choices := list_choices(field):
        return " | ".join(choices)
    bounds = find_bounds(field)
    limits = ((">=", bounds.minimum), (">", bounds.above), ("<=", bounds.maximum))
    return ", ".join(f"{sign} {limit:g}" for sign, limit in limits if limit is not None)
