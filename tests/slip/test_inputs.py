"""What people bring: other delimiters, formats, rates, units, a stream of lines; and what is wrong with it."""

from __future__ import annotations

import json
import pickle
import re
import sys
import types

import numpy as np
import pytest
from fingertip.slip.traces.parsed import Wanted
from hypothesis import given, settings
from hypothesis import strategies as st

from fingertip.design import Design
from fingertip.errors import MissingLibraryError
from fingertip.slip import make_detector
from fingertip.slip.rate_adaptation import adapt_rate
from fingertip.slip.traces.read import parse
from tests.conftest import design_file
from tests.slip.recordings import ONSET, T, V, burst, csv, run, the_onset


@pytest.mark.parametrize(("delimiter", "comma"), [(",", False), (";", False), (";", True), ("\t", False), ("\t", True)])
def test_delimiters(tmp_path, delimiter, comma):
    (tmp_path / "t.txt").write_text(csv(T, V, delimiter, comma=comma))
    assert the_onset(run("detect", tmp_path / "t.txt", "--json")) == ONSET


@pytest.mark.parametrize(("delimiter", "comma"), [(",", False), (";", True)])
def test_quoted_numbers(tmp_path, delimiter, comma):
    text = re.sub(f"[^{delimiter}\n]+", r'"\g<0>"', csv(T, V, delimiter, comma=comma))
    assert text.splitlines()[1].startswith('"0,000000";"' if comma else '"0.000000","')
    (tmp_path / "t.csv").write_text(text)
    assert the_onset(run("detect", tmp_path / "t.csv", "--json")) == ONSET
    told = json.loads(run("detect", "-", "--json", lines=text).stdout)["changes"]
    assert told[0] == {"on": True, "time_s": ONSET}
    (tmp_path / "t.csv").write_text(text.replace('"0' + ("," if comma else ".") + '000500"', '"NA"'))
    refused = run("detect", tmp_path / "t.csv").stderr
    assert "'\"NA\"' in line 3 is not a number" in refused


def test_numpy_files(tmp_path):
    v = np.round(V, 6)
    np.savez(tmp_path / "a.npz", time_s=T, voltage_v=v, slip=(T >= 0.5) & (T < 0.7))
    np.savez(tmp_path / "b.npz", voltage_v=v, sample_rate_hz=2000)
    np.save(tmp_path / "c.npy", v)
    np.save(tmp_path / "d.npy", np.column_stack((T, v)))
    np.savez(tmp_path / "e.npz", t=T, AI0=v)
    done = run("detect", tmp_path / "a.npz", "--json")
    assert the_onset(done) == ONSET
    assert json.loads(done.stdout)["delays_s"] == [pytest.approx(ONSET - 0.5)]
    for words in (
        ("b.npz",),
        ("c.npy", "--rate-hz", 2000),
        ("d.npy",),
        ("e.npz", "--column", "time_s=t", "--column", "voltage_v=AI0"),
    ):
        assert the_onset(run("detect", tmp_path / words[0], *words[1:], "--json")) == ONSET, words


def test_what_simulate_writes_is_read_again(tmp_path):
    onsets = []
    for end in ("csv", "npz"):
        assert run("simulate", "--out", tmp_path / f"t.{end}", "--seed", 4).exit_code == 0
        onsets.append(the_onset(run("detect", tmp_path / f"t.{end}", "--detector", "fast", "--json")))
    assert onsets[0] == onsets[1]


def test_tdms_by_its_library(tmp_path):
    nptdms = pytest.importorskip("nptdms", reason="the tdms extra is not installed; its stand-in is tested below")
    channel = nptdms.ChannelObject("group", "AI0", np.round(V, 6), properties={"wf_increment": 1 / 2000})
    with nptdms.TdmsWriter(tmp_path / "t.tdms") as writer:
        writer.write_segment([channel])
    assert the_onset(run("detect", tmp_path / "t.tdms", "--json")) == ONSET


class Channel:
    name, properties = "AI0", {"wf_increment": 1 / 2000}

    def __getitem__(self, _):
        return np.round(V, 6)


def test_tdms_by_a_stand_in(tmp_path, monkeypatch):
    group = types.SimpleNamespace(channels=lambda: [Channel()])
    file = types.SimpleNamespace(read=lambda path: types.SimpleNamespace(groups=lambda: [group]))
    monkeypatch.setitem(sys.modules, "nptdms", types.SimpleNamespace(TdmsFile=file))
    (tmp_path / "t.tdms").write_bytes(b"TDSm")
    assert the_onset(run("detect", tmp_path / "t.tdms", "--json")) == ONSET


def test_tdms_without_its_library(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "nptdms", None)
    with pytest.raises(MissingLibraryError, match="pip install 'fingertip\\[tdms\\]'"):
        parse(tmp_path / "t.tdms", Wanted())


@pytest.mark.parametrize("rate", [1000, 5000, 20000])
@pytest.mark.parametrize("detector", ["digital", "fft", "fast"])
def test_other_rates(tmp_path, rate, detector):
    t, v = burst(rate)
    (tmp_path / "t.csv").write_text(csv(t, v))
    done = run("detect", tmp_path / "t.csv", "--detector", detector, "--json")
    assert f"is sampled at {rate} Hz: filters, window and threshold are made for that" in done.stderr
    assert 0.5 < the_onset(done) < {"digital": 0.525, "fft": 0.54, "fast": 0.506}[detector]
    given = run("detect", tmp_path / "t.csv", "--detector", detector, "--rate-hz", rate, "--json")
    assert given.stdout == done.stdout
    # A rate that was stated is kept to.
    for stated in (("--set", "detector.sample_rate_hz=2000"), ("--design", DESIGN), ("--rate-hz", 2000)):
        refused = run("detect", tmp_path / "t.csv", *stated)
        assert refused.exit_code == 2
        assert f"is sampled at {rate} Hz, the detector is designed for 2000 Hz" in refused.stderr


DESIGN = design_file("fsr400")


def test_another_rate_keeps_the_windows_duration_and_the_thresholds_place():
    from fingertip.slip.detectors.noise import noise_level

    anew = adapt_rate(Design(), 8000.0)
    assert anew.detector.window_samples == 240
    ratio = anew.detector.threshold_v / noise_level(anew).threshold_v
    assert ratio == pytest.approx(Design().detector.threshold_v / noise_level(Design()).threshold_v)
    assert adapt_rate(Design(), 2000.0) == Design()


def test_a_force_and_a_noise_that_was_measured(tmp_path):
    (tmp_path / "t.csv").write_text(csv(T, 50 * (V - 3.9), header=("time_s", "force_n")))
    words = ("detect", tmp_path / "t.csv", "--column", "voltage_v=force_n")
    assert "thresholds are in volts" in run(*words).stderr
    for detector in ("digital", "fft", "fast"):
        onset = the_onset(run(*words, "--quiet-s", 0.4, "--detector", detector, "--json"))
        assert 0.5 < onset < 0.535


def test_counts_with_a_scale(tmp_path):
    (tmp_path / "t.csv").write_text(csv(T, np.round(V / 20 * 65536)))
    words = ("detect", tmp_path / "t.csv", "--json")
    assert "--scale 0.00030517578 makes volts of them" in run(*words).stderr
    assert the_onset(run(*words, "--scale", 0.00030517578)) == pytest.approx(ONSET, abs=0.003)


# What is wrong: words of the command, the file's text, what is said, the exit code.
SHORT = slice(0, 10)
HELD = (np.arange(2000) < 300) | (np.arange(2000) >= 400)
BAD = {
    "constant": (csv(T, np.full(2000, 4.0)), "the voltage is 4 V throughout: is a sensor connected?", 0),
    "saturated": (csv(T, np.minimum(V + 6.0, 10.0)), "samples stand at an end of the converter's range", 0),
    "all nan": (csv(T, np.full(2000, np.nan)), "nan in line 2, and 1999 more after it, is not a finite number", 2),
    "ten samples": (csv(T[SHORT], V[SHORT]), "holds 10 samples; at least one window of 60", 2),
    "wrong delimiter": (csv(T, V, "|"), "has its names apart by neither comma, semicolon nor tab", 2),
    "decimal commas between commas": (csv(T, V, comma=True), "has 4 cells, the header 2", 2),
    "negative time": (csv(T - 0.3, V), "", 0),  # a trigger's time is an origin like any other
    "time that runs backwards": (csv(-T, V), "does not advance in most of its steps", 2),
    "duplicate times": (csv(np.floor(T * 1000) / 1000, V), "0 s in line 3 repeats the time before it, and 999", 2),
    "one duplicate": (csv(np.sort(np.append(T[1:], T[7])), V), "0.0035 s in line 9 repeats the time before it", 2),
    "rate changing midway": (csv(np.where(T < 0.5, T, 0.5 + 3 * (T - 0.5)), V), "comes after a gap", 2),
    "counts": (csv(T, np.round(V / 20 * 65536)), "whole numbers throughout look like its counts", 2),
    "millivolts": (csv(T, 1000 * V), "is beyond the converter's 10 V; give --scale", 2),
    "milliseconds": (csv(1000 * T, V), "time_s: is sampled at 2 Hz, which no detector is made for", 2),
    "too slow": (csv(*burst(500.0)), "time_s: is sampled at 500 Hz, which no detector is made for", 2),
    "a gap": (csv(T[HELD], V[HELD]), "0.2 s in line 302 comes after a gap", 2),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_a_sentence_or_a_correct_answer(tmp_path, name):
    text, sentence, code = BAD[name]
    (tmp_path / "t.csv").write_text(text)
    done = run("detect", tmp_path / "t.csv")
    assert done.exit_code == code, done.stderr
    assert sentence in done.stderr
    assert "Traceback" not in done.stderr
    expected = {"constant": "never ON", "saturated": "ON", "negative time": "ON"}
    assert done.stdout.startswith(expected[name]) if code == 0 else done.stdout == ""


ARRAYS = {
    "objects": ({"time_s": T, "voltage_v": np.array(["a"] * 2000)}, "give an array of numbers"),
    "no voltage": ({"time_s": T, "volts": V}, "did you mean volts? Or name the file's column: --column voltage_v="),
    "no time": ({"voltage_v": V}, "Or give --rate-hz, or sample_rate_hz in the file"),
    "other length": ({"time_s": T, "voltage_v": V[:-1]}, "has shape (1999,), time_s (2000,)"),
    "two columns": ({"time_s": T, "voltage_v": np.column_stack((V, V))}, "has shape (2000, 2)"),
    "infinite": ({"time_s": T, "voltage_v": np.where(T == 0.1, np.inf, V)}, "inf at sample 200 is not a finite"),
}


@pytest.mark.parametrize("name", ARRAYS)
def test_bad_arrays(tmp_path, name):
    arrays, sentence = ARRAYS[name]
    np.savez(tmp_path / "t.npz", **arrays)
    done = run("detect", tmp_path / "t.npz")
    assert done.exit_code == 2
    assert sentence in done.stderr


RATES = {
    "words": (np.array("2 kHz"), "holds '2 kHz'"),
    "nothing": (np.zeros(0), "holds no value"),
    "zero": (0, "holds 0"),
    "nan": (np.nan, "holds nan"),
    "infinite": (np.inf, "holds inf"),
    "negative": (-2000.0, "holds -2000.0"),
    "two": (np.array([2000.0, 5000.0]), "holds 2 values"),
    "complex": (2000 + 1j, "holds (2000+1j)"),
}


@pytest.mark.parametrize("name", RATES)
def test_rates_that_are_none(tmp_path, name):
    stated, sentence = RATES[name]
    np.savez(tmp_path / "t.npz", voltage_v=np.array(["a"] * 2000), sample_rate_hz=stated)
    done = run("detect", tmp_path / "t.npz")
    assert done.exit_code == 2, done.stderr
    first, second = done.stderr.splitlines()
    assert first.endswith(
        f"t.npz, sample_rate_hz: {sentence}; save the rate in Hz as one number, such as 2000, or give --rate-hz."
    )
    assert "give an array of numbers" in second
    np.savez(tmp_path / "t.npz", voltage_v=np.round(V, 6), sample_rate_hz=stated)
    assert the_onset(run("detect", tmp_path / "t.npz", "--rate-hz", 2000, "--json")) == ONSET


@pytest.mark.parametrize("name", ["t.npz", "t.npy", "t.tdms"])
def test_files_that_are_not_what_they_are_called(tmp_path, name, monkeypatch):
    (tmp_path / name).write_bytes(b"hello world, this is no archive at all")
    done = run("detect", tmp_path / name)
    assert done.exit_code == 2
    assert done.stderr.startswith("error: ")
    assert run("detect", tmp_path / "none" / name).exit_code == 2


def test_options_that_say_nothing(tmp_path):
    (tmp_path / "t.csv").write_text(csv(T, V))
    for words, sentence in (
        (("--column", "voltage_v"), "names no column; write it as voltage_v=AI0"),
        (("--column", "volts=AI0"), "'volts' is no column of a trace"),
        (("--scale", "0"), "scales nothing"),
        (("--rate-hz", "0"), "detector.sample_rate_hz"),
        (("--detector", "fats"), "did you mean fast"),
        (("--quiet-s", "0.01"), "takes in 20 samples"),
    ):
        done = run("detect", tmp_path / "t.csv", *words)
        assert done.exit_code == 2, words
        assert sentence in done.stderr, words


@pytest.mark.parametrize("detector", ["digital", "fft", "fast"])
def test_lines_from_standard_input(tmp_path, detector):
    (tmp_path / "t.csv").write_text(csv(T, V))
    whole = json.loads(run("detect", tmp_path / "t.csv", "--detector", detector, "--json").stdout)["intervals"]
    told = json.loads(run("detect", "-", "--detector", detector, "--json", lines=csv(T, V)).stdout)["changes"]
    assert [change["time_s"] for change in told] == [time for i in whole for time in (i["onset_s"], i["end_s"])]
    text = run("detect", "-", "--detector", detector, lines=csv(T, V)).stdout.splitlines()
    assert text[0] == f"ON   {whole[0]['onset_s']:9.4f} s"


def test_a_line_that_is_wrong_ends_the_stream_after_what_was_found():
    lines = csv(T, V).splitlines()
    for broken, sentence in (
        ("1500", "line 1500: has 1 cells, the header 2"),
        ("0.749,nan", "line 1500: nan is not a finite number"),
        ("0.749,4 V", "line 1500: '4 V' is not a number"),
        ("0.8,4.0", "line 1500: 0.8 s comes 0.0515 s after"),
        ("0.7485,4.0", "line 1500: 0.7485 s comes 0 s after"),
    ):
        edited = [*lines[:1499], broken, *lines[1500:]]
        done = run("detect", "-", lines="\n".join(edited))
        assert done.exit_code == 2
        assert sentence in done.stderr
        assert done.stdout.splitlines()[0].startswith("ON ")
    assert "is empty" in run("detect", "-", lines="").stderr
    bare = run("detect", "-", lines="time_s,voltage_v\n")
    assert bare.exit_code == 2
    assert "ends below its header" in bare.stderr
    assert "needs the whole trace" in run("detect", "-", "--plot", "p.png", lines=csv(T, V)).stderr


PRECISION = ("--set", "board.variant=precision")


def test_analog_simulates_the_board_where_no_envelope_was_recorded(tmp_path):
    (tmp_path / "t.csv").write_text(csv(T, V))
    done = run("detect", tmp_path / "t.csv", "--detector", "analog", *PRECISION, "--json")
    assert the_onset(done) == pytest.approx(ONSET, abs=0.006)
    assert "holds no column envelope_v: simulating the design's board on voltage_v" in done.stderr
    # a burst of 10 mV hardly opens a bare diode, and the noise does not at all
    shut = run("detect", tmp_path / "t.csv", "--detector", "analog", "--json")
    assert json.loads(shut.stdout)["noise_threshold_v"] == pytest.approx(20 / 65536, abs=1e-6)
    assert "what the noise here asks for" not in shut.stderr  # offsets and leakage lift a real board's rest


def test_analog_takes_a_recorded_envelope(tmp_path):
    envelope = np.where((T >= 0.5) & (T < 0.7), 0.2, 0.001)
    np.savez(tmp_path / "t.npz", time_s=T, voltage_v=V, envelope_v=envelope)
    done = run("detect", tmp_path / "t.npz", "--detector", "analog", "--json")
    assert "simulating" not in done.stderr
    assert the_onset(done) == 0.5 + 4 / 2000  # five of sixty samples of 0.2 V: 17.6 mV
    quiet = run("detect", tmp_path / "t.npz", "--detector", "analog", "--quiet-s", 0.4, "--json")
    assert json.loads(quiet.stdout)["threshold_v"] == pytest.approx(0.001 + 20 / 65536, abs=1e-4)
    assert "takes in 600 samples" in run("detect", tmp_path / "t.npz", "--detector", "analog", "--quiet-s", 0.3).stderr
    # a recording of the board's output alone
    (tmp_path / "e.csv").write_text(csv(T, envelope, header=("time_s", "AI1")))
    both = ("--column", "voltage_v=AI1", "--column", "envelope_v=AI1")
    assert the_onset(run("detect", tmp_path / "e.csv", "--detector", "analog", *both, "--json")) == 0.502
    # and lines of it
    lines = run(
        "detect", "-", "--detector", "analog", "--json", lines=csv(T, envelope, header=("time_s", "envelope_v"))
    )
    assert json.loads(lines.stdout)["changes"][0] == {"on": True, "time_s": 0.502}


def test_analog_line_by_line_on_a_simulated_board(tmp_path):
    (tmp_path / "t.csv").write_text(csv(T, V))
    words = ("--detector", "analog", *PRECISION, "--json")
    whole = json.loads(run("detect", tmp_path / "t.csv", *words).stdout)["intervals"]
    done = run("detect", "-", *words, lines=csv(T, V))
    assert "simulating the design's board" in done.stderr
    told = json.loads(done.stdout)["changes"]
    assert [change["time_s"] for change in told] == [time for i in whole for time in (i["onset_s"], i["end_s"])]
    force = run("detect", "-", *words, "--column", "voltage_v=force_n", lines=csv(T, V, header=("time_s", "force_n")))
    assert "line by line analog takes volts only" in force.stderr + force.stdout


@settings(max_examples=10, deadline=None)
@given(sizes=st.lists(st.integers(0, 400), max_size=6))
def test_a_simulated_board_in_any_chunks_gives_the_same_bits_though_pickled(sizes):
    from fingertip.sim.electronics.board_output import SimulatedBoardDetector, simulate_envelope_v

    design = Design(board={"variant": "precision"})
    whole = make_detector("analog", design).process(simulate_envelope_v(design, V))
    detector, parts, start = SimulatedBoardDetector(design), [], 0
    for size in [*sizes, len(V)]:
        parts.append(detector.process(V[start : start + size]))
        start += size
        detector = pickle.loads(pickle.dumps(detector))
    for field in ("level_v", "on"):
        assert np.concatenate([getattr(part, field) for part in parts]).tobytes() == getattr(whole, field).tobytes()
    assert detector.threshold_v == whole.threshold_v[0]
    stepping = SimulatedBoardDetector(design)
    assert [stepping.step(x) for x in V[:300].tolist()] == whole.on[:300].tolist()


def test_analog_takes_a_force_through_the_designs_bridge(tmp_path):
    force = 1.0 + 0.05 * np.sin(2 * np.pi * 90 * T) * ((T >= 0.5) & (T < 0.7))
    (tmp_path / "t.csv").write_text(csv(T, force, header=("time_s", "force_n")))
    words = ("--column", "voltage_v=force_n", "--detector", "analog", *PRECISION, "--json")
    assert 0.5 < the_onset(run("detect", tmp_path / "t.csv", *words)) < 0.52


def test_an_envelope_that_is_not_there_is_missed_in_python():
    from fingertip.errors import TraceError
    from fingertip.slip import Trace, detect

    with pytest.raises(TraceError, match="envelope_v: is missing: analog works on the board's output"):
        detect(Trace(T, V), Design(), "analog")


def test_digital_and_a_board_without_dead_zone_agree():
    """On the same trace: means within 5 % of each other's, flags within 1 % of the samples. The board is linear between
    samples where the bilinear transform is not, and is built of preferred values."""
    from fingertip.sim.electronics import board_output

    design = Design(board={"variant": "precision"})
    digital = make_detector("digital", design).process(V)
    analog = make_detector("analog", design).process(board_output.simulate_envelope_v(design, V))
    during = (T >= 0.53) & (T < 0.7)
    off = analog.statistic_v[during] - digital.statistic_v[during]
    assert np.sqrt(np.mean(off**2)) < 0.05 * np.sqrt(np.mean(digital.statistic_v[during] ** 2))
    assert np.mean(analog.on != digital.on) < 0.01


def test_a_recorded_trace_in_python(tmp_path):
    import fingertip

    (tmp_path / "t.csv").write_text(csv(T, V, header=("t", "AI0")))
    trace = fingertip.read_trace(tmp_path / "t.csv", columns={"time_s": "t", "voltage_v": "AI0"})
    assert fingertip.detect(trace, Design()).intervals[0].onset_s == ONSET
    np.save(tmp_path / "v.npy", V)
    assert np.array_equal(fingertip.read_trace(str(tmp_path / "v.npy"), rate_hz=2000, scale=0.5).voltage_v, 0.5 * V)
    with pytest.raises(fingertip.FingertipError, match="is sampled at 2000 Hz, the detector is designed for 4000"):
        fingertip.read_trace(
            tmp_path / "t.csv", Design(detector={"sample_rate_hz": 4000.0}), {"time_s": "t", "voltage_v": "AI0"}
        )
