"""Runs decks in ngspice."""

from __future__ import annotations

import subprocess
from pathlib import Path

from tests.tools import require_tool

HOW = "run `sh .ci/install-ngspice` as root on Debian, or install ngspice"


def simulate(folder: Path, deck: str, commands: str) -> list[list[float]]:
    """Rows of numbers ngspice writes with `wrdata out ...` in these commands."""
    ngspice = require_tool("ngspice", HOW)
    body, analysis, _ = deck.partition("\n.ac ")
    assert analysis
    body += f"\n.control\nset wr_singlescale\n{commands}\n.endc\n.end\n"
    (folder / "run.cir").write_text(body, encoding="utf-8")
    done = subprocess.run([ngspice, "-b", "run.cir"], cwd=folder, capture_output=True, text=True, check=False)
    assert (folder / "out").exists(), done.stdout + done.stderr
    return [[float(word) for word in line.split()] for line in (folder / "out").read_text().splitlines()]
