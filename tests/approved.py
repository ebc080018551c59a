"""Comparison of a text with an approved file: exact, or words and quotations exactly and numbers
within a tolerance.

A text that stands beside another, the whole of its kind, is stored as its differences: `@@ -12,3
@@` are three lines of the whole from line 12 on, which the lines below replace. After a change that
is meant, `FINGERTIP_APPROVE=1 FINGERTIP_FULL=1 pytest -n 0 FILE` writes both, in any order; then
read the difference. Wholes of the folder `pcb` are written by `fingertip board`, before.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterable, Iterator
from difflib import SequenceMatcher
from itertools import zip_longest
from pathlib import Path
from typing import Any

import pytest

from fingertip import __version__

_HEADING = re.compile(r"Differences from (.+):\n")
_QUOTED = re.compile(r"'[^']*'")
_NUMBER = re.compile(r"(?<![\w#.])-?\d+(?:\.\d+)?(?:e[-+]?\d+)?")


def check_text(path: Path, text: str | bytes, beside: Path | None = None) -> None:
    """Compare a text with an approved file, or with its differences from a whole, or approve it."""
    text = text if isinstance(text, str) else text.decode()
    assert text == _read(path, text, beside)


def check_figures(
    path: Path,
    lines: Iterable[str],
    rel: float = 2e-3,
    abs_: float = 0.02,
    beside: Path | None = None,
) -> None:
    """Compare lines with those of an approved file, numbers within a tolerance, or approve them."""
    text = "\n".join(lines).replace(__version__, "VERSION") + "\n"
    for line, approved in zip_longest(text.splitlines(), _read(path, text, beside).splitlines()):
        if line != approved:
            assert _NUMBER.sub("0", line or "") == _NUMBER.sub("0", approved or ""), (
                f"{line} | {approved}"
            )
            assert _QUOTED.findall(line or "") == _QUOTED.findall(approved or ""), (
                f"{line} | {approved}"
            )
            found, wanted = (
                [float(number) for number in _NUMBER.findall(one)] for one in (line, approved)
            )
            assert found == pytest.approx(wanted, rel=rel, abs=abs_), f"{line} | {approved}"


def list_data(data: Any, name: str = "") -> Iterator[str]:
    """Lines of data of a JSON file: what is long is split into its parts."""
    line = f"{name}: {json.dumps(data)}"
    if len(line) <= 400 or not isinstance(data, dict | list):
        yield line
    else:
        for key, value in data.items() if isinstance(data, dict) else enumerate(data):
            yield from list_data(value, f"{name}.{key}" if name else f"{key}")


def read_text(path: Path) -> str:
    """Read an approved text, of differences the text that has them."""
    stored = path.read_text(encoding="utf-8") if path.exists() else ""
    heading = _HEADING.match(stored)
    return _patch(read_text(path.parent / heading[1]), stored) if heading else stored


def _read(path: Path, text: str, beside: Path | None) -> str:
    if os.environ.get("FINGERTIP_APPROVE"):
        path.parent.mkdir(exist_ok=True)
        others = [other for other in path.parent.iterdir() if _name_whole(other) == path]
        kept = {other: read_text(other) for other in others if other != path}
        _write(path, text, beside)
        for other, content in kept.items():
            _write(other, content, path)
    return read_text(path)


def _name_whole(path: Path) -> Path | None:
    heading = _HEADING.match(path.read_text(encoding="utf-8"))
    return path.parent / heading[1] if heading else None


def _write(path: Path, text: str, beside: Path | None) -> None:
    if beside is not None:
        text = (
            "Differences from "
            f"{os.path.relpath(beside, path.parent)}:\n{_differ(read_text(beside), text)}"
        )
    path.write_text(text, encoding="utf-8")


def _differ(whole: str, text: str) -> str:
    """Return the lines of a text that are not those of a whole."""
    old = whole.split("\n")
    new = text.split("\n")
    lines = list[str]()
    for kind, start, end, first, last in SequenceMatcher(
        None, old, new, autojunk=False
    ).get_opcodes():
        if kind != "equal":
            lines += (
                f"@@ -{start + 1},{end - start} @@",
                *(f"+{line}" for line in new[first:last]),
            )
    return "".join(f"{line}\n" for line in lines)


def _patch(whole: str, differences: str) -> str:
    """Return the text whose differences from a whole are stored."""
    old = whole.split("\n")
    new = list[str]()
    at = 0
    for line in differences.split("\n")[1:-1]:
        if line.startswith("+"):
            new.append(line[1:])
        else:
            start, count = map(int, line.strip("@ -").split(","))
            new += old[at : start - 1]
            at = start - 1 + count
    return "\n".join([*new, *old[at:]])
