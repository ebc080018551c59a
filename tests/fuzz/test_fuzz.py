"""Five hundred generated and damaged inputs: no traceback, no hang, little memory, no invalid result.

`python -m tools.fuzz.run` runs twenty thousand. What these find becomes a test of its own elsewhere, by name.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.conftest import ROOT, run_python
from tests.tools import require_module
from tools.fuzz import in_process
from tools.fuzz.cases import Case
from tools.fuzz.outcome import MEMORY_LIMIT_BYTES, Outcome, find_faults
from tools.fuzz.run import run_cases

COUNT = 500


@pytest.mark.full
def test_generated_and_damaged_inputs_show_no_fault() -> None:
    for module in ("nptdms", "scipy", "pyarrow"):
        require_module(module)
    # This process may have grown in other tests before; the memory of a new one is that of its cases.
    done = run_python("-m", "tools.fuzz.run", "--piece", "case", str(COUNT), "24", PWD=str(ROOT))
    assert done.returncode == 0, done.stderr[-2000:]
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    assert len(lines) >= COUNT
    found = [f"{line['words']}: {fault}" for line in lines for fault in line["faults"]]
    assert not found, found[:3]
    assert max(line["peak"] for line in lines) < MEMORY_LIMIT_BYTES
    assert len({line["family"] for line in lines}) >= 15


CASE = Case("test", ("params",), promise="design")


@pytest.mark.parametrize(
    ("outcome", "fault"),
    [
        (Outcome(70, "", "error: fault", 0, 0.1), "traceback"),
        (Outcome(1, "", "Traceback (most recent call last)", 0, 0.1), "traceback"),
        (Outcome(1, "", "", 0, 0.1), "exit code"),
        (Outcome(-11, "", "", 0, 0.1), "exit code"),
        (Outcome(2, "", "", 0, 0.1), "silent"),
        (Outcome(None, "", "", 0, 10.1), "hang"),
        (Outcome(2, "", "error: x", 2**31, 0.1), "memory"),
        (Outcome(2, "", "error: \x07", 0, 0.1), "control"),
        (Outcome(2, "", "error: " + "x" * 10_000, 0, 0.1), "length"),
        (Outcome(0, "[skin]\nwidth_mm = 1\n", "", 0, 0.1), "invalid"),
    ],
)
def test_each_fault_is_seen(tmp_path: Path, outcome: Outcome, fault: str) -> None:
    assert any(found.startswith(fault) for found in find_faults(CASE, outcome, tmp_path))


def test_a_hang_is_ended(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(in_process, "TIME_LIMIT_S", 0.05)

    def never_end(rows: object) -> str:
        while True:
            pass

    monkeypatch.setattr("fingertip.design.export.format_parameter_table", never_end)
    outcome = in_process.run(Case("test", ("params",)), tmp_path)
    assert outcome.code is None


@pytest.mark.full
def test_the_same_seed_gives_the_same_cases() -> None:
    drawn: list[list[Case]] = []
    for _ in range(2):
        cases: list[Case] = []
        run_cases(
            30, 5, lambda case, *_, cases=cases: cases.append(case), lambda case, _: Outcome(2, "", "error", 0, 0.0)
        )
        drawn.append(cases)
    assert drawn[0] == drawn[1]
    assert len({case.family for case in drawn[0]}) > 5
