"""Detector `fast` with the board's filtered signal beside the
tactile voltage, of arrays, files and streams.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.detection.live import detect_stream
from fingertip.detection.recordings import detect_file
from fingertip.detection.warnings import filtered_warnings
from fingertip.foundation import jit
from fingertip.lab.campaign.run import select_board_outputs
from fingertip.sim.runs.manipulation import run_manipulation
from fingertip.sim.runs.scene import run_scene
from fingertip.sim.runs.scene_and_manipulation_files import ManipulationFile, SceneFile
from fingertip.slip.detectors.fast import FastDetector, FastOutput
from fingertip.slip.detectors.fast_settings import (
    LIMIT_SHARE,
    LIMITED_S,
    FastSettings,
    FilteredSignal,
)
from fingertip.slip.detectors.registry import find_second_column, make_detector, select_inputs
from fingertip.slip.scored_detection import detect
from fingertip.slip.traces.trace import Trace
from fingertip.slip.traces.truth import intervals

RATE = 2000.0
GAIN = 67.0
STEP_V = 3.3 / 4096
CONTROLLER = Design(
    board={"variant": "precision", "supply_v": 3.3},
    detector={"noise_v": 5e-4, "adc_bits": 12, "adc_range_v": 3.3, "adc_polarity": "unipolar"},
)
SETTINGS = FastSettings(RATE, 4e-4, filtered=FilteredSignal(GAIN, 1.4))


def quantise(volts: np.ndarray, rng: np.random.Generator, noise_v: float = 4e-4) -> np.ndarray:
    return np.asarray(np.round((volts + rng.normal(0.0, noise_v, len(volts))) / STEP_V) * STEP_V)


def board(volts: np.ndarray, cutoff_hz: float = 67.0, gain: float = GAIN) -> np.ndarray:
    """Filtered signal of an ideal board, around a rest of 1.47 V."""
    from scipy import signal as scipy_signal

    sos = scipy_signal.butter(3, cutoff_hz, "high", fs=RATE, output="sos")
    return np.asarray(1.47 + gain * scipy_signal.sosfilt(sos, volts - volts[0]))


def slip_from(seconds: float, rms_v: float, at_s: float, seed: int) -> np.ndarray:
    from scipy import signal as scipy_signal

    t = np.arange(round(seconds * RATE)) / RATE
    sos = scipy_signal.butter(4, [60.0, 140.0], "band", fs=RATE, output="sos")
    raw = scipy_signal.sosfilt(sos, np.random.default_rng(seed).normal(0.0, 1.0, len(t) + 2000))[
        2000:
    ]
    return np.asarray(2.3 + rms_v * raw / raw.std() * (t >= at_s))


def test_an_exact_filtered_signal_is_the_vibration_of_the_voltage():
    """Without noise and steps, both ways differ by the drift below 3 Hz that is taken away."""
    volts = slip_from(1.0, 0.002, 0.3, 1)
    alone = FastDetector(SETTINGS).process(volts).filtered_v
    both = FastDetector(SETTINGS).process(volts, board(volts)).filtered_v
    assert np.corrcoef(alone, both)[0, 1] > 0.999
    assert both.std() == pytest.approx(alone.std(), rel=0.01)


def test_weak_slip_is_found_in_a_noisy_converter():
    """Noise of two steps hides slip of 1.5 mV in the voltage, and not in the filtered signal."""
    found = {"alone": 0, "both": 0}
    for seed in range(6):
        rng = np.random.default_rng(seed)
        volts = slip_from(2.0, 0.0015, 1.2, seed)
        samples = quantise(volts, rng, 1.6e-3)
        filtered = quantise(board(volts), rng, 1.6e-3)
        found["alone"] += bool(
            make_detector("fast", CONTROLLER).process(samples).on[2400:3200].any()
        )
        on = make_detector("fast", CONTROLLER).process(samples, filtered).on
        assert not on[:2400].any()
        found["both"] += bool(on[2400:3200].any())
    assert found["both"] == 6
    assert found["alone"] < 6


@pytest.mark.parametrize(("cutoff_hz", "gain"), [(62.0, 1.03 * GAIN), (72.0, 0.97 * GAIN)])
def test_a_real_board_s_tolerances_do_not_matter(cutoff_hz, gain):
    for seed in range(4):
        rng = np.random.default_rng(seed)
        volts = slip_from(2.0, 0.006, 1.2, seed)
        t = np.arange(len(volts)) / RATE
        x = np.clip((t - 0.6) / 0.1, 0.0, 1.0)
        volts -= 0.2 * x * x * (3 - 2 * x)  # a change of grip
        filtered = quantise(np.clip(board(volts, cutoff_hz, gain), 0.0, 3.3), rng)
        output = make_detector("fast", CONTROLLER).process(quantise(volts, rng), filtered)
        assert isinstance(output, FastOutput)
        assert not output.incipient[:2400].any()
        assert 2400 <= np.flatnonzero(output.incipient)[0] < 2460
        assert np.flatnonzero(output.on)[0] < 2480


def test_a_stage_at_its_limit_is_not_believed():
    """After a hard knock the filtered signal sticks to a rail; the bands then follow
    the voltage.
    """
    rng = np.random.default_rng(3)
    t = np.arange(4000) / RATE
    since = np.clip(t - 1.0, 0.0, None)
    volts = 2.3 + 0.2 * np.sin(2 * np.pi * 90 * since) * np.exp(-since / 0.01)
    samples = quantise(volts, rng)
    stuck = np.where((t > 1.0) & (t < 1.0 + LIMITED_S), 3.3, 1.47)
    detector = make_detector("fast", CONTROLLER)
    output = detector.process(samples, quantise(stuck, rng))
    assert not output.on.any()
    alone = make_detector("fast", CONTROLLER).process(samples)
    during = (t > 1.005) & (t < 1.02)
    assert np.corrcoef(output.filtered_v[during], alone.filtered_v[during])[0, 1] > 0.99
    limit_v = (
        LIMIT_SHARE
        * FilteredSignal.from_design(CONTROLLER).range_v
        / CONTROLLER.board.passband_gain
    )
    assert 0.015 < limit_v < 0.022


@pytest.mark.parametrize("level_v", [0.0, 1.472, 3.299])
def test_a_broken_wire_leaves_the_tactile_voltage(level_v):
    """A filtered signal that never changes is not used: decisions
    come from the voltage, and slip is found.
    """
    volts = quantise(slip_from(2.0, 0.01, 1.2, 8), np.random.default_rng(8))
    dead = np.full(len(volts), level_v)
    detector = make_detector("fast", CONTROLLER)
    on = detector.process(volts, dead).on
    assert not on[:2400].any()
    assert 2400 <= np.flatnonzero(on)[0] < 2470
    assert on[2470:].mean() > 0.95
    (warning,) = (
        text
        for text in filtered_warnings(
            Trace(np.arange(len(volts)), volts, filtered_v=dead), CONTROLLER
        )
    )
    assert "is the board's pin S connected?" in warning


def test_a_wire_that_breaks_later_is_noticed():
    rng = np.random.default_rng(9)
    volts = slip_from(4.0, 0.01, 3.0, 9)
    filtered = quantise(board(volts), rng)
    filtered[2000:] = filtered[2000]
    output = make_detector("fast", CONTROLLER).process(quantise(volts, rng), filtered)
    assert isinstance(output, FastOutput)
    assert not output.incipient[3000:6000].any()
    assert np.flatnonzero(output.incipient[6000:])[0] < 40
    assert np.flatnonzero(output.on[6000:])[0] < 80


def test_exchanged_wires_are_named():
    volts = slip_from(1.0, 0.01, 0.5, 10)
    good = Trace(np.arange(len(volts)) / RATE, volts, filtered_v=board(volts))
    assert list(filtered_warnings(good, CONTROLLER)) == []
    assert list(filtered_warnings(replace(good, filtered_v=board(volts) - 1.47), CONTROLLER)) == []
    (warning,) = filtered_warnings(
        replace(good, voltage_v=board(volts), filtered_v=volts), CONTROLLER
    )
    assert "are T and S exchanged?" in warning
    assert list(filtered_warnings(replace(good, filtered_v=None), CONTROLLER)) == []


def test_the_rest_of_the_filtered_signal_does_not_matter():
    """A controller may send the filtered signal above ground, or above signal ground."""
    volts = slip_from(1.5, 0.01, 1.0, 4)
    filtered = np.round(board(volts) * 2**20) / 2**20  # so that a shift by a power of two is exact
    one = FastDetector(SETTINGS).process(volts, filtered)
    other = FastDetector(SETTINGS).process(volts, filtered - 1.5)
    assert one.on.any()
    assert np.array_equal(one.on, other.on)


def test_chunks_steps_and_both_forms_give_the_same_bits(monkeypatch):
    rng = np.random.default_rng(5)
    volts = slip_from(1.5, 0.01, 1.0, 5)
    samples = quantise(volts, rng)
    filtered = quantise(board(volts), rng)
    whole = FastDetector(SETTINGS).process(samples, filtered)
    detector = FastDetector(SETTINGS)
    parts = []
    for first in range(0, len(samples), 700):
        parts.append(
            detector.process(
                samples[first : first + 700], filtered[first : first + 700]
            ).statistic_v
        )
    assert np.concatenate(parts).tobytes() == whole.statistic_v.tobytes()
    stepped = FastDetector(SETTINGS)
    pairs = zip(samples.tolist(), filtered.tolist(), strict=True)
    assert [stepped.step(*pair) for pair in pairs] == whole.on.tolist()
    monkeypatch.setattr(jit, "available", lambda: False)
    plain = FastDetector(SETTINGS).process(samples, filtered)
    assert plain.statistic_v.tobytes() == whole.statistic_v.tobytes()


def test_a_board_without_a_filtered_output_ignores_the_column():
    volts = slip_from(1.5, 0.01, 1.0, 6)
    trace = Trace(np.arange(len(volts)) / RATE, volts, filtered_v=np.zeros(len(volts)))
    assert len(select_inputs(trace, "fast")) == 2
    assert len(select_inputs(trace, "digital")) == 1
    assert find_second_column(ARTICLE, "fast") is None
    assert find_second_column(CONTROLLER, "fast") == "filtered_v"
    assert find_second_column(CONTROLLER, "digital") is None
    with_zeros = detect(trace, ARTICLE, "fast").output
    without = detect(replace(trace, filtered_v=None), ARTICLE, "fast").output
    assert with_zeros.on.any()
    assert np.array_equal(with_zeros.on, without.on)


ARTICLE = Design(
    board={"variant": "article", "supply_v": 5.0},
    detector={"noise_v": 4e-4, "adc_bits": 16, "adc_range_v": 10.0, "adc_polarity": "bipolar"},
)


@pytest.fixture(scope="module")
def recording() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(7)
    volts = slip_from(2.0, 0.003, 1.2, 7)
    return (
        np.arange(len(volts)) / 2000,
        quantise(volts, rng, 1.2e-3),
        quantise(board(volts), rng, 1.2e-3),
    )


def as_lines(columns: tuple[np.ndarray, ...], names: str, factor: float = 1.0) -> Iterator[str]:
    yield names
    for time_s, *values in zip(*columns, strict=True):
        yield ",".join([f"{time_s:.6f}", *(f"{factor * value:.9g}" for value in values)])


@pytest.mark.parametrize(
    ("names", "columns", "factor"),
    [
        ("time_s,voltage_v,filtered_v", {}, 1.0),
        ("time_s,voltage_v,sampled_filtered_v", {}, 1.0),  # as a simulation calls it
        ("time_s,T,S", {"voltage_v": "T", "filtered_v": "S"}, 1.0),
        ("time_s,T,S", {"voltage_v": "T", "filtered_v": "S"}, 1000.0),
    ],
)
def test_files_and_streams_use_the_column(tmp_path: Path, recording, names, columns, factor):
    """Both find what the detector finds on the arrays, in volts or in millivolts."""
    time_s, samples, filtered = recording
    expected = intervals(time_s, make_detector("fast", CONTROLLER).process(samples, filtered).on)
    assert [round(i.onset_s, 1) for i in expected] == [1.2]
    lines = list(as_lines(recording, names, factor))
    path = tmp_path / "trace.csv"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    found = detect_file(path, CONTROLLER, "fast", scale=1 / factor, columns=columns)
    assert found.detection.intervals == pytest.approx(expected)
    assert not any("steps" in warning for warning in found.warnings)
    stream = detect_stream(lines, CONTROLLER, "fast", scale=1 / factor, columns=columns)
    archive = dict(
        zip(names.split(","), (time_s, factor * samples, factor * filtered), strict=True)
    )
    np.savez(tmp_path / "trace.npz", **archive)
    found = detect_file(
        tmp_path / "trace.npz", CONTROLLER, "fast", scale=1 / factor, columns=columns
    )
    assert found.detection.intervals == pytest.approx(expected)
    first = next(iter(stream.transitions))
    assert first.on
    assert first.time_s == pytest.approx(expected[0].onset_s)


def test_only_signals_that_a_detector_reads_are_simulated():
    assert select_board_outputs(CONTROLLER, ["digital", "fft"]) == []
    assert select_board_outputs(CONTROLLER, ["analog", "fast"]) == [
        "sampled_envelope_v",
        "sampled_filtered_v",
    ]
    assert select_board_outputs(ARTICLE, ["analog", "fast"]) == ["sampled_envelope_v"]


@pytest.mark.full
def test_simulated_traces_carry_the_filtered_signal():
    """The board's simulated signal is the high-pass of the voltage,
    and every finger of a hand has its own.
    """
    outputs = ["voltage_v", "slip", "sampled_filtered_v"]
    scene = SceneFile(
        scene="sliding_finger", slide={"distance_m": 0.04, "speed_m_s": 0.04}, outputs=outputs
    )
    trace = run_scene(CONTROLLER, scene, 1).trace
    assert trace.filtered_v is not None
    both = make_detector("fast", CONTROLLER).process(trace.voltage_v, trace.filtered_v)
    alone = make_detector("fast", CONTROLLER).process(trace.voltage_v)
    slipping = trace.slip
    assert np.corrcoef(both.filtered_v[slipping], alone.filtered_v[slipping])[0, 1] > 0.9
    hand = ManipulationFile(scene="hand", outputs=outputs)
    result = run_manipulation(CONTROLLER, hand, None, 1)
    signals = [result.trace(finger).filtered_v for finger in result.fingers]
    assert all(signal is not None for signal in signals)
    assert not np.array_equal(signals[0], signals[1])


@pytest.mark.parametrize("hz", [50.0, 76.0, 100.0])
def test_ripple_of_the_supply_is_noise_unless_it_begins_suddenly(hz: float) -> None:
    """The README of the board allows 320 mV for an envelope, and an eighth of that where it
    begins at once: it lies below the least threshold then.
    """
    t = np.arange(20_000) / RATE
    rng = np.random.default_rng(3)
    tactile = quantise(np.full(len(t), 0.79), rng)
    for ripple_v, begin_s in ((0.32, 0.0), (0.04, 4.0)):
        # 0.226 of the ripple reaches S at 76 Hz, the largest share.
        ripple = 0.226 * ripple_v * np.sin(2 * np.pi * hz * t) * (t >= begin_s)
        sampled = quantise(1.65 + ripple, rng)
        output = make_detector("fast", CONTROLLER).process(tactile, sampled)
        assert isinstance(output, FastOutput)
        assert not output.incipient.any()
