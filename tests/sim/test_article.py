"""Trials of the article: physical plausibility, and the same bytes for the same seed."""

from __future__ import annotations

import numpy as np
import pytest

from fingertip.foundation.errors import TraceError
from fingertip.sim import SURFACES, SceneFile, Trial, run_scene, simulate
from fingertip.sim.contact.pad import Pad
from fingertip.sim.runs.scene import SceneRun
from fingertip.sim.runs.timeline import build_timeline
from fingertip.sim.signal.converter import compute_bridge_v
from tests.designs import ARTICLE, article_design

DESIGN = ARTICLE


@pytest.fixture(scope="module")
def gross():
    return simulate(DESIGN, Trial("gross", 0.04, 1.0, 3))


def test_trial_has_the_rate_voltage_and_force_of_the_article(gross):
    assert (gross.time_s[1] - gross.time_s[0]) == 0.0005
    assert gross.voltage_v[:200].mean() == pytest.approx(compute_bridge_v(DESIGN, np.zeros(1))[0], abs=1e-3)
    holding = (gross.time_s > 1.4) & (gross.time_s < 1.8)
    assert gross.force_n[holding].mean() == pytest.approx(1.0, rel=1e-3)
    assert gross.force_n.min() == 0.0
    assert not gross.force_n[-2000:].any()
    assert not gross.force_n[:700].any()
    begins = gross.time_s[gross.slip][0]
    command = 1.0 + np.flatnonzero(gross.force_n > 0.99)[0] / 2000  # one second after the touch
    assert command < begins < command + 0.1
    assert gross.slip.sum() / 2000 == pytest.approx(1.0, abs=0.06)


def test_onset_is_later_under_a_larger_load():
    onsets = []
    for force in (0.3, 1.0, 3.0):
        trial = Trial("gross", 0.04, force, 3)
        trace = simulate(DESIGN, trial)
        command = build_timeline(trial.scene, Pad.from_design(DESIGN), force).slide.start_s
        onsets.append(trace.time_s[trace.slip][0] - command)
    assert 0.0 < onsets[0] < onsets[1] < onsets[2]


def test_slide_shorter_than_the_shear_of_the_pad_is_no_gross_slip():
    """True slip follows from the physics and not from the command."""
    slides = {}
    for distance, speed in ((5e-5, 0.007), (5e-3, 0.04)):
        scene = SceneFile(
            contact={"surface": "gross"},
            hold={"min_force_n": 2.0, "max_force_n": 2.0},
            slide={"distance_m": distance, "speed_m_s": speed},
        )
        slides[distance] = run_scene(DESIGN, scene, 3).trace.slip.any()
    assert slides == {5e-5: False, 5e-3: True}


@pytest.mark.full
def test_vibration_grows_with_roughness_and_load_and_stays_below_100_hz():
    def shaking(surface, force):
        trace = simulate(DESIGN, Trial(surface, 0.06, force, 5))
        during = trace.force_n[trace.slip][100:1100]
        return during - during.mean()

    rms = {key: shaking(*key).std() for key in [("smooth", 1.0), ("medium", 1.0), ("gross", 1.0), ("medium", 0.3)]}
    assert rms["smooth", 1.0] < rms["medium", 1.0] < rms["gross", 1.0]
    assert rms["medium", 0.3] < rms["medium", 1.0]
    for surface in SURFACES:
        power = np.abs(np.fft.rfft(shaking(surface, 1.0) * np.hanning(1000))) ** 2
        above = np.fft.rfftfreq(1000, 1 / 2000) > 100
        assert power[above].sum() < 0.15 * power.sum(), surface


def test_hand_keeps_the_force_over_a_wavy_surface():
    trace = simulate(DESIGN, Trial("wood", 0.08, 1.3, 2))
    end = trace.time_s[trace.slip][-1]
    after = (trace.time_s > end + 0.3) & (trace.time_s < end + 0.8)
    assert trace.force_n[after].mean() == pytest.approx(1.3, rel=0.01)


def test_drawn_force_lies_in_the_range_of_the_article():
    forces = [SceneRun(DESIGN, Trial(seed=seed).scene, seed).force_n for seed in range(200)]
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
