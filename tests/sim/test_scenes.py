"""Scenes and trials: the bundled ones, the effect of each event,
and how the command line loads them.
"""

from __future__ import annotations

import json
import re

import numpy as np
import pytest

from fingertip.catalogues.file_kinds import SCENE, list_bundled_files
from fingertip.design import Design
from fingertip.foundation.errors import TraceError
from fingertip.foundation.jit import compiled
from fingertip.pad.response import Pad
from fingertip.sim.runs.scene import SceneRun, run_scene
from fingertip.sim.runs.scene_and_manipulation_files import SceneFile
from fingertip.sim.signal.analog_circuit import AnalogBoard
from fingertip.sim.signal.bridge import Bridge
from fingertip.sim.signal.filter_board import simulate_board
from fingertip.sim.signal.grid import STAGES, CostMeter, Grid, StageCost
from fingertip.sim.simulation import Trial, load_simulation, simulate
from fingertip.sim.simulation_summary import find_warnings
from fingertip.slip.scored_detection import detect
from tests.conftest import ROOT, design_file, run_fingertip
from tests.designs import ARTICLE, article_design

DESIGN = ARTICLE

SCENES = [*list_bundled_files(SCENE).values()]

NOT_SLIP = {
    "contact",
    "release",
    "load_change",
    "hard_tap",
    "motor_vibration",
    "drift",
    "cable_touch",
    "tremor",
    "servo_steps",
    "set_down",
    "walking",
    "edge_contact",
}


def load_scene(name: str, **changes) -> SceneFile:
    return SceneFile.load(
        ROOT / "params" / "scenes" / f"{name}.toml",
        changes=[f"{k}={v}" for k, v in changes.items()],
    )


def held_s(scene: SceneFile, seed: int = 0) -> float:
    return SceneRun(DESIGN, scene, seed).timeline.held_s


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_bundled_scene_runs_and_slips_if_named_so(path):
    scene = SceneFile.load(path)
    assert scene.scene == scene.name == path.stem
    result = run_scene(DESIGN, scene, 1)
    assert result.columns["slip"].any() == (path.stem not in NOT_SLIP)
    assert all(np.isfinite(values).all() for values in result.columns.values())
    assert result.columns["force_n"].max() > 0.3
    detect(result.trace, DESIGN)  # the detector accepts the trace


@pytest.mark.parametrize("bridge", ["board", "article"])
def test_slide_begins_one_second_after_the_voltage_has_dropped(bridge):
    scene = load_scene(
        "sliding_surface", **{"sensing.noise": "false", "sensing.bridge": f'"{bridge}"'}
    )
    run = run_scene(DESIGN, scene.model_copy(update={"outputs": ["tactile_v"]}), 3)
    volts = run.columns["tactile_v"]
    assert run.motion_s - 1.0 == pytest.approx(
        run.time_s[np.flatnonzero(volts[0] - volts >= 0.01)[0]], abs=2e-3
    )
    late = scene.model_copy(update={"hold": scene.hold.model_copy(update={"trigger_v": 1.0})})
    assert SceneRun(DESIGN, late, 3).timeline.slide.start_s == pytest.approx(held_s(late, 3) + 1.0)


def test_bridge_of_the_design_gives_nearly_the_voltages_of_the_article():
    voltages = {}
    for bridge in ("board", "article"):
        scene = SceneFile(
            hold={"min_force_n": 0.8, "max_force_n": 0.8, "release": False},
            sensing={"bridge": bridge},
        )
        voltages[bridge] = run_scene(DESIGN, scene).columns["voltage_v"][-200:].mean()
    # The pose of its curve has the share of 1 N.
    assert voltages["article"] == pytest.approx(4.0, abs=0.01)
    sensed_n = Pad.from_design(DESIGN).sensed_n(np.array([0.8]))
    board = Bridge.of_board(DESIGN)
    assert voltages["board"] == pytest.approx(board.voltage_v(sensed_n)[0], abs=1e-3)
    # A bare sensor.
    assert board.voltage_v(np.array([0.8]))[0] == pytest.approx(4.0, abs=0.02)
    other = run_scene(
        article_design(board={"series": "E12"}),
        scene.model_copy(update={"sensing": load_scene("contact").sensing}),
    )
    # Other components, other voltage.
    assert abs(other.columns["voltage_v"][-200:].mean() - voltages["board"]) > 1e-3


@pytest.mark.parametrize("rise", [0.002, 0.010])
def test_taps_have_the_given_times_and_force(rise):
    scene = load_scene(
        "hard_tap", **{"tap.rise_s": rise, "tap.force_n": 3.0, "hold.min_force_n": 2.0}
    )
    result = run_scene(DESIGN, scene)
    time = result.time_s
    force = result.columns["force_n"]
    start = held_s(scene)
    for i in range(3):
        tap = (time > start + 1 + 0.5 * i) & (time < start + 1.05 + 0.5 * i)
        before = (time > start + 0.9 + 0.5 * i) & (time < start + 1 + 0.5 * i)
        # The resonance near 100 Hz attenuates short taps and slightly amplifies long ones.
        assert (
            (0.5 if rise < 0.005 else 0.9) * 3 < force[tap].max() - force[before].mean() < 1.3 * 3
        )


def test_motor_vibration_has_its_frequency_and_amplitude():
    scene = load_scene("motor_vibration", **{"motor.force_n": 0.1, "motor.harmonic": 0.0})
    result = run_scene(DESIGN, scene)
    start = held_s(scene)
    during = (result.time_s > start + 1.1) & (result.time_s < start + 2.1)
    force = result.columns["force_n"][during]
    spectrum = np.abs(np.fft.rfft((force - force.mean()) * np.hanning(len(force))))
    assert np.fft.rfftfreq(len(force), 1 / 2000)[spectrum.argmax()] == pytest.approx(45.0, abs=1.0)
    assert np.ptp(force) / 2 == pytest.approx(0.1 / (1 - (45 / 95) ** 2), rel=0.15)


def test_load_changes_by_the_given_force():
    scene = load_scene("load_change", **{"hold.min_force_n": 1.0, "hold.max_force_n": 1.0})
    result = run_scene(DESIGN, scene)
    start = held_s(scene)
    for moment, force in ((start + 0.9, 1.0), (start + 1.6, 2.0)):
        assert result.columns["force_n"][result.time_s > moment][0] == pytest.approx(
            force, rel=0.01
        )
    assert result.columns["force_n"][-1] == 0.0


def test_jitter_error_is_proportional_to_the_slope():
    steady = {"hold.min_force_n": 1.0, "hold.max_force_n": 1.0}
    runs = [
        run_scene(
            article_design(detector={"noise_v": 0.0}),
            load_scene("load_change", **steady | {"sensing.jitter_s": jitter}),
        )
        for jitter in (0.0, 1e-5)
    ]
    start = held_s(load_scene("load_change"))
    untouched, jittered = (run.columns["voltage_v"] for run in runs)
    time = runs[0].time_s
    off = np.abs(jittered - untouched)
    slope = np.abs(np.gradient(untouched, time))
    changing = (time > start + 1.02) & (time < start + 1.13)
    # The mean of |x| of a Gaussian is 0.8 of its standard deviation. The ADC's step of 305 uV adds
    # an error.
    assert off[changing].mean() == pytest.approx(0.8e-5 * slope[changing].mean(), rel=0.5)
    assert off[(time > start + 0.5) & (time < start + 0.9)].max() <= 20 / 65536 + 1e-12


def test_only_long_scenes_report_progress(monkeypatch):
    monkeypatch.setattr("fingertip.foundation.progress.EVERY_S", 0.0)
    messages: list[str] = []
    run_scene(DESIGN, load_scene("contact"), 0, messages.append)
    assert messages == []
    run_scene(
        DESIGN,
        SceneFile(scene="long", hold={"min_s": 20.0}, outputs=["force_n"]),
        0,
        messages.append,
    )
    assert all(
        re.fullmatch(r"simulating 2.* s of long: \d+ % done(, \d+ s left)?", line)
        for line in messages
    )
    shares = [message.share for message in messages]
    assert len(shares) > 3
    assert shares == sorted(shares)
    assert shares[-1] == 1.0


def test_parameters_are_listed_with_their_values_units_and_descriptions():
    rows = json.loads(run_fingertip("simulate", "hard_tap", "--parameters", "--json").stdout)[
        "parameters"
    ]
    named = {row["name"]: row["value"] for row in rows}
    assert (named["mount.mass_kg"], named["surface.roughness_um"]) == (0.035, 0.8)
    names = {row["name"] for row in rows}
    assert {name.split(".")[0] for name in names} == set(SceneFile.model_fields)
    assert all(row["description"] for row in rows)
    bounds = {row["name"]: row["bounds"] for row in rows}
    assert (
        bounds.items()
        >= {
            "hold.min_force_n": ">= 0.001, <= 4",
            "contact.length_m": "> 0, <= 1",
            "scene": "",
            "surface.load_law": "named | hertz | proportional",
        }.items()
    )
    assert all(row["unit"] for row in rows if row["name"].endswith(("_s", "_n", "_hz", "_m", "_v")))


def test_jump_of_the_cable_is_a_jump_for_the_board():
    """The board does not see a ramp over one sample."""
    outputs = {"outputs": '["tactile_v","filtered_v"]', "cable.hum_v": 0.0}
    touched = load_scene(
        "cable_touch", **outputs, **{"cable.decay_s": 10.0, "sensing.noise": "false"}
    )
    result = run_scene(DESIGN, touched)
    jump = np.flatnonzero(result.time_s >= held_s(touched) + touched.cable.at_s)[0]
    before = result.columns["tactile_v"][jump - 1]
    board = AnalogBoard.from_design(DESIGN)
    straight = simulate_board(board, 1 / 2000, result.columns["tactile_v"], 1e-6).filtered_v
    at_once = result.columns["tactile_v"].copy()
    at_once[jump] = before
    right = simulate_board(
        board, 1 / 2000, at_once, 1e-6, after_v=result.columns["tactile_v"]
    ).filtered_v
    near = slice(jump, jump + 40)
    assert result.columns["filtered_v"][near] == pytest.approx(right[near], abs=2e-3)
    assert np.abs(straight[near] - right[near]).max() > 0.1


@pytest.mark.full
def test_a_board_that_clips_says_so():
    shown = {}
    for kind, felt_um in (("ideal", 8.0), ("real", 8.0), ("real", 0.8)):
        changes = {
            "outputs": '["filtered_v", "slip"]',
            "surface.felt_um": felt_um,
            "slide.distance_m": 0.01,
            "sensing.amplifiers": f'"{kind}"',
        }
        result = run_scene(DESIGN, load_scene("sliding_finger", **changes))
        shown[kind, felt_um] = (
            result.columns["filtered_v"].max(),
            [*find_warnings(result)],
            result.clip_share,
        )
    assert shown["real", 8.0][0] == 3.5 < shown["ideal", 8.0][0]
    assert (
        f"the board clips in {shown['real', 8.0][2]:.0%} of the slide" in shown["real", 8.0][1][-1]
    )
    assert shown["real", 0.8][1:] == ([], 0.0)


def test_nothing_given_means_default_design_and_trial():
    simulation = load_simulation()
    assert (simulation.design, simulation.scene, simulation.seed) == (Design(), Trial().scene, 0)
    assert simulation.scene == load_scene("sliding_finger")


def test_changes_go_to_the_file_that_has_the_parameter():
    simulation = load_simulation(
        "hard_tap",
        design_file("fsr400"),
        changes=["tap.count=1", "detector.noise_v=0.0"],
        force_n=1.5,
    )
    assert isinstance(simulation.scene, SceneFile)
    assert simulation.scene.tap.count == 1
    assert simulation.scene.hold.min_force_n == simulation.scene.hold.max_force_n == 1.5
    assert simulation.design.detector.noise_v == 0.0
    result = simulation.run()
    expected = run_scene(simulation.design, simulation.scene)
    assert np.array_equal(result.columns["force_n"], expected.columns["force_n"])


@pytest.mark.parametrize(
    ("changes", "warning"),
    [
        (["converter.bits=12"], None),
        (["converter.bits=12", "converter.high_v=3.3"], "to 3.3 V clips what lies outside"),
        (["converter.bits=12", "converter.high_v=1.2"], "to 1.2 V clips all of it"),
        (["detector.adc_range_v=4.0"], "is clipped"),
    ],
)
def test_converter_that_clips_the_voltage_is_reported(changes, warning):
    found = [*load_simulation("sliding_finger", "article", changes=changes).find_warnings()]
    assert len(found) == (warning is not None)
    assert warning is None or warning in found[0]


def test_range_up_to_the_named_voltage_does_not_clip():
    simulation = load_simulation(
        "sliding_finger", "article", changes=["converter.bits=12", "converter.high_v=3.3"]
    )
    (warning,) = simulation.find_warnings()
    named = re.search(r"converter\.high_v=([0-9.]+)\.$", warning).group(1)
    wide = load_simulation(
        "sliding_finger", "article", changes=["converter.bits=12", f"converter.high_v={named}"]
    )
    assert not [*wide.find_warnings()]
    volts = wide.run().columns["voltage_v"]
    assert volts.max() < float(named) - 5 / 2**12


def test_trial_has_the_rate_voltage_and_force_of_the_article():
    gross = simulate(ARTICLE, Trial("gross", 0.04, 1.0, 3))
    assert (gross.time_s[1] - gross.time_s[0]) == 0.0005
    assert gross.voltage_v[:200].mean() == pytest.approx(
        Bridge.of_board(ARTICLE).voltage_v(np.zeros(1))[0], abs=1e-3
    )
    holding = (gross.time_s > 1.4) & (gross.time_s < 1.8)
    assert gross.force_n[holding].mean() == pytest.approx(1.0, rel=1e-3)
    assert gross.force_n.min() == 0.0
    assert not gross.force_n[-2000:].any()
    assert not gross.force_n[:700].any()
    begins = gross.time_s[gross.slip][0]
    command = 1.0 + np.flatnonzero(gross.force_n > 0.99)[0] / 2000  # one second after the touch
    assert command < begins < command + 0.1
    assert gross.slip.sum() / 2000 == pytest.approx(1.0, abs=0.06)


def test_slide_shorter_than_the_shear_of_the_pad_is_no_gross_slip():
    slides = {}
    for distance, speed in ((5e-5, 0.007), (5e-3, 0.04)):
        scene = SceneFile(
            contact={"surface": "gross"},
            hold={"min_force_n": 2.0, "max_force_n": 2.0},
            slide={"distance_m": distance, "speed_m_s": speed},
        )
        slides[distance] = run_scene(ARTICLE, scene, 3).trace.slip.any()
    assert slides == {5e-5: False, 5e-3: True}


def test_drawn_force_lies_in_the_range_of_the_article():
    forces = [SceneRun(ARTICLE, Trial(seed=seed).scene, seed).force_n for seed in range(200)]
    assert 0.2 <= min(forces) < 0.25
    assert 1.95 < max(forces) <= 2.0


@pytest.mark.parametrize(
    ("slide", "length_m"),
    [
        ({"distance_m": 1e-5}, 0.1),
        ({"distance_m": 1e-5, "speed_m_s": 0.2, "moves": 50, "acceleration_m_s2": 0.05}, 1e-6),
        ({"distance_m": 0.0123456789}, 1e-5),
    ],
)
def test_a_slide_that_is_refused_passes_with_the_values_of_the_message(slide, length_m):
    tables = {"slide": slide, "contact": {"length_m": length_m}}
    with pytest.raises(TraceError) as refused:
        SceneFile(**tables)
    for issue in refused.value.issues:
        for table, name, value in re.findall(
            r"(\w+)\.(\w+)=([\d.e-]*\d)", issue.message.partition(", or")[0]
        ):
            tables[table] = tables[table] | {name: float(value)}
    SceneFile(**tables)


@pytest.mark.full
def test_a_light_pad_gets_a_grid_that_holds_its_error():
    tables = {"mount.mass_kg": 1e-4, "mount.stiffness_n_per_m": 90.0, "outputs": ["force_n"]}
    scene = load_scene("sliding_finger", **tables)
    assert SceneRun(DESIGN, load_scene("sliding_finger")).grid == Grid()
    chosen = SceneRun(DESIGN, scene).grid
    assert chosen.refinement == 4
    with compiled():
        exact, found, coarse = (
            run_scene(DESIGN, scene, grid=grid).columns["force_n"]
            for grid in (Grid(64), None, Grid())
        )
    assert np.abs(found - exact).max() < 2e-5 < np.abs(coarse - exact).max()


def test_costs_of_a_stage_add_up():
    meter = CostMeter(iter((0.0, 1.0, 5.0, 7.0)).__next__)
    for evaluations in (3, 4):
        with meter.stage(STAGES[1], 2, evaluations):
            pass
    assert meter.costs == (StageCost(STAGES[1], 2, 7, 3.0),)
