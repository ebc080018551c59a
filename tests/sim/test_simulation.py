"""Trials of the article, simulations as the command line loads them, and the stages that they need."""

from __future__ import annotations

import re
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.foundation.errors import FingertipError, TraceError
from fingertip.sim import (
    ManipulationFile,
    SceneFile,
    Trial,
    load_simulation,
    run_manipulation,
    run_scene,
    simulate,
)
from fingertip.sim import report as summary
from fingertip.sim.runs.scene import SceneRecord, SceneRun
from fingertip.sim.signal.converter import compute_bridge_v
from fingertip.slip.traces.truth import SlipCollector, intervals
from tests.conftest import ROOT, design_file
from tests.designs import ARTICLE, article_design

SCENES = ROOT / "params" / "scenes"


def test_nothing_given_means_default_design_and_trial():
    simulation = load_simulation()
    assert (simulation.design, simulation.scene, simulation.seed) == (Design(), Trial().scene, 0)


def test_changes_go_to_the_file_that_has_the_parameter():
    simulation = load_simulation(
        str(SCENES / "hard_tap.toml"),
        design_file("fsr400"),
        changes=["tap.count=1", "detector.noise_v=0.0"],
        force_n=1.5,
    )
    assert isinstance(simulation.scene, SceneFile)
    assert simulation.scene.tap.count == 1
    assert simulation.scene.hold.min_force_n == simulation.scene.hold.max_force_n == 1.5
    assert simulation.design.detector.noise_v == 0.0
    result, expected = simulation.run(), run_scene(simulation.design, simulation.scene)
    assert np.array_equal(result.columns["force_n"], expected.columns["force_n"])


def test_all_issues_are_reported_at_once():
    with pytest.raises(FingertipError) as caught:
        load_simulation(SCENES / "contact.toml", changes=["tap.rise_s=9", "skin.width_mm=1"], speed_m_s=0.05, seed=-1)
    assert [issue.field for issue in caught.value.issues] == ["--seed", "skin.width_mm", "tap.rise_s"]
    with pytest.raises(FingertipError) as caught:
        load_simulation(design_file("fsr400"), design_file("fsr402"), changes=["tap.force_n=1"])
    assert [issue.field for issue in caught.value.issues] == ["--design", "--set tap.force_n=1"]


def test_summary_describes_the_surface_and_the_peak_speed_that_is_reached():
    def title(scene: str, **options: object) -> str:
        simulation = load_simulation(SCENES / scene, **options)
        return summary.as_text(simulation.run().record)[0]

    assert title("sliding_finger.toml", surface="smooth").startswith("smooth (metal, Ra 0.2 um), 0.04 m/s, ")
    assert title("sliding_finger.toml", surface="wood").startswith("wood, 0.04 m/s, ")


def test_slide_that_never_reaches_its_speed_is_refused_with_a_speed_that_passes():
    slow = ["slide.acceleration_m_s2=0.05"]
    message = r"slide\.speed_m_s: 0\.2 m/s is not reached within 0\.04 m at 0\.05 m/s2; at most 0\.0447 m/s\."
    with pytest.raises(FingertipError, match=message):
        load_simulation(SCENES / "sliding_finger.toml", speed_m_s=0.2, changes=slow)
    assert load_simulation(SCENES / "sliding_finger.toml", speed_m_s=0.0447, changes=slow)


def test_motor_faster_than_half_the_sampling_rate_is_refused():
    changes = ["motor.frequency_hz=500.0", "detector.sample_rate_hz=1000.0"]
    with pytest.raises(FingertipError, match=r"motor\.frequency_hz: 500 Hz is not below half of .*; below 500 Hz\."):
        load_simulation(SCENES / "motor_vibration.toml", changes=changes).run()
    assert load_simulation(SCENES / "motor_vibration.toml", changes=["motor.frequency_hz=499.0", *changes[1:]]).run()


def test_summary_merges_slips_as_detection_does():
    time = np.arange(2000) / 2000
    slip = ((time >= 0.1) & (time < 0.2)) | ((time >= 0.24) & (time < 0.3)) | ((time >= 0.5) & (time < 0.6))
    scene = SceneFile(scene="events", outputs=["slip"])
    collector = SlipCollector()
    for part in np.split(np.arange(len(time)), [150, 450, 451]):
        collector.add(time[part], slip[part])
    result = SceneRecord(scene, 0, 1.0, len(time), collector.close(), (), 2000.0)
    assert result.slips == intervals(time, slip)
    assert summary.as_text(result)[1:] == [
        "gross slip from 0.1000 s to 0.3000 s",
        "gross slip from 0.5000 s to 0.6000 s",
    ]
    assert len(summary.as_data(result)["slips"]) == 3


def test_summary_tells_grams_and_millimetres() -> None:
    """An object of 0.12 kg that moves by 3.1 mm."""
    target = SimpleNamespace(surface="paper", mass_kg=0.12)
    result: Any = SimpleNamespace(
        scene=SimpleNamespace(object=target, grasp=SimpleNamespace(kind="pinch")), seed=0, samples=1000, slips=(),
        duration_s=0.5, force_n=2.0, lost_s=None, plan=SimpleNamespace(pin=None),
        signals=SimpleNamespace(object_m=[0.0, 0.0031]),
    )  # fmt: skip
    first, second = summary.as_text(result)
    assert ", 120 g, pinch grasp, thumb 2.00 N, seed 0: 1000 samples, 0.50 s" in first
    assert second == "the object moved by 3.1 mm and was held"


def test_load_change_that_ends_the_contact_names_a_remedy_that_works():
    with pytest.raises(FingertipError) as refused:
        load_simulation(SCENES / "load_change.toml", changes=["load_change.by_n=-4"])
    assert "set load_change.by_n=0 and hold.release=true" in str(refused.value)
    assert load_simulation(SCENES / "load_change.toml", changes=["load_change.by_n=0", "hold.release=true"])


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
    simulation = load_simulation("sliding_finger", "article", changes=["converter.bits=12", "converter.high_v=3.3"])
    (warning,) = simulation.find_warnings()
    named = re.search(r"converter\.high_v=([0-9.]+)\.$", warning).group(1)
    wide = load_simulation("sliding_finger", "article", changes=["converter.bits=12", f"converter.high_v={named}"])
    assert not [*wide.find_warnings()]
    volts = wide.run().columns["voltage_v"]
    assert volts.max() < float(named) - 5 / 2**12


def test_range_without_a_converter_is_refused():
    with pytest.raises(FingertipError, match="the range has no effect; choose 12, or leave the range out"):
        load_simulation("sliding_finger", changes=["converter.high_v=3.3"])
    assert load_simulation("sliding_finger", changes=["converter.high_v=3.3", "converter.bits=12"])


def test_list_of_words_needs_no_quotes():
    scene = load_simulation("sliding_finger", changes=["outputs=[voltage_v, envelope_v]"]).scene
    assert scene.outputs == ["voltage_v", "envelope_v"]
    with pytest.raises(FingertipError, match=r"write 'outputs=\[\"voltage_v\"\]', with both kinds of quotes"):
        load_simulation("sliding_finger", changes=["outputs=voltage_v"])


def test_values_of_a_wrong_type_are_refused_with_an_example():
    design, scene, hand = ARTICLE, SceneFile(), ManipulationFile()
    with pytest.raises(TraceError, match=r"scene: is .*ManipulationFile; give a SceneFile, such as SceneFile\.load"):
        run_scene(design, hand)
    with pytest.raises(TraceError, match=r"scene: is .*SceneFile; give a ManipulationFile"):
        run_manipulation(design, scene)
    with pytest.raises(TraceError, match=r"design: is 'fsr400', of type str; give a Design"):
        run_scene("fsr400", scene)
    with pytest.raises(TraceError, match=r"grid: is 16, of type int; give a Grid, such as Grid\(16\)"):
        run_scene(design, scene, grid=16)
    with pytest.raises(TraceError, match="controller: is 'fast', which has no method step"):
        run_manipulation(design, hand, "fast")


def test_controller_that_commands_millimetres_is_refused():
    class InMillimetres:
        def step(self, observation):
            return observation.planned_m * 1000

    with pytest.raises(TraceError, match=r"return closings in metres, at most 0\.5 m"):
        run_manipulation(ARTICLE, ManipulationFile(grasp={"kind": "pinch"}), InMillimetres())


@pytest.fixture(scope="module")
def gross():
    return simulate(ARTICLE, Trial("gross", 0.04, 1.0, 3))


def test_trial_has_the_rate_voltage_and_force_of_the_article(gross):
    assert (gross.time_s[1] - gross.time_s[0]) == 0.0005
    assert gross.voltage_v[:200].mean() == pytest.approx(compute_bridge_v(ARTICLE, np.zeros(1))[0], abs=1e-3)
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


@pytest.mark.parametrize("rate", [1000.0, 3000.0, 10000.0])
def test_onset_does_not_depend_on_the_sampling_rate(rate):
    trace = simulate(article_design(detector={"sample_rate_hz": rate}), Trial("gross", 0.04, 1.0, 3))
    assert trace.time_s[trace.slip][0] == pytest.approx(1.8831, abs=0.003)


@pytest.mark.parametrize(
    ("values", "field", "message"),
    [
        ({"surface": "woood"}, "--surface", "did you mean wood?"),
        ({"speed_m_s": -0.04}, "--speed-m-s", "-0.04 m/s is refused; choose 0.005 to 0.2 m/s"),
        ({"speed_m_s": float("nan")}, "--speed-m-s", "nan m/s"),
        ({"force_n": -1.0}, "--force-n", "-1 N is refused; choose above 0 and at most 4 N"),
        ({"force_n": float("inf")}, "--force-n", "inf N"),
        ({"seed": -1}, "--seed", "at least 0"),
    ],
)
def test_invalid_trial_is_refused(values, field, message):
    with pytest.raises(TraceError) as caught:
        Trial(**values)
    (issue,) = caught.value.issues
    assert issue.field == field
    assert message in issue.message


SLIDE = {"slide": {"distance_m": 0.01}, "hold": {"wait_s": 0.1, "release": False}}
STILL = {"hold": {"wait_s": 0.1, "release": False}}


def run(tables: dict, outputs: list[str]):
    found = run_scene(Design(), SceneFile(**tables, outputs=outputs), 3)
    return found, {stage.name: stage for stage in found.stages}


@pytest.mark.parametrize(
    ("tables", "outputs", "stages"),
    [
        (SLIDE, ["slip"], ["load", "carriage", "friction", "slip"]),
        (SLIDE, ["shear_m"], ["load", "carriage", "friction", "shear"]),
        (SLIDE, ["force_n"], ["load", "carriage", "friction", "profile", "contact", "force"]),
        (STILL, ["force_n"], ["load", "contact", "force"]),
        (STILL, ["slip"], ["load", "no motion"]),
        (STILL, ["voltage_v"], ["load", "contact", "sensor", "bridge", "ADC"]),
        (STILL, ["envelope_v"], ["load", "contact", "sensor", "bridge", "board noise", "filter board"]),
        (STILL | {"tap": {"force_n": 1.0}}, ["force_n"], ["load", "disturbances", "contact", "force"]),
        (
            STILL | {"cable": {"hum_v": 0.1}},
            ["tactile_v"],
            ["load", "contact", "sensor", "bridge", "interference", "board noise"],
        ),
        (
            SLIDE | {"contact": {"feedback": True}},
            ["force_n", "slip"],
            ["load", "carriage", "coupled contact", "force", "slip"],
        ),
    ],
    ids=str,
)
def test_only_needed_stages_run(tables, outputs, stages):
    found, by_name = run(tables, outputs)
    assert list(by_name) == stages
    assert list(found.columns) == outputs


@pytest.mark.parametrize("tables", [SLIDE, STILL | {"motor": {"force_n": 0.05}}], ids=["slide", "motor"])
def test_outputs_do_not_depend_on_the_other_outputs(tables):
    every = ["voltage_v", "force_n", "slip", "velocity_m_s", "shear_m", "tactile_v", "filtered_v", "envelope_v"]
    full, _ = run(tables, every)
    for name in every:
        alone, _ = run(tables, [name])
        assert np.array_equal(alone.columns[name], full.columns[name]), name


def test_states_and_evaluations_count_needed_stages_only():
    _, slip_only = run(SLIDE, ["slip"])
    _, everything = run(SLIDE, ["voltage_v", "force_n", "slip", "envelope_v"])
    steps = everything["friction"].evaluations // 2
    assert sum(stage.states for stage in slip_only.values()) == 3
    assert sum(stage.evaluations for stage in slip_only.values()) == 2 * steps
    assert sum(stage.states for stage in everything.values()) == 3 + 1 + 2 + 1 + 4
    assert everything["contact"].evaluations == steps
    _, still = run(STILL, ["voltage_v", "force_n", "slip"])
    assert sum(stage.states for stage in still.values()) == 2 + 1
