"""Detector `digital`: the chain compared with closed forms, and streaming compared with batch processing."""

from __future__ import annotations

import cmath
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fingertip.design import Design
from fingertip.detection.warnings import settings_warnings, threshold_warnings
from fingertip.slip.detectors.analog_and_digital import ChainSettings, SlipChain, noise_level
from fingertip.slip.detectors.noise import NoiseLevel, mean_quantised_noise_v, quantised_noise_v
from tests.designs import ARTICLE
from tests.oracles.chain_response import analog_response, digital_response

SETTINGS = ChainSettings.from_design(ARTICLE)


@pytest.mark.parametrize("cutoff", [5.0, 67.0, 200.0, 499.0])
def test_response_at_the_cutoff_is_exact_for_any_cutoff(cutoff):
    settings = replace(SETTINGS, cutoff_hz=cutoff)
    assert cmath.isclose(digital_response(settings, cutoff), analog_response(settings, cutoff), rel_tol=1e-11)
    assert abs(digital_response(settings, cutoff)) == pytest.approx((1 + 100 / 1.5) / math.sqrt(2), rel=1e-11)


@pytest.mark.parametrize("frequency", [30.0, 67.0, 120.0])
def test_rms_of_a_filtered_tone_matches_the_response(frequency):
    time = np.arange(8000) / 2000
    out = SlipChain(SETTINGS).process(np.sin(2 * math.pi * frequency * time)).filtered_v[4000:]
    assert math.sqrt(2 * np.mean(out**2)) == pytest.approx(abs(digital_response(SETTINGS, frequency)), rel=1e-9)


def test_envelope_step_response_matches_the_analog_pole():
    chain = SlipChain(replace(SETTINGS, cutoff_hz=1e-4, gain=1.0, window_samples=1))
    out = chain.process([0.0] + [1.0] * 200).envelope_v[1:]
    tau = 1 / (2 * math.pi * 36.17)
    expected = [1 - math.exp(-(n + 1) / 2000 / tau) for n in range(200)]
    assert out == pytest.approx(np.array(expected), abs=2e-4)


def test_negative_half_wave_is_rectified_to_zero():
    output = SlipChain(replace(SETTINGS, cutoff_hz=1e-4)).process([1.0] + [0.0] * 100)
    assert output.filtered_v[1:].max() < 0.0
    assert not output.envelope_v.any()


@given(st.lists(st.floats(-10, 10), min_size=1, max_size=300), st.integers(1, 40))
def test_window_mean_is_the_mean_of_the_last_samples(samples, length):
    out = SlipChain(replace(SETTINGS, window_samples=length)).process(samples)
    padded = np.concatenate((np.zeros(length - 1), out.envelope_v))
    means = [math.fsum(padded[i : i + length]) / length for i in range(len(samples))]
    assert out.mean_v == pytest.approx(np.array(means), abs=1e-11)
    assert np.array_equal(out.on, out.mean_v > SETTINGS.threshold_v)


def test_running_sum_does_not_accumulate_rounding_errors():
    chain = SlipChain(SETTINGS)
    rng = np.random.default_rng(2)
    chain.process(rng.normal(0, 5, 100_000))
    out = chain.process([0.0] * 4000)
    assert abs(out.mean_v[-1]) < 1e-15


@pytest.mark.parametrize("design", [ARTICLE, Design()])
def test_noise_level_matches_simulated_noise(design):
    level = noise_level(design)
    rng = np.random.default_rng(3)
    step = design.detector.adc_step_v
    noise = np.round((2.5 * step + rng.normal(0, design.detector.noise_v, 200_000)) / step) * step
    means = SlipChain(ChainSettings.from_design(design)).process(noise).mean_v[200:]
    assert means.mean() == pytest.approx(level.mean_v, rel=0.03)
    assert means.std() == pytest.approx(level.deviation_v, rel=0.10)
    assert means.max() < level.threshold_v


@pytest.mark.parametrize("design", [ARTICLE, Design()])
def test_default_threshold_is_the_rounded_noise_derived_threshold(design):
    derived_v = noise_level(design).threshold_v
    assert design.detector.threshold_v == math.ceil(derived_v * 1000) / 1000


def test_threshold_within_the_noise_gives_a_warning():
    level = NoiseLevel(0.010, 0.001)
    (below,) = threshold_warnings(0.009, level)
    (within,) = threshold_warnings(0.0135, level)
    (far,) = threshold_warnings(0.1, level)
    assert "is below the mean noise level (0.01 V)" in below
    assert "is within the noise, which crosses it repeatedly" in within
    assert "(mean level 0.01 V, standard deviation 0.001 V); the noise-derived threshold is 0.016 V" in within
    assert "detects weaker slip" in far
    assert list(threshold_warnings(0.017, level)) == list(threshold_warnings(0.1, level, may_be_lower=False)) == []


def test_noise_smaller_than_an_adc_step_vanishes_at_most_voltages():
    rng = np.random.default_rng(0)
    for noise, step in ((4e-4, 3e-4), (4e-4, 2.4e-3), (1e-4, 3e-3)):
        at = rng.uniform(-0.5, 0.5, 400)[:, None] * step
        codes = np.round((at + rng.normal(0, noise, (400, 2000))) / step) * step
        drawn = float(np.sqrt(np.mean(codes.var(axis=1))))
        assert mean_quantised_noise_v(noise, step) == pytest.approx(drawn, rel=0.04)
        assert mean_quantised_noise_v(noise, step) < 1.01 * quantised_noise_v(noise, step)
    assert mean_quantised_noise_v(0.0, 3e-4) == 0.0
    assert mean_quantised_noise_v(1e-2, 3e-4) == quantised_noise_v(1e-2, 3e-4)


def test_unsuitable_settings_give_a_warning():
    assert list(settings_warnings(Design())) == []
    (low,) = settings_warnings(Design(board={"cutoff_hz": 40.0}))
    assert "cutoff_hz of 40 Hz passes contacts and changes of grip" in low
    (coarse,) = settings_warnings(Design(detector={"adc_bits": 10}))
    assert "steps of 3.22 mV" in coarse
    assert "noise of 0.5 mV" in coarse
    (short,) = settings_warnings(Design(detector={"sample_rate_hz": 10000.0}))
    assert list(settings_warnings(Design(detector={"sample_rate_hz": 10000.0}), "fast")) == []
    assert "is 6 ms" in short
    assert "Choose 300 samples for 30 ms" in short
