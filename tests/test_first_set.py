"""First set of tests: what it leaves out."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.conftest import ROOT, run_python

TESTS = """
import pytest

@pytest.mark.full
def test_full(): pass

@pytest.mark.parametrize("case", range(20))
def test_many(case): pass

@pytest.mark.every_case
@pytest.mark.parametrize("case", range(20))
def test_every(case): pass
"""


@pytest.mark.parametrize(("full", "expected"), [("", 23), ("1", 41)], ids=["first", "all"])
def test_cases(tmp_path: Path, full: str, expected: int) -> None:
    (tmp_path / "test_some.py").write_text(TESTS, encoding="utf-8")
    marks = ("-o", "markers=full\nevery_case")
    words = ("-m", "pytest", "-q", "-p", "tests.first_set", "-p", "no:cacheprovider", *marks, str(tmp_path))
    done = run_python(*words, FINGERTIP_FULL=full, PYTHONPATH=f"{ROOT}:{ROOT / 'src'}")
    assert f"{expected} passed" in done.stdout
