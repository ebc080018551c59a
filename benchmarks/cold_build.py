"""Cold start: `fingertip build` as STL alone against the same build with STEP, in one run, turn by turn.

    python benchmarks/cold_build.py [runs]

Each build is a fresh process. CPU time counts the process and its children; beside it stands what the time buys: the
largest relative distance between a part's mesh volume and its exact volume. `import cadquery` alone, which every script
that writes STEP pays, is measured between them.
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


IMPORT = "import cadquery"


def measure(name: str, folder: str) -> tuple[float, float]:
    """Wall and CPU time [s] of one build, or of the import, in a fresh process."""
    build = ["-m", "fingertip", "build", str(DESIGN), "--out", folder, "--formats", VARIANTS.get(name, ""), "-q"]
    command = [sys.executable, *(["-c", IMPORT] if name == IMPORT else build)]
    before, start = os.times(), time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    wall, after = time.perf_counter() - start, os.times()
    cpu = after.children_user - before.children_user + after.children_system - before.children_system
    return wall, cpu


def main() -> None:
    """Print the table and the ratios the project promises: a quarter, and twice."""
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    names = [IMPORT, *VARIANTS]
    times: dict[str, list[tuple[float, float]]] = {name: [] for name in names}
    with tempfile.TemporaryDirectory() as folder:
        for name in names:  # once each, uncounted: byte code and disk cache
            measure(name, folder)
        for _ in range(runs):
            for name in names:
                times[name].append(measure(name, folder))
        parts = json.loads((Path(folder) / "report.json").read_text())["parts"].values()
    error = max(abs(p["volume_mm3"] / p["brep_volume_mm3"] - 1) for p in parts)
    print(f"{platform.machine()}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}, {runs} runs each")
    print(f"{'formats':20}{'wall s (median)':>18}{'CPU s (median)':>18}{'volume error':>16}")
    for name, pairs in times.items():
        wall, cpu = (statistics.median(column) for column in zip(*pairs, strict=True))
        print(f"{name:20}{wall:18.2f}{cpu:18.2f}" + ("" if name == IMPORT else f"{error:16.1e}"))
    step = "stl + 3mf + step"
    print(f"STL alone takes {ratio(times['stl'], times[step])} of the build with STEP")
    print(f"the build with STEP takes {ratio(times[step], times[IMPORT])} of import cadquery alone")


def ratio(some: list[tuple[float, float]], others: list[tuple[float, float]]) -> str:
    """Wall time of some runs against others, pair by pair."""
    ratios = sorted(a[0] / b[0] for a, b in zip(some, others, strict=True))
    return f"{statistics.median(ratios):.2f} (pairs {ratios[0]:.2f} to {ratios[-1]:.2f})"


if __name__ == "__main__":
    main()
