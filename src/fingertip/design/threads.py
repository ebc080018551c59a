"""Metric threads: the hole a bolt passes, and the nut it takes. The one table for rules, traps and the casting sheet.

Clearance holes of the fine series by ISO 273; across flats and greatest height of hexagon nuts, style 1, by ISO 4032.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Thread:
    """A metric thread, its sizes in mm."""

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
NUT_TRAP_CLEARANCE_MM = 0.2
"""A nut trap is wider than its nut by this at least, so that a print takes the nut. An assumption."""
MAX_TRAP_RATIO = 1.09
"""Ratio of the trap's width to the nut's flats above which the nut turns. The corners of a nut are 1.09 times as far
apart as its flats (ISO 4032 gives both)."""


def select_thread(hole_mm: float) -> Thread:
    """The thickest thread whose bolt passes a hole [mm], of `MIN_HOLE_MM` or more."""
    return max((t for t in THREADS if t.hole_mm <= hole_mm + 1e-9), key=lambda thread: thread.diameter_mm)
