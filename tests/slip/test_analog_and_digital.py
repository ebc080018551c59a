"""Detectors `digital` and `analog`: the chain against closed forms, a
recorded envelope, and a simulated board.
"""

from __future__ import annotations

import cmath
import json
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fingertip.board.components.values import VARIANT_CHANGES
from fingertip.design import Design
from fingertip.detection.warnings import settings_warnings, threshold_warnings
from fingertip.foundation.errors import TraceError
from fingertip.sim.signal.converter import SimulatedBoardDetector
from fingertip.slip.detectors.analog_and_digital import (
    AnalogDetector,
    ChainSettings,
    SlipChain,
    high_pass,
    noise_level,
)
from fingertip.slip.detectors.noise_and_threshold import NoiseLevel
from fingertip.slip.detectors.registry import make_detector
from fingertip.slip.scored_detection import detect
from fingertip.slip.traces.trace import Trace
from tests.designs import ARTICLE
from tests.slip.recordings import ONSET, T, V, csv, run, single_onset

SETTINGS = ChainSettings.from_design(ARTICLE)


def digital_response(settings: ChainSettings, frequency_hz: float) -> complex:
    """Frequency response of the digital high-pass filter."""
    (g0, g1, p1), (b0, b1, b2, a1, a2) = high_pass(settings)
    d = cmath.exp(-2j * math.pi * frequency_hz / settings.sample_rate_hz)
    return (g0 + g1 * d) / (1 + p1 * d) * (b0 + b1 * d + b2 * d * d) / (1 + a1 * d + a2 * d * d)


def analog_response(settings: ChainSettings, frequency_hz: float) -> complex:
    """Frequency response of the board's ideal high-pass filter (article, eq.

    9, with the j that it omits); Q is 1.
    """
    s = 1j * frequency_hz / settings.cutoff_hz
    return settings.gain * s / (s + 1) * s * s / (s * s + s + 1)


@pytest.mark.parametrize("cutoff", [5.0, 67.0, 200.0, 499.0])
def test_response_at_the_cutoff_is_exact_for_any_cutoff(cutoff):
    settings = replace(SETTINGS, cutoff_hz=cutoff)
    assert cmath.isclose(
        digital_response(settings, cutoff), analog_response(settings, cutoff), rel_tol=1e-11
    )
    assert abs(digital_response(settings, cutoff)) == pytest.approx(
        (1 + 100 / 1.5) / math.sqrt(2), rel=1e-11
    )


@pytest.mark.parametrize("frequency", [30.0, 67.0, 120.0])
def test_rms_of_a_filtered_tone_matches_the_response(frequency):
    time = np.arange(8000) / 2000
    out = SlipChain(SETTINGS).filter(np.sin(2 * math.pi * frequency * time))[4000:]
    assert math.sqrt(2 * np.mean(out**2)) == pytest.approx(
        abs(digital_response(SETTINGS, frequency)), rel=1e-9
    )


def test_envelope_step_response_matches_the_analog_pole():
    chain = SlipChain(replace(SETTINGS, cutoff_hz=1e-4, gain=1.0, window_samples=1))
    out = chain.process([0.0] + [1.0] * 200).envelope_v[1:]
    tau = 1 / (2 * math.pi * 36.17)
    expected = [1 - math.exp(-(n + 1) / 2000 / tau) for n in range(200)]
    assert out == pytest.approx(np.array(expected), abs=2e-4)


def test_negative_half_wave_is_rectified_to_zero():
    settings = replace(SETTINGS, cutoff_hz=1e-4)
    volts = [1.0] + [0.0] * 100
    assert SlipChain(settings).filter(volts)[1:].max() < 0.0
    assert not SlipChain(settings).process(volts).envelope_v.any()


@given(st.lists(st.floats(-10, 10), min_size=1, max_size=300), st.integers(1, 40))
def test_window_mean_is_the_mean_of_the_last_samples(samples, length):
    out = SlipChain(replace(SETTINGS, window_samples=length)).process(samples)
    padded = np.concatenate((np.zeros(length - 1), out.envelope_v))
    means = [math.fsum(padded[i : i + length]) / length for i in range(len(samples))]
    assert out.statistic_v == pytest.approx(np.array(means), abs=1e-11)
    assert np.array_equal(out.on, out.statistic_v > SETTINGS.threshold_v)


def test_running_sum_does_not_accumulate_rounding_errors():
    chain = SlipChain(SETTINGS)
    rng = np.random.default_rng(2)
    chain.process(rng.normal(0, 5, 100_000))
    out = chain.process([0.0] * 4000)
    assert abs(out.statistic_v[-1]) < 1e-15


@pytest.mark.parametrize("design", [ARTICLE, Design()])
def test_noise_level_matches_simulated_noise(design):
    level = noise_level(design)
    rng = np.random.default_rng(3)
    step = design.detector.adc_step_v
    noise = np.round((2.5 * step + rng.normal(0, design.detector.noise_v, 200_000)) / step) * step
    means = SlipChain(ChainSettings.from_design(design)).process(noise).statistic_v[200:]
    assert means.mean() == pytest.approx(level.mean_v, rel=0.03)
    assert means.std() == pytest.approx(level.deviation_v, rel=0.10)
    assert means.max() < level.threshold_v


@pytest.mark.parametrize("design", [ARTICLE, Design()])
def test_default_threshold_is_the_rounded_noise_derived_threshold(design):
    derived_v = noise_level(design).threshold_v
    assert design.detector.threshold_v == math.ceil(derived_v * 1000) / 1000


def test_the_threshold_of_a_board_s_output_is_not_that_of_the_chain() -> None:
    """The article's board passes next to no noise: 0.31 mV is within the noise of `digital`."""
    article = Design.load("article")
    assert article.detector.kind == "analog"
    assert make_detector("analog", article).threshold_v == 0.00031
    level = noise_level(article)
    assert make_detector("digital", article).threshold_v == level.rounded_threshold_v
    assert level.mean_v > 0.00031

    for_chain = Design.load("article", changes=["detector.kind=digital"])
    assert make_detector("digital", for_chain).threshold_v == 0.00031


def test_threshold_within_the_noise_gives_a_warning():
    level = NoiseLevel(0.010, 0.001)
    (within,) = threshold_warnings(0.0135, level)
    (far,) = threshold_warnings(0.1, level)
    assert "is within the noise, which crosses it repeatedly" in within
    assert (
        "(mean level 0.01 V, standard deviation 0.001 V); the noise-derived threshold is 0.016 V"
        in within
    )
    assert "detects weaker slip" in far
    assert (
        list(threshold_warnings(0.017, level))
        == list(threshold_warnings(0.1, level, may_be_lower=False))
        == []
    )


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
    assert list(settings_warnings(Design(detector={"window_samples": 199}))) == []
    (long,) = settings_warnings(Design(detector={"window_samples": 200}))
    assert "is 100 ms; from 100 ms on slip is reported" in long
    assert list(settings_warnings(Design(detector={"window_samples": 200}), "fast")) == []


ARTICLE_DESIGN = ("--design", "article", "--set", "detector.threshold_v=0.017")


def test_the_board_is_simulated_for_a_recording_without_envelope(tmp_path):
    (tmp_path / "t.csv").write_text(csv(T, V))
    done = run("detect", tmp_path / "t.csv", "--detector", "analog", "--json")
    assert single_onset(done) == pytest.approx(ONSET, abs=0.006)
    assert (
        "has no column envelope_v: simulating the design's board for the column voltage_v"
        in done.stderr
    )
    # A burst of 10 mV hardly opens a diode without bias, and the noise does not open it.
    closed = run("detect", tmp_path / "t.csv", "--detector", "analog", *ARTICLE_DESIGN, "--json")
    assert json.loads(closed.stdout)["noise_threshold_v"] == pytest.approx(20 / 65536, abs=1e-6)
    # No lower threshold is recommended: offsets and leakage raise a real board's quiescent output.
    assert "times the noise-derived threshold" not in closed.stderr


def test_on_outlasts_the_envelope_by_the_memory() -> None:
    """A window of 40 samples at 2 kHz: 20 ms."""
    detector = AnalogDetector(2000.0, 40, 1e-6)
    on = detector.process([1.0] * 100 + [0.0] * 100).on
    assert detector.memory_s == 0.02
    assert on[100:].sum() == pytest.approx(detector.memory_s * 2000, abs=1)


def test_a_recorded_envelope_is_used(tmp_path):
    def find(path, *words, **lines):
        return run(
            "detect", path, "--detector", "analog", "--json", *ARTICLE_DESIGN, *words, **lines
        )

    envelope = np.where((T >= 0.5) & (T < 0.7), 0.2, 0.001)
    np.savez(tmp_path / "t.npz", time_s=T, voltage_v=V, envelope_v=envelope)
    done = find(tmp_path / "t.npz")
    assert "simulating" not in done.stderr
    assert single_onset(done) == 0.5 + 4 / 2000  # five of sixty samples of 0.2 V: 17.6 mV
    quiet = find(tmp_path / "t.npz", "--calibrate", "0:0.4")
    assert json.loads(quiet.stdout)["threshold_v"] == pytest.approx(0.001 + 20 / 65536, abs=1e-4)
    assert "covers 600 samples" in find(tmp_path / "t.npz", "--calibrate", "0:0.3").stderr
    # A recording that contains only the board's output, and the same as a stream.
    (tmp_path / "e.csv").write_text(csv(T, envelope, header=("time_s", "AI1")))
    both = ("--column", "voltage_v=AI1", "--column", "envelope_v=AI1")
    assert single_onset(find(tmp_path / "e.csv", *both)) == 0.502
    live = find("-", lines=csv(T, envelope, header=("time_s", "envelope_v")))
    assert json.loads(live.stdout)["transitions"][0] == {"on": True, "time_s": 0.502}
    # Counts of both voltages, as a file and as a stream.
    step = 5 / 65536
    counts = np.column_stack((T, np.round(V / step), np.round(envelope / step)))
    np.savetxt(
        tmp_path / "c.csv", counts, "%.6f", ",", header="time_s,voltage_v,envelope_v", comments=""
    )
    assert single_onset(find(tmp_path / "c.csv", "--scale", step)) == 0.502
    live = find("-", "--scale", step, lines=(tmp_path / "c.csv").read_text())
    assert json.loads(live.stdout)["transitions"][0] == {"on": True, "time_s": 0.502}


def test_the_board_is_simulated_for_a_stream_but_not_of_a_force():
    words = ("--detector", "analog", "--json")
    assert "simulating the design's board" in run("detect", "-", *words, lines=csv(T, V)).stderr
    force = run(
        "detect",
        "-",
        *words,
        "--column",
        "voltage_v=force_n",
        lines=csv(T, V, header=("time_s", "force_n")),
    )
    assert (
        "names a force, whose thresholds require --calibrate and the whole recording"
        in force.stderr + force.stdout
    )


def test_a_force_passes_the_simulated_bridge(tmp_path):
    force = 1.0 + 0.05 * np.sin(2 * np.pi * 90 * T) * ((T >= 0.5) & (T < 0.7))
    (tmp_path / "t.csv").write_text(csv(T, force, header=("time_s", "force_n")))
    words = ("--column", "voltage_v=force_n", "--detector", "analog", "--json")
    assert 0.5 < single_onset(run("detect", tmp_path / "t.csv", *words)) < 0.52


def test_an_envelope_recorded_against_ground_gives_a_warning(tmp_path):
    """E of a board for a controller rests at its signal ground, 1.47 V; the envelope is
    E minus M.
    """
    envelope = 0.002 + 0.1 * ((T >= 0.5) & (T < 0.7))
    for rest_v, variant, is_warned in (
        (1.475, "precision", True),
        (0.0, "precision", False),
        (1.475, "article", False),
    ):
        np.savez(tmp_path / "t.npz", time_s=T, voltage_v=V, envelope_v=envelope + rest_v)
        changes = [word for change in VARIANT_CHANGES[variant] for word in ("--set", change)]
        done = run("detect", tmp_path / "t.npz", "--detector", "analog", *changes)
        assert done.exit_code == 0, done.stderr
        assert ("The envelope is E minus M: subtract" in done.stderr) == is_warned, (
            rest_v,
            variant,
        )


def test_detect_requires_an_envelope_for_analog():
    with pytest.raises(
        TraceError, match="envelope_v: is missing: the detector analog works on the board's output"
    ):
        detect(Trace(T, V), Design(), "analog")


def test_digital_agrees_with_a_simulated_board_without_dead_zone():
    """The means differ by less than 5 %, the flags in less than 1 % of the samples.

    The differences have two causes: the simulated board is linear between samples, which the
    bilinear transform is not, and it is built of preferred values.
    """
    design = Design(board={"variant": "precision"})
    digital = make_detector("digital", design).process(V)
    analog = make_detector("analog", design).process(
        SimulatedBoardDetector(design).simulate_envelope_v(V)
    )
    during = (T >= 0.53) & (T < 0.7)
    difference = analog.statistic_v[during] - digital.statistic_v[during]
    assert np.sqrt(np.mean(difference**2)) < 0.05 * np.sqrt(
        np.mean(digital.statistic_v[during] ** 2)
    )
    assert np.mean(analog.on != digital.on) < 0.01
