"""Tapes to buy and cut: over the sensor, around the seat, and the paper between the seat's tape and a bare film."""

from __future__ import annotations

import math
from typing import Any

from fingertip.cad.shapes.seals import TAPE_RIM_MM, tape_outline_mm
from fingertip.design import Design
from fingertip.design.geometry.insert_body import add_groove
from fingertip.design.geometry.seat import tape_span_mm

_STOCK_WIDTHS_MM = (3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 15.0, 20.0, 25.0, 30.0, 40.0, 50.0)
"""Widths in which polyimide tape is sold. An assumption: makers' lists differ."""
_STATIONS = 100
"""Places along the flat at which its width is computed."""


def cover_tape_data(design: Design) -> dict[str, Any]:
    """Size the tape under the skin: past the pocket on each side, from the collar past the head, on the flat."""
    half, end = tape_outline_mm(design)
    wanted, flat = 2.0 * half, flat_width_mm(design, design.dimensions.sensor_z)
    rounded = math.ceil(2.0 * wanted - 1e-6) / 2.0  # to half a millimetre, where the flat has room
    width = rounded if rounded <= flat else math.ceil(10.0 * wanted - 1e-6) / 10.0
    narrowest = min(flat_width_mm(design, design.dimensions.sensor_z * i / _STATIONS) for i in range(1, _STATIONS + 1))
    return {
        "width_mm": round(width, 1),
        "stock_mm": next((stock for stock in _STOCK_WIDTHS_MM if stock >= width - 1e-6), None),
        "length_mm": math.ceil(end - 1e-6),
        "overlap_mm": TAPE_RIM_MM,
        "pocket_mm": round(2.0 * (half - TAPE_RIM_MM), 2),
        "flat_mm": round(narrowest, 1),
        "trim": narrowest < width,
    }


def seat_tape_data(design: Design) -> dict[str, Any] | None:
    """Size the tape around bone or core in the recess; None without one."""
    span = tape_span_mm(design)
    if span is None:
        return None
    room = span[1] - span[0]
    return {
        "thickness_mm": design.mold.seat_tape_mm,
        "from_mm": round(span[0], 1),
        "to_mm": round(span[1], 1),
        "width_mm": round(room, 1),
        "stock_mm": max((stock for stock in _STOCK_WIDTHS_MM if stock <= room + 1e-6), default=None),
    }


def flat_width_mm(design: Design, z: float) -> float:
    """Width of the bone's palmar flat at a height z [mm], where a retention groove narrows it too."""
    dims = design.dimensions
    return 2.0 * add_groove(design, dims.bone_outline).half_width_at(-dims.flat_depth, z)
