"""Benchmarks: points of the work-precision diagrams, output of the command, CPU time of campaigns and many boards."""

from __future__ import annotations

import contextlib
import json
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.peers import board, contact, spice, throughput
from benchmarks.peers.__main__ import main
from benchmarks.peers.board import BoardProblem
from benchmarks.peers.contact import ContactProblem
from benchmarks.peers.native import NATIVE, NativeSolver, SolverFailedError, compile_solvers
from benchmarks.peers.spice import Spice
from benchmarks.peers.work_precision import WorkPrecision
from fingertip.foundation.errors import TraceError
from fingertip.foundation.jit import compiled
from fingertip.sim.signal.analog_circuit import AnalogBoard
from fingertip.sim.signal.filter_board import simulate_board
from fingertip.sim.simulation import article_trials
from tests.conftest import run_fingertip, run_python
from tests.designs import ARTICLE, article_design
from tests.tools import require_tool

DESIGN = ARTICLE
ZERO = np.zeros(3)


def diagram_of(*points: tuple[str, float, float], levels: tuple[float, ...] = (1e-3,)) -> WorkPrecision:
    """Diagram with points of solver, CPU time [s] and error [V]; "ours" comes first."""
    diagram = WorkPrecision("p", "V", levels, solvers={"ours": "1.0", "theirs": "2.0"})
    for solver, cpu_s, error in points:
        diagram.add_result(solver, "s", cpu_s, ZERO + error, ZERO)
    return diagram


@contextlib.contextmanager
def native_or_skip(*names: str) -> Iterator[dict[str, NativeSolver]]:
    """Solvers in C; skips loudly where compiler or library are missing."""
    require_tool("cc", "install a C compiler")
    if "CVODE" in names:
        require_tool("/usr/include/cvode/cvode.h", "install libsundials-dev, version 6 or newer")
    if "RADAU" in names:
        require_tool("/usr/local/lib/libradau.so", "run `sh .ci/install-radau` as root on Debian")
    with compile_solvers(names) as native:
        assert not native.missing
        yield dict(native.found)


@pytest.mark.full
def test_peers_agree_with_fingertip_on_the_contact():
    problem = ContactProblem.over(1.0)
    system = contact._scipy_equations(problem.mount, problem.normal)
    with compiled(), native_or_skip(*NATIVE) as native:
        ours = problem.run_fingertip(1e-10).result
        runs = {method: problem.run_scipy(system, method, 1e-10) for method in ("odeint", "LSODA")}
        runs |= {name: problem.run_native(solver, 1e-10) for name, solver in native.items()}
        for name, solver in native.items():
            with pytest.raises(SolverFailedError, match=f"{name}'s error -"):
                problem.run_native(solver, 1e-30)
    for name, run in runs.items():
        assert np.abs(run.result - ours).max() < 1e-6, name
        assert run.cpu_s > 0.0
    assert np.abs(ours[: len(problem.time_s)]).max() > 0.2


@pytest.mark.full
def test_peers_agree_with_fingertip_on_the_board():
    problem = BoardProblem(AnalogBoard.from_design(DESIGN), 0.5)
    system = board._scipy_equations(problem.board)
    with compiled(), native_or_skip(*NATIVE) as native:
        ours = problem.run_fingertip(1e-10).result
        sine = problem.run_exact_sine(system, "LSODA", 1e-11, problem.time_s)
        for name, solver in native.items():
            # Steps over the input's corners deceive the error estimates of high orders.
            for way, expected, bound in (
                ("step <= sample", ours, 2e-4), ("stops at samples", ours, 2e-6), ("sine", sine, 2e-6),
            ):  # fmt: skip
                found = problem.run_native(solver, way, None, 1e-8).result
                assert np.abs(found - expected).max() < bound, (name, way)
    assert ours.max() > 0.3


@pytest.mark.full
def test_rodas5p_has_its_published_order():
    # Equal steps from corner to corner of the drive, where the solution is smooth, each half as long as before. Where a
    # step is longer than a sample, the dense output counts, whose order is 4.
    problem = ContactProblem.over(1.0)
    with compiled(), native_or_skip("Rodas5P") as native:
        ours = problem.run_fingertip(1e-13).result
        errors = [
            np.abs(problem.run_native(native["Rodas5P"], 1.0, steps).result - ours).max() for steps in (250, 500, 1000)
        ]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    print(errors, orders)
    assert ((orders > 3.7) & (orders < 5.5)).all(), errors


@pytest.mark.full
def test_ngspice_agrees_on_both_sources():
    program = require_tool("ngspice", "run `sh .ci/install-ngspice` as root on Debian, or install ngspice")
    problem = BoardProblem(AnalogBoard.from_design(DESIGN), 0.5)
    system = board._scipy_equations(problem.board)
    sampled = spice.sampled_source(board.STEP_S, problem.voltage_v)
    simulator = Spice(program, problem.board, sampled, board.STEP_S, problem.seconds)
    lines = problem.run_spice(simulator, None, 1e-5, 5e-5)
    assert np.abs(lines.result - problem.run_fingertip(1e-8).result).max() < 1e-3
    source = spice.burst_source(board.CONSTANT_V, board.AMPLITUDE_V, board.FREQUENCY_HZ, *problem.burst_s)
    native = problem.run_spice(replace(simulator, source=source), system, 1e-5, 5e-5)
    assert native.reference is not None
    assert np.abs(native.result - native.reference).max() < 1e-3
    assert native.result.max() > 0.3
    assert min(native.cpu_s, lines.cpu_s, simulator.measure_start_up_s()) > 0.0


@pytest.mark.full
def test_command_writes_diagrams_and_times(tmp_path):
    pytest.importorskip("numba")
    done = run_python(
        "-m", "benchmarks.peers", "--out", str(tmp_path), "--seconds", "1", "--boards", "20",
        "--solvers", "LSODA, odeint,CVODE,RADAU5,Rodas5P,ngspice", "--no-first-run", "--json",
    )  # fmt: skip
    data = json.loads(done.stdout)
    missed = any(data[name]["cpu_s"] > data[name]["target_s"] for name in ("trials", "manipulations", "boards"))
    for diagram in data["diagrams"]:
        for found in diagram["comparisons"].values():
            missed |= bool(found["mean"] and found["target"] and found["mean"] < found["target"])
    trial = data["whole_trial"]
    coarse = [point["errors"] for point in trial["points"] if point["step_s"] == 1e-4]
    missed |= any(errors[name] > limit for errors in coarse for name, limit in trial["targets"].items())
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
        # The references differ by the machine's rounding, and an error counts from a hundred times that.
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


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ["--solvers", "LSODA,Euler"],
            "'Euler' is not known; choose among LSODA, Radau, BDF, odeint, CVODE, RADAU5, RADAU, Rodas5P, ngspice.",
        ),
        (["--solvers", ""], "--solvers: '' names no solver; give at least one of LSODA, Radau, BDF, odeint, CVODE"),
        (["--solvers", " , "], "--solvers: ' , ' names no solver"),
        (["--seconds", "0"], "--seconds: 0 s is out of bounds; choose 1 to 60 s."),
        (["--boards", "0"], "--boards: 0 is out of bounds"),
    ],
)
def test_command_refuses_bad_options(arguments, message, tmp_path, capsys):
    with pytest.raises(SystemExit, match="2"):
        main([*arguments, "--out", str(tmp_path / "x")])
    assert message in capsys.readouterr().err
    assert not (tmp_path / "x").exists()


def test_the_former_command_says_where_to():
    done = run_fingertip("bench", "solvers", "--seconds", 2)
    assert (done.returncode, done.stdout, len(done.stderr.splitlines())) == (2, "", 1)
    assert "`fingertip accuracy` states" in done.stderr
    assert "`python -m benchmarks.peers` compares" in done.stderr


def test_trials_are_those_of_the_article():
    planned = list(article_trials())
    assert len({seed for _, seed in planned}) == len(planned) == 120
    assert Counter(scene.scene for scene, _ in planned) == {"sliding_finger": 90, "sliding_surface": 30}
    assert Counter(scene.slide.speed_m_s for scene, _ in planned) == {0.04: 40, 0.06: 40, 0.08: 40}


@pytest.mark.parametrize(("variant", "count"), [("article", 10), ("precision", 10), ("comparator", 15)])
def test_drawn_boards_lie_within_their_tolerances(variant, count):
    nominal = AnalogBoard.from_design(article_design(board={"variant": variant}))
    many, few = throughput.draw_boards(nominal, 500, 3).components, throughput.draw_boards(nominal, 20, 3).components
    assert len(many) == count
    for name, value in nominal.components.items():
        share = 0.01 if name.startswith("R") else 0.05
        ratio = many[name] / value
        assert 1 - share * (1 + 1e-9) <= ratio.min() < 1 - 0.95 * share
        assert 1 + 0.95 * share < ratio.max() <= 1 + share * (1 + 1e-9)
        assert np.array_equal(few[name], many[name][:20])
    assert not np.array_equal(many["C1"], many["C2"])
    assert not np.array_equal(throughput.draw_boards(nominal, 20, 4).components["C1"], few["C1"])
    with pytest.raises(TraceError, match="count: 0 is too few; give at least 1 board"):
        throughput.draw_boards(nominal, 0)


def test_boards_in_chunks_equal_boards_at_once():
    boards, voltage = throughput.draw_boards(AnalogBoard.from_design(DESIGN), 300), 4 + 0.01 * np.sin(np.arange(40.0))
    whole = simulate_board(boards, 5e-4, voltage)
    chunks = [simulate_board(part, 5e-4, voltage) for part in throughput.split_boards(boards)]
    assert [len(chunk.envelope_v) for chunk in chunks] == [256, 44]
    assert np.array_equal(np.concatenate([chunk.envelope_v for chunk in chunks]), whole.envelope_v)
    assert sum(chunk.steps for chunk in chunks) == whole.steps
