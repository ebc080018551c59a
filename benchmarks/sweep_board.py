"""Benchmark of board sweeps: points per second, speed-up by a second worker, cost by size, memory
of a million points.

    python benchmarks/sweep_board.py [--million] [plot.png]

Except for the first number, each run is the command itself in fresh processes. Rates per CPU second
do not depend on other load of the machine; wall times do.
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


def measure_worker_rate(points: int = 20_000) -> float:
    """Measure the points per CPU second of one worker, without process pool and database."""
    from fingertip.sweep.point_evaluator import Chunk, evaluate_chunk
    from fingertip.sweep.sweep_plan import SweepPlan

    plan = SweepPlan.from_tables(tomllib.loads(FILE.format(points=points)))
    numbers = plan.computing_order(0, points)
    columns = {name: column.tolist() for name, column in plan.columns(numbers).items()}
    chunk = Chunk(plan.to_toml(), tuple(numbers.tolist()), columns)
    evaluate_chunk(chunk.select(range(100)))  # not measured: imports
    start = time.process_time()
    evaluate_chunk(chunk)

    return points / (time.process_time() - start)


def measure_cpu_time(points: int, jobs: int, folder: Path) -> float:
    """Measure the CPU time of all processes of the command [s]."""
    file = folder / "sweep.toml"
    out = folder / f"out{time.monotonic_ns()}"
    file.write_text(FILE.format(points=points))
    command = [
        sys.executable,
        "-m",
        "fingertip",
        "sweep",
        str(file),
        "--out",
        str(out),
        "--jobs",
        str(jobs),
        "--json",
    ]
    before = os.times()
    result = subprocess.run(command, check=True, capture_output=True, text=True)
    after = os.times()
    assert json.loads(result.stdout)["rows"] == points

    return (
        after.children_user - before.children_user + after.children_system - before.children_system
    )


def measure_wall_rate(points: int, jobs: int) -> float:
    """Measure the points per second of wall time after the first
    tenth, so that the workers' start does not count.
    """
    from fingertip.sweep.database import SweepDatabase
    from fingertip.sweep.engines import ProcessEngine
    from fingertip.sweep.run import RunState, compute_rows
    from fingertip.sweep.sweep_plan import SweepPlan

    first: list[tuple[float, int]] = []

    def record_first_tenth(state: RunState) -> None:
        if not first and state.written >= points // 10:
            first.append((time.perf_counter(), state.written))

    plan = SweepPlan.from_tables(tomllib.loads(FILE.format(points=points)))
    with tempfile.TemporaryDirectory() as name, SweepDatabase.create(Path(name), plan) as database:
        written = compute_rows(plan, database, ProcessEngine(jobs), record_first_tenth).written

    return (written - first[0][1]) / (time.perf_counter() - first[0][0])


def measure_peak_memory(points: int, jobs: int, folder: Path) -> tuple[float, float]:
    """Measure the peak resident memory of the largest process, and of all processes
    together [MB].
    """
    file = folder / "sweep.toml"
    out = folder / "million"
    file.write_text(FILE.format(points=points))
    command = [
        sys.executable,
        "-m",
        "fingertip",
        "sweep",
        str(file),
        "--out",
        str(out),
        "--jobs",
        str(jobs),
        "-q",
    ]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, start_new_session=True)
    maximum = 0.0

    while process.poll() is None:
        maximum = max(maximum, _sum_resident_memory(process.pid))
        time.sleep(0.2)

    assert process.returncode == 0
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024, maximum


def _sum_resident_memory(group: int) -> float:
    """Sum the resident memory of a process group [MB]."""
    total = 0.0
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            if os.getpgid(int(folder.name)) == group:
                total += (
                    int((folder / "statm").read_text().split()[1]) * resource.getpagesize() / 2**20
                )
        except (OSError, ValueError, IndexError):
            continue

    return total


def main() -> None:
    """Print the results; draw the cost by number of points if a file is given."""
    arguments = sys.argv[1:]
    plots = [name for name in arguments if not name.startswith("--")]
    print(f"{platform.machine()}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}")
    print(f"one worker: {measure_worker_rate():.0f} points per CPU second (goal 5000)")

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        measure_cpu_time(100, 1, folder)  # not measured: byte code and disk cache
        ratios = [measure_wall_rate(100_000, 2) / measure_wall_rate(100_000, 1) for _ in range(3)]
        load = os.getloadavg()[0]
        print(
            f"speed-up by a second worker, wall time: {statistics.median(ratios):.2f} (goal 1.8), "
            f"load {load:.1f}"
        )
        costs = {points: measure_cpu_time(points, 2, folder) for points in SIZES}
        start, per_point = _fit_line(costs)
        print(f"CPU time: {start:.2f} s to start the processes, {1e6 * per_point:.1f} us per point")
        print(f"{'points':>10}{'CPU s':>10}{'deviation':>16}")

        for points, cpu in costs.items():
            print(
                f"{points:10d}{cpu:10.2f}{100 * (cpu / (start + per_point * points) - 1):14.1f} %"
            )

        if "--million" in arguments:
            before = time.perf_counter()
            largest, total = measure_peak_memory(MILLION, 2, folder)
            elapsed = time.perf_counter() - before
            print(
                f"{MILLION} points: {elapsed:.0f} s; {largest:.0f} MB in the largest process, "
                f"{total:.0f} MB in all"
            )

        if plots:
            _plot(costs, Path(plots[0]))


def _fit_line(costs: dict[int, float]) -> tuple[float, float]:
    """Fit start-up time [s] and cost of a point [s] by least squares of the relative errors."""
    points = np.array(list(costs))
    cpu = np.array(list(costs.values()))
    (start, per_point), *_ = np.linalg.lstsq(
        np.column_stack((1 / cpu, points / cpu)), np.ones(len(cpu))
    )

    return float(start), float(per_point)


def _plot(costs: dict[int, float], path: Path) -> None:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5.5, 4), layout="constrained")
    axes = figure.add_subplot()
    start, per_point = _fit_line(costs)
    ends = np.array([0, SIZES[-1]])
    label = f"{start:.1f} s and {1e6 * per_point:.0f} us per point"
    axes.plot(ends, start + per_point * ends, "--", color="grey", label=label)
    axes.plot(list(costs), list(costs.values()), "o", label="measured")
    axes.set_xlabel("points of the sweep")
    axes.set_ylabel("CPU time of all processes [s]")
    axes.grid(True, alpha=0.3)
    axes.legend()
    figure.savefig(path, dpi=120)


if __name__ == "__main__":
    main()
