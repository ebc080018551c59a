"""Cold start: `fingertip build` as STL alone against the same build with STEP, in one run, turn by turn.

    python benchmarks/cold_build.py [runs]

Each build is a fresh process. CPU time counts the process and its children; beside it stands what the time buys: the
largest relative distance between a part's mesh volume and its exact volume.
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


def measure(formats: str, folder: str) -> tuple[float, float]:
    """Wall and CPU time [s] of one build in a fresh process."""
    command = [sys.executable, "-m", "fingertip", "build", str(DESIGN), "--out", folder, "--formats", formats, "-q"]
    before, start = os.times(), time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    wall, after = time.perf_counter() - start, os.times()
    cpu = after.children_user - before.children_user + after.children_system - before.children_system
    return wall, cpu


def main() -> None:
    """Print the table and the ratio the project promises (a quarter)."""
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    times: dict[str, list[tuple[float, float]]] = {name: [] for name in VARIANTS}
    with tempfile.TemporaryDirectory() as folder:
        for formats in VARIANTS.values():  # once each, uncounted: byte code and disk cache
            measure(formats, folder)
        for _ in range(runs):
            for name, formats in VARIANTS.items():
                times[name].append(measure(formats, folder))
        parts = json.loads((Path(folder) / "report.json").read_text())["parts"].values()
    error = max(abs(p["volume_mm3"] / p["brep_volume_mm3"] - 1) for p in parts)
    print(f"{platform.machine()}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}, {runs} runs each")
    print(f"{'formats':20}{'wall s (median)':>18}{'CPU s (median)':>18}{'volume error':>16}")
    for name, pairs in times.items():
        wall, cpu = (statistics.median(column) for column in zip(*pairs, strict=True))
        print(f"{name:20}{wall:18.2f}{cpu:18.2f}{error:16.1e}")
    ratios = sorted(a[0] / b[0] for a, b in zip(times["stl"], times["stl + 3mf + step"], strict=True))
    spread = f"pairs {ratios[0]:.2f} to {ratios[-1]:.2f}"
    print(f"STL alone takes {statistics.median(ratios):.2f} of the build with STEP ({spread})")


if __name__ == "__main__":
    main()
