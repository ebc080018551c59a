"""Cold start of `fingertip build`: STL alone compared with STL, 3MF and STEP.

    python benchmarks/cold_build.py [runs]

Each build runs in a fresh process, and the variants alternate. CPU time counts the process and its
children. The volume error is the largest relative difference between a part's mesh and its B-rep
solid. `import cadquery` alone, which every script that writes STEP must pay for, is measured for
comparison.
"""

from __future__ import annotations

import json
import os
import platform
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

DESIGN = Path(__file__).resolve().parent.parent / "params" / "fsr400.toml"
VARIANTS = {"stl": "stl", "stl + 3mf": "stl,3mf", "stl + 3mf + step": "stl,3mf,step"}
"""Label -> value of --formats."""
IMPORT = "import cadquery"


def measure(name: str, folder: str) -> tuple[float, float]:
    """Measure wall and CPU time [s] of one build, or of the import, in a fresh process."""
    build = [
        "-m",
        "fingertip",
        "build",
        str(DESIGN),
        "--out",
        folder,
        "--formats",
        VARIANTS.get(name, ""),
        "-q",
    ]
    command = [sys.executable, *(["-c", IMPORT] if name == IMPORT else build)]
    before = os.times()
    start = time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    wall = time.perf_counter() - start
    after = os.times()
    cpu = (
        after.children_user - before.children_user + after.children_system - before.children_system
    )

    return wall, cpu


def main() -> None:
    """Print the table, and the ratios that the project aims at: a quarter and twice."""
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    names = [IMPORT, *VARIANTS]
    times: dict[str, list[tuple[float, float]]] = {name: [] for name in names}

    with tempfile.TemporaryDirectory() as folder:
        for name in names:  # one run each, not counted, fills byte code and disk caches
            measure(name, folder)

        for _ in range(runs):
            for name in names:
                times[name].append(measure(name, folder))

        parts = json.loads((Path(folder) / "report.json").read_text())["parts"].values()

    error = max(abs(p["volume_mm3"] / p["brep_volume_mm3"] - 1) for p in parts)
    print(
        f"{platform.machine()}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}, {runs} "
        "runs each"
    )
    print(f"{'formats':20}{'wall s (median)':>18}{'CPU s (median)':>18}{'volume error':>16}")

    for name, pairs in times.items():
        wall, cpu = (statistics.median(column) for column in zip(*pairs, strict=True))
        print(f"{name:20}{wall:18.2f}{cpu:18.2f}" + ("" if name == IMPORT else f"{error:16.1e}"))

    step = "stl + 3mf + step"
    print(f"STL alone takes {format_ratio(times['stl'], times[step])} of the build with STEP")
    print(
        f"the build with STEP takes {format_ratio(times[step], times[IMPORT])} of import cadquery "
        "alone"
    )


def format_ratio(
    numerators: list[tuple[float, float]], denominators: list[tuple[float, float]]
) -> str:
    """Format the median ratio of two series of wall times, pair by pair, with its range."""
    ratios = sorted(a[0] / b[0] for a, b in zip(numerators, denominators, strict=True))
    return f"{statistics.median(ratios):.2f} (pairs {ratios[0]:.2f} to {ratios[-1]:.2f})"


if __name__ == "__main__":
    main()
