"""Processor time and memory of `fingertip detect` on long recordings, beside pandas and scipy.

    python benchmarks/recordings.py [--minutes 60] [--repeats 3] [--base FOLDER]

One recording at 2 kHz is read as CSV, NPY, Parquet, and as a stream of lines. pandas and scipy do
the same work in a script: they read it and apply high-pass filter, rectifier, envelope, window and
threshold of the article's chain. They must find the same slips. `--base` adds another version of
fingertip, by the folder of its sources. All programs run in turn, each in a process of its own with
its bytecode cached, and the median of the repeats counts. Processor seconds are those of user and
system, so that other load on the machine hardly counts.
"""

from __future__ import annotations

import argparse
import json
import math
import multiprocessing
import os
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import fingertip
from fingertip.design import Design
from fingertip.slip.detectors.analog_and_digital import ChainSettings

RATE_HZ = 2000
KINDS = ("csv", "npy", "parquet", "stream")
_DETECT = "from fingertip.__main__ import main; main()"
_PANDAS = """
import json, sys
import numpy as np, pandas as pd
from scipy import signal

path, settings = sys.argv[1], json.loads(sys.argv[2])
if path.endswith(".npy"):
    time_s, volts = np.load(path).T
else:
    read = pd.read_parquet if path.endswith(".parquet") else pd.read_csv
    frame = read(sys.stdin.buffer if path == "-" else path)
    time_s, volts = (frame[name].to_numpy() for name in ("time_s", "voltage_v"))

rate_hz = settings["sample_rate_hz"]
sos = signal.butter(3, settings["cutoff_hz"], "high", fs=rate_hz, output="sos")
filtered, _ = signal.sosfilt(sos, volts, zi=signal.sosfilt_zi(sos) * volts[0])
half_wave = settings["gain"] * np.maximum(filtered, 0.0)
share = settings["smoothing"]
envelope = signal.lfilter([share], [1.0, share - 1.0], half_wave)
window = settings["window_samples"]
total = np.cumsum(envelope)
total[window:] -= total[:-window].copy()
on = total / window > settings["threshold_v"]
begins = np.flatnonzero(np.diff(on.astype(np.int8), prepend=0) > 0)
print(json.dumps({"begins_s": time_s[begins].tolist()}))
"""


@dataclass(frozen=True)
class Run:
    """Cost and result of one process."""

    cpu_s: float
    peak_mb: float
    begins_s: tuple[float, ...]


def main() -> None:
    """Print a table of all kinds of files and programs."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--base", type=Path, help="folder of the sources of another version")
    options = parser.parse_args()

    sources = {"fingertip": Path(fingertip.__file__).parents[1]}
    if options.base:
        sources["base"] = options.base.resolve()

    print(f"{'recording':10}{'program':12}{'CPU s':>8}{'MB':>7}{'ratio':>8}{'lines/s':>11}")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        samples = round(60 * options.minutes * RATE_HZ)
        write_in_process(folder, samples)
        for kind in KINDS:
            runs = measure(folder, kind, sources, options.repeats)
            print_runs(kind, runs, samples)


def write_in_process(folder: Path, count: int) -> None:
    """Write the recordings in a process of its own.

    The memory of this one at its greatest counts for each that it starts.
    """
    process = multiprocessing.get_context("spawn").Process(
        target=write_recordings, args=(folder, count)
    )
    process.start()
    process.join()
    if process.exitcode:
        raise SystemExit("the recordings cannot be written")


def write_recordings(folder: Path, count: int) -> None:
    """Write a recording of some samples with a slip of 0.2 s each minute."""
    import pyarrow
    from pyarrow import parquet

    time_s = np.arange(count) / RATE_HZ
    slides = (time_s % 60 >= 30) & (time_s % 60 < 30.2)
    noise_v = np.random.default_rng(0).normal(0, 4e-4, count)
    volts = np.round(2.3 + noise_v + 0.01 * np.sin(2 * np.pi * 90 * time_s) * slides, 6)

    np.save(folder / "trace.npy", np.column_stack([time_s, volts]))
    table = pyarrow.table({"time_s": time_s, "voltage_v": volts})
    parquet.write_table(table, folder / "trace.parquet")
    with (folder / "trace.csv").open("w") as file:
        file.write("time_s,voltage_v\n")
        np.savetxt(file, np.column_stack([time_s, volts]), ["%.4f", "%.6f"], ",")


def measure(
    folder: Path, kind: str, sources: Mapping[str, Path], repeats: int
) -> dict[str, list[Run]]:
    """Run all programs on a recording in turn, once more than counts, to fill their caches."""
    path = "-" if kind == "stream" else str(folder / f"trace.{kind}")
    stdin = folder / "trace.csv" if kind == "stream" else Path(os.devnull)
    programs = {"pandas": ("-c", _PANDAS, path, json.dumps(chain_settings()))}
    programs |= dict.fromkeys(sources, ("-c", _DETECT, "detect", path, "--json", "--quiet"))
    runs: dict[str, list[Run]] = {name: [] for name in programs}

    for _ in range(repeats + 1):
        for name, words in programs.items():
            runs[name].append(run(folder, words, stdin, sources.get(name)))

    check_alike(runs)
    return {name: found[1:] for name, found in runs.items()}


def chain_settings() -> dict[str, float]:
    """Settings of the default design's chain."""
    settings = ChainSettings.from_design(Design())
    smoothing = 1 - math.exp(-2 * math.pi * settings.envelope_cutoff_hz / settings.sample_rate_hz)
    return vars(settings) | {"smoothing": smoothing}


def run(folder: Path, words: Sequence[str], stdin: Path, source: Path | None) -> Run:
    """Run a program of Python, and read its cost from the system."""
    environment = os.environ | {"PYTHONPYCACHEPREFIX": str(folder / "bytecode")}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    if source:
        environment["PYTHONPATH"] = str(source)

    output = folder / "output.json"
    with stdin.open("rb") as lines, output.open("wb") as file:
        process = subprocess.Popen(
            [sys.executable, *words], stdin=lines, stdout=file, env=environment, cwd=folder
        )
        _, status, usage = os.wait4(process.pid, 0)

    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise SystemExit(f"{words[2:4]} has ended with {process.returncode}")

    data = json.loads(output.read_text())
    return Run(usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1000, find_begins(data))


def find_begins(data: dict[str, list[dict[str, float]]]) -> tuple[float, ...]:
    """Find when slip begins in what a program has printed [s]."""
    if "transitions" in data:
        return tuple(each["time_s"] for each in data["transitions"] if each["on"])
    if "intervals" in data:
        return tuple(each["onset_s"] for each in data["intervals"])

    return tuple(map(float, data["begins_s"]))  # type: ignore[arg-type]


def check_alike(runs: Mapping[str, Sequence[Run]]) -> None:
    """Refuse results that are not the same."""
    begins = {tuple(np.round(each.begins_s, 7)) for found in runs.values() for each in found}
    if len(begins) != 1:
        raise SystemExit(f"the programs do not find the same slips: {begins}")


def print_runs(kind: str, runs: Mapping[str, Sequence[Run]], samples: int) -> None:
    """Print the median cost of each program, and its ratio to pandas."""
    cpu_s = {name: statistics.median(each.cpu_s for each in found) for name, found in runs.items()}
    for name, found in runs.items():
        peak_mb = statistics.median(each.peak_mb for each in found)
        ratio = cpu_s[name] / cpu_s["pandas"]
        rate = samples / cpu_s[name]
        print(f"{kind:10}{name:12}{cpu_s[name]:8.2f}{peak_mb:7.0f}{ratio:8.2f}{rate:11.0f}")


if __name__ == "__main__":
    main()
