"""A sweep from its file to its rows, by the command line, in fresh processes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from fingertip.board import board_values
from fingertip.design import Design
from fingertip.errors import DesignError
from fingertip.sweep.store import Row, Store
from tests.conftest import run_fingertip

FILE = """
name = "boards"
outputs = ["q", "cutoff_3db_hz", "board.r2_ohm", "gain"]

[axes]
board.cutoff_hz = {low = 20, high = 2000, steps = 6, spacing = "logarithmic"}
board.capacitor_uf = [0.0001, 1.0]
board.series = ["E12", "E96"]
"""


@pytest.fixture(scope="module")
def swept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a finished sweep of boards."""
    folder = tmp_path_factory.mktemp("boards")
    (folder / "sweep.toml").write_text(FILE)
    ran = run_fingertip("sweep", folder / "sweep.toml", "--out", folder / "out", "--json", "--jobs", 2)
    assert ran.returncode == 0, ran.stderr
    said = json.loads(ran.stdout)
    assert (said["points"], said["rows"], said["ok"] + said["refused"]) == (24, 24, 24)
    assert said["refused"] > 0
    return folder


def rows(folder: Path) -> list[Row]:
    with Store.open(folder) as store:
        return list(store.rows())


def test_each_row_is_what_the_design_alone_gives(swept: Path) -> None:
    found = rows(swept / "out")
    assert [row.point for row in found] == list(range(24))
    for row in found:
        changes = [f"{name}={value}" for name, value in row.axes.items()]
        if row.status == "refused":
            with pytest.raises(DesignError) as refused:
                Design.load(changes=changes)
            assert (row.field, row.reason.partition(" (and ")[0]) == (
                refused.value.faults[0].field,
                refused.value.faults[0].sentence,
            )
        else:
            values = board_values(Design.load(changes=changes))
            assert row.outputs == pytest.approx(
                {
                    "q": values.achieved.section_quality,
                    "cutoff_3db_hz": values.achieved.cutoff_hz,
                    "board.r2_ohm": values.preferred.r2_ohm,
                    "gain": values.achieved.passband_gain,
                },
                abs=5.1e-7,
            )


def test_a_folder_with_a_sweep_is_left_alone_without_resume(swept: Path) -> None:
    before = (swept / "out" / "sweep.sqlite").read_bytes()
    again = run_fingertip("sweep", swept / "sweep.toml", "--out", swept / "out")
    assert again.returncode == 2
    assert "--resume" in again.stderr
    assert (swept / "out" / "sweep.sqlite").read_bytes() == before
    assert [path.name for path in (swept / "out").iterdir()] == ["sweep.sqlite"]


def test_resuming_what_is_finished_computes_nothing(swept: Path) -> None:
    again = run_fingertip("sweep", swept / "sweep.toml", "--out", swept / "out", "--resume", "--json")
    assert again.returncode == 0, again.stderr
    assert json.loads(again.stdout)["computed_now"] == 0


def test_another_sweep_under_resume_is_refused_line_by_line(swept: Path, tmp_path: Path) -> None:
    (tmp_path / "other.toml").write_text(FILE.replace("0.0001, 1.0", "0.0001, 1.5"))
    again = run_fingertip("sweep", tmp_path / "other.toml", "--out", swept / "out", "--resume")
    assert again.returncode == 2
    assert "  - board.capacitor_uf = [0.0001, 1.0]\n  + board.capacitor_uf = [0.0001, 1.5]" in again.stderr
    assert again.stderr.count("\n") == 3
    assert len(rows(swept / "out")) == 24
