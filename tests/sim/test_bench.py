"""Benchmarks: points of the work-precision diagrams, output of the command, CPU time of campaigns and many boards."""

from __future__ import annotations

import json
from collections import Counter

import numpy as np
import pytest
from typer.testing import CliRunner

from fingertip.cli import app
from fingertip.design import Design
from fingertip.errors import TraceError
from fingertip.jit import compiled
from fingertip.sim import run_scene
from fingertip.sim.article import article_trials
from fingertip.sim.bench import throughput
from fingertip.sim.bench.work_precision import WorkPrecision
from fingertip.sim.signal.analog_circuit import AnalogBoard
from fingertip.sim.signal.filter_board import simulate_board, simulate_boards
from fingertip.sim.signal.monte_carlo import draw_boards
from tests.conftest import run_fingertip

DESIGN = Design()
ZERO = np.zeros(3)


def test_an_error_near_the_references_difference_is_omitted():
    diagram = WorkPrecision("p", "V", 1e-3, reference_difference=1e-8)
    diagram.add_result("ours", "fine", 1.0, ZERO + 1e-7, ZERO)
    diagram.add_result("ours", "coarse", 0.5, ZERO + 1e-5, ZERO)
    diagram.add_result("theirs", "nan", 0.5, ZERO * np.nan, ZERO)
    diagram.add_result("theirs", "short", 0.5, np.zeros(2), ZERO)
    diagram.measure("theirs", "broken", lambda: 1 / 0, ZERO)  # type: ignore[arg-type, return-value]
    assert [(p.solver, p.setting, p.error) for p in diagram.points] == [("ours", "coarse", 1e-5)]
    assert [line.split(":")[0] for line in diagram.omissions] == [
        "ours, fine", "theirs, nan", "theirs, short", "theirs, broken",
    ]  # fmt: skip
    assert "100 times the difference of the references, 1.0e-08 V" in diagram.omissions[0]
    assert "ZeroDivisionError" in diagram.omissions[-1]


def test_solvers_are_compared_at_errors_that_ours_reaches():
    diagram = WorkPrecision("p", "V", 1e-3, input_s=0.5)
    for solver, cpu, error in (("ours", 1.5, 1e-2), ("ours", 2.5, 2e-4), ("ours", 9.5, 1e-6), ("theirs", 99.5, 1e-2),
                               ("theirs", 199.5, 3e-4), ("late", 5.0, 1.0)):  # fmt: skip
        diagram.add_result(solver, "s", cpu, ZERO + error, ZERO)
    assert diagram.cpu_ratio("ours", "theirs") == pytest.approx(200 / 3)  # the input is part of both
    assert diagram.cpu_ratio("ours", "late") is None
    diagram.target_ratios["theirs"] = 50.0
    assert any("theirs: 67 times fingertip's CPU time (target 50) at an error of" in line for line in diagram.as_text())


@pytest.mark.slow
def test_command_writes_diagrams_and_times(tmp_path):
    pytest.importorskip("numba")
    done = run_fingertip(
        "bench", "--out", tmp_path, "--seconds", 1, "--boards", 20, "--solvers", "LSODA", "--no-first-run", "--json"
    )
    data = json.loads(done.stdout)
    missed = any(data[name]["cpu_s"] > data[name]["target_s"] for name in ("trials", "manipulations", "boards"))
    assert done.returncode == int(missed), done.stderr  # the machine's speed decides, not the test
    assert data == json.loads((tmp_path / "work_precision.json").read_text())
    assert (tmp_path / "work_precision.png").read_bytes()[:4] == b"\x89PNG"
    assert len(data["machine"]["load"]) == 3
    for diagram in data["diagrams"]:
        points = diagram["points"]
        ours = [p["error"] for p in points if p["solver"].startswith("fingertip")]
        assert len(ours) >= 3
        assert ours[-1] < 0.05 * ours[0]
        assert ours[-1] >= 100 * diagram["reference_difference"]
        assert min(p["error"] for p in points if p["solver"] == "scipy LSODA") < diagram["target"]
        assert diagram["cpu_ratios"]["scipy LSODA"] > 2
        assert isinstance(diagram["omissions"], list)
    assert "preparing the loop " in done.stderr


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--solvers", "LSODA,Euler"], "'Euler' is not known; choose among LSODA, Radau, BDF."),
        (["--seconds", "0"], "--seconds: 0 s is out of bounds; choose 1 to 60 s."),
        (["--boards", "0"], "--boards: 0 is out of bounds"),
    ],
)
def test_command_refuses_bad_options(arguments, message, tmp_path):
    done = CliRunner().invoke(app, ["bench", *arguments, "--out", str(tmp_path / "x")])
    assert done.exit_code == 2
    assert message in done.stderr
    assert not (tmp_path / "x").exists()


def test_trials_are_those_of_the_article():
    planned = list(article_trials())
    assert len({seed for _, seed in planned}) == len(planned) == 120
    assert Counter(scene.scene for scene, _ in planned) == {"sliding_finger": 90, "sliding_surface": 30}
    assert Counter(scene.slide.speed_m_s for scene, _ in planned) == {0.04: 40, 0.06: 40, 0.08: 40}


@pytest.mark.slow
def test_trials_take_seconds_and_all_slip():
    pytest.importorskip("numba")
    with compiled():
        found = throughput.measure_trials()
    assert found["slipping"] == found["trials"] == 120
    assert found["cpu_s"] < throughput.CAMPAIGN_TARGET_S


@pytest.mark.slow
def test_a_manipulation_takes_less_than_half_a_second():
    pytest.importorskip("numba")
    with compiled():
        found = throughput.measure_manipulations()
    assert found["manipulations"] == 12
    assert found["cpu_s"] < 0.5 * found["target_s"]
    assert found["lost"] >= 5  # without control


def test_boards_are_measured_on_a_trial_in_which_the_diode_conducts():
    """A fiftieth of 10 000 boards, on a strong trial of 5 s; `fingertip bench` compares the time with its target."""
    pytest.importorskip("numba")
    with compiled():
        found = throughput.measure_boards(200)
    assert found["samples"] == 10_000
    assert found["target_s"] == 0.3  # a fiftieth of 15 s
    assert found["cpu_s"] > 0.0
    assert found["conducting_ratio"] > 0.001
    peaks = found["peak_v"]
    assert 0.01 < peaks["5 %"] < peaks["50 %"] < peaks["95 %"]


def test_compiled_trial_has_the_bits_of_the_plain_one():
    pytest.importorskip("numba")
    scene, seed = next(iter(article_trials()))
    scene = scene.model_copy(update={"outputs": ["voltage_v", "force_n", "slip", "envelope_v"]})
    plain = run_scene(DESIGN, scene, seed)
    with compiled():
        fast = run_scene(DESIGN, scene, seed)
    for name, values in plain.columns.items():
        assert np.array_equal(values, fast.columns[name]), name


@pytest.mark.parametrize(("variant", "count"), [("article", 10), ("precision", 15)])
def test_drawn_boards_lie_within_their_tolerances(variant, count):
    board = AnalogBoard.from_design(Design(board={"variant": variant}))
    many, few = draw_boards(board, 500, 3).components, draw_boards(board, 20, 3).components
    assert len(many) == count
    for name, nominal in board.components.items():
        share = 0.01 if name.startswith("R") else 0.05
        ratio = many[name] / nominal
        assert 1 - share * (1 + 1e-9) <= ratio.min() < 1 - 0.95 * share
        assert 1 + 0.95 * share < ratio.max() <= 1 + share * (1 + 1e-9)
        assert np.array_equal(few[name], many[name][:20])
    assert not np.array_equal(many["C1"], many["C2"])
    assert not np.array_equal(draw_boards(board, 20, 4).components["C1"], few["C1"])
    with pytest.raises(TraceError, match="count: 0 is too few; give at least 1 board"):
        draw_boards(board, 0)


def test_boards_in_chunks_equal_boards_at_once():
    boards, voltage = draw_boards(AnalogBoard.from_design(DESIGN), 300), 4 + 0.01 * np.sin(np.arange(40.0))
    whole = simulate_board(boards, 5e-4, voltage)
    chunks = list(simulate_boards(boards, 5e-4, voltage))
    assert [len(chunk.envelope_v) for chunk in chunks] == [256, 44]
    assert np.array_equal(np.concatenate([chunk.envelope_v for chunk in chunks]), whole.envelope_v)
    assert sum(chunk.steps for chunk in chunks) == whole.steps
