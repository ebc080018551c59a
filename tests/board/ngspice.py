"""Run SPICE decks in ngspice."""

from __future__ import annotations

import math
import re
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


def read_noise_total(folder: Path, deck: str, net: str) -> float:
    """Integrate the noise of a net from 0.1 Hz to 1 MHz [V].

    ngspice 46 adds one sidewall noise for every diode, though none has a sidewall; it is left out of the sum.
    """
    commands = f"noise v({net.lower()}) IJ1 dec 100 0.1 1meg 1\nsetplot noise2\nset filetype=ascii\nwrite all.raw"
    run_ngspice(folder, deck, f"{commands}\nwrdata out onoise_total")
    return sum_noise((folder / "all.raw").read_text(encoding="utf-8"))


def sum_noise(raw: str) -> float:
    """Return the total of a raw file of noise less what ngspice 46 adds for sidewalls [V]."""
    head, _, values = raw.partition("Values:\n")
    names = [name.removeprefix("v(").removesuffix(")") for name in re.findall(r"^\t\d+\t(\S+)", head, re.MULTILINE)]
    found = dict(zip(names, map(float, values.split()[1:]), strict=True))
    sidewalls = (found[name] ** 2 for name in names if name.startswith("onoise_total") and name.endswith("_idsw"))
    return math.sqrt(found["onoise_total"] ** 2 - sum(sidewalls))
