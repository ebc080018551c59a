"""Design files: their tables are read and merged before anything is validated, and designs are
written as TOML.
"""

from __future__ import annotations

import copy
import json
import re
import tomllib
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic.fields import FieldInfo

from fingertip.catalogues.electronics import spell_sensor
from fingertip.catalogues.file_kinds import DESIGN, FileKind, find_file, read_file
from fingertip.design.parameters import PARAMETERS, ParameterTable, Tables, find_kind
from fingertip.design.parameters.declaration import (
    describe_table,
    find_bounds,
    find_unit,
    list_choices,
)
from fingertip.design.proportions import fill_in
from fingertip.foundation.errors import (
    MAX_VALUE_LENGTH,
    ArgumentError,
    DesignError,
    Issue,
    gather,
    quote_value,
    raise_issues,
    shorten,
)
from fingertip.foundation.input_files import is_safe_name
from fingertip.foundation.tables import MAX_DEPTH, UnusableTomlError, parse_toml


@dataclass(frozen=True)
class LoadedTables:
    """Tables of the files of a design, with the changes made, and before them."""

    tables: dict[str, Any]
    before: dict[str, Any]
    changed: tuple[str, ...]
    """Names of the changed parameters, such as "skin.width_mm"."""
    provisional: tuple[str, ...] = ()
    """Names of the unchanged parameters that the files mark as guessed or lowered."""


Changes = Iterable[str] | Mapping[str, Any]
"""Changes of parameters: texts such as "skin.width_mm=18", or {"skin.width_mm": 18}, or nested
tables.
"""


def list_changes(changes: Changes) -> Sequence[str]:
    """List changes as texts. Raises DesignError if they are a single text."""
    if isinstance(changes, str):
        raise DesignError(Issue("changes", f"{changes!r} is a single text; use --set {changes}."))
    if isinstance(changes, Mapping):
        return _list_values(changes)

    texts = list(changes)
    for change in texts:
        if not isinstance(change, str):
            problem = f"holds {quote_value(change)}; give texts such as skin.width_mm=18."
            raise ArgumentError(Issue("changes", problem))

    return texts


def _list_values(changes: Mapping[str, Any]) -> list[str]:
    """List the values of a mapping, or of nested ones, as texts. Raises DesignError."""
    import tomlkit  # noqa: PLC0415

    texts = list[str]()
    values = dict[str, Any]()

    for name, value in flatten(changes):
        known = values.setdefault(name, value)
        if known is not value:
            message = (
                f"is given twice, as {quote_value(known)} and as {quote_value(value)}; "
                "give it once."
            )
            raise DesignError(Issue(f"changes {name}", message))

        plain = value.tolist() if hasattr(value, "tolist") else value  # of numpy
        try:
            texts.append(f"{name}={tomlkit.item(plain).as_string()}")
        except ValueError:
            message = (
                f"{quote_value(value)} is no value; give a number, a text, True, False or a list."
            )
            raise DesignError(Issue(f"changes {name}", message)) from None

    return texts


def load_tables(
    files: Iterable[str | Path],
    changes: Changes,
    kind: FileKind = DESIGN,
    below: Path | None = None,
) -> LoadedTables:
    """Merge TOML files, then changes of the form `table.key=value`; later values win.

    What design files leave out follows the nearest proven finger (see `design.proportions`). Files
    that another file names are read `below` its folder (see `read_input`). Raises DesignError.
    """
    before: dict[str, Any] = {}
    parsed: list[dict[str, Any]] = []
    issues: list[Issue] = []
    marked = dict[str, None]()

    for file in files:
        with gather(issues):
            path = find_file(file, kind)
            tables = read_file(path, kind, below)
            resolve_names(tables, path.parent)
            merge(before, tables)
            marked |= dict.fromkeys(_find_marked(path))

    for change in list_changes(changes):
        with gather(issues):
            parsed.append(parse_change(change))

    raise_issues(DesignError, issues)
    if before and kind is DESIGN:
        before = fill_in(before)

    tables = copy.deepcopy(before)
    for nested in parsed:
        merge(tables, nested)

    _spell_sensor(before)
    _spell_sensor(tables)
    changed = list[str]()
    for nested in parsed:
        changed += [name for name, _ in flatten(nested)]

    provisional = tuple(name for name in marked if name not in changed)
    return LoadedTables(tables, before, tuple(changed), provisional)


def _spell_sensor(tables: dict[str, Any]) -> None:
    """Replace the name of the sensor by that of the catalogue."""
    sensor = tables.get("sensor")
    model = sensor.get("model") if isinstance(sensor, dict) else None
    if isinstance(sensor, dict) and isinstance(model, str):
        sensor["model"] = spell_sensor(model)


_MARKS = {
    "hand": ("guessed: measure it. ", "measurement"),
    "strength": ("lowered to what the bone holds. ", "derived"),
}
"""Table -> beginning of the comment and kind of those of its parameters that are provisional."""
_MARKED = re.compile(
    rf"^(?:\[([\w.]+)\]|([\w.]+) *=.*# (?:{'|'.join(mark for mark, _ in _MARKS.values())}))", re.M
)


def _find_marked(path: Path) -> Iterator[str]:
    """Find the parameters whose comments in a design file begin with a mark."""
    if not path.is_file():
        return

    prefix = ""
    for table, name in _MARKED.findall(path.read_text(encoding="utf-8")):
        prefix = f"{table}." if table else prefix
        if name:
            yield prefix + name


def resolve_names(tables: Mapping[str, Any], folder: Path) -> None:
    """Replace the names of files that tables name by paths in their folder. Raises DesignError."""
    bone = tables.get("bone")
    name = bone.get("adapter_file") if isinstance(bone, dict) else None
    if not isinstance(bone, dict) or not isinstance(name, str) or not name:
        return

    if not is_safe_name(name):
        problem = f"{quote_value(name)} is no name of a file beside the design file"
        raise DesignError(Issue("bone.adapter_file", f"{problem}; put it there."))

    bone["adapter_file"] = str(folder / name)


def parse_change(change: str) -> dict[str, Any]:
    """Parse "skin.width_mm=18" as ``{"skin": {"width_mm": 18}}``.

    A shell takes quotes away: a value that is not TOML is a text, and words in square brackets are
    a list of texts.
    """
    key, equals, text = change.partition("=")
    steps = [step.strip() for step in key.split(".")]
    field = f"--set {shorten(change, MAX_VALUE_LENGTH)}"

    if not equals or not all(steps):
        raise DesignError(
            Issue(field, "is not of the form table.key=value, such as skin.width_mm=18.")
        )
    if len(steps) > MAX_DEPTH:
        raise DesignError(Issue(field, "names tables in too many tables; write table.key=value."))
    if re.search(r",\s*[a-z_]+\.[a-z0-9_.]+\s*=", text):
        raise DesignError(Issue(field, "holds several changes; give --set once for each of them."))

    try:
        value: Any = parse_toml(f"v = {text}")["v"]
    except UnusableTomlError as error:
        raise DesignError(Issue(field, f"{error}.")) from None
    except tomllib.TOMLDecodeError:
        value = text.strip()
        if re.fullmatch(r"\[\s*\w+(\s*,\s*\w+)*\s*\]", value):
            value = [word.strip() for word in value[1:-1].split(",")]

    for step in reversed(steps):
        value = {step: value}

    return dict(value)


def merge(into: dict[str, Any], new: Mapping[str, Any]) -> None:
    """Merge new values into nested tables, in place."""
    for key, value in new.items():
        if isinstance(value, Mapping) and isinstance(into.get(key), dict):
            merge(into[key], value)
        else:
            into[key] = value


def flatten(tables: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """Yield the values of nested tables, each with its dotted name."""
    for name, value in tables.items():
        if isinstance(value, Mapping):
            yield from ((f"{name}.{inner}", leaf) for inner, leaf in flatten(value))
        else:
            yield name, value


_MAX_COLUMN_WIDTH = 60
"""Maximum width of a column of the parameter table.
A longer entry shifts the rest of its own row only.
"""


@dataclass(frozen=True)
class Parameter:
    """Parameter of a design, as lists show it."""

    path: str
    """Dotted name, such as "skin.width_mm"."""
    default: Any
    unit: str
    bounds: str
    """Bounds of a number, such as ">= 0, <= 15", or the words that are accepted."""
    kind: str
    """wish, measurement or derived (see `find_kind`)."""
    description: str


def list_parameters(provisional: Collection[str] = ()) -> Iterator[Parameter]:
    """Yield all parameters; the descriptions of those that are provisional say so."""
    for path, field in PARAMETERS.items():
        mark = ""
        kind: str = find_kind(path)
        if path in provisional:
            mark, kind = _MARKS[path.partition(".")[0]]

        yield Parameter(
            path=path,
            default=field.default,
            unit=find_unit(field),
            bounds=format_bounds(field),
            kind=kind,
            description=mark + (field.description or ""),
        )


def format_parameter_table(rows: Iterable[Sequence[str]], *more: str) -> str:
    """Format rows of name, value, unit, bounds, `more` and description as a table with a header."""
    rows = [("parameter", "value", "unit", "bounds", *more, "description"), *rows]
    widths = [
        max(len(cell) for cell in column if len(cell) <= _MAX_COLUMN_WIDTH)
        for column in zip(*rows, strict=True)
    ]
    lines = []
    for row in rows:
        cells = [cell.ljust(width) for cell, width in zip(row, widths, strict=True)]
        cells[1] = row[1].rjust(widths[1])
        lines.append("  ".join(cells).rstrip())

    return "\n".join(lines)


def format_value(value: Any) -> str:
    """Format a value as it is written in a TOML file, text without its quotes."""
    if isinstance(value, bool | list | tuple):
        return json.dumps(value)

    return str(value)


def to_toml(design: Tables, heading: str = "") -> str:
    """Write a whole design as TOML that reads back as equal, with comments on each parameter."""
    import tomlkit  # noqa: PLC0415

    design = design.with_bare_names()
    described = {
        parameter.path: parameter
        for parameter in list_parameters(getattr(design, "provisional", ()))
    }
    document = tomlkit.document()
    for line in heading.splitlines():
        document.add(tomlkit.comment(line) if line else tomlkit.nl())

    for move in getattr(design, "moves", ()):
        document.add(
            tomlkit.comment(f"Fitted: {move.name} was {format_value(move.before)}; {move.reason}")
        )

    for name in Tables.model_fields:
        value = getattr(design, name)
        if not isinstance(value, ParameterTable):
            document.add(name, value)
            continue

        table = tomlkit.table()
        table.add(tomlkit.comment(describe_table(type(value))))
        for key in type(value).model_fields:
            parameter = described[f"{name}.{key}"]
            bounds = f" [{parameter.bounds}]" if parameter.bounds else ""
            item = tomlkit.item(getattr(value, key))
            item.comment(f"{parameter.description}{bounds}")
            table.add(key, item)

        document.add(tomlkit.nl())
        document.add(name, table)

    return tomlkit.dumps(document)


def format_bounds(field: FieldInfo) -> str:
    """Format the bounds of a number, or the words that a parameter accepts."""
    choices = list_choices(field)
    if choices:
        return " | ".join(choices)

    bounds = find_bounds(field)
    limits = ((">=", bounds.minimum), (">", bounds.above), ("<=", bounds.maximum))
    return ", ".join(f"{sign} {limit:g}" for sign, limit in limits if limit is not None)
