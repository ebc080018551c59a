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
from collections.abc import Callable
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


def plain_cadquery(design: Any, folder: Path, shared: bool) -> None:
    """The same parts with CadQuery: exact solids, each written as a mesh.

    A plain script has a function for each part, and asks whether its solid is valid. `shared` is what can be made of
    it at best: solids that several parts are cut with are made once, and nobody asks.
    """
    from fingertip.cad.kernel.brep import BrepEvaluator
    from fingertip.cad.shapes.parts import parts_by_name

    kernel = BrepEvaluator()
    for name, part in parts_by_name(design).items():
        solid = kernel.shape(part.solid(design)) if shared else BrepEvaluator().solid(part.solid(design))
        solid.exportStl(str(folder / f"{name}.stl"), TOLERANCE_MM, 0.5)


def compare(designs: int) -> None:
    """Print CPU times of both ways, and their ratios."""
    from fingertip.cad.shapes.parts import parts_by_name
    from fingertip.design import Design
    from fingertip.sweep.point_evaluator import Bench
    from fingertip.sweep.cached_solids import CachedEvaluator

    made = plan(designs)
    bench = Bench(made)
    bench.outcome(0, made.point(0))  # uncounted: imports
    times: dict[str, list[float]] = {name: [] for name in ("sweep", "parts", "plain", "shared")}
    failed = checks = 0

    def timed(name: str, run: Callable[[], Any]) -> Any:
        start = time.process_time()
        result = run()
        times[name].append(time.process_time() - start)
        return result

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        plain_cadquery(Design(), folder, shared=True)
        for number in range(designs):
            point = made.point(number)
            changes = ["bone.base_length_mm=24", *(f"{key}={value}" for key, value in point.items())]
            design = Design.load(changes=changes)
            row = timed("sweep", lambda: Bench(made).outcome(number, point))  # noqa: B023 (nothing remembered)
            assert row[1] == "ok", row
            failed, checks = failed + (row[4][0] > 0), int(row[4][1])
            kernel = CachedEvaluator(TOLERANCE_MM)
            timed("parts", lambda: [kernel.mesh(p.solid(design)) for p in parts_by_name(design).values()])  # noqa: B023
            timed("plain", lambda: plain_cadquery(design, folder, shared=False))  # noqa: B023
            timed("shared", lambda: plain_cadquery(design, folder, shared=True))  # noqa: B023
    mean = statistics.mean(times["sweep"])
    print(f"{designs} designs at {TOLERANCE_MM} mm, {checks} checks each, {failed} with a failed one; CPU time:")
    print(f"parts and checks: {mean:.3f} s, {1 / mean:.2f} designs/s of a core, {2 / mean:.2f} of two (goal 5)")
    for other, label in (("plain", "plain CadQuery"), ("shared", "CadQuery, common solids made once, unchecked")):
        print(f"{label}: {statistics.mean(times[other]):.3f} s, parts only")
        for ours, what in (("sweep", "parts and checks"), ("parts", "parts only")):
            ratios = sorted(b / a for a, b in zip(times[ours], times[other], strict=True))
            spread = f"pairs {ratios[0]:.1f} to {ratios[-1]:.1f}"
            print(f"  {statistics.median(ratios):.1f} times as long as a sweep's {what} ({spread}; goal 8)")


def two_against_one(points: int) -> None:
    """Pace with one and two workers, from when the first tenth is written: their start is not counted."""
    from fingertip.sweep.engines import Processes
    from fingertip.sweep.run import State, run
    from fingertip.sweep.database import Store

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
from fingertip.sweep.point_evaluator import Bench
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
