"""Defaults < file(s) < changes on the command line: reading and merging, before anything is validated."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from fingertip.errors import DesignError, Issue


def load_tables(files: Iterable[str | Path], changes: Iterable[str]) -> dict[str, Any]:
    """Merge TOML files, then `table.key=value` changes, into one nested mapping.

    Raises
    ------
    DesignError
        With every file that cannot be read and every change that cannot be understood.
    """
    if isinstance(changes, str):
        raise DesignError(Issue("changes", f"{changes!r} is one text; give a list, such as {[changes]!r}."))
    merged: dict[str, Any] = {}
    issues: list[Issue] = []
    for path in map(Path, files):
        try:
            _merge(merged, tomllib.loads(path.read_text(encoding="utf-8-sig")))
        except tomllib.TOMLDecodeError as error:
            issues.append(Issue(str(path), f"is no valid TOML: {error}."))
        except UnicodeDecodeError:
            issues.append(Issue(str(path), "is not UTF-8 text; a design is a TOML file."))
        except OSError as error:
            issues.append(Issue(str(path), f"cannot be read ({error.strerror}); give the path of a design file."))
    for change in changes:
        try:
            _merge(merged, parse_change(change))
        except DesignError as error:
            issues.extend(error.issues)
    if issues:
        raise DesignError(issues)
    return merged


def parse_change(change: str) -> dict[str, Any]:
    """`"mold.draft_deg=2"` -> ``{"mold": {"draft_deg": 2}}``; a value that is no TOML is taken as text."""
    key, equals, text = change.partition("=")
    steps = [step.strip() for step in key.split(".")]
    if not equals or not all(steps):
        raise DesignError(Issue(f"--set {change}", "is not of the form table.key=value, such as mold.draft_deg=2."))
    try:
        value: Any = tomllib.loads(f"v = {text}")["v"]
    except tomllib.TOMLDecodeError:
        value = text.strip()
    for step in reversed(steps):
        value = {step: value}
    return dict(value)


def _merge(into: dict[str, Any], new: Mapping[str, Any]) -> None:
    for key, value in new.items():
        if isinstance(value, Mapping) and isinstance(into.get(key), dict):
            _merge(into[key], value)
        else:
            into[key] = value
