"""Benchmarks: points of the work-precision diagrams, output of the
command, CPU time of campaigns and many boards.
"""

from __future__ import annotations

import json
from collections import Counter

import numpy as np
import pytest

from benchmarks.peers import throughput
from fingertip.sim.signal.analog_circuit import AnalogBoard
from fingertip.sim.signal.filter_board import simulate_board
from fingertip.sim.simulation import article_trials
from tests.conftest import run_fingertip, run_python
from tests.designs import ARTICLE


@pytest.mark.full
def test_command_writes_diagrams_and_times(tmp_path):
    pytest.importorskip("numba")
    done = run_python(
        "-m",
        "benchmarks.peers",
        "--out",
        str(tmp_path),
        "--seconds",
        "1",
        "--boards",
        "20",
        "--solvers",
        "LSODA, odeint,CVODE,RADAU5,Rodas5P,ngspice",
        "--no-first-run",
        "--json",
    )
    data = json.loads(done.stdout)
    missed = any(
        data[name]["cpu_s"] > data[name]["target_s"]
        for name in ("trials", "manipulations", "boards")
    )
    for diagram in data["diagrams"]:
        for found in diagram["comparisons"].values():
            missed |= bool(found["mean"] and found["target"] and found["mean"] < found["target"])
    trial = data["whole_trial"]
    coarse = [point["errors"] for point in trial["points"] if point["step_s"] == 1e-4]
    missed |= any(
        errors[name] > limit for errors in coarse for name, limit in trial["targets"].items()
    )
    assert done.returncode == int(missed), done.stderr  # the machine's speed decides, not the test
    assert data == json.loads((tmp_path / "work_precision.json").read_text())
    assert (tmp_path / "work_precision.png").read_bytes()[:4] == b"\x89PNG"
    assert len(data["machine"]["load"]) == 3
    assert all(cpu_s > 0.0 for cpu_s in data["start_up_cpu_s"].values())
    assert len(data["start_up_cpu_s"]) >= 2
    for diagram in data["diagrams"]:
        points = diagram["points"]
        ours = [p["error"] for p in points if p["solver"] == "fingertip"]
        assert len(ours) >= 3
        # The references differ by the machine's rounding, and an error counts from a hundred times
        # that.
        assert ours[-1] < max(0.05 * ours[0], 1000 * diagram["reference_difference"])
        for name in ("scipy LSODA", "scipy odeint"):
            assert None not in diagram["comparisons"][name]["ratios"]
            assert diagram["comparisons"][name]["mean"] > 0
    differences = data["whole_trial"]["reference_differences"].values()
    assert max(max(found.values()) for found in differences) < 1e-5  # [N, V]
    assert "% done" not in done.stderr, "shares are for terminals"
    text = (tmp_path / "work_precision.txt").read_text()
    assert text.startswith("a target is MISSED\n" if missed else "all targets are met\n")
    assert text.count("MISSED  ") + text.count("met     ") == 6


def test_the_former_command_says_where_to():
    done = run_fingertip("bench", "solvers", "--seconds", 2)
    assert (done.returncode, done.stdout, len(done.stderr.splitlines())) == (2, "", 1)
    assert "`fingertip accuracy` states" in done.stderr
    assert "`python -m benchmarks.peers` compares" in done.stderr


def test_trials_are_those_of_the_article():
    planned = list(article_trials())
    assert len({seed for _, seed in planned}) == len(planned) == 120
    assert Counter(scene.scene for scene, _ in planned) == {
        "sliding_finger": 90,
        "sliding_surface": 30,
    }
    assert Counter(scene.slide.speed_m_s for scene, _ in planned) == {0.04: 40, 0.06: 40, 0.08: 40}


def test_boards_in_chunks_equal_boards_at_once():
    boards = throughput.draw_boards(AnalogBoard.from_design(ARTICLE), 300)
    voltage = 4 + 0.01 * np.sin(np.arange(40.0))
    whole = simulate_board(boards, 5e-4, voltage)
    chunks = [simulate_board(part, 5e-4, voltage) for part in throughput.split_boards(boards)]
    assert [len(chunk.envelope_v) for chunk in chunks] == [256, 44]
    assert np.array_equal(np.concatenate([chunk.envelope_v for chunk in chunks]), whole.envelope_v)
    assert sum(chunk.steps for chunk in chunks) == whole.steps
