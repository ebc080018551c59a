"""Consumables of a casting: what a design needs primer and adhesive for, and the tapes to buy and cut.

One tape lies over the sensor, the other one around the seat of the bone.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from fingertip.cad.shapes.bone import tape_outline_mm, tape_rim_mm
from fingertip.design import Design
from fingertip.design.geometry.conic import add_groove
from fingertip.design.geometry.seat import tape_span_mm
from fingertip.foundation.numerics import bisect

AIDS = {
    "primer": {
        "label": "Factor II A-330-G", "use": "bonds addition-cure silicone to acrylic resin",
        "source": "Hatamleh and Watts, Dental Materials 2010, 26, 387: peels off acrylic at 8.2 N/mm at best",
    },
    "lacquer": {
        "label": "Krylon Crystal Clear Acrylic", "use": "seals a print that inhibits addition-cure silicone",
        "source": "Smooth-On: Dragon Skin bulletin (clear acrylic lacquer); its support, quoted in "
                  "sanssoucistudios.com/blog/more-adventures-in-moldmaking",
    },
}  # fmt: skip
"""Products that bond or seal a print under silicone, what they do, and the sources of their names."""
_STOCK_WIDTHS_MM = (3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 15.0, 20.0, 25.0, 30.0, 40.0, 50.0)
"""Widths in which polyimide tape is sold. An assumption: makers' lists differ."""
_STATIONS = 100
"""Places along the flat at which its width is computed."""
_LAID_OFF_MM = 0.3
"""Distance from the collar at which a hand may lay the end of the tape [mm]. An assumption."""
_RANGE_MM = 0.5
"""Range within which a knife cuts the tape [mm]. An assumption."""
_TURNED_UP_MM = 1.0
"""Length of the end that is turned up on the seal in the collar [mm]. An assumption."""
_EDGE_MM = 0.1
"""Least distance of the tape from the edge of the flat [mm]."""


def cover_tape_data(design: Design) -> dict[str, Any]:
    """Size the tape under the skin: past the pocket on each side, from the collar past the head, on the flat."""
    half, end = tape_outline_mm(design)
    wanted, flat = 2.0 * half, flat_width_mm(design, design.dimensions.sensor_z)
    narrowest = min(flat_width_mm(design, design.dimensions.sensor_z * i / _STATIONS) for i in range(1, _STATIONS + 1))
    width = _round_up(wanted)
    trim = narrowest < width
    # The place at which flat or platform ends at the tip.
    dims, low, high = design.dimensions, design.dimensions.sensor_z, design.skin.length_mm
    rim, neck = tape_rim_mm(design), None
    if design.bone.platform_mm:
        neck = round(2.0 * (dims.tail_half_width + rim), 1)
        flat_end = _round_down(low + dims.platform_radius + dims.ramp_excess)  # along the ramp, as the tape lies
        length_mm = [_round_up(end + dims.ramp_excess), flat_end]  # laid from the platform on, and cut at the collar
    else:
        flat_end = _round_down(bisect(lambda z: flat_width_mm(design, z) > 0.0, low, high, halvings=40)[0])
        length_mm = _tape_length_mm(end, flat_end)
    width_mm = [width, max(width, min(width + _RANGE_MM, _round_down((flat if trim else narrowest) - _EDGE_MM)))]
    return {
        "width_mm": [round(limit, 1) for limit in width_mm],
        "stock_mm": next((stock for stock in _STOCK_WIDTHS_MM if stock >= width - 1e-6), None),
        "length_mm": length_mm,
        "overlap_mm": round(rim, 2),
        "pocket_mm": round(2.0 * (half - rim), 2),
        "flat_mm": round(narrowest, 1),
        "flat_end_mm": flat_end,
        "turned_up_mm": _TURNED_UP_MM if dims.tail_passes_collar else 0.0,
        "head_mm": round(dims.sensor_z, 2),
        "neck_mm": neck,
        "trim": trim,
    }


def _tape_length_mm(end: float, flat_end: float) -> list[float]:
    """Find the lengths to cut [mm]: none opens the slot if it is laid a little off the collar, none leaves the flat."""
    longest = _round_down(flat_end - _EDGE_MM)
    least = math.ceil(2.0 * (end + _LAID_OFF_MM) - 1e-6) / 2.0  # to half a millimetre, where the flat has room
    if least + _RANGE_MM > longest:
        least = min(_round_up(end + _LAID_OFF_MM), max(_round_up(end), longest))
    return [round(limit, 1) for limit in (least, max(least, min(least + _RANGE_MM, longest)))]


def _round_up(size_mm: float) -> float:
    return math.ceil(10.0 * size_mm - 1e-6) / 10.0


def _round_down(size_mm: float) -> float:
    return math.floor(10.0 * size_mm + 1e-6) / 10.0


def seat_tape_data(design: Design) -> dict[str, Any] | None:
    """Size the tape around the bone in the recess; None without one."""
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


def sensor_insert_data(design: Design) -> dict[str, Any] | None:
    """Size what is stuck on the sensor's tape; None without an insert."""
    if (insert := design.dimensions.insert) is None:
        return None
    beside = design.dimensions.platform_radius - insert.radius
    return {"kind": design.sensor.insert, "beside_mm": round(beside, 1), "height_mm": round(insert.height, 2)}


def flat_width_mm(design: Design, z: float) -> float:
    """Width of the bone's palmar flat at a height z [mm], where a retention groove narrows it too."""
    dims = design.dimensions
    platform = dims.platform_half_width_at(z)
    return 2.0 * (platform or add_groove(design.bone, dims.bone_outline).half_width_at(-dims.flat_depth, z))


def uses_adhesive(data: Mapping[str, Any]) -> bool:
    """Tell from the data of a sheet whether silicone adhesive seals a passage or a lid."""
    passes = data["mold"]["tail_passes_collar"]
    return bool(passes or data["sensor_tail"] == "folded")
