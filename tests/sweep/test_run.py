"""Sweeps from the command line: a file in, rows out; resumed, refused, reported on and exported."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from fingertip.board.analysis.board_values import board_values
from fingertip.design import Design
from fingertip.foundation.errors import DesignError
from tests.sweep.examples import read_rows, run_sweep_command

FILE = """
name = "boards"
outputs = ["q", "cutoff_3db_hz", "board.r2_ohm", "gain"]

[axes]
board.cutoff_hz = {low = 20, high = 2000, steps = 6, spacing = "logarithmic"}
board.capacitor_uf = [0.0001, 1.0]
board.series = ["E12", "E96"]
"""


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a sweep file and, in `out`, the rows that two processes computed."""
    folder = tmp_path_factory.mktemp("boards")
    (folder / "sweep.toml").write_text(FILE)
    result = run_sweep_command(
        folder / "sweep.toml", "--out", folder / "out", "--json", "--jobs", 2
    )
    assert result.exit_code == 0, result.stderr
    data = json.loads(result.stdout)
    assert (data["points"], data["rows"], data["ok"] + data["refused"]) == (24, 24, 24)
    assert data["refused"] > 0
    return folder


@pytest.mark.full
def test_each_row_equals_a_single_evaluation_of_its_design(finished: Path) -> None:
    rows = read_rows(finished / "out")
    assert [row.point for row in rows] == list(range(24))
    for row in rows:
        changes = [f"{name}={value}" for name, value in row.axes.items()]
        if row.status == "refused":
            with pytest.raises(DesignError) as error:
                Design.load(changes=changes)
            (issue,) = (issue for issue in error.value.issues if issue.field == row.field)
            # A sweep states the problem without the remedy.
            assert issue.message.startswith(row.reason.partition(" (and ")[0].rstrip("."))
        else:
            values = board_values(Design.load(changes=changes))
            assert row.outputs == pytest.approx(
                {
                    "q": values.achieved_response.section_quality,
                    "cutoff_3db_hz": values.achieved_response.cutoff_hz,
                    "board.r2_ohm": values.preferred.r2_ohm,
                    "gain": values.achieved_response.passband_gain,
                },
                abs=5.1e-7,
            )


@pytest.mark.full
def test_points_beyond_the_time_limit_make_the_exit_code_one(tmp_path: Path) -> None:
    text = FILE.replace(
        'name = "boards"', 'name = "boards"\ntime_limit_s = 0.05\ntrials = 50\nscene = "slow.toml"'
    )
    text = text.replace('outputs = ["q",', 'outputs = ["delay_ms", "q",').replace(
        "steps = 6", "steps = 2"
    )
    (tmp_path / "slow.toml").write_text("[slide]\ndistance_m = 0.1\n")
    (tmp_path / "sweep.toml").write_text(
        text.replace("[0.0001, 1.0]", "[0.1]").replace('"E12", "E96"', '"E12"')
    )
    result = run_sweep_command(tmp_path / "sweep.toml", "--out", tmp_path / "out", "--json")
    assert result.exit_code == 1, result.stderr
    data = json.loads(result.stdout)
    assert (data["rows"], data["timeout"], data["refused"]) == (2, 1, 1)
    assert read_rows(tmp_path / "out")[0].reason == "took longer than 0.05 s (time_limit_s), twice."
