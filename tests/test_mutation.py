"""Mutation testing: equivalent mutants fit a line, jobs hold the tests that reach a change, and changed code runs."""

from __future__ import annotations

import re
from collections import Counter

import pytest

from tests.conftest import ROOT, run_python
from tools.mutation.mutants import Mutant, Reach, read_equivalent
from tools.mutation.run import plan_job

MUTANT = Mutant("sim", "src/fingertip/sim/signal/grid.py", 2, "", "x = 0", "x = -1", "")


def test_equivalent_mutants_fit_a_line_of_their_module_and_say_why() -> None:
    wrong = []
    for entry in read_equivalent():
        path = ROOT / entry["module"]
        lines = [line.strip() for line in path.read_text(encoding="utf-8").splitlines()] if path.is_file() else []
        fits = any(re.fullmatch(entry["before"], line) for line in lines)
        if not fits or any(re.fullmatch(entry["after"], line) for line in lines if line) or len(entry["reason"]) < 20:
            wrong.append(entry)
    assert wrong == [], "the line is gone, or has no reason: remove the entry or mend it"


@pytest.mark.full
def test_a_job_holds_the_tests_that_enter_the_innermost_block() -> None:
    blocks = [("fingertip.sim.signal.grid", 1, 9), ("fingertip.sim.signal.grid", 2, 3)]
    tests = {0: ("t.py::a", "t.py::b", "t.py::c"), 1: ("t.py::a", "t.py::b")}
    cost_s = {"t.py::a": 2.0, "t.py::b": 1.0, "t.py::c": 1.0}
    reach = Reach(blocks, cost_s, tests, dict.fromkeys(cost_s, ()), {})
    assert plan_job(MUTANT, reach, (), Counter(), 9.0).tests == ["t.py::b", "t.py::a"]
    assert plan_job(MUTANT, reach, ("t.py::a",), Counter(), 9.0).tests == ["t.py::a", "t.py::b"]
    assert plan_job(MUTANT, reach, (), Counter({"t.py::a": 1}), 9.0).tests == ["t.py::a", "t.py::b"]
    assert plan_job(MUTANT, reach, (), Counter(), 1.5).tests == ["t.py::b"]
    assert plan_job(MUTANT, reach, (), Counter(), 9.0).is_fresh is False
    outside = Mutant(**(MUTANT.__dict__ | {"line": 20}))
    assert plan_job(outside, reach, (), Counter(), 9.0).is_fresh is True
    assert len(plan_job(outside, reach, (), Counter(), 9.0).tests) == 3


@pytest.mark.full
def test_a_fork_runs_the_new_code_of_a_function() -> None:
    """In a process of its own: the function stays changed."""
    code = """
import dataclasses
from fingertip.sim.signal import grid
from tests.test_mutation import MUTANT
from tools.mutation.server import change_functions
source = open(grid.__file__, encoding="utf-8").read()
assert grid.count_samples(0.9, 1.0) == 2
change_functions(dataclasses.replace(MUTANT, code=source.replace("math.ceil(", "math.floor(")))
assert grid.count_samples(0.9, 1.0) == 1
"""
    done = run_python("-c", code, PYTHONPATH=f"{ROOT / 'src'}:{ROOT}")
    assert done.returncode == 0, done.stderr
