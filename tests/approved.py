"""Comparison of a text with an approved file: words and quotations exactly, other numbers within a tolerance.

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
_NUMBER = re.compile(r"(?<![\w#.])-?\d+(?:\.\d+)?(?:e[-+]\d+)?")


def check_approved(path: Path, lines: Iterable[str], rel: float = 2e-3, abs_: float = 0.02) -> None:
    """Compare lines with those of an approved file, or approve them."""
    text = "\n".join(lines).replace(__version__, "VERSION") + "\n"
    if os.environ.get("FINGERTIP_APPROVE"):
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")
    for line, approved in zip_longest(text.splitlines(), path.read_text(encoding="utf-8").splitlines()):
        if line != approved:
            assert _NUMBER.sub("0", line or "") == _NUMBER.sub("0", approved or ""), f"{line} | {approved}"
            assert _QUOTED.findall(line or "") == _QUOTED.findall(approved or ""), f"{line} | {approved}"
            found, wanted = ([float(number) for number in _NUMBER.findall(one)] for one in (line, approved))
            assert found == pytest.approx(wanted, rel=rel, abs=abs_), f"{line} | {approved}"
