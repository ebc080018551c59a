"""Run SPICE decks in ngspice."""

from __future__ import annotations

import subprocess
from pathlib import Path

from tests.tools import require_tool

HOW_TO_INSTALL_NGSPICE = "run `sh .ci/install-ngspice` as root on Debian, or install ngspice"


def run_ngspice(folder: Path, deck: str, commands: str) -> list[list[float]]:
    """Run a deck with these commands and return the rows of numbers that `wrdata out ...` among them writes."""
    ngspice = require_tool("ngspice", HOW_TO_INSTALL_NGSPICE)
    body, analysis, _ = deck.partition("\n.ac ")
    assert analysis
    body += f"\n.control\nset wr_singlescale\n{commands}\n.endc\n.end\n"
    (folder / "run.cir").write_text(body, encoding="utf-8")
    process = subprocess.run([ngspice, "-b", "run.cir"], cwd=folder, capture_output=True, text=True, check=False)
    assert (folder / "out").exists(), process.stdout + process.stderr
    return [[float(word) for word in line.split()] for line in (folder / "out").read_text().splitlines()]
