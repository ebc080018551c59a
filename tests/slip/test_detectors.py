"""Properties of all detectors (any chunks, causal, picklable), and
the false alarm rates of their thresholds.
"""

from __future__ import annotations

import math
import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fingertip.design import Design
from fingertip.detection.adaptation import equivalent_noise_v
from fingertip.foundation import jit
from fingertip.foundation.errors import TraceError
from fingertip.slip.detectors.analog_and_digital import ChainSettings, SlipChain
from fingertip.slip.detectors.fft import ALARMS_PER_HOUR, EXCURSION_S, FftDetector, tail_probability
from fingertip.slip.detectors.noise_and_threshold import quantised_noise_v
from fingertip.slip.detectors.registry import DETECTORS, make_detector

DESIGN = Design()
NAMES = list(DETECTORS)
FIELDS = ("statistic_v", "threshold_v", "on")


def make_signal(count: int, seed: int = 0) -> np.ndarray:
    """Noise with a contact, a rough burst and a step, so that every branch is executed."""
    t = np.arange(count) / 2000
    rng = np.random.default_rng(seed)
    volts = 4.3 + rng.normal(0, 4e-4, count) - 0.3 * np.clip(t - 0.3, 0, 0.1) / 0.1
    burst = rng.normal(0, 0.02, count) * ((t > 0.5) & (t < 0.7))
    return np.asarray(volts + burst + 0.2 * (t > 0.8))


def make_input(name: str, volts: np.ndarray, design: Design = DESIGN) -> np.ndarray:
    """Convert a voltage to a detector's input: for `analog` it is the envelope."""
    if DETECTORS[name].input_column == "voltage_v":
        return volts
    return SlipChain(ChainSettings.from_design(design)).process(volts).envelope_v


def make_full_input(name: str) -> np.ndarray:
    return make_input(name, make_signal(1700))


def assert_equal_to_whole(name: str, parts: list) -> None:
    whole = make_detector(name, DESIGN).process(make_full_input(name))
    assert whole.on.any()
    assert not whole.on.all()
    for field in FIELDS:
        assert (
            np.concatenate([getattr(part, field) for part in parts]).tobytes()
            == getattr(whole, field).tobytes()
        )


@pytest.mark.full
@pytest.mark.parametrize("name", NAMES)
@settings(max_examples=25)
@given(sizes=st.lists(st.integers(0, 499), max_size=12))
def test_any_division_into_chunks_gives_the_same_bits_even_if_pickled_between(name, sizes):
    whole = make_full_input(name)
    detector = make_detector(name, DESIGN)
    parts = []
    start = 0
    for size in [*sizes, len(whole)]:
        parts.append(detector.process(whole[start : start + size]))
        start += size
        detector = pickle.loads(pickle.dumps(detector))
    assert_equal_to_whole(name, parts)


@pytest.mark.parametrize("name", NAMES)
def test_sample_by_sample_gives_the_same_flags(name):
    whole = make_full_input(name)
    detector = make_detector(name, DESIGN)
    stepping = make_detector(name, DESIGN)
    assert_equal_to_whole(name, [detector.process([x]) for x in whole.tolist()])
    flags = [stepping.step(x) for x in whole.tolist()]
    assert flags == make_detector(name, DESIGN).process(whole).on.tolist()
    # A stream may change from `step` to `process`.
    mixed = make_detector(name, DESIGN)
    head = [mixed.step(x) for x in whole[:777].tolist()]
    assert head + mixed.process(whole[777:]).on.tolist() == flags


@pytest.mark.every_case
@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("volts", [0.0, 4.3, -10.0])
def test_a_constant_voltage_is_never_slip(name, volts):
    out = make_detector(name, DESIGN).process(make_input(name, np.full(3000, volts)))
    assert not out.on.any()


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("rate", [1000.0, 2000.0, 5000.0, 20000.0])
def test_a_burst_is_detected_at_any_sampling_rate(name, rate):
    design = Design(detector={"sample_rate_hz": rate, "window_samples": int(0.03 * rate)})
    t = np.arange(int(rate)) / rate
    volts = 4.0 + np.random.default_rng(2).normal(0, 4e-4, len(t))
    volts += 0.01 * np.sin(2 * math.pi * 90 * t) * ((t > 0.5) & (t < 0.8))
    on = make_detector(name, design).process(make_input(name, volts, design)).on
    first = int(np.flatnonzero(on)[0])
    assert (
        0.5
        < t[first]
        < 0.5
        + {"analog": 0.02, "digital": 0.02, "fft": 0.04, "fast": 0.035, "incipient": 0.02}[name]
    )
    assert on[t > 0.9].sum() == 0


def test_all_thresholds_together_permit_the_stated_alarm_rate():
    detector = FftDetector(DESIGN)
    excursions = tail_probability(
        detector.noise_weights() * detector.noise_v**2, detector.threshold_v**2
    )
    assert 3600 / EXCURSION_S * excursions == pytest.approx(ALARMS_PER_HOUR, rel=1e-3)


def test_plain_fft_takes_windows_side_by_side_and_the_strongest_bin():
    """63 bins between 0 Hz and half the rate, each of which noise
    exceeds with the probability exp(-x^2).
    """
    plain = FftDetector(DESIGN, is_plain=True)
    rate_hz = DESIGN.detector.sample_rate_hz
    n = plain.window_samples
    per_bin = ALARMS_PER_HOUR * n / rate_hz / 3600 / 63
    assert plain.threshold_v == pytest.approx(
        plain.noise_v * math.sqrt(-2 * math.log(per_bin) / n), rel=0.005
    )
    t = np.arange(6 * n) / rate_hz
    tones = 0.02 * np.sin(2 * math.pi * 125 * t) + 0.01 * np.sin(2 * math.pi * 906.25 * t)
    tones[: 2 * n + 1] = 0.0
    found = plain.process(tones)
    assert np.flatnonzero(found.on)[0] == 3 * n
    assert found.statistic_v[4 * n] == pytest.approx(0.02 / math.sqrt(2))
    assert len(set(found.statistic_v[4 * n : 5 * n])) == 1


def test_tail_probability_of_a_sum_of_squares():
    # Two equal weights give an exponential distribution, one weight a chi-square distribution.
    assert tail_probability(np.array([2.0, 2.0]), 60.0) == pytest.approx(math.exp(-15.0), rel=0.05)
    assert tail_probability(np.array([3.0]), 75.0) == pytest.approx(
        math.erfc(5 / math.sqrt(2)), rel=0.1
    )
    rng = np.random.default_rng(0)
    weights = np.array([1.0, 0.5, 0.2, 0.1])
    drawn = rng.normal(size=(400_000, 4)) ** 2 @ weights
    assert tail_probability(weights, 8.0) == pytest.approx(float(np.mean(drawn > 8.0)), rel=0.1)


@pytest.mark.full
@pytest.mark.parametrize("detector", ["digital", "fast", "fft"])
@pytest.mark.parametrize("kind", ["white", "low-passed", "hum"])
def test_a_quiet_part_sets_the_threshold_whatever_its_spectrum(detector, kind):
    from scipy import signal as scipy_signal

    rng = np.random.default_rng(9)
    t = np.arange(40_000) / 2000
    signal_v = rng.normal(0, 3e-4, len(t))
    if kind == "low-passed":
        signal_v = 4 * scipy_signal.sosfilt(
            scipy_signal.butter(2, 300, fs=2000, output="sos"), signal_v
        )
    elif kind == "hum":
        signal_v = signal_v + 1e-3 * np.sin(2 * math.pi * 50 * t)
    noise_v = equivalent_noise_v(detector, DESIGN, signal_v[:4000], "t")
    assert not make_detector(detector, DESIGN, noise_v).process(signal_v).on.any()
    if kind == "white":
        assert noise_v == pytest.approx(3e-4, rel=0.12 if detector != "digital" else 0.3)
    # A tone well above the noise is still detected.
    loud = signal_v + 8e-3 * np.sin(2 * math.pi * 110 * t) * (t > 10)
    assert make_detector(detector, DESIGN, noise_v).process(loud).on[20_400:25_000].mean() > 0.9


def test_quantised_noise_matches_simulated_noise():
    """At the worst voltage, halfway between two codes."""
    rng = np.random.default_rng(2)
    for noise, step in ((4e-4, 3e-4), (1e-4, 3e-4), (3e-4, 3e-4), (1e-3, 1e-4)):
        drawn = np.round((rng.normal(0, noise, 400_000) + step / 2) / step) * step
        assert quantised_noise_v(noise, step) == pytest.approx(np.std(drawn), rel=0.01)
    assert quantised_noise_v(0.0, 3e-4) == 1.5e-4


@pytest.mark.skipif(not jit.available(), reason="numba is not installed")
@pytest.mark.parametrize("name", ["digital", "analog", "fast"])
def test_compiled_and_plain_give_the_same_bits(name, monkeypatch):
    with jit.compiled():
        compiled = make_detector(name, DESIGN).process(make_full_input(name))
    monkeypatch.setattr(jit, "available", lambda: False)
    plain = make_detector(name, DESIGN).process(make_full_input(name))
    for field in FIELDS:
        assert getattr(compiled, field).tobytes() == getattr(plain, field).tobytes()


@pytest.mark.parametrize("name", ["digital", "fft", "fast"])
def test_twice_the_noise_gives_twice_the_threshold(name):
    one = make_detector(name, DESIGN, 1e-3).threshold_v
    two = make_detector(name, DESIGN, 2e-3).threshold_v
    assert two == pytest.approx(2 * one, rel=0.06 if name == "digital" else 1e-9)


def test_analog_and_digital_use_the_same_window():
    """For the same envelope both have the same mean, so they differ only in the board."""
    chain = make_detector("digital", DESIGN).process(make_signal(1700))
    window = make_detector("analog", DESIGN).process(chain.envelope_v)
    assert np.array_equal(window.statistic_v, chain.statistic_v)
    assert np.array_equal(window.on, chain.on)
    with pytest.raises(
        TraceError,
        match="does not determine the threshold of the detector analog, which applies to the "
        "board's output",
    ):
        make_detector("analog", DESIGN, 1e-3)
