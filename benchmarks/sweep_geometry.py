"""Geometry with all mesh checks: designs per second, against plain CadQuery making the same parts, memory of many.

    python benchmarks/sweep_geometry.py [designs] [--memory [points]]

The designs are drawn at random and share nothing but what any two designs do. Turn by turn in one run: a sweep's
worker computes a design's parts and checks at 0.02 mm; a plain script makes the same parts with CadQuery and writes
their meshes at the same tolerance, without any check. Rates are of CPU time, so that they hold on a busy machine.
"""

from __future__ import annotations

import os
import platform
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

TOLERANCE_MM = 0.02
AXES: dict[str, Any] = {
    "skin.width_mm": {"low": 17.0, "high": 19.0},
    "skin.thickness_palmar_mm": {"low": 2.8, "high": 3.3},
    "skin.length_mm": {"low": 33.0, "high": 36.0},
    "bone.channel_diameter_mm": {"low": 2.0, "high": 2.6},
    "mold.wall_mm": {"low": 4.0, "high": 6.0},
}


def plan(points: int) -> Any:
    """A sweep of that many designs."""
    from fingertip.sweep.plan import Plan

    return Plan.of(
        {
            "outputs": ["checks_failed", "checks_made", "skin_volume_mm3", "bone_volume_mm3", "mold_mass_g"],
            "sampling": "latin_hypercube",
            "points": points,
            "seed": 1,
            "tolerance_mm": TOLERANCE_MM,
            "axes": AXES,
            "design": {"bone": {"base_length_mm": 24.0}},
        }
    )


def plain_cadquery(design: Any, folder: Path) -> None:
    """The same parts, as a script with CadQuery makes them: exact solids, each written as a mesh."""
    from fingertip.cad.brep import Evaluator
    from fingertip.cad.parts import parts_of

    kernel = Evaluator()
    for name, part in parts_of(design).items():
        kernel.shape(part.describe(design)).exportStl(str(folder / f"{name}.stl"), TOLERANCE_MM, 0.5)


def compare(designs: int) -> None:
    """Print CPU times of both, and their ratio."""
    from fingertip.design import Design
    from fingertip.sweep.evaluate import Bench

    made = plan(designs)
    bench = Bench(made)
    bench.outcome(0, made.point(0))  # uncounted: imports
    ours, theirs, failed = [], [], 0
    with tempfile.TemporaryDirectory() as name:
        plain_cadquery(Design(), Path(name))
        for number in range(designs):
            point = made.point(number)
            start = time.process_time()
            row = Bench(made).outcome(number, point)  # nothing remembered
            ours.append(time.process_time() - start)
            assert row[1] == "ok", row
            failed += row[4][0] > 0
            changes = ["bone.base_length_mm=24", *(f"{key}={value}" for key, value in point.items())]
            design = Design.load(changes=changes)
            start = time.process_time()
            plain_cadquery(design, Path(name))
            theirs.append(time.process_time() - start)
    checks = int(row[4][1])
    mean = statistics.mean(ours)
    print(f"{designs} designs at {TOLERANCE_MM} mm, {checks} checks each, {failed} with a failed one")
    print(f"parts and checks: {mean:.3f} CPU s, {1 / mean:.2f} designs/s of a core, {2 / mean:.2f} of two (goal 5)")
    print(f"plain CadQuery, parts only: {statistics.mean(theirs):.3f} CPU s")
    ratios = sorted(b / a for a, b in zip(ours, theirs, strict=True))
    print(f"ratio {statistics.median(ratios):.1f} (goal 8; pairs {ratios[0]:.1f} to {ratios[-1]:.1f})")


def two_against_one(points: int) -> None:
    """Pace with one and two workers, from when the first tenth is written: their start is not counted."""
    from fingertip.sweep.engines import Processes
    from fingertip.sweep.run import State, run
    from fingertip.sweep.store import Store

    pace = {}
    for jobs in (1, 2):
        first: list[tuple[float, int]] = []

        def told(state: State, first: list[tuple[float, int]] = first) -> None:
            if not first and state.written >= points // 10:
                first.append((time.perf_counter(), state.written))

        with tempfile.TemporaryDirectory() as name, Store.create(Path(name), plan(points)) as store:
            written = run(store.plan, store, Processes(jobs), told).written
        pace[jobs] = (written - first[0][1]) / (time.perf_counter() - first[0][0])
    load = os.getloadavg()[0]
    print(f"{points} designs, wall: {pace[1]:.2f}/s with 1 worker, {pace[2]:.2f}/s with 2, load {load:.1f}")
    print(f"2 workers against 1: {pace[2] / pace[1]:.2f} (goal 1.8)")


def memory(points: int) -> None:
    """Resident memory of one worker along a long sweep."""
    program = f"""
import sys
sys.path.insert(0, {str(Path(__file__).parent)!r})
import sweep_geometry
from fingertip.sweep.evaluate import Bench
made = sweep_geometry.plan({points})
bench = Bench(made)
for number in range({points}):
    bench.outcome(number, made.point(number))
    if (number + 1) % {max(1, points // 10)} == 0:
        pages = int(open("/proc/self/statm").read().split()[1])
        print(number + 1, "designs:", round(pages * 4096 / 2**20), "MB resident", flush=True)
"""
    subprocess.run([sys.executable, "-c", program], check=True)


def main() -> None:
    """Print everything; `--memory` runs some ten minutes alone."""
    arguments = sys.argv[1:]
    print(f"{platform.machine()}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}")
    if "--memory" in arguments:
        rest = [int(a) for a in arguments if a.isdigit()]
        memory(rest[0] if rest else 2000)
        return
    designs = int(arguments[0]) if arguments else 6
    compare(designs)
    two_against_one(10 * designs)


if __name__ == "__main__":
    main()
