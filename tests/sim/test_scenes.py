"""Scene files: the bundled ones, what they make of a finger, what is refused, and the command."""

from __future__ import annotations

import json
import tomllib

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.errors import TraceError
from fingertip.sim import ManipulationFile, SceneFile, Trial, run_scene, simulate
from fingertip.sim.electronics.analog import respond
from fingertip.sim.electronics.circuit import Analog
from fingertip.sim.kinds import kind_of, split
from fingertip.sim.stages.context import Context
from fingertip.slip import detect
from tests.conftest import ROOT, run_fingertip

DESIGN = Design()
ALL = sorted((ROOT / "params" / "scenes").glob("*.toml"))
SCENES = [path for path in ALL if path.stem != "real_manipulation"]  # a hand's: test_manipulation.py
NOT_SLIP = {"contact", "release", "load_change", "hard_tap", "motor_vibration", "drift", "cable_touch"}


def scene(name: str, **changes) -> SceneFile:
    return SceneFile.load(ROOT / "params" / "scenes" / f"{name}.toml", changes=[f"{k}={v}" for k, v in changes.items()])


def held(found, tables: SceneFile, seed: int = 0) -> float:
    return Context(DESIGN, tables, seed).timeline.held_s


def test_the_bundled_scenes_are_all_there():
    assert {path.stem for path in ALL} == NOT_SLIP | {"sliding_finger", "sliding_surface", "real_manipulation"}


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_bundled_scenes(path):
    tables = SceneFile.load(path)
    assert tables.scene == path.stem
    found = run_scene(DESIGN, tables, 1)
    assert found.columns["slip"].any() == (path.stem not in NOT_SLIP)
    assert all(np.isfinite(values).all() for values in found.columns.values())
    assert found.columns["force_n"].max() > 0.3
    detect(found.trace, DESIGN)  # a trace that the detector takes
    for line in path.read_text().splitlines():  # a heading, and only names that change something
        assert "TODO" not in line
    raw = tomllib.loads(path.read_text())
    assert raw != {}


def test_the_sliding_finger_is_the_trial():
    tables = scene("sliding_finger")
    found, trial = run_scene(DESIGN, tables, 7), simulate(DESIGN, Trial(seed=7))
    assert np.array_equal(found.columns["voltage_v"], trial.voltage_v)
    assert np.array_equal(found.columns["slip"], trial.slip)


def test_the_designs_own_bridge_gives_the_articles_voltages_nearly():
    voltages = {}
    for bridge in ("board", "article"):
        tables = SceneFile(hold={"min_force_n": 0.8, "max_force_n": 0.8, "release": False}, sensing={"bridge": bridge})
        voltages[bridge] = run_scene(DESIGN, tables).columns["voltage_v"][-200:].mean()
    assert voltages["article"] == pytest.approx(4.0, abs=1e-3)
    assert voltages["board"] == pytest.approx(4.0, abs=0.02)
    other = run_scene(Design(board={"series": "E12"}), tables.model_copy(update={"sensing": scene("contact").sensing}))
    assert abs(other.columns["voltage_v"][-200:].mean() - voltages["board"]) > 1e-3  # other parts, other voltage


def test_a_grasp_may_hold_more_than_a_finger_slides_with():
    tables = scene("sliding_surface")
    forces = [run_scene(DESIGN, tables.model_copy(update={"outputs": ["force_n"]}), seed).force_n for seed in range(40)]
    assert 0.5 <= min(forces) < 0.8
    assert 3.0 < max(forces) <= 3.5
    finger = SceneFile(hold={"mode": "grasp", "share": 0.5, "min_force_n": 2.0, "max_force_n": 2.0})
    assert run_scene(DESIGN, finger).force_n == 1.0


@pytest.mark.parametrize("rise", [0.002, 0.010])
def test_taps_come_when_and_as_hard_as_they_are_asked_for(rise):
    tables = scene("hard_tap", **{"tap.rise_s": rise, "tap.force_n": 3.0, "hold.min_force_n": 2.0})
    found = run_scene(DESIGN, tables)
    time, force, start = found.time_s, found.columns["force_n"], held(found, tables)
    for i in range(3):
        tap = (time > start + 1 + 0.5 * i) & (time < start + 1.05 + 0.5 * i)
        before = (time > start + 0.9 + 0.5 * i) & (time < start + 1 + 0.5 * i)
        # 3 N through a resonance at some 100 Hz: a short tap loses, a long one gains a little.
        assert (0.5 if rise < 0.005 else 0.9) * 3 < force[tap].max() - force[before].mean() < 1.3 * 3


def test_motors_shake_at_their_frequency():
    tables = scene("motor_vibration", **{"motor.force_n": 0.1, "motor.harmonic": 0.0})
    found = run_scene(DESIGN, tables)
    start = held(found, tables)
    during = (found.time_s > start + 1.1) & (found.time_s < start + 2.1)
    force = found.columns["force_n"][during]
    spectrum = np.abs(np.fft.rfft((force - force.mean()) * np.hanning(len(force))))
    assert np.fft.rfftfreq(len(force), 1 / 2000)[spectrum.argmax()] == pytest.approx(45.0, abs=1.0)
    assert np.ptp(force) / 2 == pytest.approx(0.1 / (1 - (45 / 95) ** 2), rel=0.15)


def test_load_changes_by_as_much_as_asked():
    tables = scene("load_change", **{"hold.min_force_n": 1.0, "hold.max_force_n": 1.0})
    found = run_scene(DESIGN, tables)
    start = held(found, tables)
    for moment, force in ((start + 0.9, 1.0), (start + 1.6, 2.0)):
        assert found.columns["force_n"][found.time_s > moment][0] == pytest.approx(force, rel=0.01)
    assert found.columns["force_n"][-1] == 0.0


def test_a_touched_cable_changes_the_voltage_and_not_the_force():
    tables, plain = scene("cable_touch"), scene("cable_touch", **{"cable.step_v": 0.0, "cable.hum_v": 0.0})
    touched, calm = run_scene(DESIGN, tables), run_scene(DESIGN, plain.model_copy(update={"cable": tables.cable}))
    assert np.array_equal(touched.columns["force_n"], calm.columns["force_n"])
    start = held(touched, tables)
    before = (touched.time_s > start + 0.9) & (touched.time_s < start + 1)
    first = np.flatnonzero(touched.time_s >= start + 1)[0]
    assert touched.columns["voltage_v"][first] - touched.columns["voltage_v"][before].mean() < 0.01
    risen = first + 6  # through the poles ahead of the converter
    jump = touched.columns["voltage_v"][risen] - touched.columns["voltage_v"][before].mean()
    assert jump == pytest.approx(0.02, abs=0.004)


def test_jitter_shows_where_the_voltage_moves():
    steady = {"hold.min_force_n": 1.0, "hold.max_force_n": 1.0}
    runs = [
        run_scene(Design(detector={"noise_v": 0.0}), scene("load_change", **steady | {"sensing.jitter_s": jitter}))
        for jitter in (0.0, 1e-5)
    ]
    start = held(runs[0], scene("load_change"))
    calm, jittered = (run.columns["voltage_v"] for run in runs)
    time, off = runs[0].time_s, np.abs(jittered - calm)
    slope = np.abs(np.gradient(calm, time))
    changing = (time > start + 1.02) & (time < start + 1.13)
    # Gaussian: mean |x| is 0.8 of the deviation; a converter's step of 305 uV blurs it.
    assert off[changing].mean() == pytest.approx(0.8e-5 * slope[changing].mean(), rel=0.5)
    assert off[(time > start + 0.5) & (time < start + 0.9)].max() <= 20 / 65536 + 1e-12


def test_a_long_scene_reports_its_progress():
    said: list[str] = []
    run_scene(DESIGN, scene("contact"), 0, said.append)
    assert said == []
    run_scene(DESIGN, SceneFile(scene="long", hold={"min_s": 20.0}, outputs=["force_n"]), 0, said.append)
    assert said[0].startswith("long, 2")
    assert said[1:] == ["load", "contact", "force"]


def test_parameters_are_listed_with_unit_and_bounds():
    file = ROOT / "params/scenes/hard_tap.toml"
    done = run_fingertip("simulate", file, "--parameters", "--set", "tap.count=7")
    assert done.returncode == 0, done.stderr
    line = next(line for line in done.stdout.splitlines() if line.startswith("tap.force_n"))
    assert line.split()[1:3] == ["2.0", "N"]
    assert ">= 0, <= 50" in line
    rows = json.loads(run_fingertip("simulate", file, "--parameters", "--json").stdout)["parameters"]
    names = {row["name"] for row in rows}
    assert {name.split(".")[0] for name in names} == set(SceneFile.model_fields)
    assert all(row["description"] for row in rows)
    assert all(row["unit"] for row in rows if row["name"].endswith(("_s", "_n", "_hz", "_m", "_v")))


def test_creep_is_a_share_for_each_decade():
    steady = {"hold.min_force_n": 1.0, "hold.max_force_n": 1.0, "drift.volt_per_s": 0.0}
    creeping = run_scene(DESIGN, scene("drift", **steady)).columns["voltage_v"]
    still = run_scene(DESIGN, scene("drift", **steady | {"drift.share_per_decade": 0.0})).columns["voltage_v"]
    moment = 15 * 2000
    assert still[moment : moment + 400].mean() > creeping[moment : moment + 400].mean() + 1e-3
    assert np.abs(still[:400] - creeping[:400]).max() < 1e-9


def test_embedded_and_bare_spectra_are_the_articles():
    """Figure 2: embedded rarely above 100 Hz, bare past 200 Hz."""
    above = {}
    for resonance in (90.0, 230.0):
        tables = scene("sliding_finger", **{
            "contact.resonance_hz": resonance, "slide.speed_m_s": 0.08, "hold.min_force_n": 1.0,
            "hold.max_force_n": 1.0, "contact.surface": '"gross"',
        })  # fmt: skip
        found = run_scene(DESIGN, tables, 2)
        force = found.columns["force_n"][found.columns["slip"]][100:900]
        power = np.abs(np.fft.rfft((force - force.mean()) * np.hanning(len(force)))) ** 2
        frequency = np.fft.rfftfreq(len(force), 1 / 2000)
        above[resonance] = [power[frequency > f].sum() / power.sum() for f in (100, 200)]
    assert above[90.0][0] < 0.25
    assert above[230.0][1] > 0.05
    assert above[230.0][0] > 2 * above[90.0][0]


def test_vibration_that_acts_back_changes_little_and_elasto_plastic_bristles_hold():
    base = {"hold.min_force_n": 1.0, "hold.max_force_n": 1.0, "slide.speed_m_s": 0.08}
    runs = {}
    for name, more in {
        "plain": {},
        "elasto": {"contact.bristles": '"elasto_plastic"'},
        "feedback": {"contact.feedback": "true"},
    }.items():
        found = run_scene(DESIGN, scene("sliding_finger", **base | more), 2)
        runs[name] = found.time_s[found.columns["slip"]][0], found.columns["slip"].sum() / 2000
    for name in ("elasto", "feedback"):
        assert runs[name][0] == pytest.approx(runs["plain"][0], abs=0.006)
        assert runs[name][1] == pytest.approx(runs["plain"][1], abs=0.03)
    assert len({onset for onset, _ in runs.values()}) > 1


@pytest.mark.parametrize(
    ("tables", "field", "words"),
    [
        ({"contact": {"surface": "woood"}}, "contact.surface", "'woood' is not known; choose 'smooth'"),
        ({"tap": {"forc_n": 1.0}}, "tap.forc_n", "did you mean force_n?"),
        ({"slid": {}}, "slid", "did you mean slide?"),
        ({"slide": {"distance_m": 0.5}}, "slide.distance_m", "longer than contact.length_m; at most 0.1 m"),
        ({"slide": {"speed_m_s": 0.0}}, "slide.speed_m_s", "0.0 m/s is too small; at least 0.005 m/s"),
        ({"hold": {"min_force_n": 3.0}}, "hold.min_force_n", "at most 2 N"),
        ({"outputs": ["volt_v"]}, "outputs", "did you mean voltage_v?"),
        ({"outputs": []}, "outputs", "name at least one of voltage_v"),
        ({"outputs": ["slip", "slip"]}, "outputs", "named 2 times"),
        ({"load_change": {"by_n": -0.5}}, "load_change.by_n", "ends the contact; above -0.2 N"),
        (
            {"tap": {"force_n": 1.0, "count": 2, "interval_s": 0.01, "rise_s": 0.01}},
            "tap.interval_s",
            "at least 0.02 s",
        ),
        ({"hold": {"wait_s": float("nan")}}, "hold.wait_s", "nan is not a finite number"),
    ],
    ids=str,
)
def test_what_cannot_be_is_refused(tables, field, words):
    with pytest.raises(TraceError) as caught:
        SceneFile(**tables)
    (issue,) = caught.value.issues
    assert issue.field == field
    assert words in issue.message


def test_all_faults_at_once():
    with pytest.raises(TraceError) as caught:
        SceneFile(tap={"forc_n": 1.0}, slide={"distance_m": 0.5, "speed_m_s": 9.0}, outputs=["volts"])
    fields = [issue.field for issue in caught.value.issues]
    assert fields == ["slide.speed_m_s", "tap.forc_n", "outputs", "slide.distance_m"]


def test_files_are_told_apart_by_their_tables(tmp_path):
    for text, kind in (
        ('scene = "x"', SceneFile), ("[skin]", Design), ("", Design), ("[slide]", SceneFile),
        ("[grasp]", ManipulationFile), ("[sensing]\n[grasp]", ManipulationFile), ("[sensing]", SceneFile),
    ):  # fmt: skip
        (tmp_path / "a.toml").write_text(text)
        assert kind_of(tmp_path / "a.toml") == kind
    (tmp_path / "a.toml").write_text("[slide]\n[skin]")
    with pytest.raises(TraceError, match="holds slide of a scene and skin of a design; write them in two files"):
        kind_of(tmp_path / "a.toml")
    (tmp_path / "a.toml").write_text("[slide]\n[knock]")
    with pytest.raises(TraceError, match=r"holds knock of a manipulation and slide of a scene; .* one for each"):
        kind_of(tmp_path / "a.toml")
    changes = ["tap.force_n=1", "knock.at_s=1", "outputs=[]"]
    assert split(changes, SceneFile) == (["tap.force_n=1", "outputs=[]"], ["knock.at_s=1"])
    others = ["cable.hum_v=1", *changes[1:]]
    assert split(others, ManipulationFile) == (others[1:], others[:1])
    assert split(changes, Design) == (changes, [])
    assert split(["tap.force_n=1", "skin.width_mm=18"]) == (["tap.force_n=1"], ["skin.width_mm=18"])
    assert split(["tp.force_n=1", "skn.width_mm=18", "x=1"]) == (["tp.force_n=1"], ["skn.width_mm=18", "x=1"])


def test_a_jump_of_the_cable_is_a_jump_to_the_board():
    """Not a ramp of one sample: what comes out is what the board makes of the cable's jump alone."""
    wanted = {"outputs": '["tactile_v","filtered_v"]', "cable.hum_v": 0.0}
    touched = scene("cable_touch", **wanted, **{"cable.decay_s": 10.0, "sensing.noise": "false"})
    found = run_scene(DESIGN, touched)
    jump = np.flatnonzero(found.time_s >= held(found, touched) + touched.cable.at_s)[0]
    before = found.columns["tactile_v"][jump - 1]
    straight = respond(Analog.of(DESIGN), 1 / 2000, found.columns["tactile_v"], 1e-6).filtered_v
    at_once = found.columns["tactile_v"].copy()
    at_once[jump] = before
    right = respond(Analog.of(DESIGN), 1 / 2000, at_once, 1e-6, after_v=found.columns["tactile_v"]).filtered_v
    near = slice(jump, jump + 40)
    assert found.columns["filtered_v"][near] == pytest.approx(right[near], abs=2e-3)
    assert np.abs(straight[near] - right[near]).max() > 0.1


def test_amplifiers_are_as_real_as_asked_for():
    outs = {}
    for kind in ("ideal", "rails", "gain_bandwidth"):
        tables = scene(
            "hard_tap", **{"tap.force_n": 20.0, "outputs": '["filtered_v"]', "sensing.amplifiers": f'"{kind}"'}
        )
        outs[kind] = run_scene(DESIGN, tables).columns["filtered_v"]
    assert np.abs(outs["rails"]).max() == 3.5 < np.abs(outs["ideal"]).max()
    difference = np.abs(outs["gain_bandwidth"] - outs["ideal"]).max() / np.abs(outs["ideal"]).max()
    assert 1e-5 < difference < 0.05


def test_the_command_takes_scenes(tmp_path):
    arguments = ["simulate", ROOT / "params/scenes/hard_tap.toml", "--design", ROOT / "params/fsr400.toml", "--json"]
    more = ["--set", "tap.count=1", "--set", "detector.noise_v=0.0", "--seed", "3", "-q", "--force-n", "1.5"]
    done = run_fingertip(*arguments, *more, "--out", tmp_path / "a.csv")
    assert done.returncode == 0, done.stderr
    data = json.loads(done.stdout)
    assert data["scene"] == "hard_tap"
    assert data["force_n"] == 1.5
    assert [stage["name"] for stage in data["stages"]][:2] == ["load", "shaking"]
    again = run_fingertip(*arguments, *more, "--out", tmp_path / "b.csv")
    assert again.returncode == 0
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()
    outputs = ["--set", 'outputs=["voltage_v","envelope_v","slip"]']
    for name in ("a.npz", "b.npz", "c.csv"):
        assert run_fingertip(*arguments, *more, *outputs, "--out", tmp_path / name).returncode == 0
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()
    archive = np.load(tmp_path / "a.npz")
    table = np.loadtxt(tmp_path / "c.csv", delimiter=",", skiprows=1)
    assert (tmp_path / "c.csv").read_text().splitlines()[0] == "time_s,voltage_v,envelope_v,slip"
    for i, name in enumerate(("time_s", "voltage_v", "envelope_v", "slip")):
        assert np.array_equal(archive[name].astype(float), table[:, i]), name
    assert archive["envelope_v"].max() > 0.1


def test_the_command_refuses_everything_at_once(tmp_path):
    scene_file, design_file = ROOT / "params/scenes/contact.toml", ROOT / "params/fsr400.toml"
    done = run_fingertip(
        "simulate", scene_file, "--design", design_file, "--set", "tap.rise_s=9", "--set", "skin.width_mm=1",
        "--seed", "-1", "--out", tmp_path / "a.xyz",
    )  # fmt: skip
    assert done.returncode == 2
    for words in ("'a.xyz' is no kind of trace file", "tap.rise_s: 9", "skin.width_mm: 1", "--seed: -1"):
        assert words in done.stderr
    done = run_fingertip("simulate", design_file, "--set", "tap.force_n=1", "--out", tmp_path / "a.csv")
    assert done.returncode == 2
    assert "changes a scene; give a scene file" in done.stderr
    assert not list(tmp_path.iterdir())
    done = run_fingertip("simulate", design_file, "--design", design_file, "--out", tmp_path / "a.csv")
    assert "is no scene; leave --design out" in done.stderr
    done = run_fingertip("simulate", design_file, "--out", tmp_path / "a.csv", "--plot", tmp_path / "a.csv")
    assert "is the trace's own name; choose another" in done.stderr
