"""Comparison of a text with an approved file: exact, or words and quotations exactly and numbers within a tolerance.

After a change that is meant, `FINGERTIP_APPROVE=1 FINGERTIP_FULL=1 pytest FILE` writes them; then read the difference.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from itertools import zip_longest
from pathlib import Path

import pytest

from fingertip.foundation.version import __version__

_QUOTED = re.compile(r"'[^']*'")
_NUMBER = re.compile(r"(?<![\w#.])-?\d+(?:\.\d+)?(?:e[-+]?\d+)?")


def check_text(path: Path, text: str | bytes) -> None:
    """Compare a text with an approved file, or approve it."""
    text = text if isinstance(text, str) else text.decode()
    assert text == _read(path, text)


def check_figures(path: Path, lines: Iterable[str], rel: float = 2e-3, abs_: float = 0.02) -> None:
    """Compare lines with those of an approved file, numbers within a tolerance, or approve them."""
    text = "\n".join(lines).replace(__version__, "VERSION") + "\n"
    for line, approved in zip_longest(text.splitlines(), _read(path, text).splitlines()):
        if line != approved:
            assert _NUMBER.sub("0", line or "") == _NUMBER.sub("0", approved or ""), f"{line} | {approved}"
            assert _QUOTED.findall(line or "") == _QUOTED.findall(approved or ""), f"{line} | {approved}"
            found, wanted = ([float(number) for number in _NUMBER.findall(one)] for one in (line, approved))
            assert found == pytest.approx(wanted, rel=rel, abs=abs_), f"{line} | {approved}"


def _read(path: Path, text: str) -> str:
    if os.environ.get("FINGERTIP_APPROVE"):
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return path.read_text(encoding="utf-8")
