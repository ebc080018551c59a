"""Metric threads: clearance hole of the bolt, and size of the nut. The one table for rules, traps and casting sheet.

Clearance holes are those of the fine series of ISO 273. Widths across flats and maximum heights are those of hexagon
nuts, style 1, of ISO 4032.
"""

from __future__ import annotations

from dataclasses import dataclass


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
        """Trade name, such as M3."""
        return f"M{self.diameter_mm:g}"


THREADS = (
    Thread(1.6, 1.7, 3.2, 1.3),
    Thread(2.0, 2.2, 4.0, 1.6),
    Thread(2.5, 2.7, 5.0, 2.0),
    Thread(3.0, 3.2, 5.5, 2.4),
    Thread(4.0, 4.3, 7.0, 3.2),
    Thread(5.0, 5.3, 8.0, 4.7),
    Thread(6.0, 6.4, 10.0, 5.2),
    Thread(8.0, 8.4, 13.0, 6.8),
)
"""Metric threads, from the thinnest to the thickest."""
MIN_HOLE_MM = THREADS[0].hole_mm
"""Smallest clearance hole [mm] that a bolt of the table passes."""
NUT_TRAP_CLEARANCE_MM = 0.2
"""Minimum clearance of a nut trap [mm], so that a printed trap takes the nut. An assumption."""
MAX_TRAP_RATIO = 1.09
"""Ratio of the trap's width to the nut's flats above which the nut turns. The corners of a nut are 1.09 times as far
apart as its flats (ISO 4032 gives both)."""


def find_thread(diameter_mm: float) -> Thread:
    """Find the thread of a nominal diameter [mm], such as 2 for M2."""
    return next(thread for thread in THREADS if thread.diameter_mm == diameter_mm)


def select_thread(hole_mm: float) -> Thread:
    """Select the thickest thread whose bolt passes a hole [mm], which is at least `MIN_HOLE_MM`."""
    return max((t for t in THREADS if t.hole_mm <= hole_mm + 1e-9), key=lambda thread: thread.diameter_mm)
