"""Which bolts go through the holes a design has."""

from __future__ import annotations

from dataclasses import dataclass

from fingertip.design import Design
from fingertip.design.geometry.mold_layout import lay_out
from fingertip.design.threads import Thread, select_thread

_LENGTHS_MM = (5, 6, 8, 10, 12, 16, 20, 25, 30, 35, 40, 45, 50, 55, 60, 65, 70, 80, 90, 100, 110, 120, 130, 140, 150)
"""Usual lengths of metric bolts (ISO 888)."""


@dataclass(frozen=True)
class Bolts:
    """Equal bolts with a nut each."""

    count: int
    thread: Thread
    length_mm: float
    """Below the head."""


def clamp_bolts(design: Design) -> Bolts:
    """The bolts that hold the mold's halves together.

    They enter from the dorsal face and reach through the nut, which lies at the bottom of its trap in the palmar face.
    """
    layout, mold = lay_out(design, design.dimensions), design.mold
    thread = select_thread(mold.bolt_diameter_mm)
    grip = layout.dorsal_height + layout.palmar_height - mold.nut_depth_mm + thread.nut_height_mm
    length = next((usual for usual in _LENGTHS_MM if usual >= grip), _LENGTHS_MM[-1])
    return Bolts(len(layout.bolts), thread, float(length))
