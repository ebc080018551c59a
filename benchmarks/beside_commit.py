"""Processor time of commands beside those of another commit, in one run.

    python benchmarks/beside_commit.py COMMIT [--repeats 3] [--only make]

Both versions run in turn with this Python and its libraries, each run in a process of its own with
its bytecode cached. Processor seconds are those of user and system of the process and its children,
so that other load on the machine hardly counts; seconds on the clock mean something on an idle
machine alone. The median of the repeats counts.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import platform
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
COMMANDS = {
    "make first_finger": "make first_finger --out {out}",
    "make adult_finger": "make adult_finger --out {out}",
    "make first_finger, no STEP": "make first_finger --formats stl,3mf --out {out}",
    "check": "check fsr400",
    "simulate": "simulate fsr400 --out {out}.csv",
    "detect": "detect {trace} --design fsr400",
    "params": "params",
    "--version": "--version",
}
"""Name in the table -> words of the command."""


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("commit")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--only", default="", help="commands whose name begins like this")
    options = parser.parse_args()
    names = [name for name in COMMANDS if name.startswith(options.only)]

    with checked_out(options.commit) as other, tempfile.TemporaryDirectory() as folder:
        trace = Path(folder) / "trace.csv"
        measure(ROOT, ["simulate", "fsr400", "--out", str(trace)], Path(folder) / "x")
        print(f"{platform.machine()}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}")
        print(
            f"{'':28}{'here: CPU s':>14}{'wall s':>9}{options.commit[:8]:>12}{'wall s':>9}  ratio"
        )

        for name in names:
            words = COMMANDS[name].format(out=Path(folder) / "out", trace=trace).split()
            compare(name, words, (ROOT, other), options.repeats, Path(folder) / "out")


def compare(
    name: str, words: list[str], versions: tuple[Path, Path], repeats: int, out: Path
) -> None:
    """Print the row of one command. A first run of each fills the caches."""
    for version in versions:
        measure(version, words, out)

    seconds = [[measure(version, words, out) for version in versions] for _ in range(repeats)]
    (wall, cpu), (other_wall, other_cpu) = (
        [statistics.median(column) for column in zip(*runs, strict=True)]
        for runs in zip(*seconds, strict=True)
    )
    print(
        f"{name:28}{cpu:14.2f}{wall:9.2f}{other_cpu:12.2f}{other_wall:9.2f}{cpu / other_cpu:7.2f}",
        flush=True,
    )


def measure(version: Path, words: list[str], out: Path) -> tuple[float, float]:
    """Measure seconds on the clock and of processors of one command of a version."""
    shutil.rmtree(out, ignore_errors=True)
    out.with_suffix(".csv").unlink(missing_ok=True)
    before = os.times()
    begun = time.perf_counter()
    subprocess.run(
        [sys.executable, "-m", "fingertip", *words],
        check=True,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env=os.environ | {"PYTHONPATH": str(version / "src")},
    )
    wall = time.perf_counter() - begun
    after = os.times()
    cpu = after.children_user - before.children_user
    cpu += after.children_system - before.children_system

    return wall, cpu


@contextlib.contextmanager
def checked_out(commit: str) -> Iterator[Path]:
    """Check a commit out into a temporary folder."""
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / "commit"
        git = ["git", "-C", str(ROOT), "worktree"]
        subprocess.run([*git, "add", "--detach", "--quiet", str(place), commit], check=True)
        try:
            yield place
        finally:
            subprocess.run([*git, "remove", "--force", str(place)], check=True)


if __name__ == "__main__":
    main()
