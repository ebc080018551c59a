"""Sweeps on a real Dask cluster: a scheduler and workers as a user
starts them, each a process of its own.
"""

from __future__ import annotations

import contextlib
import json
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy
import pytest

from fingertip import __version__
from fingertip.foundation.errors import SweepError
from fingertip.sweep import engines
from fingertip.sweep.database import SweepDatabase
from fingertip.sweep.engines import DaskEngine
from fingertip.sweep.run import RunState, compute_rows
from tests.conftest import ROOT
from tests.sweep import worker_functions
from tests.sweep.examples import InlineEngine, make_plan, read_rows, run_sweep_command

pytest.importorskip("distributed")
pytestmark = pytest.mark.second

SWEEP = """
name = "cluster"
outputs = ["q", "cutoff_3db_hz", "skin_volume_mm3"]
tolerance_mm = 0.2

[axes]
skin.width_mm = [14.0, 17.0, 18.0]
board.cutoff_hz = {low = 20, high = 2000, steps = 6, spacing = "logarithmic"}
board.capacitor_uf = [0.0001, 1.0]
"""
LONG_SWEEP = {"axes": {"board.cutoff_hz": {"low": 20.0, "high": 2000.0, "steps": 900}}}
"""Two seconds of `worker_functions.succeed` for two workers."""


@dataclass
class DaskCluster:
    folder: Path
    address: str = ""
    processes: list[subprocess.Popen[bytes]] = field(default_factory=list)

    def start(self, *arguments: str, path: Path = ROOT) -> subprocess.Popen[bytes]:
        log = (self.folder / f"{len(self.processes)}.log").open("wb")
        paths = os.pathsep.join(filter(None, [str(path), os.environ.get("PYTHONPATH")]))
        self.processes.append(
            subprocess.Popen(
                [sys.executable, "-m", "dask", *arguments, "--no-dashboard"],
                stdout=log,
                stderr=log,
                cwd=self.folder,
                env=os.environ
                | {"PYTHONPATH": paths},  # so that workers find the tests' own functions
                start_new_session=True,
            )
        )
        log.close()
        return self.processes[-1]

    def start_all(self, workers: int) -> None:
        """Start a scheduler on a free port, and workers."""
        scheduler_file = self.folder / "scheduler.json"
        options = [
            "--host",
            "127.0.0.1",
            "--port",
            "0",
            "--idle-timeout",
            "120",
            "--scheduler-file",
        ]
        self.start("scheduler", *options, str(scheduler_file))
        until = time.monotonic() + 30
        while not self.address:
            assert time.monotonic() < until, (self.folder / "0.log").read_text()
            with contextlib.suppress(OSError, ValueError):
                self.address = json.loads(scheduler_file.read_text())["address"]
            time.sleep(0.05)
        for _ in range(workers):
            self.start("worker", self.address, "--nthreads", "1", "--death-timeout", "20")

    def kill(self, index: int) -> None:
        """Kill -9 the scheduler (0), or a worker (1, 2 ...) and its nanny, as when a
        machine fails.
        """
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.processes[index].pid, signal.SIGKILL)
        self.processes[index].wait()

    def kill_all(self) -> None:
        for i in range(len(self.processes)):
            self.kill(i)


@pytest.fixture(autouse=True)
def patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """Gives workers a minute to start: on a busy machine they
    take longer than a user waits for them.
    """
    monkeypatch.setattr(engines, "_CONNECT_TIMEOUT_S", 60.0)


@pytest.fixture
def dask(tmp_path: Path) -> Iterator[DaskCluster]:
    """A cluster in which the test itself starts the processes; all of them are killed
    at the end.
    """
    cluster = DaskCluster(tmp_path)
    yield cluster
    cluster.kill_all()


@pytest.fixture(scope="module")
def running_cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[DaskCluster]:
    cluster = DaskCluster(tmp_path_factory.mktemp("dask"))
    try:
        cluster.start_all(2)
        yield cluster
    finally:
        cluster.kill_all()


def test_rows_equal_those_of_an_engine_without_processes(
    running_cluster: DaskCluster, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fingertip.sweep.engines.ProcessEngine", InlineEngine)
    (tmp_path / "sweep.toml").write_text(SWEEP)
    data = {}
    for name, options in (("inline", ()), ("cluster", ("--cluster", running_cluster.address))):
        result = run_sweep_command(
            tmp_path / "sweep.toml", "--out", tmp_path / name, "--json", *options
        )
        assert result.exit_code == 0, result.stderr
        data[name] = json.loads(result.stdout) | {"folder": None}
    assert data["inline"] == data["cluster"]
    rows = read_rows(tmp_path / "cluster")
    assert repr(rows) == repr(read_rows(tmp_path / "inline"))  # as text, in which NaN equals itself
    assert len(rows) == 36
    assert {row.status for row in rows} == {"ok", "refused"}


def assert_rows_complete(folder: Path, size: int) -> None:
    rows = read_rows(folder)
    assert [row.point for row in rows] == list(range(size))
    for row in rows:
        assert (row.status, tuple(row.outputs.values())) == (
            "ok",
            worker_functions.make_result(row.point)[4],
        )


@pytest.mark.full
def test_loss_of_a_worker_loses_no_row(running_cluster: DaskCluster, tmp_path: Path) -> None:
    plan = make_plan(**LONG_SWEEP)
    done_at_loss: list[int] = []

    def kill_once(state: RunState) -> None:
        if state.written and not done_at_loss:
            done_at_loss.append(state.done)
            running_cluster.kill(2)

    with SweepDatabase.create(tmp_path / "out", plan) as database:
        engine = DaskEngine(running_cluster.address)
        state = compute_rows(plan, database, engine, kill_once, worker_functions.succeed)
    assert 0 < done_at_loss[0] < plan.size
    assert state.written == plan.size
    assert_rows_complete(tmp_path / "out", plan.size)


@pytest.mark.full
def test_loss_of_the_scheduler_is_reported_and_resume_completes_the_rows(
    dask: DaskCluster,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> None:
    dask.start_all(1)
    monkeypatch.setattr("fingertip.sweep.engines._RECONNECT_TIMEOUT_S", 1.0)
    engine = DaskEngine(dask.address)
    plan = make_plan(**LONG_SWEEP)

    def kill_scheduler(state: RunState) -> None:
        if state.written:
            dask.kill(0)

    is_lost = pytest.raises(SweepError, match=r"cluster: is lost.*resume")
    with SweepDatabase.create(tmp_path / "out", plan) as database, is_lost:
        compute_rows(plan, database, engine, kill_scheduler, worker_functions.succeed)
    assert capfd.readouterr() == ("", "")
    before = read_rows(tmp_path / "out")
    assert 0 < len(before) < plan.size
    with SweepDatabase.resume(tmp_path / "out", plan) as database:
        state = compute_rows(plan, database, InlineEngine(), evaluate=worker_functions.succeed)
    assert state.written == plan.size - len(before)
    assert_rows_complete(tmp_path / "out", plan.size)


def find_free_port() -> int:
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return int(listener.getsockname()[1])


def run_refused(folder: Path, address: str) -> str:
    """Run the command with a cluster that it refuses, and give its error message."""
    (folder / "sweep.toml").write_text(SWEEP)
    result = run_sweep_command(folder / "sweep.toml", "--out", folder / "out", "--cluster", address)
    assert (result.exit_code, result.stdout) == (2, "")
    assert not (folder / "out").exists()
    return result.stderr


def test_closed_port_is_refused_at_once_and_nothing_is_written(tmp_path: Path) -> None:
    address = f"tcp://127.0.0.1:{find_free_port()}"
    assert run_refused(tmp_path, address) == (
        f"error: --cluster: nothing answers at {address} (Connection refused); start dask "
        "scheduler there.\n"
    )


def test_listener_that_is_not_a_scheduler_is_refused_at_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fingertip.sweep.engines._CONNECT_TIMEOUT_S", 0.5)
    with socket.create_server(("127.0.0.1", 0)) as silent:
        address = f"tcp://127.0.0.1:{silent.getsockname()[1]}"
        assert f"the process listening at {address} is not a Dask scheduler" in run_refused(
            tmp_path, address
        )


@pytest.mark.full
def test_missing_workers_and_workers_of_another_version_are_refused(
    dask: DaskCluster, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fingertip.sweep.engines._CONNECT_TIMEOUT_S", 0.5)
    dask.start_all(0)
    remedy = f"start some there with dask worker {dask.address}."
    assert f"{dask.address} has no workers; {remedy}" in run_refused(tmp_path, dask.address)
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "fingertip.py").write_text("__version__ = '9.9'")
    monkeypatch.setattr("fingertip.sweep.engines._CONNECT_TIMEOUT_S", 30.0)
    dask.start("worker", dask.address, "--death-timeout", "20", path=tmp_path / "other")
    assert (
        f"has fingertip 9.9, but this is {__version__}; install the same version everywhere."
        in run_refused(tmp_path, dask.address)
    )


@pytest.mark.parametrize(
    ("name", "found", "message"),
    [
        (
            "Python",
            "3.9.2",
            f"has Python 3.9, but this is {sys.version_info[0]}.{sys.version_info[1]};",
        ),
        ("numpy", "1.0", f"has numpy 1.0, but this is {numpy.__version__};"),
        (
            "numpy",
            ImportError("No module named 'numpy'"),
            r"has no numpy \(No module named 'numpy'\), but this is",
        ),
    ],
)
def test_worker_with_another_python_or_numpy_is_refused(
    name: str, found: str | ImportError, message: str
) -> None:
    with pytest.raises(
        SweepError, match=f"worker tcp://w:1 {message}.*install the same version everywhere"
    ):
        engines.compare_version("tcp://w:1", name, found)
    engines.compare_version("tcp://w:1", "Python", ".".join(map(str, (*sys.version_info[:2], 99))))


@pytest.mark.full
def test_worker_that_hangs_is_refused_before_anything_is_written(
    dask: DaskCluster, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    dask.start_all(1)
    DaskEngine(dask.address).close()  # the worker is ready
    group = dask.processes[1].pid
    os.killpg(group, signal.SIGSTOP)
    try:
        monkeypatch.setattr(engines, "_ANSWER_TIMEOUT_S", 1.0)
        message = run_refused(tmp_path, dask.address)
        assert (
            "a worker has not answered for 1 s; end the workers that hang, or start them again"
            in message
        )
    finally:
        os.killpg(group, signal.SIGCONT)
