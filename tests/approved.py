"""Comparison of a text with an approved file: exact, or words and quotations exactly and numbers
within a tolerance.

Each approved file holds its text as it stands. After a change that is meant,
`FINGERTIP_APPROVE=1 FINGERTIP_FULL=1 pytest FILE` writes the files of a test anew; then read the
difference that git shows.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterable, Iterator
from itertools import zip_longest
from pathlib import Path
from typing import Any

import pytest

from fingertip import __version__

_QUOTED = re.compile(r"'[^']*'")
_NUMBER = re.compile(r"(?<![\w#.])-?\d+(?:\.\d+)?(?:e[-+]?\d+)?")


def check_text(path: Path, text: str | bytes) -> None:
    """Compare a text with an approved file, or approve it."""
    text = text if isinstance(text, str) else text.decode()
    _write_if_approving(path, text)

    assert text == read_text(path)


def check_figures(path: Path, lines: Iterable[str], rel: float = 2e-3, abs_: float = 0.02) -> None:
    """Compare lines with those of an approved file, numbers within a tolerance, or approve them."""
    text = "\n".join(lines).replace(__version__, "VERSION") + "\n"
    _write_if_approving(path, text)

    approved_lines = read_text(path).splitlines()
    for line, approved in zip_longest(text.splitlines(), approved_lines, fillvalue="(no line)"):
        assert _is_alike(line, approved, rel, abs_), f"{line} | {approved}"


def list_data(data: Any, name: str = "") -> Iterator[str]:
    """Lines of data of a JSON file: what is long is split into its parts."""
    line = f"{name}: {json.dumps(data)}"
    if len(line) <= 400 or not isinstance(data, dict | list):
        yield line
    else:
        for key, value in data.items() if isinstance(data, dict) else enumerate(data):
            yield from list_data(value, f"{name}.{key}" if name else f"{key}")


def read_text(path: Path) -> str:
    """Read an approved text; one that is not written yet is empty."""
    return path.read_text(encoding="utf-8") if path.exists() else ""


def _write_if_approving(path: Path, text: str) -> None:
    if os.environ.get("FINGERTIP_APPROVE"):
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")


def _is_alike(line: str, approved: str, rel: float, abs_: float) -> bool:
    """Return whether words and quotations are the same, and numbers within the tolerance."""
    if line == approved:
        return True
    if _NUMBER.sub("0", line) != _NUMBER.sub("0", approved):
        return False
    if _QUOTED.findall(line) != _QUOTED.findall(approved):
        return False

    numbers = [float(number) for number in _NUMBER.findall(line)]
    wanted = [float(number) for number in _NUMBER.findall(approved)]
    return numbers == pytest.approx(wanted, rel=rel, abs=abs_)
