"""What `fingertip detect` says of recordings and options that it cannot use, or warns of: whole
outputs, approved.

After a change that is meant, `FINGERTIP_APPROVE=1 pytest tests/slip/test_refusals.py` writes them;
then read them.
"""

from __future__ import annotations

import gzip
import json
import pickle
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.approved import check_text
from tests.conftest import ROOT
from tests.slip.recordings import DATES, PLAIN, T, V, burst, csv, lvm, rows, run, zip_of

HEADER = "time_s,voltage_v,force_n,slip"
GOOD = [f"{i / 2000:.4f},2.3,0.8,0" for i in range(200)]
LINES = PLAIN.splitlines(keepends=True)


def table(*changes: tuple[int, str], lines: list[str] = GOOD, header: str = HEADER) -> str:
    edited = dict(enumerate(lines)) | dict(changes)
    return "\n".join([header, *edited.values()]) + "\n"


def with_lines(*changes: tuple[int, str]) -> str:
    """The recording with other lines in place of some, which are counted from 1."""
    edited = dict(enumerate(LINES, start=1)) | {number: text + "\n" for number, text in changes}
    return "".join(edited.values())


OUTSIDE_GAP = (np.arange(2000) < 300) | (np.arange(2000) >= 400)
FLOAT_WAV = (
    b"RIFF"
    + struct.pack("<I", 44)
    + b"WAVEfmt "
    + struct.pack("<IHHIIHH", 16, 3, 1, 2000, 8000, 4, 32)
)
FORCE = csv(T, np.where(T < 0.3, 0.0, np.abs(V - 3.9)), header=("time_s", "force_n"))
CLEAR_TEXT = np.array(["a"] * 2000)
NOISE_FROM_3_S = np.random.default_rng(8).normal(0, 4e-4, 12_000) * np.where(
    np.arange(12_000) > 6000, 3.0, 1.0
)
GRASPED = csv(np.arange(12_000) / 2000, 2.6 + NOISE_FROM_3_S - 0.3 * (np.arange(12_000) > 6000))
LONG_S = np.arange(12_000) / 2000
WEAK_SLIDE = 2.6 + np.random.default_rng(8).normal(
    0, np.where((LONG_S > 3.0) & (LONG_S < 4.2), 2e-3, 4e-4)
)
VIBRATING = {
    "time_s": LONG_S,
    "voltage_v": 2.0
    + np.random.default_rng(2).normal(0, 4e-4, 12_000)
    + 0.01 * np.sin(2 * np.pi * 90 * LONG_S) * ((LONG_S > 2.0) & (LONG_S < 2.3)),
}

# Family -> cases: content of a file, or arrays of an archive; options. A dash among them makes the
# file a stream.
FAMILIES: dict[str, list[tuple[Any, ...]]] = {
    "tables": [
        (table(header="time_s,volts,force_n,slip"),),
        (table(header="1,2,3,4"),),
        (table(header="time_s,voltage_v,voltage_v,slip"),),
        (table((7, "0.0035,nan,0.8,0")),),
        (table((7, "0.0035,4 V,0.8,0")),),
        (table((7, "0.0035,4,0.8,2")),),
        (table((7, "0.0035,4")),),
        (table(lines=GOOD[:50] + GOOD[60:]),),
        (table(lines=GOOD[:50] + GOOD[49:]),),
        (table(lines=GOOD[:50] + GOOD[40:]),),
        (table(lines=GOOD[:59]),),
        (table((3, "0.0015,nan,0.8,0"), (7, "0.0035,4,x,0"), (9, "0.0020,4,0.8,0")), "--json"),
        (b"",),
        (b"\x89PNG\x00\xff\xfe",),
        (b"hello\nworld\n",),
        (b"\n\n",),
        (table(lines=[line.rsplit(",", 2)[0] for line in GOOD], header="time_s,voltage_v"),),
        (
            table(lines=[line.rsplit(",", 2)[0] for line in GOOD], header="time_s,voltage_v"),
            "--json",
        ),
        (table(lines=[f"{i / 2000:.4f},{3.3 - 3.3 / 4096:.6f},0.8,0" for i in range(200)]),),
        (table(lines=[f"{i / 2000:.4f},0.0,0.8,0" for i in range(200)]),),
        (with_lines((50, "0.024000,"), (60, "0.029000,")),),
        ("".join([*LINES[:701], LINES[0], "\n", *LINES[701:998], "nan,2.3\n", *LINES[999:]]),),
        ("".join([*LINES[:701], LINES[0], "\n", *LINES[701:998], "word,2.3\n", *LINES[999:]]),),
        (with_lines((1001, "0.5000")),),
        (with_lines((1001, "0.5000,x")),),
        (PLAIN + "1.000000,NA\n",),
        (b"time_s,voltage_v" + b" " * 2**20 + b"\n0,1\n",),
        (b"time_s,voltage_v\n" + b"0.0,1\n" * 10 + b"1" * 2**21,),
    ],
    "signals": [
        (csv(T, np.full(2000, 2.3)),),
        (csv(T, np.minimum(V + 1.0, 3.3)),),
        (csv(T, V, "|"),),
        (csv(T, V, comma=True),),
        (csv(T - 0.3, V),),  # times relative to a trigger are valid
        (csv(-T, V),),
        (csv(np.floor(T * 1000) / 1000, V),),
        (csv(T, np.round(V / 20 * 65536)),),
        (csv(T, 1000 * V),),
        (csv(1000 * T, V),),
        (csv(*burst(500.0)),),
        (csv(T[OUTSIDE_GAP], V[OUTSIDE_GAP]),),
    ],
    "archives": [
        ({},),
        ({"time_s": T, "voltage_v": CLEAR_TEXT},),
        ({"time_s": T, "volts": V},),
        ({"voltage_v": V},),
        ({"voltage_v": V, "sample_rate_hz": 0},),
        ({"time_s": T, "voltage_v": V[:-1]},),
        *(
            ({"voltage_v": CLEAR_TEXT, "sample_rate_hz": rate},)
            for rate in (
                np.array("2 kHz"),
                np.zeros(0),
                np.inf,
                np.array([2000.0, 5000.0]),
                2000 + 1j,
            )
        ),
        ({"voltage_v": np.round(V, 6), "sample_rate_hz": np.inf}, "--rate-hz", 2000),
        ({"time_s": np.array(DATES, dtype="datetime64[us]"), "voltage_v": V}, "--time-scale", "ms"),
    ],
    "options": [
        *(
            (PLAIN, *options)
            for options in (
                ("--column", "voltage_v"),
                ("--column", "volts=AI0"),
                ("--column", "voltage_v=nope"),
                ("--scale", 0),
                ("--rate-hz", 0),
                ("--detector", "fats"),
            )
        ),
        *(
            (rows(T), *options)
            for options in (
                ("--time-scale", "minutes"),
                ("--time-scale", 0),
                ("--time-scale", "nan"),
                ("--rate-hz", "nan"),
                ("--column", "voltage_v=0", "--column", "time_s=1"),
                ("--column", "voltage_v=99999999999999", "--column", "time_s=1"),
                ("--column", "voltage_v=2", "--column", "time_s=none"),
            )
        ),
        *(
            (
                "voltage_v\n" + "4.0\n" * 500,
                "--rate-hz",
                rate,
                "--set",
                "detector.window_samples=40",
            )
            for rate in ("1e308", "1e-308", "inf")
        ),
        ("time_s,voltage_v\n" + rows(DATES), "--time-scale", "ms"),
        (Path("params/fsr400.toml"),),
        (Path("params/scenes/hard_tap.toml"),),
        (
            lvm("One")
            .replace("X_Value\tVoltage\tComment", "X_Value\tVoltage\tLoad cell")
            .replace("\n", "\t1.5\n"),
        ),
        (lvm("No").replace("Delta_X\t0.000500", "Delta_X\tnan"),),
    ],
    "quiet parts": [
        *(
            (PLAIN, "--calibrate", part, *more)
            for part, more in (
                ("0:0.01", ()),
                ("0:5", ()),
                ("0:1", ()),
                ("0:inf", ()),
                ("0:-1", ()),
                ("0:0.9", ()),
                ("0:0.4", ()),
                ("0:nan", ("--detector", "analog")),
                ("4.0", ()),
            )
        ),
        ({"time_s": T, "voltage_v": V, "slip": (T >= 0.5) & (T < 0.7)}, "--calibrate", "0:0.9"),
        *(
            (GRASPED, "--calibrate", part)
            for part in ("2.5:3.5", "9:9.5", "4:4.1", "0:9", "3:9", "3:6")
        ),
        (VIBRATING, "--calibrate", "0.5:5.5", "--detector", "fast"),
        *(
            (csv(LONG_S, WEAK_SLIDE), "--detector", "fast", *more)
            for more in ((), ("--calibrate", "3.2:4"))
        ),
        (csv(LONG_S, WEAK_SLIDE), "--detector", "digital", "--calibrate", "3.2:4"),
        *(
            (FORCE, "--column", "voltage_v=force_n", "--detector", "fast", *more)
            for more in ((), ("--calibrate", "0:0.3"), ("--calibrate", "0:0.4"))
        ),
    ],
    "outside the fit": [
        (csv(T, V + 2e-3 * np.sin(2 * np.pi * 50 * T)),),
        (csv(T, V + 2e-3 * np.sin(2 * np.pi * 60 * T)),),
        (csv(T, V + 1e-3 * np.sin(2 * np.pi * 50 * T)),),
        (csv(T, V + 3e-3 * np.sin(2 * np.pi * 40 * T)),),
        (csv(LONG_S, 3.1 - 0.5 * np.clip(LONG_S - 1, 0, 1) + NOISE_FROM_3_S),),
        (
            csv(LONG_S, 3.1 - 0.5 * np.clip(LONG_S - 1, 0, 1) + NOISE_FROM_3_S),
            "--design",
            "article",
        ),
        (
            csv(T, np.where(np.isin(np.arange(len(T)), [400, 800, 900, 1100]), 0.3, V)),
            "--detector",
            "fast",
        ),
        (csv(LONG_S, 2.0 + 8 * NOISE_FROM_3_S), "--detector", "fast"),
        (csv(LONG_S, 2.0 + 8 * NOISE_FROM_3_S), "--detector", "fast", "--calibrate", "4:5"),
        (csv(LONG_S, 2.0 + 8 * NOISE_FROM_3_S), "--detector", "digital", "--calibrate", "4:5"),
        ("".join(f"T:{v:.4f},S:1.65\n" for v in V),),
        ("".join(f"12:00:00.{i:04d} -> {v:.4f}\n" for i, v in enumerate(V)),),
    ],
    "streams": [
        *(
            (with_lines((1500, text)), "-")
            for text in (
                "1500",
                "0.749,nan",
                "0.749,4 V",
                "0.8,2.3",
                "0.7485,2.3",
                "no timer is free",
                "0.749,x\x07" + 300 * "y",
            )
        ),
        ("", "-"),
        ("time_s,voltage_v\n", "-"),
        (PLAIN, "-", "--plot", "p.png"),
        (with_lines((50, "0.024000,")), "-"),
        ("".join(LINES[:100]), "-"),
        ("".join(LINES[:31]), "-"),
        ("x" * (2**20 + 1), "-"),
        *(
            (csv(T, volts), "-")
            for volts in (np.round(V / 3.3 * 4096), 1000 * V, np.where(T < 0.1, V, 11.0))
        ),
        (csv(T, 1000 * V), "-", "--scale", 0.001),
        (csv(*burst(5000.0)), "-", "--rate-hz", 5000),
    ],
}

# Name of a file of another kind -> its content; it is answered by how to convert it.
OTHER_KINDS: dict[str, bytes] = {
    "t.xlsx": zip_of("[Content_Types].xml", "xl/workbook.xml"),
    "t.xls": b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(504),
    "v7.3.mat": b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(512) + b"\x89HDF\r\n\x1a\n",
    "t.csv.gz": gzip.compress(PLAIN.encode()),
    "t.pkl": pickle.dumps([1, 2]),
    "t.json": json.dumps({"t": [1, 2]}).encode(),
    "float.wav": FLOAT_WAV + b"data" + struct.pack("<I", 8) + bytes(8),
}


def describe(folder: Path, path: Path | str, *words: Any, lines: str | None = None) -> str:
    """Run the command and return what it says, without the folder; nothing may end in a
    traceback.
    """
    done = run("detect", path, *words, lines=lines)
    said = [f"exit {done.exit_code}", *done.stdout.splitlines(), *done.stderr.splitlines()]
    assert type(done.exception) in (SystemExit, type(None)), words
    assert done.exit_code in (0, 2)
    assert done.exit_code == 0 or "-" in (path, *words) or "--json" in words or not done.stdout
    return "\n".join(line.replace(f"{folder}/", "").replace(f"{ROOT}/", "") for line in said)


@pytest.mark.every_case
@pytest.mark.parametrize("family", FAMILIES)
def test_outputs_are_the_approved_ones(family: str, tmp_path: Path) -> None:
    told = []
    for number, (content, *words) in enumerate(FAMILIES[family], start=1):
        path = tmp_path / ("t.npz" if isinstance(content, dict) else "t.csv")
        lines = None
        if isinstance(content, Path):
            path = ROOT / content
        elif isinstance(content, dict):
            np.savez(path, **content)
        elif "-" in words:
            path = Path("-")
            lines = content
        else:
            path.write_bytes(content if isinstance(content, bytes) else content.encode())
        options = [word for word in words if word != "-"]
        said = describe(tmp_path, str(path), *options, lines=lines)
        source = "standard input" if lines is not None else path.name
        told.append(f"{number}: {source} {' '.join(map(str, options))}\n{said}")
    approved = Path(__file__).with_name("approved") / f"refusals_{family.replace(' ', '_')}.txt"
    check_text(approved, "\n\n".join(told) + "\n")


def test_other_kinds_of_files_are_answered_by_how_to_convert_them(tmp_path: Path) -> None:
    told = []
    for name, content in OTHER_KINDS.items():
        (tmp_path / name).write_bytes(content)
        said = describe(tmp_path, tmp_path / name)
        assert said.count("error: ") == 1
        told.append(said)
    check_text(Path(__file__).with_name("approved") / "other_kinds.txt", "\n\n".join(told) + "\n")
