"""Printing time and material by PrusaSlicer, where it is installed.

Its exit code is 0 for many a broken part; what counts is the G-code it writes and the figures in it.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

from fingertip.cad.printing import Orientation
from fingertip.errors import GeometryError, Issue

PROGRAM = "prusa-slicer"
HOW_TO_INSTALL = "on Debian or Ubuntu: apt-get install prusa-slicer"
LAYER_MM = 0.1
TIME_LIMIT_S = 120.0
_TIME = re.compile(r"^; estimated printing time \(normal mode\) = (.+)$", re.MULTILINE)
_FILAMENT = re.compile(r"^; filament used \[cm3\] = ([\d.]+)$", re.MULTILINE)
_UNITS_MIN = {"d": 1440.0, "h": 60.0, "m": 1.0, "s": 1.0 / 60.0}


@dataclass(frozen=True)
class PrintEstimate:
    """What the slicer says of one part, printed from filament with the slicer's own settings."""

    minutes: float
    filament_cm3: float
    """Supports included."""


def find_slicer() -> Path | None:
    """Where PrusaSlicer is, or None."""
    found = shutil.which(PROGRAM)
    return Path(found) if found else None


def slice_part(program: Path, name: str, stl: bytes, orientation: Orientation) -> PrintEstimate:
    """Slice a part, given as STL, in layers of `LAYER_MM`.

    Raises
    ------
    GeometryError
        If the slicer fails, takes longer than `TIME_LIMIT_S`, or its G-code holds no figures.
    """
    with tempfile.TemporaryDirectory(prefix="fingertip-slice-") as folder:
        part, code = Path(folder) / f"{name}.stl", Path(folder) / f"{name}.gcode"
        part.write_bytes(stl)
        command = [str(program), "--export-gcode", "--layer-height", f"{LAYER_MM:g}"]
        command += ["--rotate-x", f"{orientation.rotate_x_deg:g}"]
        command += ["--support-material"] if orientation.needs_supports else []
        try:
            done = subprocess.run(
                [*command, "-o", str(code), str(part)],
                capture_output=True,
                text=True,
                timeout=TIME_LIMIT_S,
                check=False,
            )
        except subprocess.TimeoutExpired:
            sentence = f"was not sliced after {TIME_LIMIT_S:g} s; leave out --slicer."
            raise GeometryError(Issue(name, sentence)) from None
        if not code.exists():
            last = (done.stderr.strip() or done.stdout.strip() or "no message").splitlines()[-1]
            raise GeometryError(Issue(name, f"was not sliced ({last}); leave out --slicer."))
        return parse_gcode(name, code.read_text(encoding="utf-8", errors="replace"))


def parse_gcode(name: str, code: str) -> PrintEstimate:
    """The figures in the comments at the end of PrusaSlicer's G-code.

    Raises
    ------
    GeometryError
        If they are not there.
    """
    time, filament = _TIME.search(code), _FILAMENT.search(code)
    if time is None or filament is None:
        raise GeometryError(
            Issue(name, "was sliced, but the G-code states no time or no filament; leave out --slicer.")
        )
    return PrintEstimate(minutes(time[1]), float(filament[1]))


def minutes(text: str) -> float:
    """`1d 2h 31m 30s` in minutes."""
    return sum(float(word[:-1]) * _UNITS_MIN[word[-1]] for word in text.split())
