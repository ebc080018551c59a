"""Ceilings of weight: lines of the wheel and of what carries it. Raise one only where an issue says so."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.conftest import ROOT

CEILINGS = {"src": 61_760, "modules": 364, "tests": 33_000, "approved": 14_000, "moved": 2_400, "templates": 289}
MOVED = ("slip/mix.py", "slip/mix_signals.py", "slip/__main__.py", "peers/__main__.py", "command.py")
"""What of `benchmarks` was in the wheel before."""


def _count_lines(*paths: Path) -> int:
    return sum(path.read_bytes().count(b"\n") for path in paths)


@pytest.mark.parametrize("what", CEILINGS)
@pytest.mark.every_case
def test_weight_stays_below_its_ceiling(what: str) -> None:
    files = [path for path in (ROOT / "tests").rglob("*") if path.is_file() and "__pycache__" not in path.parts]
    approved = [path for path in files if {"approved", "transcripts"} & set(path.relative_to(ROOT).parts[:-1])]
    sources = [path for path in (ROOT / "src").rglob("*") if path.suffix in (".py", ".md", ".txt")]
    article = ROOT / "tools" / "article"
    found = {
        "src": _count_lines(*(path for path in sources if not any(".egg-info" in part for part in path.parts))),
        "modules": sum(path.suffix == ".py" for path in sources),
        "tests": _count_lines(*(path for path in files if path.suffix == ".py")),
        "approved": _count_lines(*approved),
        "moved": _count_lines(*article.rglob("*.py"), *(ROOT / "benchmarks" / name for name in MOVED)),
        "templates": _count_lines(*article.rglob("*.md")),
    }
    assert found[what] <= CEILINGS[what]
