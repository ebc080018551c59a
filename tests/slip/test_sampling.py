"""Other sampling rates than the design's: adaptation of filters, window and threshold, and rounded times."""

from __future__ import annotations

import json
import re
import shlex

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.detection.adaptation import adapt_rate
from fingertip.foundation.errors import FingertipError
from fingertip.slip import make_detector
from fingertip.slip.detectors.analog_and_digital import noise_level
from fingertip.slip.traces.sampling import MAX_RATE_HZ, MIN_RATE_HZ, find_rounding, rate_bounds_message
from tests.conftest import design_file
from tests.slip.recordings import T, burst, csv, run, single_onset

DESIGN = design_file("fsr400")


@pytest.mark.full
@pytest.mark.parametrize("rate", [1000, 5000, 20000])
@pytest.mark.parametrize("detector", ["digital", "fft", "fast"])
def test_detectors_adapt_to_the_sampling_rate_of_a_file(tmp_path, rate, detector):
    t, v = burst(rate)
    (tmp_path / "t.csv").write_text(csv(t, v))
    done = run("detect", tmp_path / "t.csv", "--detector", detector, "--json")
    assert f"is sampled at {rate} Hz: filters, window and threshold adapted to {rate} Hz" in done.stderr
    assert 0.5 < single_onset(done) < {"digital": 0.525, "fft": 0.54, "fast": 0.506}[detector]
    stated = run("detect", tmp_path / "t.csv", "--detector", detector, "--rate-hz", rate, "--json")
    assert stated.stdout == done.stdout
    # A stated rate is not adapted.
    for options in (("--set", "detector.sample_rate_hz=2000"), ("--design", DESIGN), ("--rate-hz", 2000)):
        done = run("detect", tmp_path / "t.csv", *options)
        assert done.exit_code == 2
        assert f"is sampled at {rate} Hz, but the detector is designed for 2000 Hz" in done.stderr


def test_adaptation_keeps_the_windows_duration_and_the_ratio_of_threshold_to_noise():
    adapted = adapt_rate(Design(), 8000.0)
    assert adapted.detector.window_samples == 240
    ratio = adapted.detector.threshold_v / noise_level(adapted).threshold_v
    assert ratio == pytest.approx(Design().detector.threshold_v / noise_level(Design()).threshold_v)
    assert adapt_rate(Design(), 2000.0) == Design()


def test_a_stated_threshold_does_not_change_with_the_rate(tmp_path):
    t, v = burst(5000)
    (tmp_path / "t.csv").write_text(csv(t, v))
    (tmp_path / "d.toml").write_text("[detector]\nthreshold_v = 0.0123\n")
    rate, mine = ("--rate-hz", 5000), ("--set", "detector.threshold_v=0.0123")
    default, adapted = Design().detector.threshold_v, adapt_rate(Design(), 5000.0).detector.threshold_v
    assert adapted != pytest.approx(default, rel=0.05)
    for words, volts, message in (
        ((), adapted, f"the threshold is {adapted:.3g} V"),
        (
            mine,
            0.0123,
            "filters and window adapted to 5000 Hz; the window is 150 samples, 30 ms; the threshold remains 0.0123 V",
        ),
        (
            (*rate, *mine),
            0.0123,
            "filters and window adapted to 5000 Hz; the window is 150 samples, 30 ms; the threshold remains 0.0123 V",
        ),
        ((*rate, "--design", tmp_path / "d.toml"), 0.0123, "remains 0.0123 V, as set"),
        (
            ("--detector", "analog"),
            default,
            f"the threshold remains {default:g} V, as it applies to the board's output",
        ),
        (
            (*rate, "--detector", "analog"),
            default,
            f"the threshold remains {default:g} V, as it applies to the board's output",
        ),
    ):
        done = run("detect", tmp_path / "t.csv", *words, "--json")
        assert json.loads(done.stdout)["threshold_v"] == pytest.approx(volts, abs=2e-6), words
        assert message in done.stderr, words
    fast = run("detect", tmp_path / "t.csv", "--detector", "fast")
    assert "filters, window and threshold adapted to 5000 Hz; the window is 150 samples, 30 ms\n" in fast.stderr


@pytest.mark.full
def test_a_window_given_by_set_does_not_change_with_the_rate(tmp_path):
    t, v = burst(10_000)
    (tmp_path / "t.csv").write_text(csv(t, v))
    (tmp_path / "d.toml").write_text("[detector]\nwindow_samples = 90\n")
    rate, mine = ("--rate-hz", 10_000), ("--set", "detector.window_samples=400")
    both = (*mine, "--set", "detector.threshold_v=0.0123")
    for words, message in (
        ((), "filters, window and threshold adapted to 10000 Hz; the window is 300 samples, 30 ms; the threshold is"),
        (mine, "filters and threshold adapted to 10000 Hz; the window remains 400 samples, 40 ms, as set"),
        ((*rate, *mine), "filters and threshold adapted to 10000 Hz; the window remains 400 samples, 40 ms, as set"),
        ((*rate, *both), "filters adapted to 10000 Hz; the window remains 400 samples, 40 ms, as set; the threshold"),
        ((*rate, "--design", tmp_path / "d.toml"), "the window is 450 samples, 45 ms"),
    ):
        assert message in run("detect", tmp_path / "t.csv", *words).stderr, words
    # A window of the default duration has the default threshold.
    same_duration = adapt_rate(Design(detector={"window_samples": 300}), 10_000.0, keep_window=True).detector
    assert same_duration == adapt_rate(Design(), 10_000.0).detector
    # The detector uses this window; not only the message states it.
    output = run("detect", tmp_path / "t.csv", *rate, *mine, "--json").stdout
    detector = make_detector(
        "digital", adapt_rate(Design(detector={"window_samples": 400}), 10_000.0, keep_window=True)
    )
    expected = t[np.flatnonzero(detector.process(np.round(v, 6)).on)[0]]
    assert json.loads(output)["intervals"][0]["onset_s"] == pytest.approx(expected)


@pytest.mark.full
@pytest.mark.parametrize("rate", [1200, 2000, 3000, 5000])
@pytest.mark.parametrize("cut", [np.floor, np.round])
def test_rounded_times_are_ignored_with_the_options_in_the_message(tmp_path, rate, cut):
    t, v = burst(rate)
    coarse = cut(np.round(1000 * t, 6)) / 1000
    (tmp_path / "t.csv").write_text(csv(coarse, v))
    np.savez(tmp_path / "t.npz", time_s=coarse, voltage_v=v)
    np.save(tmp_path / "t.npy", np.column_stack((coarse, v)))
    for name in ("t.csv", "t.npz", "t.npy"):
        onsets = set()
        for stated in ((), ("--rate-hz", rate)):
            done = run("detect", tmp_path / name, *stated)
            assert done.exit_code == 2
            (message,) = [line for line in done.stderr.splitlines() if line.startswith("error")]
            assert f"the times are rounded to 0.001 s, at a mean rate of {rate} Hz" in message
            assert "is sampled at" not in done.stderr
            remedy = shlex.split(re.search(r"ignore them with (.*)\.$", message)[1])
            assert remedy == ["--rate-hz", str(rate), "--column", "time_s=none"]
            onsets.add(single_onset(run("detect", tmp_path / name, *remedy, "--json")))
        (onset,) = onsets
        assert 0.5 < onset < 0.525
    live = run("detect", "-", "--rate-hz", rate, lines=csv(np.floor(1000 * t) / 1000, v)).stderr
    assert "ignore rounded times with --column time_s=none" in live


def test_only_evenly_spaced_times_are_recognised_as_rounded():
    assert find_rounding(T) is None
    assert find_rounding(np.zeros(100)) is None
    assert find_rounding(np.sort(np.append(T, T[7]))) is None  # one
    assert find_rounding(np.sort(np.append(T, T[:300]))) is None  # many, all at the start
    assert find_rounding(np.where(np.arange(2000) % 2, T - 0.001, T)[::-1]) is None  # backwards
    whole = find_rounding(np.floor(T * 4))  # whole seconds do not determine the rate
    assert whole is not None
    assert whole.rate_hz is None
    assert find_rounding(np.round(np.arange(100_000) / 4567, 3)).rate_hz == pytest.approx(4567, rel=1e-4)


def test_bounds_of_the_sampling_rate_are_those_of_a_design():
    for rate in (MIN_RATE_HZ, MAX_RATE_HZ):
        assert Design(detector={"sample_rate_hz": rate})
        assert rate_bounds_message(rate) is None
    for rate in (0.99 * MIN_RATE_HZ, 1.01 * MAX_RATE_HZ):
        with pytest.raises(FingertipError):
            Design(detector={"sample_rate_hz": rate})
        assert rate_bounds_message(rate)
