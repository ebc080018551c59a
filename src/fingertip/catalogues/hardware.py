"""Catalogues of bought parts: metric threads, and the syringes that fill a mold with the cone on which they sit.

Clearance holes are those of the fine series of ISO 273. Widths across flats and maximum heights are those of
hexagon nuts, style 1, of ISO 4032.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from fingertip.foundation.tables import load_table, read_rows

STEEL_G_CM3 = 7.85
"""Density of screws and pins."""


@dataclass(frozen=True)
class Thread:
    """Metric thread, with its sizes in millimetres."""

    diameter_mm: float
    hole_mm: float
    """Smallest clearance hole of the bolt."""
    nut_flats_mm: float
    """Maximum width across flats (ISO 4032)."""
    nut_height_mm: float

    @property
    def label(self) -> str:
        return f"M{self.diameter_mm:g}"


THREADS = load_table(Thread, read_rows(Path(__file__).with_name("threads.csv")))
MIN_HOLE_MM = THREADS[0].hole_mm
"""Smallest clearance hole [mm] that a bolt of the table passes."""
NUT_TRAP_CLEARANCE_MM = 0.2
"""Minimum clearance of a nut trap [mm], so that a printed trap takes the nut. An assumption."""
MAX_TRAP_RATIO = 1.09
"""Ratio of the trap's width to the nut's flats above which the nut turns. The corners of a nut are 1.09 times as far
apart as its flats (ISO 4032 gives both)."""


def find_thread(diameter_mm: float) -> Thread:
    return next(thread for thread in THREADS if thread.diameter_mm == diameter_mm)


def select_thread(hole_mm: float) -> Thread:
    """Select the thickest thread whose bolt passes a hole [mm], which is at least `MIN_HOLE_MM`."""
    return max((t for t in THREADS if t.hole_mm <= hole_mm + 1e-9), key=lambda thread: thread.diameter_mm)


@dataclass(frozen=True)
class Syringe:
    name: str
    volume_ml: float
    bore_mm: float
    barrel_mm: float
    """Outer diameter of the barrel, which must pass the heads of the mold's bolts."""
    source: str
    verified: bool = False

    @property
    def load_cm3(self) -> float:
        """Silicone that leaves room to put the plunger back. The room of 0.5 cm3 is an assumption."""
        return self.volume_ml - 0.5


SYRINGES = {
    syringe.name: syringe for syringe in load_table(Syringe, read_rows(Path(__file__).with_name("syringes.csv")))
}

LUER_MOUTH_MM = 4.3
"""Diameter of a female Luer cone at its mouth [mm] (unverified: the standard, ISO 80369-7, was not at hand)."""
LUER_TAPER = 0.06
"""Taper of a Luer cone: its diameter per length. The 6 % stand in the title of ISO 80369-7."""
LUER_DEPTH_MM = 7.5
"""Depth of the female cone in the mold [mm]."""
NOZZLE_DEPTH_MM = 5.0
"""Depth to which a nozzle sits in the cone [mm] (unverified)."""
NOZZLE_LENGTH_MM = 10.0
"""Length of the nozzle's bore [mm] (unverified)."""


# Blunt needles that fill the hole of the chaplet's screw from its bottom.

_OUTER_MM = {14: 2.11, 16: 1.65, 18: 1.27, 20: 0.91, 22: 0.72}
"""Nominal outer diameters of needles by gauge [mm], as ISO 9626 gives them (unverified)."""
_PLAY_MM = 0.2
"""Least play of the needle in the hole: air must leave beside it [mm]. An assumption."""


def find_needle(hole_mm: float) -> dict[str, float] | None:
    """Find the thickest needle that enters a hole [mm]; None if none does."""
    fitting = [gauge for gauge, outer in _OUTER_MM.items() if outer <= hole_mm - _PLAY_MM + 1e-9]
    return {"gauge": min(fitting), "outer_mm": _OUTER_MM[min(fitting)]} if fitting else None
