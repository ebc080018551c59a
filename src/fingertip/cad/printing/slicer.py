"""Print time and filament volume of a plate, as PrusaSlicer estimates them.

PrusaSlicer exits with code 0 for many a broken part. Only the G-code it writes, and the estimates in it, count.
"""

from __future__ import annotations

import re
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

from fingertip.cad.printing.overhang import OVERHANG_DEG
from fingertip.cad.printing.settings import FIRST_LAYER_MM, PROFILE
from fingertip.design import Design
from fingertip.foundation.errors import GeometryError, Issue
from fingertip.foundation.files import temporary_folder

PROGRAM = "prusa-slicer"
HOW_TO_INSTALL = "on Debian or Ubuntu: apt-get install prusa-slicer"
TIME_LIMIT_S = 300.0
_TIME = re.compile(r"^; estimated printing time \(normal mode\) = (.+)$", re.MULTILINE)
_FILAMENT = re.compile(r"^; filament used \[cm3\] = ([\d.]+)$", re.MULTILINE)
_UNITS_MIN = {"d": 1440.0, "h": 60.0, "m": 1.0, "s": 1.0 / 60.0}


@dataclass(frozen=True)
class PrintEstimate:
    """Estimate for one plate, printed from filament with the plate's settings on the slicer's default printer."""

    minutes: float
    filament_cm3: float
    """Filament volume, supports included."""


def find_slicer() -> Path | None:
    """Path of PrusaSlicer, or None if it is not installed."""
    path = shutil.which(PROGRAM)
    return Path(path) if path else None


def slice_plate(program: Path, name: str, plate: bytes, design: Design) -> PrintEstimate:
    """Slice a plate, given as 3MF, in its layers on the design's bed. Raises GeometryError."""
    return parse_gcode(name, slice_to_gcode(program, name, plate, design, PROFILE.layer_mm))


def slice_to_gcode(program: Path, name: str, plate: bytes, design: Design, layer_mm: float) -> str:
    """Slice a plate with automatic supports, unless its objects ask for none, and return the G-code.

    What the objects of a plate set for themselves, such as the height of the layers, comes before the arguments. Raises
    GeometryError.
    """
    x, y = design.printer.bed_x_mm, design.printer.bed_y_mm
    with temporary_folder() as folder:
        part, gcode = folder / f"{name}.3mf", folder / f"{name}.gcode"
        part.write_bytes(plate)
        command = [str(program), "--export-gcode", "--dont-arrange", "--bed-shape", f"0x0,{x:g}x0,{x:g}x{y:g},0x{y:g}"]
        command += ["--layer-height", f"{layer_mm:g}", "--first-layer-height", f"{max(layer_mm, FIRST_LAYER_MM):g}"]
        command += ["--support-material", "--support-material-threshold", f"{OVERHANG_DEG:g}"]
        try:
            process = subprocess.run(
                [*command, "-o", str(gcode), str(part)], capture_output=True, text=True, timeout=TIME_LIMIT_S
            )
        except subprocess.TimeoutExpired:
            message = f"PrusaSlicer did not finish within {TIME_LIMIT_S:g} s; remove --slicer."
            raise GeometryError(Issue(name, message)) from None
        if not gcode.exists():
            last_line = (process.stderr.strip() or process.stdout.strip() or "no message").splitlines()[-1]
            raise GeometryError(Issue(name, f"PrusaSlicer could not slice it ({last_line}); remove --slicer."))
        return gcode.read_text(encoding="utf-8", errors="replace")


def parse_gcode(name: str, gcode: str) -> PrintEstimate:
    """Read the estimates from the comments at the end of PrusaSlicer's G-code. Raises GeometryError."""
    time, filament = _TIME.search(gcode), _FILAMENT.search(gcode)
    if time is None or filament is None:
        raise GeometryError(
            Issue(name, "PrusaSlicer's G-code states no print time or no filament volume; remove --slicer.")
        )
    minutes = sum(float(word[:-1]) * _UNITS_MIN[word[-1]] for word in time[1].split())  # as in 1d 2h 31m 30s
    return PrintEstimate(minutes, float(filament[1]))
