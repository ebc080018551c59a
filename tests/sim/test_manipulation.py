"""Real manipulation: hand, object, sensors, and a controller that sees no more than a real one would."""

from __future__ import annotations

import itertools
import json
from dataclasses import replace

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.errors import TraceError
from fingertip.sim import FixedGrip, ManipulationFile, compiled, manipulations, run_manipulation
from fingertip.sim.contact.pad import Pad
from fingertip.sim.electronics.anti_alias import Poles
from fingertip.sim.electronics.sensing import LOAD_SHIFT_PER_M, voltage_of
from fingertip.sim.hand.manipulation_plan import plan
from fingertip.sim.hand.manipulation_run import Run
from tests.conftest import ROOT, run_fingertip

DESIGN = Design()
PAD = Pad.of(DESIGN)
QUICK = {"close_s": 0.3, "settle_s": 0.2, "after_s": 1.0}


@pytest.fixture(autouse=True)
def _fast():
    """Compiled where numba is; test_hand.py holds that the bits are the same."""
    with compiled():
        yield


def scene(**tables) -> ManipulationFile:
    tables = {name: dict(table) if isinstance(table, dict) else table for name, table in tables.items()}
    tables["grasp"] = QUICK | tables.get("grasp", {})
    tables["object"] = {"friction_spread": 0.0} | tables.get("object", {})
    return ManipulationFile(**tables)


def test_stepping_changes_no_bit():
    """One step over everything, and a controller that looks on every 10 ms but does nothing."""
    outputs = ["voltage_v", "force_n", "slip", "object_m", "closing_m", "pin_n", "envelope_v"]
    tables = scene(grasp={"max_margin": 1.15}, outputs=outputs)
    at_once, stepped = run_manipulation(DESIGN, tables, None, 3), run_manipulation(DESIGN, tables, FixedGrip(), 3)
    assert at_once.lost_s is not None
    for name, signal in at_once.signals.items():
        assert np.array_equal(signal, stepped.signals[name]), name


def test_cuts_change_no_bit_while_the_hand_moves():
    """The run itself, cut at random, under commands that never rest."""
    tables = scene(grasp={"kind": "pinch"}, object={"mass_kg": 0.06}, outputs=["voltage_v", "force_n", "envelope_v"])
    made = plan(tables, PAD, 1)
    time = np.arange(4000) / 2000
    command = made.planned_m(time) + 0.003 * np.sin(20 * time) * (time > 1.0)
    whole, cut = (Run(DESIGN, tables, made, PAD, 1, frozenset(tables.outputs)) for _ in range(2))
    whole.advance(command)
    cuts = [0, 1, 2, 19, 20, 777, 2500, 2501, 4000]
    for start, end in itertools.pairwise(cuts):
        cut.advance(command[:, start:end])
    for name, parts in whole.parts.items():
        assert np.array_equal(np.concatenate(parts, axis=-1), np.concatenate(cut.parts[name], axis=-1)), name


def test_a_command_takes_the_delay():
    class Steps:
        def step(self, seen):
            return np.full(2, 0.01 if seen.time_s >= 0.1 else 0.0)

    for delay in (0.0, 0.02, 0.0215):
        made = run_manipulation(DESIGN, scene(grasp={"kind": "pinch"}, hand={"delay_s": delay}), Steps(), 1)
        moving = np.flatnonzero(made.signals["closing_m"][0])[0]
        assert made.time_s[moving] == pytest.approx(0.1 + delay + 0.0005)


def test_the_weight_shears_the_pads_and_the_sensor_loses_by_it():
    tables = scene(
        grasp={"force_n": 10.0, "kind": "pinch"}, object={"mass_kg": 0.5}, knock={"speed_m_s": 0.0, "at_s": 0.5}
    )
    made = run_manipulation(DESIGN, tables, None, 1)
    before = made.time_s < made.plan.let_go_s - tables.grasp.let_go_s
    held = [made.signals["voltage_v"][0][flags][-200:].mean() for flags in (before, made.time_s > 0)]
    sheared = 0.5 * 9.80665 / 2 / PAD.tangential_stiffness_n_per_m(10.0)
    voltage = voltage_of(DESIGN, "board")
    # Its hysteresis shows a falling force larger by a part of it: between nothing and all of the change.
    change = voltage(10.0 * (1 - LOAD_SHIFT_PER_M * sheared)) - voltage(10.0)
    assert 0.5 * change < held[1] - held[0] < 1.1 * change


def test_a_grip_at_the_margin_is_knocked_loose_and_one_well_beyond_it_holds():
    loose, firm = (
        run_manipulation(DESIGN, scene(grasp={"min_margin": m, "max_margin": m}, outputs=["slip", "object_m"]), None, 1)
        for m in (1.15, 1.6)
    )
    assert loose.lost_s > loose.plan.knock_s
    assert firm.lost_s is None
    assert firm.signals["object_m"][-1] < 0.02
    for run in (loose, firm):
        onset = run.time_s[run.signals["slip"][0]][0]
        assert run.plan.knock_s < onset < run.plan.knock_s + 0.03


class Tighter:
    """Closes by 2 cm at a given moment."""

    def __init__(self, at_s: float) -> None:
        self.at_s = at_s

    def step(self, seen):
        return seen.planned_m + (0.02 if seen.time_s >= self.at_s else 0.0)


def test_a_hand_told_in_time_holds_what_it_would_lose():
    tables = scene(grasp={"max_margin": 1.15})
    lost = run_manipulation(DESIGN, tables, FixedGrip(), 2)
    held = run_manipulation(DESIGN, tables, Tighter(lost.plan.knock_s + 0.05), 2)
    late = run_manipulation(DESIGN, tables, Tighter(lost.lost_s + 0.05), 2)
    assert (held.lost_s, late.lost_s) == (None, lost.lost_s)
    gain = held.signals["force_n"][:, -1] - held.plan.force_n
    assert gain[0] == pytest.approx(gain[1:].sum(), abs=0.1)
    assert gain[0] > 1.0


def test_what_a_controller_is_handed():
    seen = []

    class Looks:
        def step(self, now):
            seen.append(replace(now, voltage_v=now.voltage_v.copy(), envelope_v=now.envelope_v.copy()))
            command = now.planned_m.copy()
            for array in (now.voltage_v, now.closing_m, now.planned_m, now.envelope_v):
                array[...] = 99.0  # what it does to its copies is its own affair
            return command

    wanted = scene(grasp={"kind": "pinch"}, outputs=["voltage_v", "envelope_v"])
    made = run_manipulation(DESIGN, wanted, Looks(), 1)
    voltage = np.concatenate([now.voltage_v for now in seen], axis=1)
    assert np.array_equal(voltage, made.signals["voltage_v"][:, : voltage.shape[1]])
    assert {now.voltage_v.shape for now in seen[1:]} == {(2, 20)}
    assert [now.time_s for now in seen[:3]] == [0.0, 0.01, 0.02]
    assert set(vars(seen[0])) == {"time_s", "voltage_v", "closing_m", "planned_m", "envelope_v"}
    enveloped = np.concatenate([now.envelope_v for now in seen], axis=1)
    board = np.stack([Poles.envelope(DESIGN).process(v) for v in made.signals["envelope_v"]])[:, : voltage.shape[1]]
    difference = (enveloped - board)[board < DESIGN.detector.adc_range_v - 0.1]  # noise and steps of the converter
    assert np.std(difference) == pytest.approx(np.hypot(DESIGN.detector.noise_v, 20 / 2**16 / np.sqrt(12)), rel=0.05)
    unasked = []

    class Peeks:
        def step(self, now):
            unasked.append(now.envelope_v)
            return now.planned_m

    run_manipulation(DESIGN, scene(grasp={"kind": "pinch"}), Peeks(), 1)
    assert set(unasked) == {None}


@pytest.mark.parametrize(("answer", "words"), [([0.0], "shape (1,)"), ([0.0, float("nan")], "nan for finger 1")])
def test_a_command_that_is_none(answer, words):
    class Wrong:
        def step(self, seen):
            return np.array(answer)

    with pytest.raises(TraceError, match="controller") as caught:
        run_manipulation(DESIGN, scene(grasp={"kind": "pinch"}), Wrong())
    assert words in str(caught.value)


@pytest.mark.parametrize(
    ("outputs", "stages"),
    [
        (["slip", "object_m"], ["hand", "object"]),
        (["force_n"], ["profile", "hand", "object", "contact"]),
        (["voltage_v"], ["profile", "hand", "object", "contact", "sensor"]),
    ],
    ids=str,
)
def test_only_what_is_needed_runs(outputs, stages):
    tables = scene(outputs=outputs, grasp={"kind": "pinch", "after_s": 0.0})
    made = run_manipulation(DESIGN, tables, None, 1)
    assert [stage.name for stage in made.ran] == stages
    assert {stage.name: stage.states for stage in made.ran}["object"] == 3 * 2 + 2
    full = run_manipulation(DESIGN, scene(grasp={"kind": "pinch", "after_s": 0.0}), None, 1)
    for name in set(outputs) & set(full.columns):
        assert np.array_equal(made.columns[name], full.columns[name])


def test_lost_is_a_result_and_silence():
    made = run_manipulation(DESIGN, scene(grasp={"min_margin": 0.8, "max_margin": 0.8}), None, 1)
    assert made.lost_s < made.plan.let_go_s + 0.5
    after = made.time_s > made.lost_s + 0.001
    assert not made.signals["force_n"][:, after].any()
    assert not made.signals["slip"][:, after].any()
    assert made.signals["object_m"][-1] == made.scene.object.length_m
    assert np.isfinite(made.signals["voltage_v"]).all()


def test_without_a_knock_nothing_slips():
    made = run_manipulation(DESIGN, scene(knock={"speed_m_s": 0.0}, outputs=["slip", "pin_n"]), None, 1)
    assert not made.signals["slip"].any()
    assert not made.signals["pin_n"].any()
    assert made.lost_s is None


@pytest.mark.parametrize("rate", [1000.0, 3000.0, 20_000.0])
def test_other_rates_give_the_same_motion(rate):
    tables = scene(grasp={"max_margin": 1.15, "min_margin": 1.15}, outputs=["voltage_v", "slip", "object_m"])
    usual = run_manipulation(DESIGN, tables, FixedGrip(), 1)
    other = run_manipulation(Design(detector={"sample_rate_hz": rate}), tables, FixedGrip(), 1)
    assert other.lost_s == pytest.approx(usual.lost_s, abs=0.003)
    onsets = [run.time_s[run.signals["slip"].any(axis=0)][0] for run in (usual, other)]
    assert onsets[1] == pytest.approx(onsets[0], abs=0.002)


def test_the_articles_twelve():
    found = list(manipulations())
    assert [(s.object.mass_kg, s.grasp.kind) for s, _ in found[::3]] == [
        (0.5, "power"), (0.255, "power"), (0.06, "pinch"), (0.02, "pinch"),
    ]  # fmt: skip
    assert [seed for _, seed in found] == list(range(12))
    assert {s.knock.speed_m_s for s, _ in found} == {0.08}
    assert {len(s.fingers) for s, _ in found} == {5, 2}


def test_the_seed_decides():
    tables = scene(grasp={"kind": "pinch", "after_s": 0.0}, object={"mass_kg": 0.2, "friction_spread": 0.05})
    one, again, other = (run_manipulation(DESIGN, tables, None, seed) for seed in (1, 1, 2))
    assert np.array_equal(one.signals["voltage_v"], again.signals["voltage_v"])
    assert one.force_n != other.force_n
    assert one.plan.friction.mu_s != other.plan.friction.mu_s


@pytest.mark.parametrize(
    ("tables", "field", "words"),
    [
        ({"object": {"mass_kg": 0.0}}, "object.mass_kg", "0.0 kg is too small; at least 0.005 kg"),
        ({"object": {"surface": "ice"}}, "object.surface", "'ice' is not known; choose 'smooth'"),
        ({"grasp": {"min_margin": 2.0}}, "grasp.min_margin", "2 is above grasp.max_margin; at most 1.2"),
        ({"knock": {"stroke_m": 0.002}}, "knock.stroke_m", "too short to stop from 0.08 m/s; at least 0.0032 m"),
        ({"hand": {"lag_s": 0.0}}, "hand.lag_s", "0.0 s is too small; at least 0.001 s"),
        ({"sensing": {"jitter_s": 1e-5}}, "sensing.jitter_s", "not modelled with the hand in the loop; set it to 0"),
        ({"outputs": ["shear_m"]}, "outputs", "'shear_m' is no output"),
        ({"knok": {}}, "knok", "there is no such parameter; did you mean knock?"),
    ],
    ids=str,
)
def test_what_cannot_be_is_refused(tables, field, words):
    with pytest.raises(TraceError) as caught:
        ManipulationFile(**tables)
    (issue,) = caught.value.issues
    assert issue.field == field
    assert words in issue.message


def test_a_hand_too_weak_is_refused_before_anything_runs():
    tables = scene(object={"mass_kg": 5.0}, hand={"max_force_n": 10.0})
    with pytest.raises(TraceError) as caught:
        run_manipulation(DESIGN, tables, None, -1)
    assert [issue.field for issue in caught.value.issues] == ["--seed", "hand.max_force_n"]
    assert "10 N is less than the thumb needs for 5 kg; at least 42." in str(caught.value)


def test_the_command(tmp_path):
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
    assert found.returncode == 0, found.stderr  # the thumb's, as the article looks at


def test_the_command_closes_the_loop(tmp_path):
    """What is lost with nobody to answer is held with a detector in the loop."""
    file = ROOT / "params/scenes/real_manipulation.toml"
    pinch = ["--set", "object.mass_kg=0.06", "--set", "grasp.kind=pinch", "--set", "grasp.after_s=1", "--seed", "3"]
    arguments = ["simulate", file, "--design", ROOT / "params/fsr402.toml", *pinch, "--json", "-q"]
    told = {}
    for grip in ([], ["--grip", "fast"], ["--grip", "analog"]):
        done = run_fingertip(*arguments, *grip, "--out", tmp_path / "a.csv")
        assert done.returncode == 0, done.stderr
        told[tuple(grip)] = json.loads(done.stdout)
    assert not told[()]["held"]
    for grip in (("--grip", "fast"), ("--grip", "analog")):
        assert told[grip]["held"]
        (first, *_) = told[grip]["grips_s"]
        assert 2.9 < first < 3.0  # the knock comes at 2.9 s
    assert "envelope_v" in told["--grip", "analog"]["columns"]
    refused = run_fingertip("simulate", "--grip", "fats", "--out", tmp_path / "b.csv")
    assert refused.returncode == 2
    assert "closes the loop of a hand" in refused.stderr
    assert "did you mean fast?" in refused.stderr
    assert not (tmp_path / "b.csv").exists()
