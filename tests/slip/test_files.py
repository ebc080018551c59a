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
from tests.slip.recordings import ONSET, PLAIN, T, V, csv, run, single_onset


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


# Name -> text of the file, part of the message, exit code.


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


def test_a_file_of_comments_is_bounded(tmp_path, monkeypatch):
    monkeypatch.setenv("FINGERTIP_MAX_SAMPLES", "100")
    (tmp_path / "t.csv").write_bytes(b"time_s,voltage_v\n" + b"#\n" * 20_000)
    assert "has more than 10200 lines" in run("detect", tmp_path / "t.csv").stderr
