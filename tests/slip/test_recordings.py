"""What people's own programs write: preambles, units, names of their own; streams at any rate; what is said of them."""

from __future__ import annotations

import json
import re
import shlex

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.slip import make_detector
from fingertip.slip.rate_adaptation import adapt_rate
from tests.slip.recordings import ONSET, T, V, burst, csv, run, the_onset

PLAIN = csv(T, V)
AS_SAVED = {
    "a spreadsheet's first line": "sep=;\n" + csv(T, V, ";", comma=True),
    "comments": "# recorded today\n\n#\n" + PLAIN,
    "a header that is a comment": "# " + PLAIN,
    "LabVIEW": "LabVIEW Measurement\t\nWriter_Version\t2\nSamples\t2000\t\n***End_of_Header***\t\n"
    + csv(T, V, "\t", ("time_s", "voltage_v\tComment"), comma=True),
    "units below": "time_s,voltage_v\n[s],V\n" + PLAIN.split("\n", 1)[1],
    "another case": "Time_s,Voltage_V\n" + PLAIN.split("\n", 1)[1],
}


@pytest.mark.parametrize("name", AS_SAVED)
def test_what_programs_write_about_the_samples(tmp_path, name):
    (tmp_path / "t.csv").write_text(AS_SAVED[name])
    assert the_onset(run("detect", tmp_path / "t.csv", "--json")) == ONSET
    (tmp_path / "u16.csv").write_bytes(AS_SAVED[name].encode("utf-16"))
    assert the_onset(run("detect", tmp_path / "u16.csv", "--json")) == ONSET
    told = json.loads(run("detect", "-", "--json", lines=AS_SAVED[name]).stdout)
    assert told["changes"][0] == {"on": True, "time_s": ONSET}
    # lines are counted as an editor does
    lines = AS_SAVED[name].splitlines()
    above = next(i for i, line in enumerate(lines) if line[:4] in ("0.00", "0,00"))
    lines[above + 100] = "word" + lines[above + 100][4:]
    (tmp_path / "t.csv").write_text("\n".join(lines))
    assert f" in line {above + 101} is not a number" in run("detect", tmp_path / "t.csv").stderr
    assert f"standard input, line {above + 101}: 'word" in run("detect", "-", lines="\n".join(lines)).stderr


OWN_NAMES = {
    "Time [s],AI0 (V)": "; or name the file's columns: --column time_s='Time [s]' --column voltage_v='AI0 (V)'.",
    "AI0,Time": "--column time_s=Time --column voltage_v=AI0.",
    "date,temp,elapsed_s,ch1": "--column time_s=elapsed_s --column voltage_v=ch1.",
    "time_s,force_n": "Or name the file's column: --column voltage_v=force_n --quiet-s 0.5",
    "t,Load [N]": "--column time_s=t --column voltage_v='Load [N]' --quiet-s 0.5",
    "time_s,Time_S,Voltage_V,VOLTAGE_V": "--column voltage_v=Voltage_V.",
    "time_s,level": "--column voltage_v=level.",
}


@pytest.mark.parametrize("header", OWN_NAMES)
def test_own_names_of_columns_are_offered_ready_to_type(tmp_path, header):
    cells = {name: (V if name in OWN_NAMES[header].replace("'", "") else 0 * V) for name in header.split(",")}
    for time in ("Time [s]", "Time", "elapsed_s", "time_s", "t"):
        if time in cells:
            cells[time] = T
    rows = "\n".join(",".join(f"{x:.6f}" for x in row) for row in zip(*cells.values(), strict=True))
    (tmp_path / "t.csv").write_text(f"made by a logger\n{header}\n{rows}\n")
    done = run("detect", tmp_path / "t.csv")
    assert done.exit_code == 2
    assert "t.csv, line 2: " in done.stderr
    assert OWN_NAMES[header] in done.stderr
    offered = shlex.split(re.search(r"(--column.*?)(?: \(a force|\.$)", done.stderr, re.MULTILINE)[1])
    if "--quiet-s" in offered:
        offered[-1] = "0.4"
    assert the_onset(run("detect", tmp_path / "t.csv", *offered, "--json")) == pytest.approx(ONSET, abs=0.003)


def test_a_line_is_no_header_for_two_names_alike(tmp_path):
    (tmp_path / "t.csv").write_text("time_s,Voltage_V,VOLTAGE_V\n" + "0.0,4.0,4.0\n" * 100)
    assert "there is no column voltage_v" in run("detect", tmp_path / "t.csv").stderr


@pytest.mark.parametrize("rate", [1400, 1900, 1980, 2020, 2100, 2990])
def test_lines_at_another_rate_are_refused_with_the_files_sentence(rate):
    t, v = burst(rate)
    done = run("detect", "-", lines=csv(t, v))
    assert done.exit_code == 2
    said = re.search(r"is sampled at ([\d.]+) Hz, the detector is designed for 2000 Hz .*-hz ([\d.]+)", done.stderr)
    assert said
    assert float(said[1]) == float(said[2]) == pytest.approx(rate, rel=1e-3)
    assert run("detect", "-", "--rate-hz", rate, "--quiet", lines=csv(t, v)).stdout.startswith("ON      0.50")


def test_lines_whose_stamps_stray_or_whose_rate_changes():
    t, v = burst()
    strayed = t + np.random.default_rng(2).uniform(-1e-4, 1e-4, len(t))
    assert run("detect", "-", lines=csv(strayed, v)).exit_code == 0
    t, v = np.concatenate((t, t[-1] + np.arange(1, 8000) / 2040)), np.full(9999, 4.0)
    done = run("detect", "-", lines=csv(t, v))  # 2 % faster from the first second on
    assert "the detector is designed for 2000 Hz" in done.stderr


def test_lines_beyond_the_converters_range():
    for v, sentence in (
        (np.round(V / 20 * 65536), "line 2: 13108 is beyond the converter's 10 V; whole numbers throughout look like"),
        (1000 * V, "is beyond the converter's 10 V; give --scale if the column is not in volts"),
        (np.where(T < 0.1, V, 11.0), "line 202: 11 is beyond the converter's 10 V; give --scale"),
    ):
        done = run("detect", "-", lines=csv(T, v))
        assert done.exit_code == 2
        assert sentence in done.stderr
    assert run("detect", "-", "--scale", 0.001, lines=csv(T, 1000 * V)).stdout.startswith("ON")


def test_lines_until_they_end_are_told_with_what_ended_them(monkeypatch):
    whole = json.loads(run("detect", "-", "--json", lines=PLAIN).stdout)
    assert json.loads(run("detect", "-", "--json", lines=PLAIN + "\n \n").stdout) == whole
    broken = json.loads(run("detect", "-", "--json", lines=PLAIN + "1.0,x\n").stdout)
    assert broken["changes"] == whole["changes"]
    assert broken["issues"][0]["field"] == "standard input, line 2002"

    def interrupted(*_):
        yield from PLAIN.splitlines(keepends=True)
        raise KeyboardInterrupt

    from fingertip.slip import live

    opened = live.opened
    monkeypatch.setattr(live, "opened", lambda lines, *wanted: opened(interrupted(), *wanted))
    done = run("detect", "-", "--json", lines="")
    assert done.exit_code == 130
    assert json.loads(done.stdout) == whole


def test_a_threshold_that_was_set_stays_at_any_rate(tmp_path):
    t, v = burst(5000)
    (tmp_path / "t.csv").write_text(csv(t, v))
    (tmp_path / "d.toml").write_text("[detector]\nthreshold_v = 0.0123\n")
    rate, mine = ("--rate-hz", 5000), ("--set", "detector.threshold_v=0.0123")
    usual, anew = Design().detector.threshold_v, adapt_rate(Design(), 5000.0).detector.threshold_v
    assert anew != pytest.approx(usual, rel=0.05)
    for words, volts, said in (
        ((), anew, f"the threshold is {anew:.3g} V"),
        (
            mine,
            0.0123,
            "filters and window are made for that; the window is 150 samples, 30 ms; the threshold stays 0.0123 V",
        ),
        (
            (*rate, *mine),
            0.0123,
            "filters and window are made for 5000 Hz; the window is 150 samples, 30 ms; the threshold stays 0.0123 V",
        ),
        ((*rate, "--design", tmp_path / "d.toml"), 0.0123, "stays 0.0123 V, as it was set"),
        (("--detector", "analog"), usual, f"the threshold stays {usual:g} V, on the board's output"),
        ((*rate, "--detector", "analog"), usual, f"the threshold stays {usual:g} V, on the board's output"),
    ):
        done = run("detect", tmp_path / "t.csv", *words, "--json")
        assert json.loads(done.stdout)["threshold_v"] == pytest.approx(volts, abs=2e-6), words
        assert said in done.stderr, words
    fast = run("detect", tmp_path / "t.csv", "--detector", "fast")
    assert "filters, window and threshold are made for that; the window is 150 samples, 30 ms\n" in fast.stderr


def test_a_window_that_was_set_stays_at_any_rate(tmp_path):
    t, v = burst(10_000)
    (tmp_path / "t.csv").write_text(csv(t, v))
    (tmp_path / "d.toml").write_text("[detector]\nwindow_samples = 90\n")
    rate, mine = ("--rate-hz", 10_000), ("--set", "detector.window_samples=400")
    both = (*mine, "--set", "detector.threshold_v=0.0123")
    for words, said in (
        ((), "filters, window and threshold are made for that; the window is 300 samples, 30 ms; the threshold is"),
        (mine, "filters and threshold are made for that; the window stays 400 samples, 40 ms, as it was set"),
        ((*rate, *mine), "filters and threshold are made for 10000 Hz; the window stays 400 samples, 40 ms, as it was"),
        ((*rate, *both), "filters are made for 10000 Hz; the window stays 400 samples, 40 ms, as it was set; the thre"),
        ((*rate, "--design", tmp_path / "d.toml"), "the window is 450 samples, 45 ms"),
    ):
        assert said in run("detect", tmp_path / "t.csv", *words).stderr, words
    # A window that lasts as long as usual has the usual threshold.
    thirty = adapt_rate(Design(detector={"window_samples": 300}), 10_000.0, keep_window=True).detector
    assert thirty == adapt_rate(Design(), 10_000.0).detector
    # It is the window that detects, and not the message alone.
    kept = run("detect", tmp_path / "t.csv", *rate, *mine, "--json").stdout
    taken = make_detector("digital", adapt_rate(Design(detector={"window_samples": 400}), 10_000.0, keep_window=True))
    expected = t[np.flatnonzero(taken.process(np.round(v, 6)).on)[0]]
    assert json.loads(kept)["intervals"][0]["onset_s"] == pytest.approx(expected)


@pytest.mark.parametrize("rate", [1200, 2000, 3000, 5000])
@pytest.mark.parametrize("cut", [np.floor, np.round])
def test_times_of_too_few_decimals_are_set_aside_as_the_sentence_says(tmp_path, rate, cut):
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
            (sentence,) = [line for line in done.stderr.splitlines() if line.startswith("error")]
            assert f"the times are rounded to 0.001 s, at a mean rate of {rate} Hz" in sentence
            assert "is sampled at" not in done.stderr
            remedy = shlex.split(re.search(r"set them aside with (.*)\.$", sentence)[1])
            assert remedy == ["--rate-hz", str(rate), "--column", "time_s=none"]
            onsets.add(the_onset(run("detect", tmp_path / name, *remedy, "--json")))
        (onset,) = onsets
        assert 0.5 < onset < 0.525
    live = run("detect", "-", "--rate-hz", rate, lines=csv(np.floor(1000 * t) / 1000, v)).stderr
    assert "rounded aside with --column time_s=none" in live


def test_times_that_repeat_for_other_reasons():
    from fingertip.slip.traces.rounded import rounded

    assert rounded(T) is None
    assert rounded(np.zeros(100)) is None
    assert rounded(np.sort(np.append(T, T[7]))) is None  # one
    assert rounded(np.sort(np.append(T, T[:300]))) is None  # many, all at the start
    assert rounded(np.where(np.arange(2000) % 2, T - 0.001, T)[::-1]) is None  # backwards
    whole = rounded(np.floor(T * 4))  # seconds alone leave the rate open
    assert whole is not None
    assert whole.rate_hz is None
    assert rounded(np.round(np.arange(100_000) / 4567, 3)).rate_hz == pytest.approx(4567, rel=1e-4)


def test_a_quiet_part_in_which_something_happens(tmp_path):
    (tmp_path / "t.csv").write_text(csv(T, V))
    for seconds in ("5", "1", "inf"):
        done = run("detect", tmp_path / "t.csv", "--quiet-s", seconds)
        assert done.exit_code == 2
        assert "s takes in all 0.9995 s of t.csv; choose a part at the start" in done.stderr
    for words in (("--quiet-s", "-1"), ("--quiet-s", "nan", "--detector", "analog")):
        assert "s takes in no sample; give seconds above 0" in run("detect", tmp_path / "t.csv", *words).stderr
    done = run("detect", tmp_path / "t.csv", "--quiet-s", "0.9")
    assert "something happens at 0.50" in done.stderr
    assert "within the 0.9 s of --quiet-s" in done.stderr
    assert "--quiet-s" not in run("detect", tmp_path / "t.csv", "--quiet-s", "0.4").stderr
    np.savez(tmp_path / "t.npz", time_s=T, voltage_v=V, slip=(T >= 0.5) & (T < 0.7))
    assert "0.9 s takes in slip, from 0.5 s on" in run("detect", tmp_path / "t.npz", "--quiet-s", "0.9").stderr


def test_slip_that_began_while_it_was_on_already(tmp_path):
    np.savez(tmp_path / "t.npz", time_s=T, voltage_v=V, slip=(T >= 0.6) & (T < 0.7))
    done = run("detect", tmp_path / "t.npz", "--plot", tmp_path / "p.png")
    assert f"ON already, {round(1000 * (0.6 - ONSET), 1):g} ms before" in done.stdout
    assert "found after -" not in done.stdout


def test_a_plot_under_another_name_than_a_pngs(tmp_path):
    (tmp_path / "t.csv").write_text(csv(T, V))
    for words in (("detect", tmp_path / "t.csv"), ("simulate", "--out", tmp_path / "s.csv")):
        done = run(*words, "--plot", tmp_path / "p.svg")
        assert done.exit_code == 2
        assert "'p.svg' is no name of a PNG, which is what is written; end it in .png" in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["t.csv"]
