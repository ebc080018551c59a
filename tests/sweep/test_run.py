"""A sweep from its file to its rows, by the command line, in fresh processes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from fingertip.board import board_values
from fingertip.design import Design
from fingertip.errors import DesignError
from fingertip.sweep.database import Row, Store
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
                refused.value.issues[0].field,
                refused.value.issues[0].message,
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


def test_a_finished_sweep_is_shown_and_exported(swept: Path, tmp_path: Path) -> None:
    folder = tmp_path / "copy"
    folder.mkdir()
    (folder / "sweep.sqlite").write_bytes((swept / "out" / "sweep.sqlite").read_bytes())
    shown = run_fingertip("sweep", "--show", "--out", folder, "--csv", tmp_path / "rows.csv", "--json", "--quiet")
    assert shown.returncode == 0, shown.stderr
    assert json.loads(shown.stdout)["points"] == 24
    assert shown.stderr == ""
    lines = (tmp_path / "rows.csv").read_text().splitlines()
    assert len(lines) == 25
    assert lines[0].startswith("point,board.cutoff_hz,board.capacitor_uf,board.series,q,")
    assert {path.name for path in folder.iterdir()} >= {"sweep.sqlite", "summary.json"}
    assert (folder / "sweep.sqlite").read_bytes() == (swept / "out" / "sweep.sqlite").read_bytes()


def test_the_same_sweep_gives_the_same_file(swept: Path, tmp_path: Path) -> None:
    ran = run_fingertip(
        "sweep", swept / "sweep.toml", "--out", tmp_path / "again", "--jobs", 1, "--csv", tmp_path / "a"
    )
    assert ran.returncode == 0, ran.stderr
    assert repr(rows(tmp_path / "again")) == repr(rows(swept / "out"))


def test_outputs_are_listed_with_their_meaning() -> None:
    listed = json.loads(run_fingertip("sweep", "--outputs", "--json").stdout)["outputs"]
    assert {"name", "stage", "meaning"} == set(listed[0])
    assert {"checks_failed", "q", "delay_ms", "silicone_g"} <= {output["name"] for output in listed}
    assert "thinnest_skin_mm" in run_fingertip("sweep", "--outputs").stdout


def test_failed_points_make_the_exit_code_one(tmp_path: Path) -> None:
    text = FILE.replace('name = "boards"', 'name = "boards"\ntime_limit_s = 0.05\ntrials = 50\nscene = "slow.toml"')
    text = text.replace('outputs = ["q",', 'outputs = ["delay_ms", "q",').replace("steps = 6", "steps = 2")
    (tmp_path / "slow.toml").write_text("[slide]\ndistance_m = 0.1\n")
    (tmp_path / "sweep.toml").write_text(text.replace("[0.0001, 1.0]", "[0.1]").replace('"E12", "E96"', '"E12"'))
    ran = run_fingertip("sweep", tmp_path / "sweep.toml", "--out", tmp_path / "out", "--json")
    assert ran.returncode == 1, ran.stderr
    said = json.loads(ran.stdout)
    assert (said["rows"], said["timeout"], said["refused"]) == (2, 1, 1)
    assert rows(tmp_path / "out")[0].reason == "took longer than 0.05 s (time_limit_s), twice."
