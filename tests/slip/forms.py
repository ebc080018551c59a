"""Corpus of 200 generated forms of recordings: instrument, separator, decimals, header, preamble,
units, other columns.

Written before the readers were made for it, from what oscilloscopes, loggers, serial monitors and
bags of ROS write. All hold one signal: a held voltage, and slip from 0.5 to 1.0 s. Text forms are
combined at random with a fixed seed.
"""

from __future__ import annotations

import functools
import io
import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

RATE_HZ = 2000
SLIP_S = (0.5, 1.0)
COUNT = 200
T = np.arange(2 * RATE_HZ) / RATE_HZ
_NOISE = np.random.default_rng(90).normal(0.0, 4e-4, (2, len(T)))
V = 1.0 + _NOISE[0] + 0.02 * np.sin(2 * np.pi * 90 * T) * ((SLIP_S[0] <= T) & (SLIP_S[1] > T))
OTHER = 0.4 + _NOISE[1]
"""A second channel, on which nothing happens."""
START_NS = 1_717_199_999_700_000_000
Column = tuple[str, str, Sequence[str]]
"""Name, unit and cells."""


@dataclass(frozen=True)
class Form:
    name: str
    file: str
    content: bytes

    def write(self, folder: Path) -> Path:
        path = folder / self.file
        path.write_bytes(self.content)
        return path


def _time(rng: random.Random) -> list[Column]:
    kind = rng.choice(
        ["s", "ms", "us", "ns", "since zero of the trigger", "stamp", "two columns", "counter"]
    )
    if kind == "two columns":
        stamps = [START_NS + round(t * 1e9) for t in T]
        return [
            ("sec", "", [str(n // 10**9) for n in stamps]),
            ("nanosec", "", [str(n % 10**9) for n in stamps]),
        ]
    cells = {
        "s": lambda t: f"{t:.6f}",
        "ms": lambda t: f"{1e3 * t:.3f}",
        "us": lambda t: f"{1e6 * t:.0f}",
        "ns": lambda t: f"{1e9 * t:.0f}",
        "since zero of the trigger": lambda t: f"{t - 1.0:+.6E}",
        "stamp": lambda t: str(START_NS + round(t * 1e9)),
        "counter": lambda t: f"{t * RATE_HZ:.0f}",
    }[kind]
    names = {
        "stamp": ("field.header.stamp", "timestamp", "%time"),
        "counter": ("seq", "sample", "Sample No."),
    }
    unit = {"ms": "ms", "us": "us", "ns": "ns"}.get(kind, "" if kind in names else "s")
    name = rng.choice(names.get(kind, ("time", "Time", "t", "X", "x-axis", "TIME")))
    return [(name, unit, [cells(t) for t in T])]


def _voltage(rng: random.Random) -> Column:
    kind = rng.choice(["V", "V", "mV", "counts", "1.2 V", "1,000.5"])
    name = rng.choice(("CH1", "Channel A", "voltage", "Volt", "A0", "field.data", "FSR", "1"))
    cells = {
        "V": lambda v: f"{v:.5f}",
        "mV": lambda v: f"{1e3 * v:.2f}",
        "counts": lambda v: f"{v / 3.3 * 4095:.0f}",
        "1.2 V": lambda v: f"{v:.5f} V",
        "1,000.5": lambda v: f"{1e3 * v:,.2f}",
    }[kind]
    return name, {"V": "V", "counts": "", "1.2 V": ""}.get(kind, "mV"), [cells(v) for v in V]


def _others(rng: random.Random) -> Iterator[Column]:
    n = len(T)
    for column in (
        ("field.header.seq", "", [str(700 + i) for i in range(n)]),
        ("frame_id", "", ["finger"] * n),
        ("Fs", "Hz", [str(RATE_HZ)] * n),
        ("status", "", ["0"] * n),
        ("CH2", "V", [f"{v:.5f}" for v in OTHER]),
        ("millis", "", [str(5000 + i // 2) for i in range(n)]),
    ):
        if rng.random() < 0.25:
            yield column


def _header(rng: random.Random, columns: Sequence[Column]) -> list[list[str]]:
    style = rng.choice(["names", "names", "names [unit]", "names (unit)", "unit row", "none"])
    names = [name for name, _, _ in columns]
    if style == "none":
        return []
    if style == "unit row":
        return [names, [f"({unit})" if unit else "" for _, unit, _ in columns]]
    brackets = {"names [unit]": " [{}]", "names (unit)": " ({})"}.get(style, "")
    return [[name + (brackets.format(unit) if unit else "") for name, unit, _ in columns]]


def _preamble(rng: random.Random, separator: str) -> list[str]:
    pairs = [
        ("Record Length", str(len(T))),
        ("Sample Interval", f"{1 / RATE_HZ:E}"),
        ("Vertical Scale", "0.5"),
        ("Model", "DS1104"),
        ("Sample Rate", f"{RATE_HZ} Hz"),
        ("Date", "2026-11-28 19:10"),
    ]
    kind = rng.choice(["none", "none", "pairs", "quoted pairs", "comments", "title"])
    lines = [separator.join(pair) for pair in rng.sample(pairs, 4)]
    return {
        "none": [],
        "pairs": lines,
        "comments": [f"# {line}" for line in lines],
        "title": ["Finger test 3", ""],
        "quoted pairs": [
            separator.join(f'"{cell}"' for cell in line.split(separator)) for line in lines
        ],
    }[kind]


def _table(rng: random.Random) -> str:
    """A table of any logger."""
    separator = rng.choice([",", ",", ";", "\t"])
    decimal = rng.choice([".", ".", ","])
    quoted = rng.random() < 0.2 or (decimal == "," and separator == ",")
    columns = [*_time(rng), _voltage(rng), *_others(rng)]
    if rng.random() < 0.4:
        rng.shuffle(columns)
    if rng.random() < 0.15:
        columns = [_voltage(rng)]
    if separator == "," and any("," in cells[0] for _, _, cells in columns):
        quoted = True

    def write(cell: str) -> str:
        if decimal == ",":
            cell = cell.translate(str.maketrans(".,", ",."))
        return f'"{cell}"' if quoted else cell

    rows = [
        [write(cell) for cell in row]
        for row in zip(*(cells for _, _, cells in columns), strict=True)
    ]
    if rng.random() < 0.1:
        rows[1700][-1] = rng.choice(["****", "OL", "inf", ""])
    table = [separator.join(row) for row in [*_header(rng, columns), *rows]]
    end = rng.choice(["\n", "\n", "\r\n"])
    return end.join([*_preamble(rng, separator), *table, ""])


def _rigol_z(rng: random.Random) -> str:
    head = f"X,CH1,Start,Increment,\nSequence,Volt,-1.0E+00,{1 / RATE_HZ:E}\n"
    return head + "".join(f"{i},{v:.5E},\n" for i, v in enumerate(V))


def _rigol_e(rng: random.Random) -> str:
    head = f'"Record Length",{len(T)},"Points"\n"Sample Interval",{1 / RATE_HZ:E},s\n'
    rows = "".join(f"{t - 1:.6E},{v:.5E},{o:.5E}\n" for t, v, o in zip(T, V, OTHER, strict=True))
    return f"{head}X,CH1,CH1\nSecond,Volt,Volt\n{rows}"


def _tektronix(rng: random.Random) -> str:
    side = [
        "Record Length,4000,Points",
        f"Sample Interval,{1 / RATE_HZ:E},s",
        "Vertical Units,V,",
        "Source,CH1,",
    ]
    side += [",,"] * (len(T) - len(side))
    return "".join(f"{left},{t - 1:.6f},{v:.5f},\n" for left, t, v in zip(side, T, V, strict=True))


def _labels(rng: random.Random) -> str:
    form = rng.choice(
        ["FSR1:{},FSR2:12", "FSR1: {} FSR2: 12", "A0={}", "12:30:01.123 -> {}", "ms:{ms} FSR:{}"]
    )
    counts = np.round(V / 3.3 * 4095).astype(int)
    return "".join(form.format(c, ms=1000 + i // 2) + "\r\n" for i, c in enumerate(counts))


def _json_lines(rng: random.Random) -> str:
    form = rng.choice(
        [
            '{{"t": {t:.4f}, "v": {v:.5f}}}',
            '{{"stamp": {{"sec": 12, "nanosec": {n}}}, "data": {v:.5f}}}',
        ]
    )
    return "".join(
        form.format(t=t, v=v, n=round(t % 1 * 1e9)) + "\n" for t, v in zip(T, V, strict=True)
    )


def _npz(rng: random.Random) -> bytes:
    buffer = io.BytesIO()
    runs = {"run1_time": T, "run1_force": OTHER, "run2_time": T, "run2_force": V}
    one = {
        rng.choice(["t", "time"]): T,
        "fs": np.array(RATE_HZ),
        rng.choice(["v", "ch1"]): V,
        "n": np.arange(len(T)),
    }
    np.savez(buffer, **rng.choice([runs, one]))
    return buffer.getvalue()


def _mat(rng: random.Random) -> bytes:
    from scipy.io import savemat

    buffer = io.BytesIO()
    two = {"trial1": {"t": T, "v": OTHER}, "trial2": {"t": T, "v": V}}
    savemat(
        buffer,
        rng.choice(
            [two, {"Fs": float(RATE_HZ), "data": V}, {"t": T, "x": np.column_stack([OTHER, V])}]
        ),
    )
    return buffer.getvalue()[:20].ljust(116) + buffer.getvalue()[116:]  # without the date of today


def _parquet(rng: random.Random) -> bytes:
    import pyarrow as pa
    import pyarrow.parquet as pq

    buffer = io.BytesIO()
    columns = {
        "header.stamp.sec": START_NS // 10**9 + np.floor(T + 0.7),
        "header.stamp.nanosec": (T + 0.7) % 1 * 1e9,
    }
    table = rng.choice(
        [{**columns, "data": V}, {"index": np.arange(len(T)), "time": T, "ch0": OTHER, "ch1": V}]
    )
    pq.write_table(pa.table(table), buffer)
    return buffer.getvalue()


def _tdms(rng: random.Random) -> bytes:
    from nptdms import ChannelObject, TdmsWriter

    buffer = io.BytesIO()
    step = {"wf_increment": 1 / RATE_HZ, "wf_start_offset": 0.0}
    groups = rng.choice(
        [{"Run1": {"AI0": V}, "Run2": {"AI0": OTHER}}, {"Log": {"Motor": OTHER, "FSR": V}}]
    )
    with TdmsWriter(buffer) as writer:
        for group, channels in groups.items():
            writer.write_segment(
                [ChannelObject(group, name, data, step) for name, data in channels.items()]
            )
    return buffer.getvalue()


KINDS = {
    "table": (".csv", _table, 145),
    "Rigol DS1000Z": (".csv", _rigol_z, 1),
    "Rigol DS1000E": (".csv", _rigol_e, 1),
    "Tektronix": (".csv", _tektronix, 1),
    "labels": (".txt", _labels, 16),
    "JSON lines": (".txt", _json_lines, 6),
    "NPZ": (".npz", _npz, 7),
    "MAT": (".mat", _mat, 9),
    "Parquet": (".parquet", _parquet, 6),
    "TDMS": (".tdms", _tdms, 8),
}
"""Kind -> suffix, function that writes one, how many."""


NAMES = [f"{kind} {i}" for kind, (_, _, count) in KINDS.items() for i in range(count)]


@functools.cache
def make_forms() -> dict[str, Form]:
    """Make the corpus, by name. It takes seconds, so only tests that read it ask for it."""
    return {form.name: form for form in _list_forms()}


def _list_forms() -> Iterator[Form]:
    for kind, (suffix, write, count) in KINDS.items():
        rng = random.Random(kind)
        for i in range(count):
            content = write(rng)
            yield Form(
                f"{kind} {i}",
                f"form{i}{suffix}",
                content.encode() if isinstance(content, str) else content,
            )
