"""Loading of tables: files and changes on the command line are merged before anything is validated."""

from __future__ import annotations

import copy
import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fingertip.catalogues.bundled import find_file
from fingertip.catalogues.file_kinds import DESIGN, FileKind, read_file
from fingertip.foundation.errors import MAX_VALUE_LENGTH, DesignError, FingertipError, Issue, shorten
from fingertip.foundation.toml_files import MAX_DEPTH, UnusableTomlError, parse_toml


@dataclass(frozen=True)
class LoadedTables:
    """Contents of files, merged with changes."""

    tables: dict[str, Any]
    before: dict[str, Any]
    """The tables without the changes."""
    changed: tuple[str, ...]
    """Names of the changed parameters, such as "mold.draft_deg"."""


def load_tables(files: Iterable[str | Path], changes: Iterable[str], kind: FileKind = DESIGN) -> LoadedTables:
    """Merge TOML files, and then changes of the form `table.key=value`, into nested tables; later values win.

    Raises DesignError.
    """
    if isinstance(changes, str):
        raise DesignError(Issue("changes", f"{changes!r} is a single text; give a list, such as {[changes]!r}."))
    before: dict[str, Any] = {}
    parsed: list[dict[str, Any]] = []
    issues: list[Issue] = []
    for file in files:
        try:
            _merge(before, read_file(find_file(file, kind), kind))
        except FingertipError as error:
            issues.extend(error.issues)
    for change in changes:
        try:
            parsed.append(parse_change(change))
        except DesignError as error:
            issues.extend(error.issues)
    if issues:
        raise DesignError(issues)
    tables = copy.deepcopy(before)
    for nested in parsed:
        _merge(tables, nested)
    return LoadedTables(tables, before, tuple(name for nested in parsed for name in _flatten(nested)))


def parse_change(change: str) -> dict[str, Any]:
    """Parse "mold.draft_deg=2" as ``{"mold": {"draft_deg": 2}}``.

    A value that is not TOML is taken as text, and words in square brackets as a list of texts, because a shell takes
    their quotes away.
    """
    key, equals, text = change.partition("=")
    steps = [step.strip() for step in key.split(".")]
    field = f"--set {shorten(change, MAX_VALUE_LENGTH)}"
    if not equals or not all(steps):
        raise DesignError(Issue(field, "is not of the form table.key=value, such as mold.draft_deg=2."))
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


def _merge(into: dict[str, Any], new: Mapping[str, Any]) -> None:
    """Merge nested tables in place."""
    for key, value in new.items():
        if isinstance(value, Mapping) and isinstance(into.get(key), dict):
            _merge(into[key], value)
        else:
            into[key] = value


def _flatten(tables: Mapping[str, Any]) -> Iterator[str]:
    """Yield the dotted names of nested tables."""
    for name, value in tables.items():
        if isinstance(value, Mapping):
            yield from (f"{name}.{inner}" for inner in _flatten(value))
        else:
            yield name
