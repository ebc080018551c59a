"""Bolts that clamp the mold halves: count, thread and length, for the casting sheet and the assembly."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from fingertip.design.threads import Thread, select_thread

if TYPE_CHECKING:
    from fingertip.design.parameters import DesignTables

_BOLT_LENGTHS_MM = (
    5, 6, 8, 10, 12, 16, 20, 25, 30, 35, 40, 45, 50, 55, 60, 65, 70, 80, 90, 100, 110, 120, 130, 140, 150
)  # fmt: skip
"""Standard lengths of metric bolts (ISO 888)."""


@dataclass(frozen=True)
class ClampBolts:
    """Identical bolts that hold the mold halves together, each with a nut."""

    count: int
    thread: Thread
    length_mm: float
    """Length below the head."""

    def stand_out_mm(self, design: DesignTables) -> float:
        """Length by which they stand out of the palmar face; negative if they end below it."""
        return self.length_mm - design.mold_layout.dorsal_height - design.mold_layout.palmar_height


def size_clamp_bolts(design: DesignTables) -> ClampBolts:
    """Size the bolts that hold the mold halves together.

    They enter from the dorsal face and reach through the nut, which lies at the bottom of its trap in the palmar face.
    """
    layout, mold = design.mold_layout, design.mold
    thread = select_thread(mold.bolt_diameter_mm)
    grip_mm = layout.dorsal_height + layout.palmar_height - mold.nut_depth_mm + thread.nut_height_mm
    return ClampBolts(len(layout.bolts), thread, standard_length_mm(grip_mm))


def standard_length_mm(wanted_mm: float) -> float:
    """Return the shortest standard length of a bolt that is at least this long [mm], or the longest of all."""
    return float(next((length for length in _BOLT_LENGTHS_MM if length >= wanted_mm), _BOLT_LENGTHS_MM[-1]))
