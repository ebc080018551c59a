"""Failures: workers crash or hang, the sweep is killed, the disk is full.

No row is lost, none is written twice.
"""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from fingertip.sweep.database import SweepDatabase, SweepRow
from fingertip.sweep.database_file import FILE
from fingertip.sweep.engines import ProcessEngine
from fingertip.sweep.point_evaluator import ChunkFunction
from fingertip.sweep.run import compute_rows
from fingertip.sweep.sweep_plan import SweepPlan
from tests.conftest import ROOT
from tests.sweep import examples, worker_functions
from tests.sweep.examples import InlineEngine, make_plan
from tests.test_workers import is_alive

BOARD_POINTS = 72
"""Points of `examples.BOARD`."""
LARGE_POINTS = 8_000
LARGE_SWEEP = """
name = "many"
outputs = ["q", "gain"]

[axes]
board.cutoff_hz = {low = 20, high = 2000, steps = 80, spacing = "logarithmic"}
board.passband_gain = {low = 2, high = 900, steps = 50}
board.series = ["E12", "E24"]
"""


@pytest.fixture(autouse=True)
def functions_of_the_tests(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let workers find the tests' own functions."""
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(ROOT), str(ROOT / "src")]))


def run_with(folder: Path, evaluate: ChunkFunction) -> dict[int, SweepRow]:
    plan = make_plan(time_limit_s=worker_functions.LIMIT_S)
    assert plan.size == BOARD_POINTS
    with SweepDatabase.create(folder, plan) as database:
        state = compute_rows(plan, database, ProcessEngine(2), evaluate=evaluate)
        assert state.written == BOARD_POINTS
        rows = list(database.rows())
    assert [row.point for row in rows] == list(range(BOARD_POINTS))
    return {row.point: row for row in rows}


@pytest.mark.full
@pytest.mark.parametrize(
    ("evaluate", "deaths"),
    [(worker_functions.crash_once, "xx"), (worker_functions.die_while_sending, "x")],
)
def test_point_whose_worker_dies_once_is_computed_at_the_second_attempt(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, evaluate: ChunkFunction, deaths: str
) -> None:
    flag = tmp_path / "flag"
    flag.touch()
    monkeypatch.setenv(worker_functions.FLAG_VARIABLE, str(flag))
    rows = run_with(tmp_path / "out", evaluate)
    assert flag.read_text() == deaths
    assert {row.status for row in rows.values()} == {"ok"}


@pytest.mark.full
@pytest.mark.parametrize(
    ("evaluate", "status", "reason"),
    [
        (worker_functions.crash, "failed", "died"),
        (worker_functions.sleep, "timeout", "longer than 0.4 s"),
        (worker_functions.loop_in_c, "timeout", "longer than 0.4 s"),
    ],
)
def test_crash_or_hang_of_a_worker_fails_only_its_point(
    tmp_path: Path, evaluate: ChunkFunction, status: str, reason: str
) -> None:
    for point, row in run_with(tmp_path / "out", evaluate).items():
        if point in worker_functions.FAILING_POINTS:
            assert (row.status, row.field) == (status, "")
            assert reason in row.reason
        else:
            assert (row.status, tuple(row.outputs.values())) == (
                "ok",
                worker_functions.make_result(point)[4],
            )


def find_children(parent: int) -> list[int]:
    children = []
    for status in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):
            if int(status.read_text().rpartition(")")[2].split()[1]) == parent:
                children.append(int(status.parent.name))
    return children


def assert_processes_end(pids: list[int]) -> None:
    assert len(pids) == 2
    until = time.monotonic() + 10
    while left := [pid for pid in pids if is_alive(pid)]:
        assert time.monotonic() < until, f"workers {left} outlive their sweep"
        time.sleep(0.05)


def start_sweep(file: Path, out: Path) -> subprocess.Popen[str]:
    """Start the command in a process group of its own, and wait until it has written rows."""
    command = [
        sys.executable,
        "-m",
        "fingertip",
        "sweep",
        str(file),
        "--out",
        str(out),
        "--jobs",
        "2",
    ]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True, start_new_session=True)
    until = time.monotonic() + 60
    while time.monotonic() < until and process.poll() is None:
        if out.is_dir() and SweepDatabase.exists(out):
            with SweepDatabase.open(out) as database:
                if sum(database.count_by_status().values()) > 0:
                    return process
        time.sleep(0.05)
    raise AssertionError(f"no rows were written: {process.communicate()[1]}")


def read_rows(folder: Path) -> list[str]:
    """Rows as text, in which NaN equals itself."""
    return [repr(row) for row in examples.read_rows(folder)]


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """Rows of the large sweep, computed without interruption in this process."""
    folder = tmp_path_factory.mktemp("uninterrupted")
    (folder / "sweep.toml").write_text(LARGE_SWEEP)
    plan = SweepPlan.load(folder / "sweep.toml")
    with SweepDatabase.create(folder / "out", plan) as database:
        assert compute_rows(plan, database, InlineEngine()).written == LARGE_POINTS
    return read_rows(folder / "out")


def resume(file: Path, out: Path) -> int:
    plan = SweepPlan.load(file)
    with SweepDatabase.resume(out, plan) as database:
        return compute_rows(plan, database, InlineEngine()).written


@pytest.mark.full
def test_resume_after_kill_9_gives_the_rows_of_an_uninterrupted_run(
    tmp_path: Path, uninterrupted: list[str]
) -> None:
    file = tmp_path / "sweep.toml"
    out = tmp_path / "out"
    file.write_text(LARGE_SWEEP)
    process = start_sweep(file, out)
    workers = find_children(process.pid)
    process.kill()
    process.wait()
    assert_processes_end(workers)
    before = read_rows(out)
    assert 0 < len(before) < LARGE_POINTS
    assert resume(file, out) == LARGE_POINTS - len(before)
    after = read_rows(out)
    assert len(after) == LARGE_POINTS
    assert set(before) <= set(after)
    assert after == uninterrupted


@pytest.mark.full
def test_interrupt_ends_cleanly_and_names_resume(tmp_path: Path) -> None:
    file = tmp_path / "sweep.toml"
    out = tmp_path / "out"
    file.write_text(LARGE_SWEEP)
    process = start_sweep(file, out)
    workers = find_children(process.pid)
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does
    errors = process.communicate(timeout=30)[1]
    assert process.returncode == 130
    assert "continue with --resume" in errors
    assert "Traceback" not in errors
    assert_processes_end(workers)
    assert [path.name for path in out.iterdir()] == [FILE]
    assert len(read_rows(out)) > 0
