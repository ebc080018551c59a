"""Detector `analog`: on a recorded envelope, and on the output of a simulated board."""

from __future__ import annotations

import json
import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fingertip.design import Design
from fingertip.foundation.errors import TraceError
from fingertip.sim.signal.converter import SimulatedBoardDetector, simulate_envelope_v
from fingertip.slip import Trace, detect, make_detector
from fingertip.slip.detectors.analog_and_digital import AnalogDetector
from tests.slip.recordings import ONSET, T, V, csv, run, single_onset

ARTICLE_DESIGN = ("--design", "article")


def test_the_board_is_simulated_for_a_recording_without_envelope(tmp_path):
    (tmp_path / "t.csv").write_text(csv(T, V))
    done = run("detect", tmp_path / "t.csv", "--detector", "analog", "--json")
    assert single_onset(done) == pytest.approx(ONSET, abs=0.006)
    assert "has no column envelope_v: simulating the design's board for the column voltage_v" in done.stderr
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


@pytest.mark.full
def test_a_recorded_envelope_is_used(tmp_path):
    envelope = np.where((T >= 0.5) & (T < 0.7), 0.2, 0.001)
    np.savez(tmp_path / "t.npz", time_s=T, voltage_v=V, envelope_v=envelope)
    done = run("detect", tmp_path / "t.npz", "--detector", "analog", *ARTICLE_DESIGN, "--json")
    assert "simulating" not in done.stderr
    assert single_onset(done) == 0.5 + 4 / 2000  # five of sixty samples of 0.2 V: 17.6 mV
    quiet = run("detect", tmp_path / "t.npz", "--detector", "analog", "--calibrate", "0:0.4", *ARTICLE_DESIGN, "--json")
    assert json.loads(quiet.stdout)["threshold_v"] == pytest.approx(0.001 + 20 / 65536, abs=1e-4)
    assert (
        "covers 600 samples" in run("detect", tmp_path / "t.npz", "--detector", "analog", "--calibrate", "0:0.3").stderr
    )
    # A recording that contains only the board's output.
    (tmp_path / "e.csv").write_text(csv(T, envelope, header=("time_s", "AI1")))
    both = ("--column", "voltage_v=AI1", "--column", "envelope_v=AI1")
    assert (
        single_onset(run("detect", tmp_path / "e.csv", "--detector", "analog", *both, *ARTICLE_DESIGN, "--json"))
        == 0.502
    )
    # The same recording as a stream.
    lines = run(
        "detect",
        "-",
        "--detector",
        "analog",
        "--json",
        *ARTICLE_DESIGN,
        lines=csv(T, envelope, header=("time_s", "envelope_v")),
    )
    assert json.loads(lines.stdout)["transitions"][0] == {"on": True, "time_s": 0.502}


@pytest.mark.full
def test_a_stream_on_a_simulated_board_gives_the_same_transitions_as_the_file(tmp_path):
    (tmp_path / "t.csv").write_text(csv(T, V))
    words = ("--detector", "analog", "--json")
    whole = json.loads(run("detect", tmp_path / "t.csv", *words).stdout)["intervals"]
    done = run("detect", "-", *words, lines=csv(T, V))
    assert "simulating the design's board" in done.stderr
    transitions = json.loads(done.stdout)["transitions"]
    assert [change["time_s"] for change in transitions] == [time for i in whole for time in (i["onset_s"], i["end_s"])]
    force = run("detect", "-", *words, "--column", "voltage_v=force_n", lines=csv(T, V, header=("time_s", "force_n")))
    assert "names a force, whose thresholds require --calibrate and the whole recording" in force.stderr + force.stdout


@pytest.mark.full
@settings(max_examples=10)
@given(sizes=st.lists(st.integers(0, 400), max_size=6))
def test_a_simulated_board_gives_the_same_bits_in_any_chunks_even_if_pickled(sizes):
    design = Design(board={"variant": "precision"})
    whole = make_detector("analog", design).process(simulate_envelope_v(design, V))
    detector, parts, start = SimulatedBoardDetector(design), [], 0
    for size in [*sizes, len(V)]:
        parts.append(detector.process(V[start : start + size]))
        start += size
        detector = pickle.loads(pickle.dumps(detector))
    for field in ("statistic_v", "on"):
        assert np.concatenate([getattr(part, field) for part in parts]).tobytes() == getattr(whole, field).tobytes()
    assert detector.threshold_v == whole.threshold_v[0]
    stepping = SimulatedBoardDetector(design)
    assert [stepping.step(x) for x in V[:300].tolist()] == whole.on[:300].tolist()


def test_a_force_passes_the_simulated_bridge(tmp_path):
    force = 1.0 + 0.05 * np.sin(2 * np.pi * 90 * T) * ((T >= 0.5) & (T < 0.7))
    (tmp_path / "t.csv").write_text(csv(T, force, header=("time_s", "force_n")))
    words = ("--column", "voltage_v=force_n", "--detector", "analog", "--json")
    assert 0.5 < single_onset(run("detect", tmp_path / "t.csv", *words)) < 0.52


def test_an_envelope_recorded_against_ground_gives_a_warning(tmp_path):
    """E of a board for a controller rests at its signal ground, 1.47 V; the envelope is E minus M."""
    envelope = 0.002 + 0.1 * ((T >= 0.5) & (T < 0.7))
    for rest_v, supply, is_warned in ((1.475, "single_3v3", True), (0.0, "single_3v3", False), (1.475, "split", False)):
        np.savez(tmp_path / "t.npz", time_s=T, voltage_v=V, envelope_v=envelope + rest_v)
        supply_v = 3.3 if supply == "single_3v3" else 5
        changes = ("--set", f"board.supply={supply}", "--set", f"board.supply_v={supply_v}")
        done = run("detect", tmp_path / "t.npz", "--detector", "analog", *changes)
        assert done.exit_code == 0, done.stderr
        assert ("The envelope is E minus M: subtract" in done.stderr) == is_warned, (rest_v, supply)


def test_detect_requires_an_envelope_for_analog():
    with pytest.raises(TraceError, match="envelope_v: is missing: the detector analog works on the board's output"):
        detect(Trace(T, V), Design(), "analog")


def test_digital_agrees_with_a_simulated_board_without_dead_zone():
    """The means differ by less than 5 %, the flags in less than 1 % of the samples.

    The differences have two causes: the simulated board is linear between samples, which the bilinear transform is not,
    and it is built of preferred values.
    """
    design = Design(board={"variant": "precision"})
    digital = make_detector("digital", design).process(V)
    analog = make_detector("analog", design).process(simulate_envelope_v(design, V))
    during = (T >= 0.53) & (T < 0.7)
    difference = analog.statistic_v[during] - digital.statistic_v[during]
    assert np.sqrt(np.mean(difference**2)) < 0.05 * np.sqrt(np.mean(digital.statistic_v[during] ** 2))
    assert np.mean(analog.on != digital.on) < 0.01
