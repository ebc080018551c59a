"""Database of a sweep: one writer, readers at any time, full
disks, and folders that cannot be used.
"""

from __future__ import annotations

import contextlib
import shutil
import sqlite3
from pathlib import Path

import pytest

from fingertip.foundation.errors import InputFileError, OutputError, SweepError
from fingertip.sweep import database
from fingertip.sweep.database import SweepDatabase
from fingertip.sweep.database_file import FILE, connect
from tests.sweep.examples import make_plan
from tools.fuzz import originals


def test_second_sweep_in_a_folder_is_refused(tmp_path: Path) -> None:
    plan = make_plan()
    with (
        SweepDatabase.create(tmp_path, plan),
        pytest.raises(SweepError, match="being written by another sweep"),
    ):
        SweepDatabase.resume(tmp_path, plan)
    SweepDatabase.resume(tmp_path, plan).close()


def test_sweep_that_was_killed_within_a_commit_is_read_and_continued(tmp_path: Path) -> None:
    plan = make_plan()
    with SweepDatabase.create(tmp_path / "sweep", plan) as database:
        database.add([(0, "ok", "", "", 20.0, 1.0, "E12", 1.0, 2.0, 3.0)])
        database._connection.executescript("PRAGMA cache_size = 1; BEGIN IMMEDIATE")
        many = [
            (i, "refused", "f", "r" * 9000, 20.0, 1.0, "E12", None, None, None)
            for i in range(1, 72)
        ]
        database._connection.executemany(f"INSERT INTO rows VALUES ({', '.join('?' * 10)})", many)
        shutil.copytree(tmp_path / "sweep", tmp_path / "killed")
        shutil.copytree(tmp_path / "sweep", tmp_path / "shown")
        database._connection.execute("ROLLBACK")
    assert SweepDatabase.exists(tmp_path / "killed")
    for found in (
        SweepDatabase.resume(tmp_path / "killed", plan),
        SweepDatabase.open(tmp_path / "shown"),
    ):
        with found:
            assert [row.point for row in found.rows()] == [0]
    assert [path.name for path in (tmp_path / "killed").iterdir()] == [FILE]


def test_full_database_is_reported_and_a_batch_is_written_completely_or_not(tmp_path: Path) -> None:
    plan = make_plan()
    with SweepDatabase.create(tmp_path, plan) as database:
        database.add([(0, "ok", "", "", 20.0, 1.0, "E12", 1.0, 2.0, 3.0)])
        pages = database._connection.execute("PRAGMA page_count").fetchone()[0]
        database._connection.execute(f"PRAGMA max_page_count = {pages}")
        many = [
            (i, "refused", "f", "r" * 500, 20.0, 1.0, "E12", None, None, None) for i in range(1, 72)
        ]
        with pytest.raises(OutputError, match=r"disk is full.*resume"):
            database.add(many)
        assert [row.point for row in database.rows()] == [0]  # all of a batch, or none


def test_slow_reader_does_not_block_the_writer(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fingertip.sweep.database._PAGE_ROWS", 10)
    plan = make_plan()
    with SweepDatabase.create(tmp_path, plan) as database:
        row = ("ok", "", "", 20.0, 1.0, "E12", 1.0, 2.0, 3.0)
        database.add([(i, *row) for i in range(30)])
        with SweepDatabase.open(tmp_path) as reader:
            reading = reader.rows()
            assert next(reading).point == 0
            database._connection.execute("PRAGMA busy_timeout = 0")
            database.add([(i, *row) for i in range(30, 40)])
            assert [r.point for r in reading] == list(range(1, 40))


def test_row_is_never_written_twice(tmp_path: Path) -> None:
    with SweepDatabase.create(tmp_path, make_plan()) as database:
        row = (0, "ok", "", "", 20.0, 1.0, "E12", 1.0, 2.0, 3.0)
        database.add([row])
        with pytest.raises(OutputError, match="already has a row"):
            database.add([(1, *row[1:]), (0, "failed", *row[2:])])
        assert [(r.point, r.status) for r in database.rows()] == [(0, "ok")]


@pytest.mark.parametrize("below", ["file", "file/below"])
def test_folder_that_cannot_be_created_is_refused(tmp_path: Path, below: str) -> None:
    (tmp_path / "file").write_text("not a folder")
    with pytest.raises(OutputError, match=r"cannot be written.*with out"):
        SweepDatabase.create(tmp_path / below, make_plan())
    assert (tmp_path / "file").read_text() == "not a folder"
    with pytest.raises(OutputError, match="unable to open"):
        connect(tmp_path / "absent", "rw")


def test_a_sweep_that_cannot_begin_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(database, "_ROWS_TABLE", "CREATE TABLE rows (")
    with pytest.raises(OutputError, match="syntax error"):
        SweepDatabase.create(tmp_path / "sweeps" / "board", make_plan())
    assert list(tmp_path.iterdir()) == []


def test_foreign_file_in_the_folder_is_not_changed(tmp_path: Path) -> None:
    (tmp_path / FILE).write_text("no database at all, but long enough to look like one")
    with pytest.raises(SweepError, match="is not the database of a sweep"):
        SweepDatabase.open(tmp_path)
    with pytest.raises(SweepError, match="is not the database of a sweep"):
        SweepDatabase.create(tmp_path, make_plan())
    assert (tmp_path / FILE).read_text().startswith("no database")
    (tmp_path / FILE).rename(tmp_path / "other")
    (tmp_path / FILE).symlink_to("other")
    with pytest.raises(InputFileError, match="is a link, not a regular file"):
        SweepDatabase.open(tmp_path)


def test_a_database_that_another_program_holds_is_in_use(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fingertip.sweep.database_file._BUSY_TIMEOUT_S", 0.01)
    (tmp_path / "sweep.sqlite").write_bytes(originals.sweep_database())
    with contextlib.closing(sqlite3.connect(tmp_path / "sweep.sqlite")) as held:
        held.execute("BEGIN EXCLUSIVE")
        with pytest.raises(SweepError, match="is in use by another program"):
            SweepDatabase.open(tmp_path)
