"""Options of `fingertip detect`: scale, columns, quiet start and plot."""

from __future__ import annotations

import json

import numpy as np
import pytest

import fingertip
from fingertip.design import Design
from tests.slip.recordings import ONSET, T, V, burst, csv, run, single_onset


@pytest.mark.full
def test_invalid_options_give_an_error(tmp_path):
    (tmp_path / "t.csv").write_text(csv(T, V))
    for words, message in (
        (("--column", "voltage_v"), "is not of the form COLUMN=NAME; write it as voltage_v=AI0"),
        (("--column", "volts=AI0"), "'volts' is not a column of a trace"),
        (("--scale", "0"), "is not a scale"),
        (("--rate-hz", "0"), "detector.sample_rate_hz"),
        (("--detector", "fats"), "did you mean fast"),
        (("--calibrate", "0:0.01"), "covers 20 samples of t.csv; choose at least 0.3 s"),
    ):
        done = run("detect", tmp_path / "t.csv", *words)
        assert done.exit_code == 2, words
        assert message in done.stderr, words


def test_a_force_is_detected_with_thresholds_from_a_quiet_part(tmp_path):
    (tmp_path / "t.csv").write_text(csv(T, 50 * (V - 3.9), header=("time_s", "force_n")))
    words = ("detect", tmp_path / "t.csv", "--column", "voltage_v=force_n")
    assert "thresholds are in volts, but this column is a force" in run(*words).stderr
    for detector in ("digital", "fft", "fast"):
        onset = single_onset(run(*words, "--calibrate", "0:0.4", "--detector", detector, "--json"))
        assert 0.5 < onset < 0.535


def test_adc_counts_are_converted_by_the_suggested_scale(tmp_path):
    (tmp_path / "t.csv").write_text(csv(T, np.round(V / 3.3 * 4096)))
    words = ("detect", tmp_path / "t.csv", "--json")
    assert "--scale 0.00080566406 converts counts of 12 bits to volts" in run(*words).stderr
    assert single_onset(run(*words, "--scale", 0.00080566406)) == pytest.approx(ONSET, abs=0.003)


@pytest.mark.full
def test_a_quiet_part_in_which_something_happens(tmp_path):
    (tmp_path / "t.csv").write_text(csv(T, V))
    for seconds in ("5", "1", "inf"):
        done = run("detect", tmp_path / "t.csv", "--calibrate", f"0:{seconds}")
        assert done.exit_code == 2
        assert "s covers all 0.9995 s of t.csv; choose a shorter part during which" in done.stderr
    for words in (("--calibrate", "0:-1"), ("--calibrate", "0:nan", "--detector", "analog")):
        assert (
            "s covers no sample of t.csv, which lasts 0.9995 s; choose an end after the start"
            in run("detect", tmp_path / "t.csv", *words).stderr
        )
    done = run("detect", tmp_path / "t.csv", "--calibrate", "0:0.9")
    assert "the signal is disturbed at 0.50" in done.stderr
    assert "within 0:0.9 s of --calibrate" in done.stderr
    assert "--calibrate" not in run("detect", tmp_path / "t.csv", "--calibrate", "0:0.4").stderr
    np.savez(tmp_path / "t.npz", time_s=T, voltage_v=V, slip=(T >= 0.5) & (T < 0.7))
    assert (
        "0:0.9 s covers slip, which begins at 0.5 s" in run("detect", tmp_path / "t.npz", "--calibrate", "0:0.9").stderr
    )


@pytest.mark.full
def test_slip_that_begins_while_the_detector_is_already_on(tmp_path):
    np.savez(tmp_path / "t.npz", time_s=T, voltage_v=V, slip=(T >= 0.6) & (T < 0.7))
    done = run("detect", tmp_path / "t.npz", "--plot", tmp_path / "p.png")
    assert f"already ON {round(1000 * (0.6 - ONSET), 1):g} ms before onset" in done.stdout
    assert "detected after -" not in done.stdout


def test_detect_file_in_python_gives_the_result_of_the_command(tmp_path):
    t, v = burst(5000)
    (tmp_path / "t.csv").write_text(csv(t, v, header=("t", "AI0")))
    progress: list[str] = []
    columns = {"time_s": "t", "voltage_v": "AI0"}
    found = fingertip.detect_file(tmp_path / "t.csv", columns=columns, calibrate_s=(0.0, 0.4), progress=progress.append)
    words = ("--column", "time_s=t", "--column", "voltage_v=AI0", "--calibrate", "0:0.4", "--json")
    done = run("detect", tmp_path / "t.csv", *words)
    assert found.detection.intervals[0].onset_s == pytest.approx(single_onset(done))
    assert found.design.detector.sample_rate_hz == 5000
    assert progress == done.stderr.splitlines()
    assert found.warnings == ()


def test_detect_file_in_python_adapts_a_design_that_states_no_rate(tmp_path):
    t, v = burst(5000)
    (tmp_path / "t.csv").write_text(csv(t, v))
    chosen = Design(detector={"threshold_v": 0.0123})
    assert fingertip.detect_file(tmp_path / "t.csv", chosen).detection.threshold_v == 0.0123
    rescaled = fingertip.detect_file(tmp_path / "t.csv", chosen, keep_threshold=False)
    assert rescaled.detection.threshold_v != pytest.approx(0.0123, rel=0.05)
    for arguments in ({"design": Design(detector={"sample_rate_hz": 2000.0})}, {"adapt_to_file": False}):
        with pytest.raises(fingertip.FingertipError, match="sampled at 5000 Hz, but the detector is designed for 2000"):
            fingertip.detect_file(tmp_path / "t.csv", **arguments)


def test_the_shortest_quiet_part_in_the_message_is_long_enough(tmp_path):
    (tmp_path / "t.csv").write_text(csv(T, V))
    for detector, seconds in (("fast", "0.3"), ("analog", "0.33")):
        words = ("detect", tmp_path / "t.csv", "--detector", detector, "--calibrate")
        assert f"covers 1 sample of t.csv; choose at least {seconds} s." in run(*words, "0:0.0001").stderr
        assert run(*words, f"0:{seconds}").exit_code == 0


def test_a_quiet_part_without_noise_gives_no_threshold(tmp_path):
    """The force of a simulated trace is constant until contact."""
    force = np.where(T < 0.3, 0.0, np.abs(V - 3.9))
    (tmp_path / "t.csv").write_text(csv(T, force, header=("time_s", "force_n")))
    words = ("detect", tmp_path / "t.csv", "--column", "voltage_v=force_n", "--detector", "fast", "--calibrate")
    message = "a signal without noise gives no threshold; use a measured signal"
    constant = run(*words, "0:0.3")
    assert constant.exit_code == 2
    assert f"covers a constant part of t.csv: {message}" in constant.stderr
    assert f"constant up to 0.2995 s, within 0:0.4 s of --calibrate: {message}" in run(*words, "0:0.4").stderr


@pytest.mark.full
def test_calibration_on_any_interval(tmp_path):
    """Noise that begins with the grasp is calibrated there: an interval in the air gives a lower threshold."""
    rng = np.random.default_rng(8)
    t = np.arange(12_000) / 2000
    volts = 2.6 + rng.normal(0, 4e-4, len(t)) + (t > 3.0) * (rng.normal(0, 1.2e-3, len(t)) - 0.3)
    (tmp_path / "t.csv").write_text(csv(t, volts))

    def threshold_v(interval: str) -> float:
        return json.loads(run("detect", tmp_path / "t.csv", "--calibrate", interval, "--json").stdout)["threshold_v"]

    assert threshold_v("4.0:4.5") == pytest.approx(threshold_v("5:5.9"), rel=0.25)
    assert threshold_v("4.0:4.5") > 2 * threshold_v("0.5:2.5")
    found = run("detect", tmp_path / "t.csv", "--calibrate", "2.5:3.5")
    assert "the signal is disturbed at 3.0" in found.stderr
    for words, message in (
        ("4.0", "'4.0' is not of the form START:END in seconds; write it as 4.0:4.5."),
        ("9:9.5", "9:9.5 s covers no sample of t.csv, which lasts 6 s"),
        ("4:4.1", "covers 200 samples of t.csv; choose at least 0.3 s"),
        ("0:9", "0:9 s covers all 6 s of t.csv; choose a shorter part"),
    ):
        refused = run("detect", tmp_path / "t.csv", "--calibrate", words)
        assert refused.exit_code == 2
        assert message in " ".join(refused.stderr.split())
