"""Workers die and hang, the sweep is killed, the disk is full: nothing is lost, nothing is there twice."""

from __future__ import annotations

import json
import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from fingertip.errors import OutputError, SweepError
from fingertip.sweep.chunk import Work
from fingertip.sweep.engines import Processes
from fingertip.sweep.run import run
from fingertip.sweep.database import FILE, Row, Store
from tests.conftest import run_fingertip
from tests.sweep import hooks
from tests.sweep.plans import plan
from tests.tools import require_tool

SIZE = 72
COUNT = 8_000
MANY = """
name = "many"
outputs = ["q", "gain"]

[axes]
board.cutoff_hz = {low = 20, high = 2000, steps = 80, spacing = "logarithmic"}
board.passband_gain = {low = 2, high = 900, steps = 50}
board.series = ["E12", "E24"]
"""


def swept(folder: Path, work: Work) -> dict[int, Row]:
    """Rows of a sweep of 72 points by two processes."""
    made = plan(time_limit_s=hooks.LIMIT_S)
    assert made.size == SIZE
    with Store.create(folder, made) as store:
        state = run(made, store, Processes(2), work=work)
        assert state.written == SIZE
        found = list(store.rows())
    assert [row.point for row in found] == list(range(SIZE))
    return {row.point: row for row in found}


def only_the_bad_are(found: dict[int, Row], status: str, reason: str) -> None:
    for point, row in found.items():
        if point in hooks.BAD:
            assert (row.status, row.field) == (status, "")
            assert reason in row.reason
        else:
            assert (row.status, tuple(row.outputs.values())) == ("ok", hooks.row(point)[4])


def test_a_worker_that_dies_costs_its_own_point(tmp_path: Path) -> None:
    only_the_bad_are(swept(tmp_path / "out", hooks.dying), "failed", "died")


def test_a_worker_that_dies_once_costs_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    flag = tmp_path / "flag"
    flag.touch()
    monkeypatch.setenv(hooks.FLAG, str(flag))
    found = swept(tmp_path / "out", hooks.dying_once)
    assert flag.read_text() == "xx"
    assert {row.status for row in found.values()} == {"ok"}


def test_a_point_that_sleeps_is_given_up(tmp_path: Path) -> None:
    start = time.perf_counter()
    only_the_bad_are(swept(tmp_path / "out", hooks.sleeping), "timeout", "longer than 0.4 s")
    assert time.perf_counter() - start < 30


def test_a_point_that_never_comes_back_from_c_is_given_up(tmp_path: Path) -> None:
    only_the_bad_are(swept(tmp_path / "out", hooks.never_back), "timeout", "longer than 0.4 s")


def test_workers_that_die_before_any_point_end_the_sweep_with_a_sentence(tmp_path: Path) -> None:
    made = plan()
    with Store.create(tmp_path, made) as store:
        with pytest.raises(SweepError, match="without being at a point"):
            run(made, store, Processes(1), work=hooks.stillborn)
        assert list(store.rows()) == []
        assert run(made, store, Processes(1)).written == SIZE


def test_rows_do_not_depend_on_how_many_compute_them(tmp_path: Path) -> None:
    tables = []
    for jobs in (1, 2):
        made = plan()
        with Store.create(tmp_path / str(jobs), made) as store:
            run(made, store, Processes(jobs))
            tables.append(list(store.rows()))
    assert repr(tables[0]) == repr(tables[1])  # as text, in which NaN equals itself
    assert len(tables[0]) == SIZE


def processes_of(group: int) -> list[int]:
    """Living processes of a group."""
    found = []
    for status in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = status.read_text().rpartition(")")[2].split()
        except OSError:
            continue
        if int(fields[2]) == group and fields[0] != "Z":
            found.append(int(status.parent.name))
    return found


def assert_gone(group: int) -> None:
    """No worker outlives its sweep, nor multiprocessing's own helper, by more than a moment."""
    until = time.monotonic() + 10
    while processes_of(group) and time.monotonic() < until:
        time.sleep(0.05)
    assert processes_of(group) == []


def begun(file: Path, out: Path) -> subprocess.Popen[str]:
    """The command in a process group of its own, with some rows written."""
    command = [sys.executable, "-m", "fingertip", "sweep", str(file), "--out", str(out), "--jobs", "2"]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True, start_new_session=True)
    until = time.monotonic() + 60
    while time.monotonic() < until and process.poll() is None:
        if out.is_dir() and Store.exists(out):
            with Store.open(out) as store:
                if sum(store.counts().values()) > 0:
                    return process
        time.sleep(0.05)
    raise AssertionError(f"no rows were written: {process.communicate()[1]}")


def rows(folder: Path) -> list[str]:
    with Store.open(folder) as store:
        return [repr(row) for row in store.rows()]


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """The rows of the large sweep, computed without a break by one process."""
    folder = tmp_path_factory.mktemp("whole")
    (folder / "sweep.toml").write_text(MANY)
    ran = run_fingertip("sweep", folder / "sweep.toml", "--out", folder / "out", "--jobs", 1, "-q")
    assert ran.returncode == 0, ran.stderr
    return rows(folder / "out")


def test_kill_9_and_resume_give_the_table_of_an_uninterrupted_run(tmp_path: Path, whole: list[str]) -> None:
    file, out = tmp_path / "sweep.toml", tmp_path / "out"
    file.write_text(MANY)
    process = begun(file, out)
    process.kill()
    process.wait()
    assert_gone(process.pid)
    before = rows(out)
    assert 0 < len(before) < COUNT
    resumed = run_fingertip("sweep", file, "--out", out, "--resume", "--json")
    assert resumed.returncode == 0, resumed.stderr
    said = json.loads(resumed.stdout)
    assert said["computed_now"] == COUNT - len(before)
    after = rows(out)
    assert len(after) == COUNT
    assert set(before) <= set(after)
    assert after == whole


def test_an_interrupt_ends_cleanly_and_says_how_to_go_on(tmp_path: Path) -> None:
    file, out = tmp_path / "sweep.toml", tmp_path / "out"
    file.write_text(MANY)
    process = begun(file, out)
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to the workers too
    said = process.communicate(timeout=30)[1]
    assert process.returncode == 130
    assert "go on with --resume" in said
    assert "Traceback" not in said
    assert_gone(process.pid)
    assert [path.name for path in out.iterdir()] == [FILE]
    assert len(rows(out)) > 0


def test_two_sweeps_in_one_folder_are_refused(tmp_path: Path) -> None:
    made = plan()
    with Store.create(tmp_path, made), pytest.raises(SweepError, match="being written by another sweep"):
        Store.resume(tmp_path, made)
    Store.resume(tmp_path, made).close()


def test_a_full_disk_is_a_sentence_and_resume_goes_on(tmp_path: Path, whole: list[str]) -> None:
    file, out = tmp_path / "sweep.toml", tmp_path / "out"
    file.write_text(MANY)

    def little_room() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (150_000, 150_000))

    command = [sys.executable, "-m", "fingertip", "sweep", str(file), "--out", str(out)]
    full = subprocess.run(command, capture_output=True, text=True, preexec_fn=little_room, timeout=120, check=False)
    assert full.returncode == 2
    assert "--resume" in full.stderr
    assert "Traceback" not in full.stderr
    before = rows(out)
    resumed = run_fingertip("sweep", file, "--out", out, "--resume", "--json")
    assert resumed.returncode == 0, resumed.stderr
    assert json.loads(resumed.stdout)["computed_now"] == COUNT - len(before)
    assert 0 < len(before) < COUNT
    assert rows(out) == whole


def test_a_disk_that_is_full_for_good_and_then_is_not(tmp_path: Path, whole: list[str]) -> None:
    """A small file system of its own, in a mount namespace of its own."""
    unshare = require_tool("unshare", "util-linux")
    if subprocess.run([unshare, "-rm", "true"], capture_output=True, check=False).returncode:
        pytest.skip("A MOUNT NAMESPACE IS NOT ALLOWED HERE, A REAL FULL DISK IS NOT TESTED")
    file, disk = tmp_path / "sweep.toml", tmp_path / "disk"
    file.write_text(MANY)
    disk.mkdir()
    sweep = f"{sys.executable} -m fingertip sweep {file} --out {disk}/out"
    script = f"""
mount -t tmpfs -o size=200k none {disk} || exit 9
{sweep} 2> {tmp_path}/said
echo $? > {tmp_path}/code
mount -o remount,size=20m {disk} || exit 9
{sweep} --resume -q || exit 8
cp -r {disk}/out {tmp_path}/out
"""
    ran = subprocess.run([unshare, "-rm", "sh", "-c", script], capture_output=True, text=True, timeout=120, check=False)
    assert ran.returncode == 0, ran.stderr
    said = (tmp_path / "said").read_text()
    assert (tmp_path / "code").read_text() == "2\n"
    assert "disk is full" in said
    assert "--resume" in said
    assert "Traceback" not in said
    assert rows(tmp_path / "out") == whole


def test_sqlite_s_own_word_for_a_full_disk_is_understood(tmp_path: Path) -> None:
    made = plan()
    with Store.create(tmp_path, made) as store:
        store.add([(0, "ok", "", "", 20.0, 1.0, "E12", 1.0, 2.0, 3.0)])
        pages = store._connection.execute("PRAGMA page_count").fetchone()[0]
        store._connection.execute(f"PRAGMA max_page_count = {pages}")
        many = [(i, "refused", "f", "r" * 500, 20.0, 1.0, "E12", None, None, None) for i in range(1, 72)]
        with pytest.raises(OutputError, match=r"disk is full.*--resume"):
            store.add(many)
        assert [row.point for row in store.rows()] == [0]  # all of a batch, or none


def test_a_reader_that_takes_its_time_keeps_nobody_from_writing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fingertip.sweep.database._PAGE", 10)
    made = plan()
    with Store.create(tmp_path, made) as store:
        row = ("ok", "", "", 20.0, 1.0, "E12", 1.0, 2.0, 3.0)
        store.add([(i, *row) for i in range(30)])
        with Store.open(tmp_path) as reader:
            reading = reader.rows()
            assert next(reading).point == 0
            store._connection.execute("PRAGMA busy_timeout = 0")
            store.add([(i, *row) for i in range(30, 40)])
            assert [r.point for r in reading] == list(range(1, 40))


def test_a_row_is_never_written_twice(tmp_path: Path) -> None:
    with Store.create(tmp_path, plan()) as store:
        row = (0, "ok", "", "", 20.0, 1.0, "E12", 1.0, 2.0, 3.0)
        store.add([row])
        with pytest.raises(OutputError, match="already has a row"):
            store.add([(1, *row[1:]), (0, "failed", *row[2:])])
        assert [(r.point, r.status) for r in store.rows()] == [(0, "ok")]


@pytest.mark.parametrize("below", ["file", "file/below"])
def test_a_folder_that_cannot_be_made_is_refused(tmp_path: Path, below: str) -> None:
    (tmp_path / "file").write_text("mine")
    (tmp_path / "sweep.toml").write_text(MANY)
    ran = run_fingertip("sweep", tmp_path / "sweep.toml", "--out", tmp_path / below)
    assert ran.returncode == 2
    assert "cannot be written" in ran.stderr
    assert "--out" in ran.stderr
    assert (tmp_path / "file").read_text() == "mine"


def test_a_folder_without_leave_to_write_is_refused(tmp_path: Path) -> None:
    (tmp_path / "sweep.toml").write_text(MANY)
    ran = run_fingertip("sweep", tmp_path / "sweep.toml", "--out", "/proc/fingertip")
    assert ran.returncode == 2
    assert "/proc/fingertip: cannot be written" in ran.stderr


def test_a_foreign_file_in_the_folder_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / FILE).write_text("no database at all, but long enough to look like one")
    with pytest.raises(SweepError, match="is no sweep's file"):
        Store.open(tmp_path)
    with pytest.raises(SweepError, match="is no sweep's file"):
        Store.create(tmp_path, plan())
    assert (tmp_path / FILE).read_text().startswith("no database")
