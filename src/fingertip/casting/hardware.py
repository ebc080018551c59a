"""Which bolts go through the holes a design has."""

from __future__ import annotations

from dataclasses import dataclass

from fingertip.design import Design
from fingertip.design.mold_layout import lay_out

_FINE_HOLES_MM = {1.6: 1.7, 2.0: 2.2, 2.5: 2.7, 3.0: 3.2, 4.0: 4.3, 5.0: 5.3, 6.0: 6.4, 8.0: 8.4}
"""Metric thread -> clearance hole, fine series (ISO 273)."""
_NUT_HEIGHTS_MM = {1.6: 1.3, 2.0: 1.6, 2.5: 2.0, 3.0: 2.4, 4.0: 3.2, 5.0: 4.7, 6.0: 5.2, 8.0: 6.8}
"""Metric thread -> greatest height of a hexagon nut, style 1 (ISO 4032)."""
_LENGTHS_MM = (5, 6, 8, 10, 12, 16, 20, 25, 30, 35, 40, 45, 50, 55, 60, 65, 70, 80, 90, 100, 110, 120, 130, 140, 150)
"""Usual lengths of metric bolts (ISO 888)."""


@dataclass(frozen=True)
class Bolts:
    """Equal bolts with a nut each."""

    count: int
    thread_mm: float
    length_mm: float
    """Below the head."""


def thread_mm(hole_mm: float) -> float:
    """The largest metric thread [mm] that passes a hole [mm]; the smallest there is if none does."""
    return max((thread for thread, least in _FINE_HOLES_MM.items() if least <= hole_mm + 1e-9), default=1.6)


def clamp_bolts(design: Design) -> Bolts:
    """The bolts that hold the mold's halves together.

    They enter from the dorsal face and reach through the nut, which lies at the bottom of its trap in the palmar face.
    """
    layout, mold = lay_out(design, design.dimensions), design.mold
    thread = thread_mm(mold.bolt_diameter_mm)
    grip = layout.dorsal_height + layout.palmar_height - mold.nut_depth_mm + _NUT_HEIGHTS_MM[thread]
    length = next((usual for usual in _LENGTHS_MM if usual >= grip), _LENGTHS_MM[-1])
    return Bolts(len(layout.bolts), thread, float(length))
