"""First set of tests: what it leaves out, and that it refuses tests that take too long."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.conftest import ROOT, run_python
from tests.first_set import EXPENSIVE

TESTS = """
import pytest, time
import tests.first_set

tests.first_set.LIMIT_S = 0.05

@pytest.mark.full
def test_full(): pass

@pytest.mark.parametrize("case", range(20))
def test_many(case): pass

@pytest.mark.every_case
@pytest.mark.parametrize("case", range(20))
def test_every(case): pass

@pytest.fixture(scope="session")
def shared():
    work(0.1)

def work(seconds):
    end = time.process_time() + seconds
    while time.process_time() < end: pass

def test_of_a_shared_fixture(shared): pass

def test_slow(): work(0.5)
"""


@pytest.mark.parametrize(
    ("full", "word", "expected"),
    [
        ("", "not slow and not shared", (24, 0)),
        ("1", "not slow and not shared", (41, 0)),
        ("", "slow or shared", (1, 1)),
    ],
    ids=["first", "all", "limit"],
)
def test_cases_and_costs(tmp_path: Path, full: str, word: str, expected: tuple[int, int]) -> None:
    (tmp_path / "test_some.py").write_text(TESTS, encoding="utf-8")
    marks = ("-o", "markers=full\nevery_case")
    words = ("-m", "pytest", "-q", "-p", "tests.first_set", "-p", "no:cacheprovider", *marks, "-k", word, str(tmp_path))
    done = run_python(*words, FINGERTIP_FULL=full, PYTHONPATH=f"{ROOT}:{ROOT / 'src'}")
    passed, failed = expected
    assert f"{passed} passed" * bool(passed) in done.stdout
    assert (f"{failed} failed" in done.stdout) is bool(failed)
    assert "CPU time of 1 processes" in done.stdout


def test_few_tests_may_take_longer() -> None:
    assert len(EXPENSIVE) <= 10
    for name in EXPENSIVE:
        path, _, test = name.partition("::")
        assert f"def {test}(" in (ROOT / path).read_text(encoding="utf-8")
