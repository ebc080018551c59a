"""Figures of an object as text, and their comparison with an approved file.

After a change that is meant, `FINGERTIP_APPROVE=1 FINGERTIP_FULL=1 pytest tests/cad/test_approved.py
tests/design/test_rules.py` writes the files; then read the difference.
"""

from __future__ import annotations

import dataclasses
import os
import re
from collections.abc import Iterator, Mapping
from functools import cached_property
from pathlib import Path

import pytest

_NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[-+]?\d+)?")


def check_figures(path: Path, text: str, rel: float = 1e-4) -> None:
    """Compare a text with the approved one, word by word, and its numbers within this distance, also relative."""
    if os.environ.get("FINGERTIP_APPROVE"):
        path.write_text(text, encoding="utf-8")
    expected = path.read_text(encoding="utf-8").splitlines()
    found = text.splitlines()
    assert [_NUMBER.sub("#", line) for line in found] == [_NUMBER.sub("#", line) for line in expected]
    for line, other in zip(found, expected, strict=True):
        numbers, approved = ([float(word) for word in _NUMBER.findall(each)] for each in (line, other))
        assert numbers == pytest.approx(approved, rel=rel, abs=rel), f"{line}\napproved: {other}"


def check_section(path: Path, heading: str, text: str) -> None:
    """Compare a text with a section of an approved file, whose sections begin with "# " and their heading."""
    _, *sections = path.read_text(encoding="utf-8").split("# ")
    approved = dict(section.split("\n", 1) for section in sections)
    if os.environ.get("FINGERTIP_APPROVE"):
        approved[heading] = text
        path.write_text("".join(f"# {name}\n{body}" for name, body in approved.items()), encoding="utf-8")
    assert text == approved[heading]


def render(value: object) -> str:
    """Write a value with six digits of each number; of an object, its name and its fields."""
    match value:
        case bool() | None | str():
            return repr(value)
        case float():
            return f"{value:.6g}" if abs(value) > 1e-12 else "0"
        case int():
            return str(value)
        case tuple() | list():
            return f"({', '.join(map(render, value))})"
        case Mapping():
            return f"{{{', '.join(f'{key}: {render(item)}' for key, item in value.items())}}}"
    if dataclasses.is_dataclass(value):
        fields = (f"{field.name}={render(getattr(value, field.name))}" for field in dataclasses.fields(value))
        return f"{type(value).__name__}({', '.join(fields)})"
    return str(value)


def list_properties(value: object) -> Iterator[str]:
    """Yield a line for each property of an object, in the order of its class."""
    for name, member in vars(type(value)).items():
        if isinstance(member, (property, cached_property)) and not name.startswith("_"):
            yield f"{name} = {render(getattr(value, name))}"
