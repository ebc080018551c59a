"""Manipulations: hand, object, sensors, and a controller that receives only what a real one would."""

from __future__ import annotations

import itertools
import json
from dataclasses import replace

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.foundation.errors import TraceError
from fingertip.sim import ManipulationFile, article_manipulations, compiled, run_manipulation
from fingertip.sim.contact.pad import Pad
from fingertip.sim.runs.motion import plan_motion
from fingertip.sim.runs.stepper import HandSignals, ManipulationStepper
from fingertip.sim.signal.bridge import LOAD_SHIFT_PER_M
from fingertip.sim.signal.converter import compute_bridge_v
from fingertip.sim.signal.grid import BASE_HZ, Grid
from tests.conftest import ROOT, run_fingertip

DESIGN = Design()
PAD = Pad.from_design(DESIGN)
QUICK = {"close_s": 0.3, "settle_s": 0.2, "after_s": 1.0}


@pytest.fixture(autouse=True)
def _fast():
    """Run compiled loops where numba is installed; test_hand.py checks that they give the same bits."""
    with compiled():
        yield


def make_scene(**tables) -> ManipulationFile:
    """A short manipulation without spread of the friction, with these tables."""
    tables = {name: dict(table) if isinstance(table, dict) else table for name, table in tables.items()}
    tables["grasp"] = QUICK | tables.get("grasp", {})
    tables["object"] = {"friction_spread": 0.0} | tables.get("object", {})
    return ManipulationFile(**tables)


def test_chunk_sizes_change_no_bit():
    scene = make_scene(
        grasp={"kind": "pinch"}, object={"mass_kg": 0.06}, outputs=["voltage_v", "force_n", "envelope_v"]
    )
    plan = plan_motion(scene, PAD, 1)
    time = np.arange(20_000) / BASE_HZ
    command = plan.planned_m(time) + 0.003 * np.sin(20 * time) * (time > 1.0)
    whole, chunked = (
        ManipulationStepper(DESIGN, scene, plan, PAD, 1, frozenset(scene.outputs), Grid()) for _ in range(2)
    )
    whole.advance(command)
    boundaries = [0, 1, 2, 19, 20, 777, 2500, 2501, 20_000]
    for start, end in itertools.pairwise(boundaries):
        chunked.advance(command[:, start:end])
    first, second = (HandSignals.join(stepper.chunks) for stepper in (whole, chunked))
    for name in (*scene.outputs, "object_m", "closing_m"):
        assert np.array_equal(first.find(name), second.find(name)), name


@pytest.mark.full
def test_command_takes_effect_after_the_delay():
    class StepController:
        def step(self, observation):
            return np.full(2, 0.01 if observation.time_s >= 0.1 else 0.0)

    for delay in (0.0, 0.02, 0.0215):
        result = run_manipulation(
            DESIGN, make_scene(grasp={"kind": "pinch"}, hand={"delay_s": delay}), StepController(), 1
        )
        moving = np.flatnonzero(result.signals.closing_m[0])[0]
        assert result.time_s[moving] == pytest.approx(0.1 + delay + 0.0005)


def test_weight_shears_the_pad_and_reduces_the_sensor_reading():
    scene = make_scene(
        grasp={"force_n": 10.0, "kind": "pinch"}, object={"mass_kg": 0.5}, knock={"speed_m_s": 0.0, "at_s": 0.5}
    )
    result = run_manipulation(DESIGN, scene, None, 1)
    before = result.time_s < result.plan.released_s - scene.grasp.let_go_s
    held = [result.output("voltage_v")[0][flags][-200:].mean() for flags in (before, result.time_s > 0)]
    sheared = 0.5 * 9.80665 / 2 / PAD.tangential_stiffness_n_per_m(10.0)

    def voltage(force_n):
        return compute_bridge_v(DESIGN, np.array([force_n]))[0]

    # The hysteresis of the sensor hides a part of a falling force.
    change = voltage(10.0 * (1 - LOAD_SHIFT_PER_M * sheared)) - voltage(10.0)
    assert 0.5 * change < held[1] - held[0] < 1.1 * change


def test_knock_frees_a_marginal_grip_and_not_a_firm_one():
    loose, firm = (
        run_manipulation(
            DESIGN, make_scene(grasp={"min_margin": m, "max_margin": m}, outputs=["slip", "object_m"]), None, 1
        )
        for m in (1.15, 1.6)
    )
    assert loose.lost_s > loose.plan.knock_s
    assert firm.lost_s is None
    assert firm.signals.object_m[-1] < 0.02
    for run in (loose, firm):
        onset = run.time_s[run.output("slip")[0]][0]
        assert run.plan.knock_s < onset < run.plan.knock_s + 0.03


@pytest.mark.full
def test_controller_receives_samples_and_encoders_only():
    observations = []

    class RecordingController:
        def step(self, observation):
            observations.append(
                replace(observation, voltage_v=observation.voltage_v.copy(), envelope_v=observation.envelope_v.copy())
            )
            command = observation.planned_m.copy()
            for array in (observation.voltage_v, observation.closing_m, observation.planned_m, observation.envelope_v):
                array[...] = 99.0  # must not change the simulation
            return command

    scene = make_scene(grasp={"kind": "pinch"}, outputs=["voltage_v", "envelope_v", "sampled_envelope_v"])
    result = run_manipulation(DESIGN, scene, RecordingController(), 1)
    voltage = np.concatenate([observation.voltage_v for observation in observations], axis=1)
    assert np.array_equal(voltage, result.output("voltage_v")[:, : voltage.shape[1]])
    assert {observation.voltage_v.shape for observation in observations[1:]} == {(2, 20)}
    assert [observation.time_s for observation in observations[:3]] == [0.0, 0.01, 0.02]
    assert set(vars(observations[0])) == {"time_s", "voltage_v", "closing_m", "planned_m", "envelope_v", "filtered_v"}
    envelope_v = np.concatenate([observation.envelope_v for observation in observations], axis=1)
    assert np.array_equal(envelope_v, result.output("sampled_envelope_v")[:, : voltage.shape[1]])
    assert np.abs(envelope_v - result.output("envelope_v")[:, : voltage.shape[1]]).max() > 1e-3


def test_manipulations_of_the_article():
    found = list(article_manipulations())
    assert [(s.object.mass_kg, s.grasp.kind) for s, _ in found[::3]] == [
        (0.5, "power"), (0.255, "power"), (0.06, "pinch"), (0.02, "pinch"),
    ]  # fmt: skip
    assert [seed for _, seed in found] == list(range(12))
    assert {s.knock.speed_m_s for s, _ in found} == {0.08}
    assert {len(s.fingers) for s, _ in found} == {5, 2}


def test_seed_determines_the_result():
    scene = make_scene(grasp={"kind": "pinch", "after_s": 0.0}, object={"mass_kg": 0.2, "friction_spread": 0.05})
    one, again, other = (run_manipulation(DESIGN, scene, None, seed) for seed in (1, 1, 2))
    assert np.array_equal(one.output("voltage_v"), again.output("voltage_v"))
    assert one.force_n != other.force_n
    assert one.plan.friction.mu_s != other.plan.friction.mu_s


def test_an_object_that_no_hand_holds_is_refused_with_remedies_that_pass():
    """They were rounded down, or above what a hand may have."""
    tables = {"object": {"mass_kg": 5.0}, "grasp": {"max_margin": 20.0}, "hand": {}}
    for table, name, remedy in (
        ("object", "mass_kg", "at most 0.713 kg"), ("hand", "max_force_n", "at least 99.9 N"), ("", "--seed", "0")
    ):  # fmt: skip
        with pytest.raises(TraceError, match=remedy) as caught:
            run_manipulation(DESIGN, make_scene(**tables), None, -1)
        assert caught.value.issues[-1].field == f"{table}.{name}".removeprefix(".")
        assert "--seed" in [issue.field for issue in caught.value.issues]
        tables |= {table: {name: float(remedy.split()[2])}} if table else {}


def test_command_writes_trace_and_plot(tmp_path):
    arguments = ["simulate", ROOT / "params/scenes/real_manipulation.toml", "--design", ROOT / "params/fsr402.toml"]
    more = ["--json", "-q", "--set", "grasp.kind=pinch", "--set", "grasp.after_s=0.1", "--force-n", "3.0"]
    files = ["--out", tmp_path / "a.csv", "--plot", tmp_path / "a.png"]
    done = run_fingertip(*arguments, *more, *files)
    assert done.returncode == 0, done.stderr
    data = json.loads(done.stdout)
    assert (data["grasp"], data["force_n"], data["held"], list(data["fingers"])) == (
        "pinch",
        3.0,
        True,
        ["thumb", "index"],
    )
    assert data["columns"] == [
        "time_s", "voltage_v", "force_n", "slip", "index_voltage_v", "index_force_n", "index_slip",
    ]  # fmt: skip
    assert (tmp_path / "a.csv").read_text().splitlines()[0] == ",".join(data["columns"])
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
    first = (tmp_path / "a.csv").read_bytes(), (tmp_path / "a.png").read_bytes()
    assert run_fingertip(*arguments, *more, *files).returncode == 0
    assert first == ((tmp_path / "a.csv").read_bytes(), (tmp_path / "a.png").read_bytes())
    found = run_fingertip("detect", tmp_path / "a.csv", "--design", ROOT / "params/fsr402.toml", "--json", "-q")
    assert found.returncode == 0, found.stderr  # the thumb's columns, like the article's


def test_command_with_grip_holds_what_is_lost_without(tmp_path):
    file = ROOT / "params/scenes/real_manipulation.toml"
    pinch = ["--set", "object.mass_kg=0.06", "--set", "grasp.kind=pinch", "--set", "grasp.after_s=1", "--seed", "3"]
    arguments = ["simulate", file, "--design", ROOT / "params/fsr402.toml", *pinch, "--json", "-q"]
    results = {}
    for grip in ([], ["--grip", "fast"], ["--grip", "analog"]):
        done = run_fingertip(*arguments, *grip, "--out", tmp_path / "a.csv")
        assert done.returncode == 0, done.stderr
        results[tuple(grip)] = json.loads(done.stdout)
    assert not results[()]["held"]
    for grip in (("--grip", "fast"), ("--grip", "analog")):
        assert results[grip]["held"]
        (first, *_) = results[grip]["grips_s"]
        assert 2.9 < first < 3.0  # the knock comes at 2.9 s
    assert "sampled_envelope_v" in results["--grip", "analog"]["columns"]
    refused = run_fingertip("simulate", "--grip", "fats", "--out", tmp_path / "b.csv")
    assert refused.returncode == 2
    assert "closes the loop of a hand" in refused.stderr
    assert "did you mean fast?" in refused.stderr
    assert not (tmp_path / "b.csv").exists()
