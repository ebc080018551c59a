"""Trials of the article, simulations as the command line loads them, and the stages that they need."""

from __future__ import annotations

import re

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.sim import (
    SceneFile,
    Trial,
    load_simulation,
    run_scene,
    simulate,
)
from fingertip.sim.runs.scene import SceneRun
from fingertip.sim.signal.converter import compute_bridge_v
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
