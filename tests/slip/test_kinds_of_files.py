"""Kinds of files as people have them: each is read with the
right numbers, or answered by what to do.
"""

from __future__ import annotations

import io
import itertools
import json
import re
import shlex
import struct
import warnings
import wave
import zipfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import fingertip
from fingertip.design import Design
from fingertip.detection.warnings import find_step_v
from fingertip.foundation.input_files import RECORDING_LIMIT, SAMPLES_LIMIT
from fingertip.slip.traces import array_files
from fingertip.slip.traces.read import read_raw_trace
from fingertip.slip.traces.sampling import restore_even_times
from fingertip.slip.traces.trace import ColumnMap
from tests.conftest import ROOT
from tests.slip.recordings import DATES, ONSET, PLAIN, T, V, csv, iso, lvm, rows, run, single_onset

BY_NUMBER = ("--column", "time_s=1", "--column", "voltage_v=2")

VOLTS = np.round(V, 6)

LINES = PLAIN.splitlines(keepends=True)

# Name -> content of the file, options, part of the warning ("" for none).
TEXTS: dict[str, tuple[str | bytes, tuple[object, ...], str]] = {
    "exact name in another case": (
        csv(T, V, header=("time_s", "force_N")),
        ("--column", "voltage_v=force_N", "--calibrate", "0:0.4"),
        "",
    ),
    "names of numpy.savetxt": ("# time_s voltage_v\n" + rows(T, " "), (), ""),
    "numpy.savetxt": (rows((f"{t:.18e}" for t in T), " "), BY_NUMBER, ""),
    "columns of fixed width": (rows((f"  {t:8.4f}" for t in T), "   "), BY_NUMBER, ""),
    "no header, decimal commas": (csv(T, V, ";", comma=True).split("\n", 1)[1], BY_NUMBER, ""),
    "no header, third column": (
        rows(T, ",7,"),
        ("--column", "time_s=1", "--column", "voltage_v=3"),
        "",
    ),
    "one column": (
        "".join(f"{v:.6f}\n" for v in V),
        ("--rate-hz", 2000, "--column", "voltage_v=1"),
        "",
    ),
    "by name and by number": ("Zeit,voltage_v\n" + rows(T), ("--column", "time_s=1"), ""),
    "milliseconds": (
        "time_s,voltage_v\n" + rows(f"{1e3 * t:.1f}" for t in T),
        ("--time-scale", "ms"),
        "",
    ),
    "nanoseconds since 1970": (
        "time_s,voltage_v\n" + rows(str(1717199999700000000 + 500000 * i) for i in range(len(T))),
        ("--time-scale", "1e-9"),
        "",
    ),
    "ISO 8601, UTC": (
        "time_s,voltage_v\n" + rows(iso("{0}Z")),
        (),
        "since 2024-05-31T23:59:59.700000+00:00",
    ),
    "ISO 8601 as pandas writes it": (
        "time_s,voltage_v\n" + rows(iso("{1}")),
        (),
        "dates are read as seconds",  # whole seconds have no decimals
    ),
    "time of day": (
        "time_s,voltage_v\n" + rows(f"12:00:{t:09.6f}" for t in T),
        (),
        "dates are read as seconds",
    ),
    "Latin-1 by name": (
        "Zeit [s];Größe [V]\n".encode("latin-1") + rows(T, ";").encode(),
        ("--column", "time_s=Zeit [s]", "--column", "voltage_v=Größe [V]"),
        "",
    ),
    "cut off after the time": (PLAIN + "1.0000", (), "line 2002: is cut off, and passed over"),
    "cut off within the voltage": (
        PLAIN + "1.000000,2.3",
        (),
        "line 2002: is cut off, and passed over",
    ),
    "cut off within a character": (PLAIN.encode() + b"1.0,2.3 \xc2", (), "line 2002: is cut off"),
    "repeated header": (
        "".join([*LINES[:701], LINES[0], *LINES[701:1201], LINES[0], *LINES[1201:]]),
        (),
        "line 702: is a header or a comment among the samples (and 1 more), and passed over",
    ),
    "comments among the samples": (
        "".join([*LINES[:701], "# pressed\n", *LINES[701:]]),
        (),
        "line 702: is a header",
    ),
    "empty lines": (PLAIN.replace("\n", "\n\n"), (), ""),
    "PicoScope": (
        "Time,Channel A\n(ms),(V)\n\n" + rows(f"{1e3 * t:.1f}" for t in T),
        ("--column", "time_s=Time", "--column", "voltage_v=Channel A", "--time-scale", "ms"),
        "",
    ),
    "LVM": (lvm("One"), (), ""),
    "LVM without times": (lvm("No"), (), ""),
    "LVM of four segments": (lvm("One", 4), (), "among the samples (and 2 more), and passed over"),
}


@pytest.mark.every_case
@pytest.mark.parametrize("name", TEXTS)
def test_text_files_are_read(tmp_path: Path, name: str) -> None:
    content, options, warning = TEXTS[name]
    (tmp_path / "t.txt").write_bytes(content if isinstance(content, bytes) else content.encode())
    done = run("detect", tmp_path / "t.txt", *options, "--json")
    tolerance = 0.006 if "--calibrate" in options else 1e-4
    start = 1717199999.7 if "since 1970" in name else 0.0
    assert single_onset(done) - start == pytest.approx(ONSET, abs=tolerance)
    assert warning in done.stderr
    assert ("warning" in done.stderr) == bool(warning)
    raw = read_raw_trace(tmp_path / "t.txt", _column_map(options))
    assert np.array_equal(raw.trace.voltage_v[: len(V)], VOLTS)


def _column_map(options: tuple[object, ...]) -> ColumnMap:
    pairs = [
        str(value).partition("=")
        for name, value in itertools.pairwise(options)
        if name == "--column"
    ]
    rate = 2000.0 if "--rate-hz" in options else None
    scales = {"ms": 1e-3, "1e-9": 1e-9}
    scale = next((scales[str(value)] for value in options if value in scales), 1.0)
    return ColumnMap({column: name for column, _, name in pairs}, rate, time_scale=scale)


def test_a_repeated_header_in_a_stream_is_passed_over_without_a_word() -> None:
    done = run("detect", "-", "--json", lines="".join([*LINES[:701], LINES[0], *LINES[701:]]))
    assert (
        json.loads(done.stdout)["transitions"][0].items() >= {"on": True, "time_s": ONSET}.items()
    )
    assert "header" not in done.stderr


def test_a_file_may_begin_before_its_header_as_a_stream_may(tmp_path: Path) -> None:
    """Lines of a controller that ran already: the rest of a line,
    samples, the header with each second.
    """
    running = ["9948,2.3\n", *LINES[1:400], LINES[0], *LINES[1:701], LINES[0], *LINES[701:]]
    (tmp_path / "t.csv").write_text("".join(running))
    done = run("detect", tmp_path / "t.csv", "--json")
    assert done.exit_code == 0, done.stderr
    assert json.loads(done.stdout)["intervals"][0]["onset_s"] == ONSET
    assert "t.csv, lines 1 to 400: stand above the header, and are passed over" in done.stderr
    # Without a repeated header numpy's reader takes the file, and says the same.
    (tmp_path / "t.csv").write_text("".join(["9948,2.3\n", *LINES[1:400], *LINES]))
    assert "lines 1 to 400: stand above the header" in run("detect", tmp_path / "t.csv").stderr
    # No header in thousands of lines: the columns by number are proposed, and read the file.
    (tmp_path / "t.csv").write_text("".join(LINES[1:]) + "made by a logger\n")
    assert "--column time_s=1 --column voltage_v=2" in run("detect", tmp_path / "t.csv").stderr


def test_a_stream_in_other_units_and_by_number() -> None:
    words = ("--time-scale", "us", *BY_NUMBER, "--json")
    done = run("detect", "-", *words, lines=rows(f"{1e6 * t:.0f}" for t in T))
    assert (
        json.loads(done.stdout)["transitions"][0].items() >= {"on": True, "time_s": ONSET}.items()
    )


def save_mat(path: Path, **arrays: object) -> None:
    pytest.importorskip("scipy.io").savemat(path, arrays, do_compression=True)


def save_parquet(path: Path, **arrays: object) -> None:
    pyarrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    parquet.write_table(pyarrow.table(arrays), path)


def save_wav(path: Path, width: int = 2, channels: int = 1, rate: int = 2000) -> None:
    full = 2 ** (8 * width - 1)
    counts = np.round(V / 10 * full).astype("<i4")
    data = counts.view(np.uint8).reshape(-1, 4)[:, :width]
    frames = np.hstack([np.zeros((len(V), width * (channels - 1)), np.uint8), data])
    with wave.open(str(path), "wb") as file:
        file.setparams((channels, width, rate, len(V), "NONE", ""))
        file.writeframes(frames.tobytes())


# Name of the file -> how to save it, options, tolerance of the voltage [V].
ARRAYS: dict[str, tuple[Callable[[Path], None], tuple[object, ...], float]] = {
    "column vectors.mat": (
        lambda p: save_mat(p, time_s=T[:, None], voltage_v=V[:, None], other=np.eye(3)),
        (),
        0.0,
    ),
    "dates.parquet": (
        lambda p: save_parquet(p, time_s=np.array(DATES, dtype="datetime64[ns]"), voltage_v=V),
        (),
        0.0,
    ),
    "24 bits.wav": (lambda p: save_wav(p, 3), ("--scale", 10), 1e-6),
    "16 bits.wav": (save_wav, ("--scale", 10), 2e-4),
    "32 bits.wav": (lambda p: save_wav(p, 4), ("--scale", 10), 1e-8),
    "stereo.wav": (lambda p: save_wav(p, 3, 2), ("--scale", 10, "--column", "voltage_v=2"), 1e-6),
    "named columns.npy": (
        lambda p: np.save(
            p, np.array(list(zip(T, V, strict=True)), dtype=[("time_s", "f8"), ("voltage_v", "f8")])
        ),
        (),
        0.0,
    ),
    "three columns.npy": (
        lambda p: np.save(p, np.column_stack((0 * T, T, V))),
        ("--column", "time_s=2", "--column", "voltage_v=3"),
        0.0,
    ),
    "numpy without suffix": (lambda p: np.save(p.open("wb"), np.column_stack((T, V))), (), 0.0),
    "half precision of nothing else.npz": (
        lambda p: np.savez(p, time_s=T.astype("f4"), voltage_v=V.astype("f4")),
        (),
        1e-6,
    ),
    "whole nanoseconds.npz": (
        lambda p: np.savez(p, time_s=np.arange(len(T), dtype="i8") * 500_000, voltage_v=V),
        ("--time-scale", "ns"),
        0.0,
    ),
}


@pytest.mark.parametrize("name", ARRAYS)
def test_files_of_arrays_are_read(tmp_path: Path, name: str) -> None:
    save, options, tolerance = ARRAYS[name]
    save(tmp_path / name)
    done = run("detect", tmp_path / name, *options, "--json")
    assert single_onset(done) == pytest.approx(ONSET, abs=0.001)
    column_map = replace(_column_map(options), scale=10 if "wav" in name else 1)
    trace = read_raw_trace(tmp_path / name, column_map).trace
    assert np.abs(trace.voltage_v - V).max() <= tolerance
    assert ("dates are read as seconds since" in done.stderr) == ("dates" in name)


def npy_header(shape: str, dtype: str = "<f8") -> bytes:
    text = f"{{'descr': '{dtype}', 'fortran_order': False, 'shape': {shape}, }}".ljust(117) + "\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text.encode()


def npz_of(**members: bytes) -> bytes:
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            archive.writestr(f"{name}.npy", content)
    return data.getvalue()


def npz(**arrays: object) -> bytes:
    data = io.BytesIO()
    np.savez_compressed(data, **arrays)
    return data.getvalue()


def flip(content: bytes, place: int, count: int = 40) -> bytes:
    return (
        content[:place]
        + bytes(255 - b for b in content[place : place + count])
        + content[place + count :]
    )


SOUND = npz(time_s=T, voltage_v=V)
HUGE = "(10000000000000,)"

DAMAGED: dict[str, tuple[Callable[[], bytes], str]] = {
    "deflate.npz": (
        lambda: flip(SOUND, len(SOUND) // 2),
        "is not a NumPy archive that can be read",
    ),
    "short.npz": (lambda: SOUND[: len(SOUND) // 2], "is not a NumPy archive that can be read"),
    "huge.npz": (
        lambda: npz_of(time_s=npy_header(HUGE), voltage_v=npy_header(HUGE)),
        "claims to hold 1e+13 values; at most 8388608 samples are read",
    ),
    "huge.npy": (lambda: npy_header(HUGE), "claims to hold 1e+13 values"),
    "objects.npy": (
        lambda: npy_header("(2,)", "|O") + bytes(16),
        "it holds objects, which only pickle reads",
    ),
    "low rate.npz": (
        lambda: npz(voltage_v=V, sample_rate_hz=5e-324),
        "sample_rate_hz: contains 5e-324; save the rate",
    ),
    **{
        f"{kind[:2]} {kind[3:-1]}.npz": (
            lambda kind=kind: npz(time_s=np.arange(2000).astype(kind), voltage_v=V),
            f"time_s: has the type {np.dtype(kind)}; give an array of numbers.",
        )
        for kind in ("M8[Y]", "M8[as]", "M8", "m8[Y]")
    },
    "0-d.npz": (
        lambda: npz(time_s=np.array(0.0), voltage_v=np.array(2.3)),
        "voltage_v: is a single number; give one",
    ),
    "not a time.npz": (
        lambda: npz(time_s=np.full(2000, "NaT", "M8[s]"), voltage_v=V),
        "nan at sample 0",
    ),
    "damaged.mat": (
        lambda: (
            b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM\x0f\0\0\0\xff\xff\xff\x7f" + bytes(50)
        ),
        "is not a MATLAB file that can be read",
    ),
    "short.parquet": (
        lambda: b"PAR1" + bytes(40) + b"\xff\xff\xff\x7fPAR1",
        "is not a Parquet file that can be read",
    ),
    "short.wav": (lambda: b"RIFF\xff\xff\xff\xffWAVEfmt ", "is not a WAV file that can be read"),
    "no rate.wav": (
        lambda: (
            b"RIFF"
            + struct.pack("<I", 100)
            + b"WAVEfmt "
            + struct.pack("<IHHIIHH", 16, 1, 1, 0, 0, 2, 16)
            + b"data"
            + struct.pack("<I", 8)
            + bytes(8)
        ),
        "sample_rate_hz: contains 0",
    ),
    "damaged.tdms": (
        lambda: b"TDSm" + b"\xff" * 60,
        "contains no arrays; save time_s and voltage_v.",
    ),
    "text.tdms": (lambda: b"text", "is not a TDMS file that can be read"),
    "text.npy": (lambda: PLAIN.encode(), "is not a NumPy file that can be read"),
}


@pytest.mark.parametrize("name", DAMAGED)
def test_damaged_files_are_refused_in_sentences(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    monkeypatch.setenv("FINGERTIP_MAX_SAMPLES", str(2**23))
    make, message = DAMAGED[name]
    for module, suffix in (("scipy", ".mat"), ("pyarrow", ".parquet"), ("nptdms", ".tdms")):
        if name.endswith(suffix):
            pytest.importorskip(module)
    (tmp_path / name).write_bytes(make())
    done = run("detect", tmp_path / name)
    assert done.exit_code == 2, done.output
    assert message in done.stderr
    assert all(line.startswith("error: ") for line in done.stderr.splitlines())
    assert type(done.exception) is SystemExit


def test_the_documentation_states_the_bounds_of_size() -> None:
    page = " ".join((ROOT / "docs/recordings.md").read_text(encoding="utf-8").split())
    bound = f"{SAMPLES_LIMIT.default:,}".replace(",", " ")
    assert f"At most {RECORDING_LIMIT.default / 1024:g} GB and {bound} samples are read" in page


def test_bounds_of_size(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "t.csv").write_text(PLAIN)
    np.save(tmp_path / "t.npy", np.column_stack((T, V)))
    monkeypatch.setenv("FINGERTIP_MAX_SAMPLES", "1500")
    assert (
        "claims to hold 1.5e+03 values; at most 1500 samples are read"
        in run("detect", tmp_path / "t.csv").stderr
    )
    assert "claims to hold 4e+03 values" in run("detect", tmp_path / "t.npy").stderr
    monkeypatch.delenv("FINGERTIP_MAX_SAMPLES")
    with (tmp_path / "t.csv").open("a") as file:
        file.write("\n" * 2**20)
    monkeypatch.setenv("FINGERTIP_MAX_RECORDING_MB", "1")
    message = (
        "at most 1 MB are read; cut the recording into parts, or raise FINGERTIP_MAX_RECORDING_MB."
    )
    assert message in run("detect", tmp_path / "t.csv").stderr


def test_times_with_gaps_are_not_restored() -> None:
    late = 6000 + np.delete(np.arange(40_000) / 2000, 30_000)
    assert restore_even_times(late) is None, "in double precision a missing sample shows"
    single = (3000 + np.delete(np.arange(40_000) / 2000, slice(30_000, 30_010))).astype(np.float32)
    assert restore_even_times(single.astype(np.float64)) is None
    assert restore_even_times(np.array([0.0, 1.0])) is None
    assert restore_even_times(np.zeros(10)) is None


def test_a_late_recording_in_single_precision_is_detected_with_a_note(tmp_path: Path) -> None:
    np.savez(tmp_path / "t.npz", time_s=(3000 + T).astype("f4"), voltage_v=V)
    done = run("detect", tmp_path / "t.npz", "--json")
    assert single_onset(done) == pytest.approx(3000 + ONSET, abs=0.001)
    assert "time_s: is in single precision; evenly spaced times are taken instead" in done.stderr


def test_coarse_steps_of_a_stream_are_warned_of_once() -> None:
    counts = np.round(np.tile(V, 3) / 5 * 1024)
    times = [f"{i / 2000:.4f}" for i in range(len(counts))]
    words = ("detect", "-", "--scale", 5 / 1024, "--json")
    done = run(*words, lines="time_s,voltage_v\n" + rows(times, volts=counts))
    assert done.exit_code == 0
    assert done.stderr.count("warning: the voltages come in steps of 4.88 mV") == 1
    assert done.stderr.count("or use --detector fast, which learns the steps") == 1
    fine = run(
        "detect", "-", "--json", lines="time_s,voltage_v\n" + rows(times, volts=np.tile(V, 3))
    )
    assert fine.stderr == "detector digital, on voltage_v\n"


@pytest.mark.full
def test_fine_steps_are_not_warned_of(tmp_path: Path) -> None:
    t = np.arange(60 * 2000) / 2000
    step = 5 / 2**14
    volts = (
        2.3 + 0.05 * np.sin(2 * np.pi * 0.3 * t) + np.random.default_rng(0).normal(0, 4e-4, len(t))
    )
    np.savez(tmp_path / "t.npz", time_s=t, voltage_v=np.round(volts / step))
    assert run("detect", tmp_path / "t.npz", "--detector", "fast", "--scale", step).stderr == ""
    assert find_step_v(np.load(tmp_path / "t.npz")["voltage_v"] * step) == pytest.approx(step)
    assert find_step_v(np.full(9, 4.0)) is None
    assert find_step_v(np.array([0.0, 1.0, 2.5])) is None
    assert find_step_v(V) is None or find_step_v(V) < 1e-6
    assert find_step_v(np.round(V / 0.01) * 0.01) == pytest.approx(0.01)


@pytest.mark.parametrize(("delimiter", "comma"), [(",", False), (";", True)])
def test_quoted_numbers_are_read(tmp_path, delimiter, comma):
    text = re.sub(f"[^{delimiter}\n]+", r'"\g<0>"', csv(T, V, delimiter, comma=comma))
    assert text.splitlines()[1].startswith('"0,000000";"' if comma else '"0.000000","')
    (tmp_path / "t.csv").write_text(text)
    assert single_onset(run("detect", tmp_path / "t.csv", "--json")) == ONSET
    transitions = json.loads(run("detect", "-", "--json", lines=text).stdout)["transitions"]
    assert transitions[0].items() >= {"on": True, "time_s": ONSET}.items()
    (tmp_path / "t.csv").write_text(
        text.replace('"0' + ("," if comma else ".") + '000500"', '"NA"')
    )
    stderr = run("detect", tmp_path / "t.csv").stderr
    assert "'NA' in line 3 is not a number" in stderr


SAVED = {
    "a spreadsheet's first line": "sep=;\n" + csv(T, V, ";", comma=True),
    "comments": "# recorded today\n\n#\n" + PLAIN,
    "a header that is a comment": "# " + PLAIN,
    "LabVIEW": "LabVIEW Measurement\t\nWriter_Version\t2\nSamples\t2000\t\n***End_of_Header***\t\n"
    + csv(T, V, "\t", ("time_s", "voltage_v\tComment"), comma=True),
    "units below": "time_s,voltage_v\n[s],V\n" + PLAIN.split("\n", 1)[1],
    "another case": "Time_s,Voltage_V\n" + PLAIN.split("\n", 1)[1],
}


@pytest.mark.parametrize("name", SAVED)
def test_preambles_and_unit_lines_are_skipped(tmp_path, name):
    (tmp_path / "t.csv").write_text(SAVED[name])
    assert single_onset(run("detect", tmp_path / "t.csv", "--json")) == ONSET
    (tmp_path / "u16.csv").write_bytes(SAVED[name].encode("utf-16"))
    assert single_onset(run("detect", tmp_path / "u16.csv", "--json")) == ONSET
    data = json.loads(run("detect", "-", "--json", lines=SAVED[name]).stdout)
    assert data["transitions"][0].items() >= {"on": True, "time_s": ONSET}.items()
    # The messages number the lines as an editor does.
    lines = SAVED[name].splitlines()
    first = next(i for i, line in enumerate(lines) if line[:4] in ("0.00", "0,00"))
    lines[first + 100] = "word" + lines[first + 100][4:]
    (tmp_path / "t.csv").write_text("\n".join(lines))
    assert f" in line {first + 101} is not a number" in run("detect", tmp_path / "t.csv").stderr
    assert (
        f"standard input, line {first + 101}: 'word"
        in run("detect", "-", lines="\n".join(lines)).stderr
    )


SUGGESTIONS = {
    "Time [s],AI0 (V)": " Or name the file's columns: --column time_s='Time [s]' --column "
    "voltage_v='AI0 (V)'",
    "AI0,Time": "--column time_s=Time --column voltage_v=AI0",
    "date,temp,elapsed_s,ch1": "--column time_s=elapsed_s --column voltage_v=ch1",
    "time_s,force_n": "Or name the file's column: --column voltage_v=force_n --calibrate 0:0.5",
    "t,Load [N]": "--column time_s=t --column voltage_v='Load [N]' --calibrate 0:0.5",
    "time_s,Time_S,Voltage_V,VOLTAGE_V": "--column voltage_v=Voltage_V",
    "time_s,level": "--column voltage_v=level",
}


@pytest.mark.parametrize("header", SUGGESTIONS)
def test_columns_are_suggested_as_options_that_work(tmp_path, header):
    cells = {
        name: (V if name in SUGGESTIONS[header].replace("'", "") else 0 * V)
        for name in header.split(",")
    }
    for time in ("Time [s]", "Time", "elapsed_s", "time_s", "t"):
        if time in cells:
            cells[time] = T
    rows = "\n".join(",".join(f"{x:.6f}" for x in row) for row in zip(*cells.values(), strict=True))
    (tmp_path / "t.csv").write_text(f"made by a logger\n{header}\n{rows}\n")
    done = run("detect", tmp_path / "t.csv")
    assert done.exit_code == 2
    assert "t.csv, line 2: " in done.stderr
    assert SUGGESTIONS[header] in done.stderr
    options = shlex.split(re.search(r"(--column.*?)(?: \(a force|$)", done.stderr, re.MULTILINE)[1])
    if "--calibrate" in options:
        options[-1] = "0:0.4"
    assert single_onset(run("detect", tmp_path / "t.csv", *options, "--json")) == pytest.approx(
        ONSET, abs=0.006
    )


@pytest.mark.full
def test_tdms_file_written_by_nptdms_is_read(tmp_path):
    nptdms = pytest.importorskip(
        "nptdms", reason="the extra tdms is not installed; a fake library is tested below"
    )
    channel = nptdms.ChannelObject(
        "group", "AI0", np.round(V, 6), properties={"wf_increment": 1 / 2000}
    )
    with nptdms.TdmsWriter(tmp_path / "t.tdms") as writer:
        writer.write_segment([channel])
    (tmp_path / "t.tdms_index").write_bytes(b"TDSh" + bytes(60))  # the library would read it
    assert single_onset(run("detect", tmp_path / "t.tdms", "--json")) == ONSET


def test_daqmx_data_of_a_tdms_file_is_read(tmp_path):
    pytest.importorskip("nptdms")
    counts = np.round(V * 1000).astype("<i2")
    index = struct.pack("<3IQ", 0x1269, 2, 1, len(counts)) + struct.pack(
        "<8I", 1, 3, 0, 0, 0, 0, 1, 2
    )
    increment = struct.pack("<I12sId", 12, b"wf_increment", 10, 1 / 2000)
    names = struct.pack("<2I9s", 1, 9, b"/'g'/'v1'") + index + struct.pack("<I", 1) + increment
    lead_in = struct.pack("<4sIIQQ", b"TDSm", 0x8E, 4713, len(names) + 2 * len(counts), len(names))
    (tmp_path / "t.tdms").write_bytes((lead_in + names + counts.tobytes()) * 2)
    done = run("detect", tmp_path / "t.tdms", "--scale", 1e-3, "--json")
    assert json.loads(done.stdout)["intervals"][0]["onset_s"] == pytest.approx(ONSET, abs=0.002)


def test_columns_of_text_of_a_parquet_file_are_refused(tmp_path):
    save_parquet(tmp_path / "t.parquet", time_s=T, voltage_v=["2.3 V"] * len(T))
    save_parquet(
        tmp_path / "u.parquet", time_s=T, voltage_v=V, **{"voltage_v.raw": ["2.3 V"] * len(T)}
    )
    for name in ("t.parquet", "u.parquet"):
        assert (
            "voltage_v: has the type object; give an array of numbers."
            in run("detect", tmp_path / name).stderr
        )


def test_a_scale_under_which_voltages_overflow_gives_infinite_ones_without_a_warning() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        trace = ColumnMap({}, scale=1e300).make_trace({"time_s": T, "voltage_v": 1e10 * V})
    assert np.isposinf(trace.voltage_v).all()


def test_read_trace_in_python(tmp_path):
    (tmp_path / "t.csv").write_text(csv(T, V, header=("t", "AI0")))
    trace = fingertip.read_trace(tmp_path / "t.csv", columns={"time_s": "t", "voltage_v": "AI0"})
    assert fingertip.detect(trace, Design()).intervals[0].onset_s == ONSET
    np.save(tmp_path / "v.npy", V)
    assert len(fingertip.read_trace(tmp_path / "v.npy", rate_hz=1000).time_s) == len(V)
    assert np.array_equal(
        fingertip.read_trace(str(tmp_path / "v.npy"), rate_hz=2000, scale=0.5).voltage_v, 0.5 * V
    )
    with pytest.raises(
        fingertip.FingertipError,
        match="is sampled at 2000 Hz, but the detector is designed for 4000",
    ):
        fingertip.read_trace(
            tmp_path / "t.csv",
            Design(detector={"sample_rate_hz": 4000.0}),
            {"time_s": "t", "voltage_v": "AI0"},
        )


@pytest.mark.parametrize(
    ("unit", "per_s"), [("milliseconds", 1e3), ("microseconds", 1e6), ("nanoseconds", 1e9)]
)
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
    remedy = shlex.split(re.search(r"ignore the times with (.*)$", done.stderr, re.MULTILINE)[1])
    assert single_onset(run("detect", tmp_path / "t.csv", *remedy, "--json")) == pytest.approx(
        ONSET, abs=0.001
    )
    live = run("detect", "-", lines=(tmp_path / "t.csv").read_text())
    assert "line 50: 0.0245 s is 0.001 s after the previous sample" in live.stderr
    assert (
        shlex.split(re.search(r"ignore the times with (.*)$", live.stderr, re.MULTILINE)[1])
        == remedy
    )


@pytest.mark.full
def test_a_matlab_file_that_unpacks_to_much_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(array_files, "_memory_bytes", lambda: 2**29)
    save_mat(
        tmp_path / "t.mat", time_s=T, voltage_v=V, s={"voltage_v": np.zeros(3 * 2**27, np.uint8)}
    )
    assert run("detect", tmp_path / "t.mat").exit_code == 0, "what no column takes is not unpacked"
    done = run("detect", tmp_path / "t.mat", "--column", "voltage_v=s/voltage_v")
    assert "is not a MATLAB file that can be read" in done.stderr


def test_a_file_of_comments_is_bounded(tmp_path, monkeypatch):
    monkeypatch.setenv("FINGERTIP_MAX_SAMPLES", "100")
    (tmp_path / "t.csv").write_bytes(b"time_s,voltage_v\n" + b"#\n" * 20_000)
    assert "has more than 10200 lines" in run("detect", tmp_path / "t.csv").stderr
