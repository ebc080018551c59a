"""Run SPICE decks in ngspice."""

from __future__ import annotations

import math
import re
import subprocess
from pathlib import Path

from tests.tools import require_tool

HOW_TO_INSTALL_NGSPICE = "run `sh .ci/install-ngspice` as root on Debian, or install ngspice"


def run_ngspice(folder: Path, deck: str, commands: str) -> list[list[float]]:
    """Run a deck with these commands and return the rows of numbers
    that `wrdata out ...` among them writes.
    """
    ngspice = require_tool("ngspice", HOW_TO_INSTALL_NGSPICE)
    body, analysis, _ = deck.partition("\n.ac ")
    assert analysis
    body += f"\n.control\nset wr_singlescale\n{commands}\n.endc\n.end\n"
    (folder / "run.cir").write_text(body, encoding="utf-8")
    process = subprocess.run(
        [ngspice, "-b", "run.cir"], cwd=folder, capture_output=True, text=True, check=False
    )
    assert (folder / "out").exists(), process.stdout + process.stderr
    return [
        [float(word) for word in line.split()] for line in (folder / "out").read_text().splitlines()
    ]


def read_noise_total(folder: Path, deck: str, net: str) -> float:
    """Integrate the noise of a net from 0.1 Hz to 1 MHz [V]."""
    commands = (
        f"noise v({net.lower()}) IJ1 dec 100 0.1 1meg 1\nsetplot noise2\nset "
        "filetype=ascii\nwrite all.raw"
    )
    run_ngspice(folder, deck, f"{commands}\nwrdata out onoise_total")
    return sum_noise((folder / "all.raw").read_text(encoding="utf-8"))


def sum_noise(raw: str) -> float:
    """Sum the sources of a raw file of noise but for sidewalls of diodes, which no deck has [V].

    ngspice 46 integrates three for every diode, from memory that it has not set, and adds them to
    the total.
    """
    head, _, values = raw.partition("Values:\n")
    names = [
        name.removeprefix("v(").removesuffix(")")
        for name in re.findall(r"^\t\d+\t(\S+)", head, re.MULTILINE)
    ]
    total = 0.0
    for name, value in zip(names, map(float, values.split()[1:]), strict=True):
        is_sum = any(other.startswith(f"{name}_") for other in names)
        if (
            name.startswith("onoise_total")
            and not is_sum
            and not name.endswith(("_rsw", "_idsw", "_1overfsw"))
        ):
            total += value**2
    return math.sqrt(total)
