"""A sweep on a real Dask cluster: a scheduler and workers as a user starts them, each a process of its own."""

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

import pytest
from typer.testing import CliRunner

from fingertip import __version__
from fingertip.cli import app
from fingertip.errors import SweepError
from fingertip.sweep.dask_engine import Cluster
from fingertip.sweep.engines import Processes
from fingertip.sweep.run import State, run
from fingertip.sweep.database import Row, Store
from tests.conftest import ROOT, run_fingertip
from tests.sweep import hooks
from tests.sweep.plans import plan

pytest.importorskip("distributed")

SWEEP = """
name = "cluster"
outputs = ["q", "cutoff_3db_hz", "skin_volume_mm3"]
tolerance_mm = 0.2

[axes]
skin.width_mm = [14.0, 17.0, 18.0]
board.cutoff_hz = {low = 20, high = 2000, steps = 6, spacing = "logarithmic"}
board.capacitor_uf = [0.0001, 1.0]
"""
LONG = {"axes": {"board.cutoff_hz": {"low": 20.0, "high": 2000.0, "steps": 900}}}
"""Two seconds of `hooks.healthy` for two workers."""


@dataclass
class Dask:
    """A scheduler and its workers, in one process group each."""

    folder: Path
    address: str = ""
    started: list[subprocess.Popen[bytes]] = field(default_factory=list)

    def start(self, *words: str, path: Path = ROOT) -> subprocess.Popen[bytes]:
        """`dask WORDS` in a process group of its own."""
        log = (self.folder / f"{len(self.started)}.log").open("wb")
        self.started.append(
            subprocess.Popen(
                [sys.executable, "-m", "dask", *words, "--no-dashboard"],
                stdout=log,
                stderr=log,
                cwd=self.folder,
                env=os.environ | {"PYTHONPATH": str(path)},  # for the tests' own work
                start_new_session=True,
            )
        )
        log.close()
        return self.started[-1]

    def begin(self, workers: int) -> None:
        """Start a scheduler on a free port, and workers."""
        note = self.folder / "scheduler.json"
        self.start(
            "scheduler", "--host", "127.0.0.1", "--port", "0", "--scheduler-file", str(note), "--idle-timeout", "120"
        )
        until = time.monotonic() + 30
        while not self.address:
            assert time.monotonic() < until, (self.folder / "0.log").read_text()
            with contextlib.suppress(OSError, ValueError):
                self.address = json.loads(note.read_text())["address"]
            time.sleep(0.05)
        for _ in range(workers):
            self.start("worker", self.address, "--nthreads", "1", "--death-timeout", "20")

    def kill(self, which: int) -> None:
        """Kill -9 the scheduler (0) or a worker (1, 2 ...) with its nanny, as when a machine goes down."""
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.started[which].pid, signal.SIGKILL)
        self.started[which].wait()


@pytest.fixture
def dask(tmp_path: Path) -> Iterator[Dask]:
    """Where a test starts a cluster of its own; nothing of it is left."""
    cluster = Dask(tmp_path)
    yield cluster
    for i in range(len(cluster.started)):
        cluster.kill(i)


@pytest.fixture(scope="module")
def running(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Dask]:
    """A scheduler with two workers."""
    cluster = Dask(tmp_path_factory.mktemp("dask"))
    try:
        cluster.begin(2)
        yield cluster
    finally:
        for i in range(len(cluster.started)):
            cluster.kill(i)


def rows(folder: Path) -> list[Row]:
    with Store.open(folder) as store:
        return list(store.rows())


def test_rows_are_those_of_processes(running: Dask, tmp_path: Path) -> None:
    (tmp_path / "sweep.toml").write_text(SWEEP)
    said = {}
    for name, engine in (("processes", ("--jobs", "2")), ("cluster", ("--cluster", running.address))):
        ran = run_fingertip("sweep", tmp_path / "sweep.toml", "--out", tmp_path / name, "--json", *engine)
        assert ran.returncode == 0, ran.stderr
        said[name] = json.loads(ran.stdout) | {"folder": None}
    assert said["processes"] == said["cluster"]
    on_cluster = rows(tmp_path / "cluster")
    assert repr(on_cluster) == repr(rows(tmp_path / "processes"))  # as text, in which NaN equals itself
    assert len(on_cluster) == 36
    assert {row.status for row in on_cluster} == {"ok", "refused"}


def healthy_rows(folder: Path, size: int) -> None:
    """Every row once, and what `hooks.healthy` gives."""
    found = rows(folder)
    assert [row.point for row in found] == list(range(size))
    assert all((row.status, tuple(row.outputs.values())) == ("ok", hooks.row(row.point)[4]) for row in found)


def test_a_worker_lost_midway_costs_nothing(running: Dask, tmp_path: Path) -> None:
    made = plan(**LONG)
    lost: list[int] = []

    def told(state: State) -> None:
        if state.written and not lost:
            lost.append(state.done)
            running.kill(2)

    with Store.create(tmp_path / "out", made) as store:
        state = run(made, store, Cluster(running.address), told, hooks.healthy)
    assert 0 < lost[0] < made.size
    assert state.written == made.size
    healthy_rows(tmp_path / "out", made.size)


def test_a_scheduler_lost_midway_is_a_sentence_and_resume_goes_on(
    dask: Dask, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    dask.begin(1)
    monkeypatch.setattr("fingertip.sweep.dask_engine._LOST_S", 1.0)
    cluster = Cluster(dask.address)
    made = plan(**LONG)

    def told(state: State) -> None:
        if state.written:
            dask.kill(0)

    start = time.monotonic()
    with Store.create(tmp_path / "out", made) as store, pytest.raises(SweepError, match=r"--cluster.*gone.*--resume"):
        run(made, store, cluster, told, hooks.healthy)
    assert time.monotonic() - start < 20
    assert capfd.readouterr() == ("", "")
    before = rows(tmp_path / "out")
    assert 0 < len(before) < made.size
    with Store.resume(tmp_path / "out", made) as store:
        assert run(made, store, Processes(1), work=hooks.healthy).written == made.size - len(before)
    healthy_rows(tmp_path / "out", made.size)


def free_port() -> int:
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return int(found.getsockname()[1])


def refused(folder: Path, address: str) -> str:
    """What the command says, in this process, of a cluster that it refuses."""
    (folder / "sweep.toml").write_text(SWEEP)
    done = CliRunner().invoke(
        app, ["sweep", str(folder / "sweep.toml"), "--out", str(folder / "out"), "--cluster", address]
    )
    assert (done.exit_code, done.stdout) == (2, "")
    assert not (folder / "out").exists()
    return done.stderr


def test_a_closed_port_is_one_sentence_soon_and_nothing_is_written(tmp_path: Path) -> None:
    (tmp_path / "sweep.toml").write_text(SWEEP)
    address = f"tcp://127.0.0.1:{free_port()}"
    start = time.monotonic()
    ran = run_fingertip("sweep", tmp_path / "sweep.toml", "--out", tmp_path / "out", "--cluster", address)
    assert time.monotonic() - start < 8
    assert (ran.returncode, ran.stdout) == (2, "")
    assert ran.stderr == (
        f"error: --cluster: nobody answers at {address} (Connection refused); start dask scheduler there.\n"
    )
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("address", ["nonsense", "tcp://127.0.0.1", "tcp://:8786", "tcp://host:port"])
def test_what_is_no_address_is_refused(tmp_path: Path, address: str) -> None:
    assert f"--cluster: {address!r} is no address; write it as tcp://HOST:8786" in refused(tmp_path, address)


def test_a_port_at_which_something_else_listens_is_refused_soon(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fingertip.sweep.dask_engine._PATIENCE_S", 0.5)
    with socket.create_server(("127.0.0.1", 0)) as silent:
        address = f"tcp://127.0.0.1:{silent.getsockname()[1]}"
        start = time.monotonic()
        assert f"what answers at {address} is no Dask scheduler" in refused(tmp_path, address)
    assert time.monotonic() - start < 8


def test_no_workers_or_those_of_another_version_are_refused(
    dask: Dask, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fingertip.sweep.dask_engine._PATIENCE_S", 0.5)
    dask.begin(0)
    remedy = f"start some there with dask worker {dask.address}."
    assert f"{dask.address} has no workers; {remedy}" in refused(tmp_path, dask.address)
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "fingertip.py").write_text("__version__ = '9.9'")
    monkeypatch.setattr("fingertip.sweep.dask_engine._PATIENCE_S", 30.0)
    dask.start("worker", dask.address, "--death-timeout", "20", path=tmp_path / "other")
    assert f"has fingertip 9.9, this is {__version__}; install the same everywhere." in refused(tmp_path, dask.address)
