"""Fit coupon: a frame and a loose piece that show, before the real parts are printed, what a printer makes of them.

Every fit is cut with the shape function of the real part: the sensor's pocket, the recess of the bone's base, the trap
of a nut, the socket of a key and the Luer cone. The loose piece is a slice of the bone's base with a key on it. Beside
them stand lengths for calipers and thin walls. Both pieces print flat, without supports.

Coordinates of the coupon: x and y on the printer's bed, z up [mm].
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

from fingertip.cad.shapes.bone import sensor_recess
from fingertip.cad.shapes.engraving import (
    HEIGHT,
    MIN_STROKE_MM,
    STROKE_WIDTH,
    engraved_lines,
    letter_outlines,
    text_width,
)
from fingertip.cad.shapes.mold import base_recess, bolt_holes, key_sockets, keys, nut_traps
from fingertip.cad.shapes.parts import Part
from fingertip.cad.shapes.runners import luer_cone
from fingertip.cad.solids import Box, Placed, Point3, Prism, Solid, cylinder, difference, intersection, union
from fingertip.design import Design
from fingertip.design.geometry.draft import add_draft
from fingertip.syringes import LUER_MOUTH_MM, NOZZLE_DEPTH_MM

WALLS_MM = (0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 1.0, 1.2)
"""Thicknesses of the thin walls [mm]."""
TONGUE_MM = 10.0
"""Width of the tongue and of the slot [mm], unless the nut needs a wider block."""
LETTERS = "AB"
"""Letters cut into the coupon, in the smallest stroke of the mold's text."""
MIN_SIZE_MM = 42.0
"""Least length and width of the frame [mm]."""
SLICE_MM = 2.4
"""Height of the slice of the bone's base [mm]."""
RING_MM = 1.8
"""Height of the recess in which the slice is tried [mm]."""

_RIB_MM, _RIB_TOP_MM = 1.6, 1.2
"""Width and height of the ribs of the frame [mm]."""
_TILE_MM = 0.8
"""Thickness of the tiles between the ribs [mm], unless pocket or letters need more."""
_TILE_FLOOR_MM, _FLOOR_MM = 0.4, 0.6
"""Material left under pocket and letters, and under trap and socket [mm]."""
_AROUND_MM = 1.2
"""Wall around recess, trap, socket and cone [mm]."""
_WINDOW_MM = 4.0
"""Room for the jaws of the calipers in a window [mm]."""
_TAIL_MM = 3.0
"""Length of the tail's slot beside the sensor's pocket [mm]."""
_LEDGE_MM = 1.2
"""Width of the pocket's floor around the hole through which the sensor is pushed out [mm]."""
_WALL_LENGTH_MM, _WALL_TOP_MM = 5.0, 2.2
"""Length and top of the thin walls [mm]."""
_WALL_GAP_MM = 2.4
"""Gap between two thin walls [mm], for the tips of the calipers."""
_LUER_TOP_MM = NOZZLE_DEPTH_MM + 0.5
"""Mouth of the Luer cone above the bed [mm]: a nozzle sits within it, and the cone's end lies below the bed."""
_GAP_MM = 1.8
"""Distance between features [mm]."""
_PAST_MM = 1.0
"""Length by which cuts reach past a surface, so that no faces coincide [mm]."""
_INTO_RIB_MM = 0.5
"""Length by which a feature overlaps the rib that carries it [mm]."""

_UP_FROM_PALMAR: Literal[-1] = -1
"""Quarter turn about x that turns the palmar side of a part up."""
_UP_FROM_DORSAL: Literal[1] = 1
"""Quarter turn about x that turns the dorsal side of a part up."""


@dataclass(frozen=True)
class Spot:
    """Rectangle of the frame that a feature takes [mm]."""

    low: tuple[float, float]
    size: tuple[float, float]

    @property
    def centre(self) -> tuple[float, float]:
        """Centre of the rectangle."""
        return self.low[0] + self.size[0] / 2, self.low[1] + self.size[1] / 2

    @property
    def high(self) -> tuple[float, float]:
        """Corner opposite to `low`."""
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
    """Thickness of the tiles."""
    sensor: Spot
    ring: Spot
    """Wall around the recess of the slice."""
    tongue: Spot
    """Block that holds the trap of the nut."""
    socket: Spot | None
    """Block that holds the socket of the key; None if the key is wider than the slice."""
    luer: Spot | None
    """Tower around the Luer cone; None if gravity fills the mold."""
    text: Spot | None
    """Letters; None if the design asks for no engraving."""
    windows: tuple[Spot, Spot, Spot]
    """Openings of the frame, from bottom to top."""
    slot: Spot
    """Slot as wide as the tongue, open at the bottom edge."""
    walls: tuple[Spot, ...]


@lru_cache(maxsize=8)
def lay_out(design: Design) -> Layout:
    """Lay out the frame and its features."""
    dims, mold = design.dimensions, design.mold
    head = dims.sensor.head_diameter_mm / 2 + design.sensor.clearance_mm
    reach, unit = _socket_radius(design) + _AROUND_MM, text_unit_mm(design)
    tongue = max(TONGUE_MM, 2 * (design.mold_layout.nut_circumradius + _AROUND_MM))
    tower = LUER_MOUTH_MM + 2 * _AROUND_MM
    around = 2 * (mold.fit_clearance_mm + _AROUND_MM)
    sensor = 2 * (max(head, dims.tail_half_width) + _AROUND_MM), 2 * (head + _AROUND_MM) + _tail_mm(design)
    ring = 2 * (_recess_half_width(design) + _AROUND_MM), slice_height(design) + around
    first = _stand({"sensor": sensor, "ring": ring}, 2 * _RIB_MM + _WINDOW_MM)
    second = _stand(
        {
            "tongue": (tongue, mold.nut_width_mm + 2 * _AROUND_MM),
            "socket": (2 * reach, 2 * reach) if has_key(design) else None,
            "luer": (tower, tower) if mold.filling == "syringe" else None,
            "text": (unit * (text_width(LETTERS) + 3 * STROKE_WIDTH), unit * (HEIGHT + 3 * STROKE_WIDTH))
            if unit
            else None,
        },
        _top(first) + _GAP_MM + _RIB_MM,
    )
    middle_top = _top(first) + _GAP_MM
    walls_y = _top(second) + _GAP_MM
    ends = max(_end(first) + _WINDOW_MM, _end(second) + _WINDOW_MM, _end_of_walls() + _WINDOW_MM)
    width = max(MIN_SIZE_MM, ends + _RIB_MM)
    depth = max(MIN_SIZE_MM, walls_y + _WALL_LENGTH_MM + _RIB_MM)
    inner = width - 2 * _RIB_MM
    slot_x = width - _RIB_MM - tongue
    heights = ((_RIB_MM, _WINDOW_MM), (2 * _RIB_MM + _WINDOW_MM, middle_top - 2 * _RIB_MM - _WINDOW_MM))
    upper = middle_top + _RIB_MM
    x, walls = _RIB_MM + _WALL_GAP_MM, []
    for thickness in WALLS_MM:
        walls.append(Spot((x, depth - _RIB_MM - _WALL_LENGTH_MM), (thickness, _WALL_LENGTH_MM)))
        x += thickness + _WALL_GAP_MM
    return Layout(
        (width, depth),
        max(_TILE_MM, dims.pocket_depth + _TILE_FLOOR_MM, mold.engraving_depth_mm + _TILE_FLOOR_MM),
        first["sensor"], first["ring"], second["tongue"], second.get("socket"), second.get("luer"), second.get("text"),
        (
            Spot((_RIB_MM, heights[0][0]), (slot_x - 2 * _RIB_MM, heights[0][1])),
            Spot((_RIB_MM, heights[1][0]), (inner, heights[1][1])),
            Spot((_RIB_MM, upper), (inner, depth - _RIB_MM - upper)),
        ),
        Spot((slot_x, 0.0), (tongue, _RIB_MM + _WINDOW_MM)),
        tuple(walls),
    )  # fmt: skip


def _stand(sizes: Mapping[str, tuple[float, float] | None], y: float) -> dict[str, Spot]:
    """Stand features side by side on the rib that ends at `y` [mm]."""
    spots, x = {}, _RIB_MM + _GAP_MM
    for name, size in sizes.items():
        if size:
            spots[name] = Spot((x, y - _INTO_RIB_MM), size)
            x += size[0] + _GAP_MM
    return spots


def _top(spots: Mapping[str, Spot]) -> float:
    return max(spot.high[1] for spot in spots.values())


def _end(spots: Mapping[str, Spot]) -> float:
    return max(spot.high[0] for spot in spots.values())


def _end_of_walls() -> float:
    """End of the row of thin walls, across the frame [mm]."""
    return _RIB_MM + _WALL_GAP_MM + sum(WALLS_MM) + _WALL_GAP_MM * len(WALLS_MM)


def has_key(design: Design) -> bool:
    """Return whether the larger key stands on the slice with a shoulder around it."""
    _, _, root = design.mold_layout.keys[0]
    section = design.dimensions.bone_outline.section
    return root / 2 + _AROUND_MM / 2 <= min(section.half_width, slice_height(design) / 2)


def text_unit_mm(design: Design) -> float:
    """Size of a grid unit of the letters [mm]: the smallest on the mold; 0 if the design asks for no engraving."""
    if not design.mold.engraving_depth_mm:
        return 0.0
    lines = [line.unit_mm for half in ("palmar", "dorsal") for line in engraved_lines(design, half)]
    return min(lines, default=MIN_STROKE_MM / STROKE_WIDTH)


def frame_with_fits(design: Design) -> Solid:
    """Build the frame with pocket, recess, trap, socket, cone, letters, slot and thin walls."""
    layout = lay_out(design)
    walls, tile = layout.walls, layout.tile_mm
    carrier = Box(
        (_RIB_MM - _INTO_RIB_MM, walls[0].low[1] - _GAP_MM / 2, 0.0),
        (walls[-1].high[0] + _GAP_MM / 2, walls[0].high[1] + _INTO_RIB_MM, tile),
    )
    features: list[Solid] = [
        carrier, *(wall.box(tile / 2, _WALL_TOP_MM) for wall in walls),
        layout.sensor.box(0.0, tile), layout.ring.box(0.0, RING_MM), layout.tongue.box(0.0, _tongue_top_mm(design)),
    ]  # fmt: skip
    hollows = [_pocket(design, layout), *_sensor_hole(design, layout), _recess(design, layout)]
    hollows += _nut_trap(design, layout)
    if layout.socket:
        features.append(layout.socket.box(0.0, _socket_top_mm(design)))
        hollows.append(_socket(design, layout.socket))
    if layout.luer:
        features.append(layout.luer.box(0.0, _LUER_TOP_MM))
        hollows.append(_luer(design, layout.luer))
    if layout.text:
        features.append(layout.text.box(0.0, tile))
        hollows += _letters(design, layout)
    return difference(union(_frame(layout), *features), *hollows)


def _frame(layout: Layout) -> Solid:
    """Build the ribs: the outline with the slot, around three windows."""
    (width, depth), slot = layout.size, layout.slot
    (left, _), (right, back) = slot.low, slot.high
    outline = (
        (0.0, 0.0),
        (left, 0.0),
        (left, back),
        (right, back),
        (right, 0.0),
        (width, 0.0),
        (width, depth),
        (0.0, depth),
    )
    holes = tuple(
        (spot.low, (spot.low[0], spot.high[1]), spot.high, (spot.high[0], spot.low[1])) for spot in layout.windows
    )
    return Prism("z", outline, 0.0, _RIB_TOP_MM, holes)


def loose_slice(design: Design) -> Solid:
    """Build the slice of the bone's base, as high as `SLICE_MM`, with a key on it; it stands upright like the bone."""
    section = design.dimensions.bone_outline.section
    reach = 2 * (section.half_width + section.palmar + section.dorsal)
    exact = base_recess(design, 0.0)[0]  # without clearance: the outline of the base itself
    low = _slice_z()
    cut = Box((-reach, -reach, low), (reach, reach, low + SLICE_MM))
    piece = Placed(intersection(exact, cut), 0, (0.0, 0.0, -low))
    if not has_key(design):
        return piece
    x, z, _ = design.mold_layout.keys[0]
    key = intersection(keys(design)[0], Box((x - reach, -reach, z - reach), (x + reach, SLICE_MM / 2, z + reach)))
    centre = (0.0, (section.dorsal - design.dimensions.base_flat_depth) / 2)
    return union(piece, _place(key, _UP_FROM_PALMAR, (x, 0.0, z), (*centre, SLICE_MM)))


def _pocket(design: Design, layout: Layout) -> Solid:
    """Build the sensor's pocket with the beginning of its tail's slot, open at the top of its tile."""
    dims, spot = design.dimensions, layout.sensor
    head = dims.sensor.head_diameter_mm / 2 + design.sensor.clearance_mm
    low, high = dims.sensor_z - head - _tail_mm(design), dims.sensor_z + head + _PAST_MM
    side, flat = spot.size[0] / 2, -dims.flat_depth
    near = Box((-side, flat - _PAST_MM, low), (side, flat + dims.pocket_depth + _PAST_MM, high))
    at = (spot.centre[0], spot.high[1] - _AROUND_MM - head, layout.tile_mm)
    # The tail points to the lower rib: y of the coupon is z of the bone.
    return _place(intersection(sensor_recess(design), near), _UP_FROM_PALMAR, (0.0, flat, dims.sensor_z), at)


def _sensor_hole(design: Design, layout: Layout) -> tuple[Solid, ...]:
    """Build the hole under the sensor's head, through which it is pushed out; none under a small head."""
    head, spot = design.dimensions.sensor.head_diameter_mm / 2, layout.sensor
    if head < 2 * _LEDGE_MM:
        return ()
    at = (spot.centre[0], spot.high[1] - _AROUND_MM - head - design.sensor.clearance_mm)
    return (cylinder("z", at, -_PAST_MM, layout.tile_mm + _PAST_MM, head - _LEDGE_MM),)


def _recess(design: Design, layout: Layout) -> Solid:
    """Build the recess of the slice, through its ring."""
    flat = design.dimensions.base_flat_depth + design.mold.fit_clearance_mm
    at = (layout.ring.centre[0], layout.ring.low[1] + _AROUND_MM, 0.0)
    recess = base_recess(design)[0]
    low = _slice_z()
    reach = 2 * max(layout.ring.size)
    near = Box((-reach, -reach, low - _PAST_MM), (reach, reach, low + RING_MM + _PAST_MM))
    return Placed(intersection(recess, near), 0, (at[0], at[1] + flat, -low))


def _nut_trap(design: Design, layout: Layout) -> tuple[Solid, ...]:
    """Build the trap of the first bolt's nut, and the hole of the bolt below it."""
    x, z = design.mold_layout.bolts[0]
    face = (x, -design.mold_layout.palmar_height, z)
    at = (*layout.tongue.centre, _tongue_top_mm(design))
    return tuple(_place(cut(design)[0], _UP_FROM_PALMAR, face, at) for cut in (nut_traps, bolt_holes))


def _socket(design: Design, spot: Spot) -> Solid:
    """Build the socket of the larger key, open at the top."""
    x, z, _ = design.mold_layout.keys[0]
    return _place(key_sockets(design)[0], _UP_FROM_DORSAL, (x, 0.0, z), (*spot.centre, _socket_top_mm(design)))


def _luer(design: Design, spot: Spot) -> Solid:
    """Build the Luer cone, its mouth at the top."""
    inlet, (cone,) = design.mold_layout.inlet, luer_cone(design)
    assert inlet
    face = (inlet.x, design.mold_layout.dorsal_height, inlet.z)
    return _place(cone, _UP_FROM_DORSAL, face, (*spot.centre, _LUER_TOP_MM))


def _letters(design: Design, layout: Layout) -> list[Solid]:
    """Build the letters in the smallest stroke of the mold's text, as deep as there."""
    assert layout.text
    unit, top = text_unit_mm(design), layout.tile_mm
    # The letters stand in the middle of their tile, whose rim is as wide as a stroke.
    x, y = (low + unit * STROKE_WIDTH * 1.5 for low in layout.text.low)
    prisms: list[Solid] = []
    for letter in letter_outlines(LETTERS, STROKE_WIDTH):
        outline, *holes = (tuple((x + unit * u, y + unit * v) for u, v in ring) for ring in letter)
        floor = top - design.mold.engraving_depth_mm
        prisms.append(Prism("z", outline, floor, top + _PAST_MM, tuple(holes)))
    return prisms


def _place(solid: Solid, turns: Literal[-1, 1], point: Point3, at: Point3) -> Solid:
    """Turn a solid and move it, such that a point of the design comes to lie at a point of the coupon."""
    x, y, z = point
    return Placed(solid, turns, (at[0] - x, at[1] + turns * z, at[2] - turns * y))


def _slice_z() -> float:
    """Height in the design of the bottom of the slice [mm]. Recess and base are prisms from there to the collar."""
    return -SLICE_MM - _PAST_MM


def slice_height(design: Design) -> float:
    """Height of the slice from its palmar flat to its dorsal side [mm]."""
    return design.dimensions.base_flat_depth + design.dimensions.bone_outline.section.dorsal


def _recess_half_width(design: Design) -> float:
    """Half the width of the recess at the parting plane [mm], where its draft has widened it."""
    section, slope = design.dimensions.bone_outline.section, design.dimensions.draft_slope
    grown = add_draft(section, slope, design.dimensions.base_flat_depth).half_width if slope else section.half_width
    return grown + design.mold.fit_clearance_mm


def _socket_radius(design: Design) -> float:
    """Radius of the key's socket at its mouth [mm]."""
    _, _, root = design.mold_layout.keys[0]
    return root / 2 + design.mold.key_clearance_mm * math.hypot(1.0, design.dimensions.draft_slope)


def _tongue_top_mm(design: Design) -> float:
    """Height of the tongue above the bed [mm]."""
    return design.mold.nut_depth_mm + _FLOOR_MM


def _socket_top_mm(design: Design) -> float:
    """Height of the socket's mouth above the bed [mm]."""
    return design.mold.key_height_mm + design.mold.key_clearance_mm + _FLOOR_MM


def _tail_mm(design: Design) -> float:
    """Length of the tail's slot on the coupon [mm]: it ends before the relief of a short tail begins."""
    dims = design.dimensions
    head = dims.sensor.head_diameter_mm / 2 + design.sensor.clearance_mm
    if dims.fold or dims.tail_passes_collar:
        return min(_TAIL_MM, max(dims.sensor_z - head, 0.0))
    return min(_TAIL_MM, max(dims.sensor_z - head - dims.tail_end_z - dims.relief_half_length, 0.0))


def _hole_count(design: Design) -> int:
    """Count the through holes of the frame: its windows, recess, pocket, the bolt's hole and the Luer cone."""
    layout = lay_out(design)
    return len(layout.windows) + 2 + len(_sensor_hole(design, layout)) + (layout.luer is not None)


COUPON_PARTS: dict[str, Part] = {
    part.name: part
    for part in (
        Part("coupon", frame_with_fits, _hole_count, (0.80, 0.74, 0.62), True),
        Part("coupon_slice", loose_slice, lambda design: 0, (0.93, 0.89, 0.80), True),
    )
}
"""Both pieces of the coupon, by name."""
