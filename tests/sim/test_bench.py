"""Work-precision: how it judges, what the command writes; campaigns and many boards, and how long they take."""

from __future__ import annotations

import json
from collections import Counter

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.errors import TraceError
from fingertip.sim import run_scene
from fingertip.sim.bench import throughput
from fingertip.sim.bench.measure import Diagram
from fingertip.sim.bench.report import as_text
from fingertip.sim.campaign import trials
from fingertip.sim.electronics.analog import respond, respond_in_parts
from fingertip.sim.electronics.circuit import Analog
from fingertip.sim.electronics.monte_carlo import spread
from fingertip.sim.jit import compiled
from tests.conftest import run_fingertip

DESIGN = Design()
ZERO = np.zeros(3)


def test_an_error_the_references_cannot_judge_is_omitted():
    found = Diagram("p", "V", 1e-3, agreement=1e-8)
    found.judge("ours", "fine", 1.0, ZERO + 1e-7, ZERO)
    found.judge("ours", "coarse", 0.5, ZERO + 1e-5, ZERO)
    found.judge("theirs", "nan", 0.5, ZERO * np.nan, ZERO)
    found.judge("theirs", "short", 0.5, np.zeros(2), ZERO)
    found.add("theirs", "broken", lambda: 1 / 0, ZERO)  # type: ignore[arg-type, return-value]
    assert [(p.solver, p.setting, p.error) for p in found.points] == [("ours", "coarse", 1e-5)]
    assert [line.split(":")[0] for line in found.omissions] == [
        "ours, fine", "theirs, nan", "theirs, short", "theirs, broken",
    ]  # fmt: skip
    assert "100 times the references' difference, 1.0e-08 V" in found.omissions[0]
    assert "ZeroDivisionError" in found.omissions[-1]


def test_solvers_are_compared_at_errors_that_ours_reaches_too():
    found = Diagram("p", "V", 1e-3, input_s=0.5)
    for solver, cpu, error in (("ours", 1.5, 1e-2), ("ours", 2.5, 2e-4), ("ours", 9.5, 1e-6), ("theirs", 99.5, 1e-2),
                               ("theirs", 199.5, 3e-4), ("late", 5.0, 1.0)):  # fmt: skip
        found.judge(solver, "s", cpu, ZERO + error, ZERO)
    assert found.against("ours", "theirs") == pytest.approx(200 / 3)  # input charged to both
    assert found.against("ours", "late") is None
    found.goals["theirs"] = 50.0
    assert any("theirs: 67 times our CPU time (goal 50) at an error of" in line for line in as_text(found))


def test_the_command(tmp_path):
    pytest.importorskip("numba")
    done = run_fingertip(
        "bench", "--out", tmp_path, "--seconds", 1, "--boards", 20, "--solvers", "LSODA", "--no-first-run", "--json"
    )
    data = json.loads(done.stdout)
    missed = any(data[name]["cpu_s"] > data[name]["target_s"] for name in ("campaign", "manipulations", "boards"))
    assert done.returncode == int(missed), done.stderr  # how fast this machine is just now is no test's affair
    assert data == json.loads((tmp_path / "work_precision.json").read_text())
    assert (tmp_path / "work_precision.png").read_bytes()[:4] == b"\x89PNG"
    assert len(data["machine"]["load"]) == 3
    for diagram in data["diagrams"]:
        points = diagram["points"]
        ours = [p["error"] for p in points if p["solver"].startswith("fingertip")]
        assert len(ours) >= 3
        assert ours[-1] < 0.05 * ours[0]
        assert ours[-1] >= 100 * diagram["agreement"]
        assert min(p["error"] for p in points if p["solver"] == "scipy LSODA") < diagram["target"]
        assert diagram["times_ours"]["scipy LSODA"] > 2
        assert isinstance(diagram["omissions"], list)
    assert "preparing the loop of" in done.stderr or "compiled once" in done.stderr


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--solvers", "LSODA,Euler"], "'Euler' is not known; choose among LSODA, Radau, BDF."),
        (["--seconds", "0"], "--seconds: 0 s is refused; choose 1 to 60 s."),
        (["--boards", "0"], "--boards: 0 is refused"),
    ],
)
def test_the_command_refuses(arguments, words, tmp_path):
    done = run_fingertip("bench", *arguments, "--out", tmp_path / "x")
    assert done.returncode == 2
    assert words in done.stderr
    assert not (tmp_path / "x").exists()


def test_the_campaign_is_the_articles():
    wanted = list(trials())
    assert len({seed for _, seed in wanted}) == len(wanted) == 120
    assert Counter(scene.scene for scene, _ in wanted) == {"sliding_finger": 90, "sliding_surface": 30}
    assert Counter(scene.slide.speed_m_s for scene, _ in wanted) == {0.04: 40, 0.06: 40, 0.08: 40}


def test_the_campaign_takes_seconds_and_every_trial_slips():
    pytest.importorskip("numba")
    with compiled():
        found = throughput.campaign()
    assert found["slipping"] == found["trials"] == 120
    assert found["cpu_s"] < throughput.CAMPAIGN_TARGET_S


def test_a_manipulation_takes_much_less_than_a_second():
    pytest.importorskip("numba")
    with compiled():
        found = throughput.hands()
    assert found["manipulations"] == 12
    assert found["cpu_s"] < 0.5 * found["target_s"]
    assert found["lost"] >= 5  # without control


def test_many_boards_take_seconds():
    """A fiftieth of the 10 000 boards in less than a fiftieth of their 15 s, on a strong trial of 5 s."""
    pytest.importorskip("numba")
    with compiled():
        found = throughput.boards(200)
    assert found["samples"] == 10_000
    assert found["cpu_s"] < found["target_s"] == 0.3
    assert found["conducting"] > 0.001
    peaks = found["peak_v"]
    assert 0.01 < peaks["5 %"] < peaks["50 %"] < peaks["95 %"]


def test_a_compiled_trial_is_the_plain_one():
    pytest.importorskip("numba")
    scene, seed = next(iter(trials()))
    wanted = scene.model_copy(update={"outputs": ["voltage_v", "force_n", "slip", "envelope_v"]})
    plain = run_scene(DESIGN, wanted, seed)
    with compiled():
        fast = run_scene(DESIGN, wanted, seed)
    for name, values in plain.columns.items():
        assert np.array_equal(values, fast.columns[name]), name


def test_boards_lie_within_their_tolerances():
    board = Analog.of(DESIGN)
    many, few = spread(board, 500, 3), spread(board, 20, 3)
    for name, share in (("r1_ohm", 0.01), ("r_lp_ohm", 0.01), ("c1_f", 0.05), ("c_lp_f", 0.05)):
        ratio = getattr(many, name) / getattr(board, name)
        assert 1 - share <= ratio.min() < 1 - 0.95 * share
        assert 1 + 0.95 * share < ratio.max() <= 1 + share
        assert np.array_equal(getattr(few, name), getattr(many, name)[:20])
    assert not np.array_equal(many.c1_f, many.c2_f)
    assert not np.array_equal(spread(board, 20, 4).c1_f, few.c1_f)
    with pytest.raises(TraceError, match="count: 0 boards are none; give at least 1"):
        spread(board, 0)


def test_parts_of_many_boards_are_the_whole():
    boards, voltage = spread(Analog.of(DESIGN), 300), 4 + 0.01 * np.sin(np.arange(40.0))
    whole = respond(boards, 5e-4, voltage)
    parts = list(respond_in_parts(boards, 5e-4, voltage))
    assert [len(part.envelope_v) for part in parts] == [256, 44]
    assert np.array_equal(np.concatenate([part.envelope_v for part in parts]), whole.envelope_v)
    assert sum(part.steps for part in parts) == whole.steps
