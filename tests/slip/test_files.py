"""Trace files: delimiters, preambles, units, the columns' names, NumPy and TDMS, and the issues of invalid files."""

from __future__ import annotations

import contextlib
import json
import re
import shlex
import struct
import sys
import types
import zlib

import numpy as np
import pytest

import fingertip
from fingertip.design import Design
from tests.conftest import ROOT
from tests.slip.recordings import ONSET, T, V, burst, csv, run, single_onset


@pytest.mark.parametrize(("delimiter", "comma"), [(",", False), (";", False), (";", True), ("\t", False), ("\t", True)])
def test_all_delimiters_and_decimal_commas_are_read(tmp_path, delimiter, comma):
    (tmp_path / "t.txt").write_text(csv(T, V, delimiter, comma=comma))
    assert single_onset(run("detect", tmp_path / "t.txt", "--json")) == ONSET


@pytest.mark.parametrize(("delimiter", "comma"), [(",", False), (";", True)])
def test_quoted_numbers_are_read(tmp_path, delimiter, comma):
    text = re.sub(f"[^{delimiter}\n]+", r'"\g<0>"', csv(T, V, delimiter, comma=comma))
    assert text.splitlines()[1].startswith('"0,000000";"' if comma else '"0.000000","')
    (tmp_path / "t.csv").write_text(text)
    assert single_onset(run("detect", tmp_path / "t.csv", "--json")) == ONSET
    transitions = json.loads(run("detect", "-", "--json", lines=text).stdout)["transitions"]
    assert transitions[0] == {"on": True, "time_s": ONSET}
    (tmp_path / "t.csv").write_text(text.replace('"0' + ("," if comma else ".") + '000500"', '"NA"'))
    stderr = run("detect", tmp_path / "t.csv").stderr
    assert "'\"NA\"' in line 3 is not a number" in stderr


PLAIN = csv(T, V)

SAVED = {
    "a spreadsheet's first line": "sep=;\n" + csv(T, V, ";", comma=True),
    "comments": "# recorded today\n\n#\n" + PLAIN,
    "a header that is a comment": "# " + PLAIN,
    "LabVIEW": "LabVIEW Measurement\t\nWriter_Version\t2\nSamples\t2000\t\n***End_of_Header***\t\n"
    + csv(T, V, "\t", ("time_s", "voltage_v\tComment"), comma=True),
    "units below": "time_s,voltage_v\n[s],V\n" + PLAIN.split("\n", 1)[1],
    "another case": "Time_s,Voltage_V\n" + PLAIN.split("\n", 1)[1],
}


@pytest.mark.full
@pytest.mark.parametrize("name", SAVED)
def test_preambles_and_unit_lines_are_skipped(tmp_path, name):
    (tmp_path / "t.csv").write_text(SAVED[name])
    assert single_onset(run("detect", tmp_path / "t.csv", "--json")) == ONSET
    (tmp_path / "u16.csv").write_bytes(SAVED[name].encode("utf-16"))
    assert single_onset(run("detect", tmp_path / "u16.csv", "--json")) == ONSET
    data = json.loads(run("detect", "-", "--json", lines=SAVED[name]).stdout)
    assert data["transitions"][0] == {"on": True, "time_s": ONSET}
    # The messages number the lines as an editor does.
    lines = SAVED[name].splitlines()
    first = next(i for i, line in enumerate(lines) if line[:4] in ("0.00", "0,00"))
    lines[first + 100] = "word" + lines[first + 100][4:]
    (tmp_path / "t.csv").write_text("\n".join(lines))
    assert f" in line {first + 101} is not a number" in run("detect", tmp_path / "t.csv").stderr
    assert f"standard input, line {first + 101}: 'word" in run("detect", "-", lines="\n".join(lines)).stderr


SUGGESTIONS = {
    "Time [s],AI0 (V)": "; or name the file's columns: --column time_s='Time [s]' --column voltage_v='AI0 (V)'.",
    "AI0,Time": "--column time_s=Time --column voltage_v=AI0.",
    "date,temp,elapsed_s,ch1": "--column time_s=elapsed_s --column voltage_v=ch1.",
    "time_s,force_n": "Or name the file's column: --column voltage_v=force_n --calibrate 0:0.5",
    "t,Load [N]": "--column time_s=t --column voltage_v='Load [N]' --calibrate 0:0.5",
    "time_s,Time_S,Voltage_V,VOLTAGE_V": "--column voltage_v=Voltage_V.",
    "time_s,level": "--column voltage_v=level.",
}


@pytest.mark.parametrize("header", SUGGESTIONS)
def test_columns_are_suggested_as_options_that_work(tmp_path, header):
    cells = {name: (V if name in SUGGESTIONS[header].replace("'", "") else 0 * V) for name in header.split(",")}
    for time in ("Time [s]", "Time", "elapsed_s", "time_s", "t"):
        if time in cells:
            cells[time] = T
    rows = "\n".join(",".join(f"{x:.6f}" for x in row) for row in zip(*cells.values(), strict=True))
    (tmp_path / "t.csv").write_text(f"made by a logger\n{header}\n{rows}\n")
    done = run("detect", tmp_path / "t.csv")
    assert done.exit_code == 2
    assert "t.csv, line 2: " in done.stderr
    assert SUGGESTIONS[header] in done.stderr
    options = shlex.split(re.search(r"(--column.*?)(?: \(a force|\.$)", done.stderr, re.MULTILINE)[1])
    if "--calibrate" in options:
        options[-1] = "0:0.4"
    assert single_onset(run("detect", tmp_path / "t.csv", *options, "--json")) == pytest.approx(ONSET, abs=0.006)


def test_tdms_file_written_by_nptdms_is_read(tmp_path):
    nptdms = pytest.importorskip("nptdms", reason="the extra tdms is not installed; a fake library is tested below")
    channel = nptdms.ChannelObject("group", "AI0", np.round(V, 6), properties={"wf_increment": 1 / 2000})
    with nptdms.TdmsWriter(tmp_path / "t.tdms") as writer:
        writer.write_segment([channel])
    assert single_onset(run("detect", tmp_path / "t.tdms", "--json")) == ONSET


class FakeChannel:
    name, properties, dtype = "AI0", {"wf_increment": 1 / 2000}, np.dtype("f8")

    def __len__(self):
        return len(V)

    def __getitem__(self, _):
        return np.round(V, 6)


def test_tdms_file_is_read_with_a_fake_library(tmp_path, monkeypatch):
    group = types.SimpleNamespace(channels=lambda: [FakeChannel()])
    file = types.SimpleNamespace(
        open=lambda path: contextlib.nullcontext(types.SimpleNamespace(groups=lambda: [group]))
    )
    monkeypatch.setitem(sys.modules, "nptdms", types.SimpleNamespace(TdmsFile=file))
    (tmp_path / "t.tdms").write_bytes(b"TDSm" + bytes(8 * len(V)))
    assert single_onset(run("detect", tmp_path / "t.tdms", "--json")) == ONSET


OUTSIDE_GAP = (np.arange(2000) < 300) | (np.arange(2000) >= 400)

# Name -> text of the file, part of the message, exit code.
UNUSUAL = {
    "constant": (csv(T, np.full(2000, 2.3)), "the voltage is constant at 2.3 V; is a sensor connected?", 0),
    "saturated": (csv(T, np.minimum(V + 1.0, 3.3)), "samples are at the limits of the ADC range", 0),
    "wrong delimiter": (csv(T, V, "|"), "does not separate its names by comma, semicolon or tab", 2),
    "decimal commas between commas": (csv(T, V, comma=True), "has 4 cells, but the header has 2 (and 1999 more", 2),
    "negative time": (csv(T - 0.3, V), "", 0),  # times relative to a trigger are valid
    "time that runs backwards": (csv(-T, V), "does not increase in most of its steps", 2),
    "duplicate times": (csv(np.floor(T * 1000) / 1000, V), "0 s in line 3 repeats the time before it, as do 999", 2),
    "counts": (csv(T, np.round(V / 20 * 65536)), "the values are whole numbers, as ADC counts are", 2),
    "millivolts": (csv(T, 1000 * V), "exceeds the ADC range of 0 to 3.3 V; use --scale", 2),
    "milliseconds": (csv(1000 * T, V), "if they are in milliseconds, add --time-scale ms.", 2),
    "too slow": (csv(*burst(500.0)), "is sampled at 500 Hz, too low for a detector; record at 1000 Hz or more.", 2),
    "a gap": (csv(T[OUTSIDE_GAP], V[OUTSIDE_GAP]), "0.2 s in line 302 comes after a gap", 2),
}  # fmt: skip


@pytest.mark.parametrize("name", UNUSUAL)
def test_unusual_input_gives_an_error_or_a_correct_result(tmp_path, name):
    text, message, code = UNUSUAL[name]
    (tmp_path / "t.csv").write_text(text)
    done = run("detect", tmp_path / "t.csv")
    assert done.exit_code == code, done.stderr
    assert message in done.stderr
    assert "Traceback" not in done.stderr
    expected = {"constant": "never ON", "saturated": "detected ", "negative time": "detected "}
    if code == 0:
        first, second, *_ = done.stdout.splitlines()
        assert first.startswith("detector digital, on voltage_v, mean of the envelope: threshold ")
        assert second.startswith(expected[name])
    else:
        assert done.stdout == ""


INVALID_ARRAYS = {
    "nothing": ({}, "t.npz: contains no arrays; save time_s and voltage_v."),
    "objects": ({"time_s": T, "voltage_v": np.array(["a"] * 2000)}, "give an array of numbers"),
    "no voltage": (
        {"time_s": T, "volts": V},
        "did you mean volts? Or name the file's column: --column voltage_v=",
    ),
    "no time": ({"voltage_v": V}, "Or give --rate-hz, or sample_rate_hz in the file."),
    "other length": ({"time_s": T, "voltage_v": V[:-1]}, "has shape (1999,), but time_s has shape (2000,)"),
}


@pytest.mark.parametrize("name", INVALID_ARRAYS)
def test_invalid_arrays_give_an_error(tmp_path, name):
    arrays, message = INVALID_ARRAYS[name]
    np.savez(tmp_path / "t.npz", **arrays)
    done = run("detect", tmp_path / "t.npz")
    assert done.exit_code == 2
    assert message in done.stderr


INVALID_RATES = {
    "words": (np.array("2 kHz"), "contains '2 kHz'"),
    "nothing": (np.zeros(0), "contains no value"),
    "zero": (0, "contains 0"),
    "infinite": (np.inf, "contains inf"),
    "two": (np.array([2000.0, 5000.0]), "contains 2 values"),
    "complex": (2000 + 1j, "contains (2000+1j)"),
}


@pytest.mark.parametrize("name", INVALID_RATES)
def test_invalid_rates_in_an_archive_give_an_error(tmp_path, name):
    stated, message = INVALID_RATES[name]
    np.savez(tmp_path / "t.npz", voltage_v=np.array(["a"] * 2000), sample_rate_hz=stated)
    done = run("detect", tmp_path / "t.npz")
    assert done.exit_code == 2, done.stderr
    first, second = done.stderr.splitlines()
    assert first.endswith(
        f"t.npz, sample_rate_hz: {message}; save the rate in Hz as one number, such as 2000, or give --rate-hz."
    )
    assert "give an array of numbers" in second
    np.savez(tmp_path / "t.npz", voltage_v=np.round(V, 6), sample_rate_hz=stated)
    assert single_onset(run("detect", tmp_path / "t.npz", "--rate-hz", 2000, "--json")) == ONSET


def test_read_trace_in_python(tmp_path):
    (tmp_path / "t.csv").write_text(csv(T, V, header=("t", "AI0")))
    trace = fingertip.read_trace(tmp_path / "t.csv", columns={"time_s": "t", "voltage_v": "AI0"})
    assert fingertip.detect(trace, Design()).intervals[0].onset_s == ONSET
    np.save(tmp_path / "v.npy", V)
    assert np.array_equal(fingertip.read_trace(str(tmp_path / "v.npy"), rate_hz=2000, scale=0.5).voltage_v, 0.5 * V)
    with pytest.raises(fingertip.FingertipError, match="is sampled at 2000 Hz, but the detector is designed for 4000"):
        fingertip.read_trace(
            tmp_path / "t.csv", Design(detector={"sample_rate_hz": 4000.0}), {"time_s": "t", "voltage_v": "AI0"}
        )


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("params/fsr400.toml", "is a design file, not a trace; give a trace first, and the design after --design."),
        ("params/scenes/hard_tap.toml", "is a scene file, not a trace; make a trace of it with `fingertip simulate`."),
    ],
)
def test_a_toml_file_in_place_of_a_trace_gives_an_error(name, message):
    done = run("detect", ROOT / name)
    assert done.exit_code == 2
    assert message in done.stderr


def test_a_column_of_the_file_is_not_suggested_for_itself(tmp_path):
    (tmp_path / "t.csv").write_text(PLAIN)
    stderr = run("detect", tmp_path / "t.csv", "--column", "voltage_v=nope").stderr
    assert "there is no column nope; known names: time_s, voltage_v." in stderr
    assert "--column" not in stderr


def test_an_empty_cell_is_reported_as_missing(tmp_path):
    lines = PLAIN.splitlines()
    for number in (50, 60):
        lines[number - 1] = lines[number - 1].split(",")[0] + ","
    (tmp_path / "t.csv").write_text("\n".join(lines))
    stderr = run("detect", tmp_path / "t.csv").stderr
    assert "t.csv, voltage_v: is missing in line 50 (and 1 more); fill it in" in stderr
    assert (
        "line 50: has an empty cell; give one number per column." in run("detect", "-", lines="\n".join(lines)).stderr
    )


@pytest.mark.full
@pytest.mark.parametrize(("unit", "per_s"), [("milliseconds", 1e3), ("microseconds", 1e6), ("nanoseconds", 1e9)])
def test_times_in_other_units_are_read_with_the_options_in_the_message(tmp_path, unit, per_s):
    text = csv(T * per_s, V)
    (tmp_path / "t.csv").write_text(text)
    for done in (
        run("detect", tmp_path / "t.csv"),
        run("detect", tmp_path / "t.csv", "--set", "detector.sample_rate_hz=2000"),
        run("detect", "-", lines=text),
    ):
        assert done.exit_code == 2
        options = re.search(rf"if they are in {unit}, add (.*)\.$", done.stderr, re.MULTILINE)
        assert options
        remedy = shlex.split(options[1])
        assert single_onset(run("detect", tmp_path / "t.csv", *remedy, "--json")) == ONSET


def test_a_missing_row_is_ignored_with_the_options_in_the_message(tmp_path):
    (tmp_path / "t.csv").write_text(csv(np.delete(T, 48), np.delete(V, 48)))
    done = run("detect", tmp_path / "t.csv")
    assert "0.0245 s in line 50 comes after a gap" in done.stderr
    remedy = shlex.split(re.search(r"ignore the times with (.*)\.$", done.stderr, re.MULTILINE)[1])
    assert single_onset(run("detect", tmp_path / "t.csv", *remedy, "--json")) == pytest.approx(ONSET, abs=0.001)
    live = run("detect", "-", lines=(tmp_path / "t.csv").read_text())
    assert "line 50: 0.0245 s is 0.001 s after the previous sample" in live.stderr
    assert shlex.split(re.search(r"ignore the times with (.*)\.$", live.stderr, re.MULTILINE)[1]) == remedy


def bomb_mat(megabytes: int) -> bytes:
    """MATLAB file whose compressed variable unpacks to zeros."""
    packed = zlib.compress(bytes(megabytes * 2**20), 9)
    return b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM" + struct.pack("<II", 15, len(packed)) + packed


def test_a_matlab_file_that_unpacks_to_much_is_refused(tmp_path, monkeypatch):
    pytest.importorskip("scipy")
    monkeypatch.setenv("FINGERTIP_MAX_SAMPLES", "100000")
    (tmp_path / "t.mat").write_bytes(bomb_mat(8))
    done = run("detect", tmp_path / "t.mat")
    assert done.exit_code == 2
    assert "its variables unpack to more than 3 MB" in done.stderr
    (tmp_path / "t.mat").write_bytes(bomb_mat(1))
    assert "unpack to" not in run("detect", tmp_path / "t.mat").stderr


def test_a_tdms_file_of_many_segments_is_refused(tmp_path):
    pytest.importorskip("nptdms")
    (tmp_path / "t.tdms").write_bytes(struct.pack("<4sIIQQ", b"TDSm", 0, 4713, 0, 0) * 100_001)
    done = run("detect", tmp_path / "t.tdms")
    assert done.exit_code == 2
    assert "it has 100001 segments or more" in done.stderr
    (tmp_path / "t.tdms").write_bytes(struct.pack("<4sIIQQ", b"TDSm", 0, 4713, 2**64 - 1, 2**63) + bytes(2**24 + 1))
    assert "1 segments or more, with 16777245 bytes of names" in run("detect", tmp_path / "t.tdms").stderr


def test_a_line_without_end_is_refused(tmp_path):
    (tmp_path / "t.csv").write_bytes(b"time_s,voltage_v" + b" " * 2**20 + b"\n0,1\n")
    message = "line 1: is longer than 1048576 characters; a trace has one sample per line, so break the lines."
    assert message in run("detect", tmp_path / "t.csv").stderr
    assert message in run("detect", "-", lines="x" * (2**20 + 1)).stderr
    (tmp_path / "t.csv").write_bytes(b"time_s,voltage_v\n" + b"0.0,1\n" * 10 + b"1" * 2**21)
    assert "line 12: is longer than" in run("detect", tmp_path / "t.csv").stderr


def test_a_file_of_comments_is_bounded(tmp_path, monkeypatch):
    monkeypatch.setenv("FINGERTIP_MAX_SAMPLES", "100")
    (tmp_path / "t.csv").write_bytes(b"time_s,voltage_v\n" + b"#\n" * 20_000)
    assert "has more than 10200 lines" in run("detect", tmp_path / "t.csv").stderr


@pytest.mark.parametrize("rate", ["1e308", "1e-308", "-1e308", "nan", "inf", "0"])
def test_a_rate_far_out_of_bounds_is_refused(tmp_path, rate):
    (tmp_path / "t.csv").write_text("voltage_v\n" + "4.0\n" * 500)
    for more in ((), ("--set", "detector.window_samples=40")):
        done = run("detect", tmp_path / "t.csv", "--rate-hz", rate, *more)
        assert done.exit_code == 2, done.stderr
        assert "Hz" in done.stderr
