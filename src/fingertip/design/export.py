"""A design as a document: commented TOML, a table of all parameters, a JSON schema for editors."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal, get_args, get_origin

from pydantic.fields import FieldInfo

from fingertip.design.model import Design
from fingertip.design.parameters import ParameterTable


@dataclass(frozen=True)
class Parameter:
    """One parameter as a person looks it up."""

    path: str
    default: Any
    unit: str
    bounds: str
    description: str


def list_parameters() -> Iterator[Parameter]:
    """Every parameter of a design file, in its order there."""
    for name, info in Design.model_fields.items():
        if isinstance(info.default, ParameterTable):
            for key, field in type(info.default).model_fields.items():
                yield _parameter(f"{name}.{key}", field)
        else:
            yield _parameter(name, info)


def json_schema() -> dict[str, Any]:
    """JSON schema of a design file (also valid for TOML editors)."""
    return Design.model_json_schema()


def to_toml(design: Design, heading: str = "") -> str:
    """The whole design as TOML, every parameter with its unit, bounds and meaning as a comment.

    Reading it back gives an equal design.
    """
    import tomlkit

    document = tomlkit.document()
    for line in heading.splitlines():
        document.add(tomlkit.comment(line) if line else tomlkit.nl())
    for name, _info in Design.model_fields.items():
        value = getattr(design, name)
        if not isinstance(value, ParameterTable):
            document.add(name, value)
            continue
        table = tomlkit.table()
        for line in (type(value).__doc__ or "").splitlines():
            table.add(tomlkit.comment(line))
        for key, field in type(value).model_fields.items():
            parameter = _parameter(f"{name}.{key}", field)
            item = tomlkit.item(getattr(value, key))
            limits = f" [{parameter.bounds}]" if parameter.bounds else ""
            item.comment(parameter.description + limits)
            table.add(key, item)
        document.add(tomlkit.nl())
        document.add(name, table)
    return tomlkit.dumps(document)


def _parameter(path: str, field: FieldInfo) -> Parameter:
    extra = field.json_schema_extra
    unit = str(extra.get("unit", "")) if isinstance(extra, dict) else ""
    return Parameter(path, field.default, unit, _bounds(field), field.description or "")


def _bounds(field: FieldInfo) -> str:
    if get_origin(field.annotation) is Literal:
        return " | ".join(get_args(field.annotation))
    limit = {
        name: value
        for item in field.metadata
        for name in ("ge", "gt", "le")
        if (value := getattr(item, name, None)) is not None
    }
    low = f">= {limit['ge']:g}" if "ge" in limit else f"> {limit['gt']:g}" if "gt" in limit else ""
    high = f"<= {limit['le']:g}" if "le" in limit else ""
    return ", ".join(part for part in (low, high) if part)
