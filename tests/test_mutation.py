"""Lists of mutation testing: modules and tests exist, equivalent mutants fit a line, and a fork runs changed code."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
from tools.mutation.forks import Target

from tests.conftest import ROOT
from tools.mutation.run import Mutant, is_equivalent, read_equivalent, read_targets


@pytest.mark.parametrize("target", read_targets(), ids=lambda target: target.name)
def test_named_modules_and_their_tests_exist(target: Target) -> None:
    assert (ROOT / target.path).is_file()
    tests = [word for word in target.arguments if word.endswith(".py")]
    assert tests
    assert all((ROOT / test).is_file() for test in tests)


@pytest.mark.parametrize("entry", read_equivalent(), ids=lambda entry: entry["module"])
def test_equivalent_mutants_fit_a_line_of_their_module_and_say_why(entry: dict[str, str]) -> None:
    lines = [line.strip() for line in (ROOT / entry["module"]).read_text(encoding="utf-8").splitlines() if line.strip()]
    assert any(re.fullmatch(entry["before"], line) for line in lines), "the line is gone: remove the entry"
    assert not any(re.fullmatch(entry["after"], line) for line in lines)
    assert len(entry["reason"]) > 20


def test_only_listed_changes_are_equivalent() -> None:
    listed = [{"module": "a.py", "before": r"x = \d", "after": "x = -1", "reason": ""}]
    path = Path("a.py")
    assert is_equivalent(path, Mutant(1, 0, "", "x = 0", "x = -1", ""), listed)
    assert not is_equivalent(path, Mutant(1, 0, "", "x = 0", "x = 1", ""), listed)
    assert not is_equivalent(path, Mutant(1, 0, "", "y = 0", "x = -1", ""), listed)
    assert not is_equivalent(Path("b.py"), Mutant(1, 0, "", "x = 0", "x = -1", ""), listed)


@pytest.mark.slow
def test_fork_runs_the_tests_on_changed_code() -> None:
    """In a process of its own, as other tests of this one have imported the module already."""
    code = """
from pathlib import Path
from tools.mutation.forks import Target, run_tests
target = Target(Path("src/fingertip/sim/grid.py"), ("tests/sim/test_grid.py",))
source = target.source
assert run_tests(target, source, 300.0).passed
assert not run_tests(target, source.replace("math.ceil(", "math.floor("), 300.0).passed
"""
    subprocess.run([sys.executable, "-c", code], check=True, cwd=ROOT)
