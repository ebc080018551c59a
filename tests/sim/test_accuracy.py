"""Error of whole simulations: order of convergence in every scene and in a hand, and what
`fingertip accuracy` says.
"""

from __future__ import annotations

import json
from itertools import takewhile
from pathlib import Path

import numpy as np
import pytest

from fingertip.board.components.values import SUPPLIES
from fingertip.catalogues.file_kinds import SCENE, list_bundled_files
from fingertip.design import Design
from fingertip.foundation.jit import compiled
from fingertip.lab.accuracy import accuracy_summary, extremes, measure
from fingertip.lab.accuracy.accuracy_summary import FILES
from fingertip.sim.runs.manipulation import run_manipulation
from fingertip.sim.runs.scene import run_scene
from fingertip.sim.runs.scene_and_manipulation_files import ManipulationFile, SceneFile
from fingertip.sim.signal.grid import TARGETS, Grid
from fingertip.sim.simulation_summary import has_target
from tests.conftest import run_fingertip
from tools.accuracy.stated_errors import draw_simulation, try_simulation

PULL = {"attached": True, "trigger_v": 0.01, "stroke_m": 0.04, "stiffness_n_per_m": 20_000.0}
QUIET = {"noise_v": 0.0, "adc_bits": 24}
DESIGN = Design(detector=QUIET)
FLOOR = {
    "force_n": 1e-7,
    "tactile_v": 1e-9,
    "voltage_v": 5e-6,
    "envelope_v": 3e-5,
    "velocity_m_s": 1e-9,
    "object_m": 1e-11,
}
"""Errors that are not those of the grid: tolerance of the board, steps of the ADC, last digits."""
BASE_ERRORS = {"force_n": 2e-5, "object_m": 1e-9, "velocity_m_s": 5e-8}
"""Largest errors of a manipulation on the base grid.

On finer grids only that of the force is the grid's; the tolerance of the motion is as large as the
others.
"""


def find_orders(
    columns: dict[int, dict[str, np.ndarray]], floor: dict[str, float] = FLOOR
) -> dict[str, float]:
    """Order of each column whose errors on the four coarsest grids
    are above its floor, against the last grid.
    """
    *grids, finest = columns
    orders = {}
    for name in columns[finest]:
        errors = [float(np.abs(columns[n][name] - columns[finest][name]).max()) for n in grids]
        above = [*takewhile(lambda error, name=name: error > floor[name], errors)]
        if len(above) >= 4:
            orders[name] = -float(np.polyfit(np.arange(len(above)), np.log2(above), 1)[0])
    return orders


@pytest.mark.full
@pytest.mark.parametrize("path", list_bundled_files(SCENE).values(), ids=lambda path: path.stem)
@pytest.mark.parametrize("variant", ["article", "precision"])
def test_every_scene_converges_with_order_2(path, variant):
    design = Design(
        detector=QUIET, board={"variant": variant, "supply_v": SUPPLIES[variant].nominal_v}
    )
    scene = SceneFile.load(path)
    outputs = ["force_n", "tactile_v", "voltage_v", "envelope_v", "velocity_m_s"]
    sensing = scene.sensing.model_copy(update={"noise": False})
    scene = scene.model_copy(update={"outputs": outputs, "sensing": sensing})
    with compiled():
        orders = find_orders(
            {n: run_scene(design, scene, 1, grid=Grid(n)).columns for n in (1, 2, 4, 8, 64)}
        )
    # Where nothing shakes the pad, only its touch counts: Hertz's force begins with depth^1.5,
    # which costs some order.
    assert all(order > 1.8 for order in orders.values()), orders


@pytest.mark.full
@pytest.mark.parametrize(
    ("kind", "mass", "knock"), [("pinch", 0.06, {}), ("power", 0.255, {}), ("tri", 0.1, PULL)]
)
def test_manipulation_converges_with_order_2(kind, mass, knock):
    grasp = {"kind": kind, "min_margin": 1.15, "max_margin": 1.15, "after_s": 0.2}
    outputs = ["force_n", "object_m", "voltage_v", "velocity_m_s"]
    target = {"mass_kg": mass, "stiffness_n_per_m": 3000.0 if knock else 0.0}
    scene = ManipulationFile(
        object=target, grasp=grasp, knock=knock, sensing={"noise": False}, outputs=outputs
    )
    # Errors of the object change their sign between grids, so a fit to four of them is too few.
    with compiled():
        runs = {
            n: run_manipulation(DESIGN, scene, None, 1, grid=Grid(n)) for n in (1, 2, 4, 8, 16, 256)
        }
    lost_s = [run.lost_s for run in runs.values() if run.lost_s]
    until = min(lost_s, default=np.inf) - 0.005
    columns = {
        n: {k: v[run.time_s < until] for k, v in run.columns.items() if k in outputs}
        for n, run in runs.items()
    }
    orders = find_orders(columns, FLOOR | {"force_n": 1e-8})
    assert "force_n" in orders
    assert all(order > 1.7 for order in orders.values()), orders  # the pin hits between two points
    for name, limit in BASE_ERRORS.items():
        assert np.abs(columns[1][name] - columns[256][name]).max() < limit, name


@pytest.mark.parametrize("number", range(12))
def test_errors_that_simulate_states_hold(number):
    """Against steps of a sixteenth, which the bounds from half the step do not know."""
    with compiled():
        tried = try_simulation(draw_simulation(number))
    for signal, error in tried.errors.items():
        assert error <= tried.bounds[signal] <= 6.0 * error + 1e-9, signal
        if has_target(tried.simulation.design, signal):
            assert error <= TARGETS[signal], signal


def test_simulate_states_errors_and_time_in_one_line(tmp_path: Path) -> None:
    """The targets, or what half of the step changes, of what is written; with a grip, the time."""
    words = ("simulate", "hard_tap", "--set", "tap.count=1", "--out", tmp_path / "t.csv")
    outputs = ("--set", "outputs=['force_n','envelope_v']")
    brief = run_fingertip(*words, *outputs).stdout.splitlines()[-2]
    assert brief.startswith("computed in ")
    assert brief.partition(": ")[2] == (
        "force within 5.0e-05 N, envelope within 8.0e-04 V, in at least 95 % of runs; "
        "--verbose measures this one"
    )
    data = json.loads(run_fingertip(*words, "--json", "--verbose").stdout)
    assert set(data["errors"]) == {"force_n", "tactile_v"}
    assert data["errors_from"] == "half the step"
    assert 0.0 < data["errors"]["force_n"] < TARGETS["force_n"]
    assert data["computed_s"] > 0.0
    article = run_fingertip(*words, *outputs, "--set", "board.variant=article").stdout
    assert "envelope within" not in article
    idle = run_fingertip("simulate", "real_manipulation", "--grip", "fast", "--verbose")
    assert "--verbose: has no effect with --grip" in idle.stderr


@pytest.mark.second
def test_command_states_errors_that_fall_with_the_step(tmp_path: Path) -> None:
    done = run_fingertip(
        "accuracy", "article", "--cases", 40, "--jobs", 1, "--out", tmp_path / "x", "--json"
    )
    assert done.returncode == 0, done.stderr
    data = json.loads(done.stdout)
    assert data == json.loads((tmp_path / "x/accuracy.json").read_text())
    assert {path.name for path in (tmp_path / "x").iterdir()} == {*FILES, "manifest.json"}
    for run in ("trial", "grasp"):
        steps = [one for one in data["steps"] if one["run"] == run]
        assert [round(1e6 * one["step_s"]) for one in steps] == [100, 50, 25]
        forces = [one["errors"]["force_n"] for one in steps]
        assert forces[0] < 1e-3
        assert forces[0] / forces[2] > 8.0  # 16 with order 2, and the pin hits between two points
        assert all(one["real_time_ratio"] > 1.0 for one in steps)
    assert [one["wrong"] for one in data["extremes"].values()] == [0, 0, 0]


def test_wrong_case_ends_the_command_with_1_and_is_described(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for module in (extremes, accuracy_summary):
        monkeypatch.setattr(module, "FAMILIES", {"broken": ("nothing", 1.0, lambda draw: 2.0)})
    monkeypatch.setattr(
        measure, "measure_steps", lambda *_: [measure.StepError("r", 1e-4, {"force_n": 1e-5}, 1, 1)]
    )
    done = run_fingertip("accuracy", "--cases", 3, "--jobs", 1, "--out", tmp_path / "x")
    assert done.returncode == 1
    assert "extreme cases: 3 are WRONG" in done.stdout
    assert "WRONG broken, case 2: 2 of the bound" in done.stdout


def test_number_of_cases_may_have_its_bounds(tmp_path: Path) -> None:
    """Beyond them `tests/cli/transcripts/limits.txt` shows the refusal."""
    (tmp_path / FILES[0]).write_text("somebody's own")
    for cases in (1, 1_000_000):
        assert (
            "was not written by fingertip"
            in run_fingertip("accuracy", "--cases", cases, "--out", tmp_path).stderr
        )
