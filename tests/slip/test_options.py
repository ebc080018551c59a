"""Options of `fingertip detect`: scale, columns, quiet start and plot."""

from __future__ import annotations

import numpy as np
import pytest

import fingertip
from fingertip.design import Design
from tests.slip.recordings import ONSET, T, V, burst, csv, run, single_onset


def test_invalid_options_give_an_error(tmp_path):
    (tmp_path / "t.csv").write_text(csv(T, V))
    for words, message in (
        (("--column", "voltage_v"), "is not of the form COLUMN=NAME; write it as voltage_v=AI0"),
        (("--column", "volts=AI0"), "'volts' is not a column of a trace"),
        (("--scale", "0"), "is not a scale"),
        (("--rate-hz", "0"), "detector.sample_rate_hz"),
        (("--detector", "fats"), "did you mean fast"),
        (("--quiet-s", "0.01"), "covers 20 samples of t.csv; choose at least 0.3 s"),
    ):
        done = run("detect", tmp_path / "t.csv", *words)
        assert done.exit_code == 2, words
        assert message in done.stderr, words


def test_a_force_is_detected_with_thresholds_from_a_quiet_start(tmp_path):
    (tmp_path / "t.csv").write_text(csv(T, 50 * (V - 3.9), header=("time_s", "force_n")))
    words = ("detect", tmp_path / "t.csv", "--column", "voltage_v=force_n")
    assert "thresholds are in volts, but this column is a force" in run(*words).stderr
    for detector in ("digital", "fft", "fast"):
        onset = single_onset(run(*words, "--quiet-s", 0.4, "--detector", detector, "--json"))
        assert 0.5 < onset < 0.535


def test_adc_counts_are_converted_by_the_suggested_scale(tmp_path):
    (tmp_path / "t.csv").write_text(csv(T, np.round(V / 20 * 65536)))
    words = ("detect", tmp_path / "t.csv", "--json")
    assert "--scale 0.00030517578 converts counts to volts" in run(*words).stderr
    assert single_onset(run(*words, "--scale", 0.00030517578)) == pytest.approx(ONSET, abs=0.003)


def test_a_quiet_start_in_which_something_happens(tmp_path):
    (tmp_path / "t.csv").write_text(csv(T, V))
    for seconds in ("5", "1", "inf"):
        done = run("detect", tmp_path / "t.csv", "--quiet-s", seconds)
        assert done.exit_code == 2
        assert "s covers all 0.9995 s of t.csv; choose a shorter part at the start" in done.stderr
    for words in (("--quiet-s", "-1"), ("--quiet-s", "nan", "--detector", "analog")):
        assert "s covers no sample; choose a value above 0 s" in run("detect", tmp_path / "t.csv", *words).stderr
    done = run("detect", tmp_path / "t.csv", "--quiet-s", "0.9")
    assert "the signal is disturbed at 0.50" in done.stderr
    assert "within the 0.9 s of --quiet-s" in done.stderr
    assert "--quiet-s" not in run("detect", tmp_path / "t.csv", "--quiet-s", "0.4").stderr
    np.savez(tmp_path / "t.npz", time_s=T, voltage_v=V, slip=(T >= 0.5) & (T < 0.7))
    assert "0.9 s covers slip, which begins at 0.5 s" in run("detect", tmp_path / "t.npz", "--quiet-s", "0.9").stderr


@pytest.mark.slow
def test_slip_that_begins_while_the_detector_is_already_on(tmp_path):
    np.savez(tmp_path / "t.npz", time_s=T, voltage_v=V, slip=(T >= 0.6) & (T < 0.7))
    done = run("detect", tmp_path / "t.npz", "--plot", tmp_path / "p.png")
    assert f"already ON {round(1000 * (0.6 - ONSET), 1):g} ms before onset" in done.stdout
    assert "detected after -" not in done.stdout


def test_a_plot_must_have_the_suffix_png(tmp_path):
    (tmp_path / "t.csv").write_text(csv(T, V))
    for words in (("detect", tmp_path / "t.csv"), ("simulate", "--out", tmp_path / "s.csv")):
        done = run(*words, "--plot", tmp_path / "p.svg")
        assert done.exit_code == 2
        assert "'p.svg' is not the name of a PNG file, the only format written; end it in .png" in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["t.csv"]


def test_detect_file_in_python_gives_the_result_of_the_command(tmp_path):
    t, v = burst(5000)
    (tmp_path / "t.csv").write_text(csv(t, v, header=("t", "AI0")))
    progress: list[str] = []
    columns = {"time_s": "t", "voltage_v": "AI0"}
    found = fingertip.detect_file(tmp_path / "t.csv", columns=columns, quiet_s=0.4, progress=progress.append)
    words = ("--column", "time_s=t", "--column", "voltage_v=AI0", "--quiet-s", 0.4, "--json")
    done = run("detect", tmp_path / "t.csv", *words)
    assert found.detection.intervals[0].onset_s == pytest.approx(single_onset(done))
    assert found.design.detector.sample_rate_hz == 5000
    assert progress == done.stderr.splitlines()
    assert found.warnings == ()


def test_detect_file_in_python_returns_warnings(tmp_path):
    (tmp_path / "t.csv").write_text(csv(T, np.full(len(T), 4.0)))
    design = Design(detector={"threshold_v": 0.001})
    constant, threshold = fingertip.detect_file(tmp_path / "t.csv", design).warnings
    assert constant == "the voltage is constant at 4 V; is a sensor connected?"
    assert "is below the mean noise level" in threshold


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


def test_the_shortest_quiet_start_in_the_message_is_long_enough(tmp_path):
    (tmp_path / "t.csv").write_text(csv(T, V))
    for detector, seconds in (("fast", "0.3"), ("analog", "0.33")):
        words = ("detect", tmp_path / "t.csv", "--detector", detector, "--quiet-s")
        assert f"covers 1 sample of t.csv; choose at least {seconds} s." in run(*words, "0.0001").stderr
        assert run(*words, seconds).exit_code == 0


def test_a_quiet_start_without_noise_gives_no_threshold(tmp_path):
    """The force of a simulated trace is constant until contact."""
    force = np.where(T < 0.3, 0.0, np.abs(V - 3.9))
    (tmp_path / "t.csv").write_text(csv(T, force, header=("time_s", "force_n")))
    words = ("detect", tmp_path / "t.csv", "--column", "voltage_v=force_n", "--detector", "fast", "--quiet-s")
    message = "a signal without noise gives no threshold; use a measured signal"
    constant = run(*words, 0.3)
    assert constant.exit_code == 2
    assert f"covers a constant part of t.csv: {message}" in constant.stderr
    assert f"constant up to 0.2995 s, within the 0.4 s of --quiet-s: {message}" in run(*words, 0.4).stderr
