"""Benchmark of geometry sweeps with all mesh checks: designs per second, comparison with plain
CadQuery, memory; and of sweeps of lengths alone, which only check the rules.

    python benchmarks/sweep_geometry.py [designs] [--memory [points]] [--lengths [points]]

The designs are drawn at random. The runs alternate: a worker of a sweep computes a design's parts
and checks at 0.02 mm; then a plain script makes the same parts with CadQuery and writes their
meshes at the same tolerance, without any check. Rates are per CPU second, so that they hold on a
busy machine.
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


OUTPUTS = ("checks_failed", "checks_run", "skin_volume_mm3", "bone_volume_mm3", "mold_mass_g")
LENGTHS = ("finger_length_mm", "sensor_rim_mm", "mold_width_mm", "mold_height_mm")


def make_plan(points: int, outputs: tuple[str, ...] = OUTPUTS) -> Any:
    """Make a sweep with that many designs."""
    from fingertip.sweep.sweep_plan import SweepPlan

    return SweepPlan.from_tables(
        {
            "outputs": list(outputs),
            "sampling": "latin_hypercube",
            "points": points,
            "seed": 1,
            "tolerance_mm": TOLERANCE_MM,
            "axes": AXES,
            "design": {"bone": {"base_length_mm": 24.0}},
        }
    )


def make_parts_with_cadquery(design: Any, folder: Path, shared: bool) -> None:
    """Make the same parts with CadQuery as exact solids, and write each as a mesh.

    A plain script has a function for each part and checks that its solid is valid. With `shared`,
    solids from which several parts are cut are made once and validity is not checked: the fastest
    such a script can be.
    """
    import cadquery as cq

    from fingertip.cad.kernel.brep import BrepEvaluator
    from fingertip.models.parts import parts_by_name

    kernel = BrepEvaluator()

    for name, part in parts_by_name(design).items():
        solid = (
            kernel.shape(part.solid(design))
            if shared
            else BrepEvaluator().solid(part.solid(design))
        )
        cq.Shape.cast(solid).exportStl(str(folder / f"{name}.stl"), TOLERANCE_MM, 0.5)


def compare_with_cadquery(designs: int) -> None:
    """Print the CPU times of both methods, and their ratios."""
    from fingertip.design import Design
    from fingertip.models.parts import parts_by_name
    from fingertip.sweep.designs import CachedEvaluator
    from fingertip.sweep.point_evaluator import PointEvaluator

    plan = make_plan(designs)
    PointEvaluator(plan).evaluate(0, plan.point(0))  # not measured: imports
    times: dict[str, list[float]] = {name: [] for name in ("sweep", "parts", "plain", "shared")}
    failed = checks = 0

    def timed(name: str, run: Callable[[], Any]) -> Any:
        start = time.process_time()
        result = run()
        times[name].append(time.process_time() - start)
        return result

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        make_parts_with_cadquery(Design(), folder, shared=True)
        for number in range(designs):
            point = plan.point(number)
            changes = [
                "bone.base_length_mm=24",
                *(f"{key}={value}" for key, value in point.items()),
            ]
            design = Design.load(changes=changes)
            # A new evaluator each time, so that nothing is cached
            row = timed("sweep", lambda: PointEvaluator(plan).evaluate(number, point))  # noqa: B023
            assert row[1] == "ok", row
            failed = failed + (row[4][0] > 0)
            checks = int(row[4][1])
            kernel = CachedEvaluator(TOLERANCE_MM)
            parts = parts_by_name(design).values()
            timed("parts", lambda: [kernel.mesh(part.solid(design)) for part in parts])  # noqa: B023
            timed("plain", lambda: make_parts_with_cadquery(design, folder, shared=False))  # noqa: B023
            timed("shared", lambda: make_parts_with_cadquery(design, folder, shared=True))  # noqa: B023

    mean = statistics.mean(times["sweep"])
    print(
        f"{designs} designs at {TOLERANCE_MM} mm, {checks} checks each, {failed} with a failed "
        "one; CPU time:"
    )
    print(
        f"parts and checks: {mean:.3f} s, {1 / mean:.2f} designs/s of a core, {2 / mean:.2f} of "
        "two (goal 5)"
    )

    for other, label in (
        ("plain", "plain CadQuery"),
        ("shared", "CadQuery with shared solids, unchecked"),
    ):
        print(f"{label}: {statistics.mean(times[other]):.3f} s, parts only")
        for own, what in (("sweep", "parts and checks"), ("parts", "parts only")):
            ratios = sorted(b / a for a, b in zip(times[own], times[other], strict=True))
            spread = f"{ratios[0]:.1f} to {ratios[-1]:.1f}"
            print(
                f"  {statistics.median(ratios):.1f} times as long as a sweep's {what} ({spread}; "
                "goal 8)"
            )


def measure_speed_up(points: int) -> None:
    """Print the rate with one and with two workers after the first
    tenth, so that their start does not count.
    """
    from fingertip.sweep.database import SweepDatabase
    from fingertip.sweep.engines import ProcessEngine
    from fingertip.sweep.run import RunState, compute_rows

    rate = {}

    for jobs in (1, 2):
        first: list[tuple[float, int]] = []

        def record_first_tenth(state: RunState, first: list[tuple[float, int]] = first) -> None:
            if not first and state.written >= points // 10:
                first.append((time.perf_counter(), state.written))

        with (
            tempfile.TemporaryDirectory() as name,
            SweepDatabase.create(Path(name), make_plan(points)) as database,
        ):
            written = compute_rows(
                database.plan, database, ProcessEngine(jobs), record_first_tenth
            ).written

        rate[jobs] = (written - first[0][1]) / (time.perf_counter() - first[0][0])

    load = os.getloadavg()[0]
    print(
        f"{points} designs, wall time: {rate[1]:.2f}/s with 1 worker, {rate[2]:.2f}/s with 2, "
        f"load {load:.1f}"
    )
    print(f"speed-up by a second worker: {rate[2] / rate[1]:.2f} (goal 1.8)")


def measure_memory(points: int) -> None:
    """Print the resident memory of one worker during a long sweep."""
    program = f"""
import sys
sys.path.insert(0, {str(Path(__file__).parent)!r})
import sweep_geometry
from fingertip.sweep.point_evaluator import PointEvaluator
plan = sweep_geometry.make_plan({points})
evaluator = PointEvaluator(plan)
for number in range({points}):
    evaluator.evaluate(number, plan.point(number))
    if (number + 1) % {max(1, points // 10)} == 0:
        pages = int(open("/proc/self/statm").read().split()[1])
        print(number + 1, "designs:", round(pages * 4096 / 2**20), "MB resident", flush=True)
"""
    subprocess.run([sys.executable, "-c", program], check=True)


def measure_lengths(points: int) -> None:
    """Print the CPU time of a point whose outputs are lengths."""
    from fingertip.sweep.point_evaluator import PointEvaluator

    plan = make_plan(points, LENGTHS)
    evaluator = PointEvaluator(plan)
    designs = [plan.point(number) for number in range(points)]
    evaluator.evaluate(0, designs[0])  # not measured: imports

    start = time.process_time()
    rows = [evaluator.evaluate(number, design) for number, design in enumerate(designs)]
    mean_ms = 1e3 * (time.process_time() - start) / points

    passed = sum(row[1] == "ok" for row in rows)
    print(f"{points} designs, {passed} not refused: {mean_ms:.2f} ms of CPU each (goal 3)")


def main() -> None:
    """Print the results; `--memory` alone takes about ten minutes."""
    arguments = sys.argv[1:]
    print(f"{platform.machine()}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}")

    if "--memory" in arguments:
        numbers = [int(a) for a in arguments if a.isdigit()]
        measure_memory(numbers[0] if numbers else 2000)
        return

    if "--lengths" in arguments:
        numbers = [int(a) for a in arguments if a.isdigit()]
        measure_lengths(numbers[0] if numbers else 200)
        return

    designs = int(arguments[0]) if arguments else 6
    compare_with_cadquery(designs)
    measure_speed_up(10 * designs)


if __name__ == "__main__":
    main()
