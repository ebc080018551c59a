"""Layout of the fit coupon: where each feature stands in the frame, and how large it is."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

from fingertip.cad.shapes.engraving import HEIGHT, MIN_STROKE_MM, STROKE_WIDTH, engraved_lines, text_width
from fingertip.catalogues.hardware import LUER_MOUTH_MM
from fingertip.design import Design
from fingertip.design.geometry.conic import add_draft
from fingertip.design.geometry.solids import Box

WALLS_MM = (0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 1.0, 1.2)
TONGUE_MM = 10.0
"""Width of the tongue and of the slot [mm], unless the nut needs a wider block."""
LETTERS = "AB"
"""Letters cut into the coupon, in the smallest stroke of the mold's text."""
MIN_SIZE_MM = 42.0
"""Least length and width of the frame [mm]."""
RIB_MM = 1.6
_TILE_MM = 0.8
"""Thickness of the tiles between the ribs [mm], unless pocket or letters need more."""
_TILE_FLOOR_MM = 0.4
"""Material left under pocket and letters [mm]."""
AROUND_MM = 1.2
"""Wall around recess, trap, socket and cone [mm]."""
_WINDOW_MM = 4.0
"""Room for the jaws of the calipers in a window [mm]."""
_TAIL_MM = 3.0
"""Length of the tail's slot beside the sensor's pocket [mm]."""
_WALL_LENGTH_MM = 5.0
_WALL_GAP_MM = 2.4
"""Gap between two thin walls [mm], for the tips of the calipers."""
GAP_MM = 1.8
INTO_RIB_MM = 0.5
"""Length by which a feature overlaps the rib that carries it [mm]."""


@dataclass(frozen=True)
class Spot:
    """Rectangle of the frame that a feature takes [mm]."""

    low: tuple[float, float]
    size: tuple[float, float]

    @property
    def centre(self) -> tuple[float, float]:
        return self.low[0] + self.size[0] / 2, self.low[1] + self.size[1] / 2

    @property
    def high(self) -> tuple[float, float]:
        return self.low[0] + self.size[0], self.low[1] + self.size[1]

    def box(self, low_z: float, high_z: float) -> Box:
        """Build the box over the rectangle between two heights [mm]."""
        return Box((*self.low, low_z), (*self.high, high_z))


@dataclass(frozen=True)
class Layout:
    """Places of all features in the frame.

    The frame has a rib at the bottom, at the top and at both sides, and two ribs across. Sensor and recess stand on the
    lower one of these; tongue, key's socket, Luer cone and letters on the upper one. The thin walls hang on the top.
    """

    size: tuple[float, float]
    tile_mm: float
    sensor: Spot
    ring: Spot
    """Wall around the recess of the slice."""
    tongue: Spot
    """Block that holds the trap of the nut."""
    socket: Spot | None
    """Block that holds the socket of the key; None if the key is wider than the slice."""
    luer: Spot
    """Tower around the Luer cone."""
    text: Spot | None
    """Letters; None if the design asks for no engraving."""
    windows: tuple[Spot, Spot, Spot]
    slot: Spot
    """Slot as wide as the tongue, open at the bottom edge."""
    walls: tuple[Spot, ...]


@lru_cache(maxsize=8)
def lay_out(design: Design) -> Layout:
    dims, mold = design.dimensions, design.mold
    head = dims.sensor.head_diameter_mm / 2 + design.sensor.clearance_mm
    socket_radius = design.mold_layout.keys[0][2] / 2 + mold.key_clearance_mm * math.hypot(1.0, dims.draft_slope)
    reach, unit = socket_radius + AROUND_MM, text_unit_mm(design)
    tongue = max(TONGUE_MM, 2 * (design.mold_layout.nut_circumradius + AROUND_MM))
    tower = LUER_MOUTH_MM + 2 * AROUND_MM
    around = 2 * (mold.fit_clearance_mm + AROUND_MM)
    sensor = 2 * (max(head, dims.tail_half_width) + AROUND_MM), 2 * (head + AROUND_MM) + tail_mm(design)
    ring = 2 * (_recess_half_width(design) + AROUND_MM), slice_height(design) + around
    lower = 2 * RIB_MM + _WINDOW_MM  # upper side of the lower rib across
    first = _stand({"sensor": sensor, "ring": ring}, lower)
    middle_top = _top(first) + GAP_MM
    upper = middle_top + RIB_MM
    letters = unit * (text_width(LETTERS) + 3 * STROKE_WIDTH), unit * (HEIGHT + 3 * STROKE_WIDTH)
    second = _stand(
        {
            "tongue": (tongue, mold.nut_width_mm + 2 * AROUND_MM),
            "socket": (2 * reach, 2 * reach) if has_key(design) else None,
            "luer": (tower, tower),
            "text": letters if unit else None,
        },
        upper,
    )
    end_of_walls = RIB_MM + _WALL_GAP_MM + sum(WALLS_MM) + _WALL_GAP_MM * len(WALLS_MM)
    ends = (spot.high[0] for spot in (*first.values(), *second.values()))
    width = max(MIN_SIZE_MM, max(end_of_walls, *ends) + _WINDOW_MM + RIB_MM)
    depth = max(MIN_SIZE_MM, _top(second) + GAP_MM + _WALL_LENGTH_MM + RIB_MM)
    inner = width - 2 * RIB_MM
    slot_x = width - RIB_MM - tongue
    x, walls = RIB_MM + _WALL_GAP_MM, []
    for thickness in WALLS_MM:
        walls.append(Spot((x, depth - RIB_MM - _WALL_LENGTH_MM), (thickness, _WALL_LENGTH_MM)))
        x += thickness + _WALL_GAP_MM
    return Layout(
        (width, depth),
        max(_TILE_MM, dims.pocket_depth + _TILE_FLOOR_MM, mold.engraving_depth_mm + _TILE_FLOOR_MM),
        first["sensor"], first["ring"], second["tongue"], second.get("socket"), second["luer"], second.get("text"),
        (
            Spot((RIB_MM, RIB_MM), (slot_x - 2 * RIB_MM, _WINDOW_MM)),
            Spot((RIB_MM, lower), (inner, middle_top - 2 * RIB_MM - _WINDOW_MM)),
            Spot((RIB_MM, upper), (inner, depth - RIB_MM - upper)),
        ),
        Spot((slot_x, 0.0), (tongue, RIB_MM + _WINDOW_MM)),
        tuple(walls),
    )  # fmt: skip


def _stand(sizes: Mapping[str, tuple[float, float] | None], y: float) -> dict[str, Spot]:
    """Stand features side by side on the rib that ends at `y` [mm]."""
    spots, x = {}, RIB_MM + GAP_MM
    for name, size in sizes.items():
        if size:
            spots[name] = Spot((x, y - INTO_RIB_MM), size)
            x += size[0] + GAP_MM
    return spots


def _top(spots: Mapping[str, Spot]) -> float:
    return max(spot.high[1] for spot in spots.values())


def has_key(design: Design) -> bool:
    """Return whether the larger key stands on the slice with a shoulder around it."""
    _, _, root = design.mold_layout.keys[0]
    section = design.dimensions.bone_outline.section
    return root / 2 + AROUND_MM / 2 <= min(section.half_width, slice_height(design) / 2)


def text_unit_mm(design: Design) -> float:
    """Size of a grid unit of the letters [mm]: the smallest on the mold; 0 if the design asks for no engraving."""
    if not design.mold.engraving_depth_mm:
        return 0.0
    lines = [line.unit_mm for half in ("palmar", "dorsal") for line in engraved_lines(design, half)]
    return min(lines, default=MIN_STROKE_MM / STROKE_WIDTH)


def _recess_half_width(design: Design) -> float:
    """Half the width of the recess at the parting plane [mm], where its draft has widened it."""
    section, slope = design.dimensions.bone_outline.section, design.dimensions.draft_slope
    grown = add_draft(section, slope, design.dimensions.base_flat_depth).half_width if slope else section.half_width
    return grown + design.mold.fit_clearance_mm


def tail_mm(design: Design) -> float:
    """Length of the tail's slot on the coupon [mm]: it ends before the relief of a short tail begins."""
    dims = design.dimensions
    head = dims.sensor.head_diameter_mm / 2 + design.sensor.clearance_mm
    if dims.fold or dims.tail_passes_collar:
        return min(_TAIL_MM, max(dims.sensor_z - head, 0.0))
    return min(_TAIL_MM, max(dims.sensor_z - head - dims.tail_end_z - dims.relief_half_length, 0.0))


def slice_height(design: Design) -> float:
    return design.dimensions.base_flat_depth + design.dimensions.bone_outline.section.dorsal
