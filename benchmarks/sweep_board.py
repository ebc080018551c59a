"""Sweeps of boards: points per second of a core, two workers against one, cost by size, memory of a million.

    python benchmarks/sweep_board.py [--million] [plot.png]

Each run is the command itself in fresh processes. Rates are of CPU time where they are called so: another load on the
machine lengthens wall time only.
"""

from __future__ import annotations

import json
import os
import platform
import resource
import statistics
import subprocess
import sys
import tempfile
import time
import tomllib
from pathlib import Path

import numpy as np

FILE = """
name = "boards"
outputs = ["cutoff_3db_hz", "cutoff_error_percent", "q", "gain", "board.r1_ohm", "board.r2_ohm"]
sampling = "latin_hypercube"
points = {points}

[axes]
board.cutoff_hz = {{ low = 20, high = 400, spacing = "logarithmic" }}
board.passband_gain = {{ low = 10, high = 300, spacing = "logarithmic" }}
board.capacitor_uf = {{ low = 0.1, high = 2, spacing = "logarithmic" }}
board.series = ["E12", "E24", "E96"]
"""
SIZES = (1_000, 3_000, 10_000, 30_000, 100_000)
MILLION = 1_000_000


def in_worker(points: int = 20_000) -> float:
    """Points per CPU second of one worker, without pool and file."""
    from fingertip.sweep.chunk import Part
    from fingertip.sweep.plan import Plan
    from fingertip.sweep.work import work

    plan = Plan.of(tomllib.loads(FILE.format(points=points)))
    numbers = plan.in_order(0, points)
    columns = {name: column.tolist() for name, column in plan.columns(numbers).items()}
    part = Part(plan.to_toml(), tuple(numbers.tolist()), columns)
    work(Part(part.text, part.points[:100], {name: column[:100] for name, column in columns.items()}))
    start = time.process_time()
    work(part)
    return points / (time.process_time() - start)


def cpu_s(points: int, jobs: int, folder: Path) -> float:
    """CPU time of all processes of the command [s]."""
    file, out = folder / "sweep.toml", folder / f"out{time.monotonic_ns()}"
    file.write_text(FILE.format(points=points))
    command = [sys.executable, "-m", "fingertip", "sweep", str(file), "--out", str(out), "--jobs", str(jobs), "--json"]
    before = os.times()
    ran = subprocess.run(command, check=True, capture_output=True, text=True)
    after = os.times()
    said = json.loads(ran.stdout)
    assert said["rows"] == points
    return after.children_user - before.children_user + after.children_system - before.children_system


def pace(points: int, jobs: int) -> float:
    """Points per second (wall), from when the first tenth is written: the workers' start is not counted."""
    from fingertip.sweep.engines import Processes
    from fingertip.sweep.plan import Plan
    from fingertip.sweep.run import State, run
    from fingertip.sweep.database import Store

    first: list[tuple[float, int]] = []

    def told(state: State) -> None:
        if not first and state.written >= points // 10:
            first.append((time.perf_counter(), state.written))

    plan = Plan.of(tomllib.loads(FILE.format(points=points)))
    with tempfile.TemporaryDirectory() as name, Store.create(Path(name), plan) as store:
        written = run(plan, store, Processes(jobs), told).written
    return (written - first[0][1]) / (time.perf_counter() - first[0][0])


def peak_mb(points: int, jobs: int, folder: Path) -> tuple[float, float]:
    """Largest resident memory of any single process, and of all processes together [MB]."""
    file, out = folder / "sweep.toml", folder / "million"
    file.write_text(FILE.format(points=points))
    command = [sys.executable, "-m", "fingertip", "sweep", str(file), "--out", str(out), "--jobs", str(jobs), "-q"]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, start_new_session=True)
    maximum = 0.0
    while process.poll() is None:
        maximum = max(maximum, _resident_mb(process.pid))
        time.sleep(0.2)
    assert process.returncode == 0
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024, maximum


def _resident_mb(group: int) -> float:
    total = 0.0
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            if os.getpgid(int(folder.name)) == group:
                total += int((folder / "statm").read_text().split()[1]) * resource.getpagesize() / 2**20
        except (OSError, ValueError, IndexError):
            continue
    return total


def main() -> None:
    """Print the table, and draw cost against number of points."""
    arguments = sys.argv[1:]
    million = "--million" in arguments
    plots = [name for name in arguments if not name.startswith("--")]
    print(f"{platform.machine()}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}")
    print(f"one worker: {in_worker():.0f} points per CPU second (goal 5000)")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        cpu_s(100, 1, folder)  # uncounted: byte code and disk cache
        ratios = [pace(100_000, 2) / pace(100_000, 1) for _ in range(3)]
        print(f"2 workers against 1, wall: {statistics.median(ratios):.2f} (goal 1.8), load {os.getloadavg()[0]:.1f}")
        costs = {points: cpu_s(points, 2, folder) for points in SIZES}
        start, each = _line(costs)
        print(f"CPU time: {start:.2f} s for the processes' start, {1e6 * each:.1f} us for each point")
        print(f"{'points':>10}{'CPU s':>10}{'off the line':>16}")
        for points, cpu in costs.items():
            print(f"{points:10d}{cpu:10.2f}{100 * (cpu / (start + each * points) - 1):14.1f} %")
        if million:
            before = time.perf_counter()
            single, together = peak_mb(MILLION, 2, folder)
            took = time.perf_counter() - before
            print(f"{MILLION} points: {took:.0f} s, {single:.0f} MB in the largest process, {together:.0f} MB in all")
        if plots:
            _plot(costs, Path(plots[0]))


def _line(costs: dict[int, float]) -> tuple[float, float]:
    """Start [s] and cost of a point [s]: the line with the least squared relative errors."""
    points, cpu = np.array(list(costs)), np.array(list(costs.values()))
    (start, each), *_ = np.linalg.lstsq(np.column_stack((1 / cpu, points / cpu)), np.ones(len(cpu)))
    return float(start), float(each)


def _plot(costs: dict[int, float], path: Path) -> None:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5.5, 4), layout="constrained")
    axes = figure.add_subplot()
    start, each = _line(costs)
    ends = np.array([0, SIZES[-1]])
    label = f"{start:.1f} s and {1e6 * each:.0f} us for each point"
    axes.plot(ends, start + each * ends, "--", color="grey", label=label)
    axes.plot(list(costs), list(costs.values()), "o", label="measured")
    axes.set_xlabel("points of the sweep")
    axes.set_ylabel("CPU time of all processes [s]")
    axes.grid(True, alpha=0.3)
    axes.legend()
    figure.savefig(path, dpi=120)


if __name__ == "__main__":
    main()
