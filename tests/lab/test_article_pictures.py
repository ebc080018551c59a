"""Figures of the article beside its own: what their numbers are, by closed forms."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.lab.campaign.campaign import Case
from fingertip.sim.simulation import Trial
from fingertip.slip.traces.truth import Interval
from tests.designs import ARTICLE
from tools.article.page import FIGURES, PAGE
from tools.article.pictures.collect import draw_blocks
from tools.article.pictures.spectra import BareScene, Spectrum
from tools.article.pictures.trials import TrialSignals
from tools.article.pictures.windows import WINDOWS_S, Touch, simulate_touch
from tools.article.steps import generate_trials

RATE_HZ = 2000.0
LARGEST_BYTES = 150_000


def test_spectrum_holds_the_power_of_its_segments() -> None:
    """Parseval: a sine has half its square, on bins of the segment and under the window."""
    time_s = np.arange(1024) / RATE_HZ
    low = 0.3 * np.sin(2 * np.pi * 50 * RATE_HZ / 2048 * time_s * 2)
    high = 0.1 * np.sin(2 * np.pi * 250 * RATE_HZ / 2048 * time_s * 2)
    spectrum = Spectrum.of_segments([low + high, low + high], RATE_HZ)
    step_hz = spectrum.frequency_hz[1]
    power = float(spectrum.power_v2_hz.sum() * step_hz)
    assert step_hz == pytest.approx(1 / 0.512)
    assert power == pytest.approx(0.3**2 / 2 + 0.1**2 / 2, rel=1e-9)
    assert spectrum.share_above(200.0) == pytest.approx(0.1, rel=1e-9)
    assert spectrum.share_above(200.0, 150.0) == pytest.approx(1.0, rel=1e-9)


def test_bare_sensor_feels_the_whole_force() -> None:
    scene = BareScene(**Trial().scene.model_dump())
    force_n = np.array([0.1, 1.0, 8.0])
    pad = scene.draw_pad(ARTICLE, 1)
    assert pad.sensed_n(force_n) == pytest.approx(force_n)
    embedded = Trial().scene.draw_pad(ARTICLE, 1)
    assert pad.resonance_hz(1.0) == pytest.approx(
        math.sqrt(10) * embedded.resonance_hz(1.0), rel=0.01
    )


def test_ideal_envelope_of_a_sine_is_its_root_mean_square_times_a_constant() -> None:
    """Of 20 samples a period, half a wave has the mean cot(pi / 20) / 20, in the limit 1/pi."""
    time_s = np.arange(4000) / RATE_HZ
    amplitude = 1 + 0.5 * np.sin(2 * np.pi * 0.5 * time_s)
    filtered_v = amplitude * np.sin(2 * np.pi * 100 * time_s)
    signals = TrialSignals(
        case=Case("slip", Trial().scene, 1),
        time_s=time_s,
        voltage_v=filtered_v,
        force_n=np.ones(4000),
        filtered_v=filtered_v,
        envelope_v=np.maximum(filtered_v, 0.0),
        slip=Interval(0.5, 1.5),
        on=time_s > 0.6,
    )
    alike, ratio = signals.compare_with_rms()
    assert alike == pytest.approx(1.0, abs=1e-3)
    assert ratio == pytest.approx(math.sqrt(2) / 20 / math.tan(math.pi / 20), rel=1e-3)
    assert signals.delay_s == pytest.approx(0.1, abs=1.1 / RATE_HZ)
    assert not signals.is_broken


def test_touch_is_averaged_over_each_window() -> None:
    touch: Touch = simulate_touch(ARTICLE, next(generate_trials(120)))
    assert touch.trace.envelope_v is not None
    longest = touch.means_v[WINDOWS_S[-1]]
    expected = np.convolve(touch.trace.envelope_v, np.full(200, 1 / 200))[: len(longest)]
    assert longest == pytest.approx(expected, abs=1e-12)
    highest_v = [touch.highest_v(window_s) for window_s in WINDOWS_S]
    assert highest_v == sorted(highest_v, reverse=True)


def test_figures_stand_on_the_page_in_small() -> None:
    figures = json.loads(FIGURES.read_text())
    blocks = draw_blocks(Design.load("article"))
    assert figures[0] == json.loads(json.dumps(blocks.as_data()))
    assert PAGE.with_name(blocks.file).read_bytes() == blocks.picture
    for one in figures:
        assert PAGE.with_name(one["file"]).stat().st_size < LARGEST_BYTES
        assert one["statements"]
