"""Catalogue of metric threads, and lengths of bolts.

Clearance holes are those of the fine series of ISO 273. Widths across flats and maximum heights are
those of hexagon nuts, style 1, of ISO 4032.
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


def select_thread(hole_mm: float) -> Thread:
    """Select the thickest thread whose bolt passes a hole [mm], which is at least `MIN_HOLE_MM`."""
    return max(
        (t for t in THREADS if t.hole_mm <= hole_mm + 1e-9), key=lambda thread: thread.diameter_mm
    )


_BOLT_LENGTHS_MM = (
    5, 6, 8, 10, 12, 16, 20, 25, 30, 35, 40, 45, 50,
    55, 60, 65, 70, 80, 90, 100, 110, 120, 130, 140, 150,
)  # fmt: skip
"""Standard lengths of metric bolts (ISO 888)."""


def standard_length_mm(wanted_mm: float) -> float:
    """Return the shortest standard length of a bolt that is at least this long [mm], or the longest
    of all.
    """
    return float(
        next((length for length in _BOLT_LENGTHS_MM if length >= wanted_mm), _BOLT_LENGTHS_MM[-1])
    )
