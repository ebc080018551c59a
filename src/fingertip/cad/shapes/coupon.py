"""Fit coupon: a frame and a loose piece that show, before the real parts are printed, what a printer makes of them.

Every fit is cut with the shape function of the real part: the sensor's pocket, the recess of the bone's base, the trap
of a nut, the socket of a key and the Luer cone. The loose piece is a slice of the bone's base with a key on it. Beside
them stand lengths for calipers and thin walls. Both pieces print flat, without supports.

Coordinates of the coupon: x and y on the printer's bed, z up [mm].
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from fingertip.cad.shapes import coupon_layout
from fingertip.cad.shapes.bone import sensor_recess
from fingertip.cad.shapes.engraving import STROKE_WIDTH, letter_outlines
from fingertip.cad.shapes.mold import base_recess, bolt_holes, key_frustums, key_sockets, luer_cone, nut_traps
from fingertip.cad.shapes.parts import Part
from fingertip.catalogues.hardware import NOZZLE_DEPTH_MM
from fingertip.design import Design
from fingertip.design.geometry.solids import Box, Placed, Prism, Solid, cylinder, difference, intersection, union

SLICE_MM = 2.4
RING_MM = 1.8
"""Height of the recess in which the slice is tried [mm]."""
_RIB_TOP_MM = 1.2
"""Height of the ribs of the frame [mm]."""
_FLOOR_MM = 0.6
"""Material left under trap and socket [mm]."""
_LEDGE_MM = 1.2
"""Width of the pocket's floor around the hole through which the sensor is pushed out [mm]."""
_WALL_TOP_MM = 2.2
_LUER_TOP_MM = NOZZLE_DEPTH_MM + 0.5
"""Mouth of the Luer cone above the bed [mm]: a nozzle sits within it, and the cone's end lies below the bed."""
_PAST_MM = 1.0
"""Length by which cuts reach past a surface, so that no faces coincide [mm]."""
_SLICE_Z_MM = -SLICE_MM - _PAST_MM
"""Height in the design of the bottom of the slice [mm]. Recess and base are prisms from there to the collar."""
_UP_FROM_PALMAR: Literal[-1] = -1
"""Quarter turn about x that turns the palmar side of a part up."""
_UP_FROM_DORSAL: Literal[1] = 1
"""Quarter turn about x that turns the dorsal side of a part up."""


def frame_with_fits(design: Design) -> Solid:
    """Build the frame with pocket, recess, trap, socket, cone, letters, slot and thin walls."""
    layout = coupon_layout.lay_out(design)
    walls, tile = layout.walls, layout.tile_mm
    carrier = Box(
        (coupon_layout.RIB_MM - coupon_layout.INTO_RIB_MM, walls[0].low[1] - coupon_layout.GAP_MM / 2, 0.0),
        (walls[-1].high[0] + coupon_layout.GAP_MM / 2, walls[0].high[1] + coupon_layout.INTO_RIB_MM, tile),
    )
    features: list[Solid] = [
        carrier, *(wall.box(tile / 2, _WALL_TOP_MM) for wall in walls),
        layout.sensor.box(0.0, tile), layout.ring.box(0.0, RING_MM), layout.tongue.box(0.0, _tongue_top_mm(design)),
    ]  # fmt: skip
    hollows = [_pocket(design, layout), *_sensor_hole(design, layout), _recess(design, layout)]
    x, z = design.mold_layout.bolts[0]
    face = (x, -design.mold_layout.palmar_height, z)
    at = (*layout.tongue.centre, _tongue_top_mm(design))
    hollows += [_place(cut(design)[0], _UP_FROM_PALMAR, face, at) for cut in (nut_traps, bolt_holes)]
    if layout.socket:
        x, z, _ = design.mold_layout.keys[0]
        at = (*layout.socket.centre, _socket_top_mm(design))
        features.append(layout.socket.box(0.0, _socket_top_mm(design)))
        hollows.append(_place(key_sockets(design)[0], _UP_FROM_DORSAL, (x, 0.0, z), at))
    inlet = design.mold_layout.inlet
    face = (inlet.x, design.mold_layout.dorsal_height, inlet.z)
    features.append(layout.luer.box(0.0, _LUER_TOP_MM))
    hollows.append(_place(luer_cone(design), _UP_FROM_DORSAL, face, (*layout.luer.centre, _LUER_TOP_MM)))
    if layout.text:
        features.append(layout.text.box(0.0, tile))
        hollows += _letters(design, layout)
    return difference(union(_frame(layout), *features), *hollows)


def _frame(layout: coupon_layout.Layout) -> Solid:
    """Build the ribs: the outline with the slot, around three windows."""
    (width, depth), slot = layout.size, layout.slot
    (left, _), (right, back) = slot.low, slot.high
    at_slot = ((left, 0.0), (left, back), (right, back), (right, 0.0))
    outline = ((0.0, 0.0), *at_slot, (width, 0.0), (width, depth), (0.0, depth))
    holes = tuple(
        (spot.low, (spot.low[0], spot.high[1]), spot.high, (spot.high[0], spot.low[1])) for spot in layout.windows
    )
    return Prism("z", outline, 0.0, _RIB_TOP_MM, holes)


def loose_slice(design: Design) -> Solid:
    """Build the slice of the bone's base, as high as `SLICE_MM`, with a key on it; it stands upright like the bone."""
    section = design.dimensions.bone_outline.section
    reach = 2 * (section.half_width + section.palmar + section.dorsal)
    exact = base_recess(design, 0.0)[0]  # without clearance: the outline of the base itself
    cut = Box((-reach, -reach, _SLICE_Z_MM), (reach, reach, _SLICE_Z_MM + SLICE_MM))
    piece = Placed(intersection(exact, cut), 0, (0.0, 0.0, -_SLICE_Z_MM))
    if not coupon_layout.has_key(design):
        return piece
    x, z, _ = design.mold_layout.keys[0]
    (larger, _), near = key_frustums(design), Box((x - reach, -reach, z - reach), (x + reach, SLICE_MM / 2, z + reach))
    centre = (0.0, (section.dorsal - design.dimensions.base_flat_depth) / 2)
    return union(piece, _place(intersection(larger, near), _UP_FROM_PALMAR, (x, 0.0, z), (*centre, SLICE_MM)))


@dataclass(frozen=True)
class Height:
    """Height of a feature above the bed, and a point of its top in the plan of its piece [mm]."""

    feature: str
    height_mm: float
    at: tuple[float, float]
    piece: str = "coupon"


def list_heights(design: Design) -> Iterator[Height]:
    """List the heights of the coupon. Layers make them, so the calibration does not use them."""
    layout, inside = coupon_layout.lay_out(design), coupon_layout.AROUND_MM / 2
    ring, tongue = layout.ring, layout.tongue
    yield Height("ribs of the frame", _RIB_TOP_MM, (coupon_layout.RIB_MM / 2, layout.windows[0].centre[1]))
    yield Height("block around the recess", RING_MM, (ring.low[0] + inside, ring.centre[1]))
    yield Height("block with the trap", _tongue_top_mm(design), (tongue.low[0] + inside, tongue.low[1] + 2 * inside))
    if spot := layout.socket:
        at = (spot.centre[0], spot.high[1] - inside)
        yield Height("block with the round socket", _socket_top_mm(design), at)
    if spot := layout.luer:
        yield Height("tallest block, with the cone", _LUER_TOP_MM, (spot.high[0] - inside, spot.centre[1]))
    yield Height("thin walls", _WALL_TOP_MM, layout.walls[-1].centre)
    side = (-0.8 * design.dimensions.bone_outline.section.half_width, 0.0)
    yield Height("loose piece, beside its key", SLICE_MM, side, "coupon_slice")


def _pocket(design: Design, layout: coupon_layout.Layout) -> Solid:
    dims, spot = design.dimensions, layout.sensor
    head = dims.sensor.head_diameter_mm / 2 + design.sensor.clearance_mm
    low, high = dims.sensor_z - head - coupon_layout.tail_mm(design), dims.sensor_z + head + _PAST_MM
    side, flat = spot.size[0] / 2, -dims.platform_depth
    near = Box((-side, flat - _PAST_MM, low), (side, flat + dims.pocket_depth + _PAST_MM, high))
    recess = sensor_recess(design)
    if design.bone.platform_mm:
        # The coupon has no ramp: its slot runs on in the plane of the pocket.
        tail = dims.tail_half_width
        slot = Box((-tail, flat - 2 * _PAST_MM, low - _PAST_MM), (tail, flat + dims.pocket_depth, dims.sensor_z))
        recess = union(cylinder("y", (dims.sensor_z, 0.0), flat - 2 * _PAST_MM, flat + dims.pocket_depth, head), slot)
    at = (spot.centre[0], spot.high[1] - coupon_layout.AROUND_MM - head, layout.tile_mm)
    # The tail points to the lower rib: y of the coupon is z of the bone.
    return _place(intersection(recess, near), _UP_FROM_PALMAR, (0.0, flat, dims.sensor_z), at)


def _sensor_hole(design: Design, layout: coupon_layout.Layout) -> tuple[Solid, ...]:
    """Build the hole under the sensor's head, through which it is pushed out; none under a small head."""
    head, spot = design.dimensions.sensor.head_diameter_mm / 2, layout.sensor
    if head < 2 * _LEDGE_MM:
        return ()
    at = (spot.centre[0], spot.high[1] - coupon_layout.AROUND_MM - head - design.sensor.clearance_mm)
    return (cylinder("z", at, -_PAST_MM, layout.tile_mm + _PAST_MM, head - _LEDGE_MM),)


def _recess(design: Design, layout: coupon_layout.Layout) -> Solid:
    flat = design.dimensions.base_flat_depth + design.mold.fit_clearance_mm
    x, y = layout.ring.centre[0], layout.ring.low[1] + coupon_layout.AROUND_MM
    reach = 2 * max(layout.ring.size)
    near = Box((-reach, -reach, _SLICE_Z_MM - _PAST_MM), (reach, reach, _SLICE_Z_MM + RING_MM + _PAST_MM))
    return Placed(intersection(base_recess(design)[0], near), 0, (x, y + flat, -_SLICE_Z_MM))


def _letters(design: Design, layout: coupon_layout.Layout) -> Iterator[Solid]:
    """Build the letters in the smallest stroke of the mold's text, as deep as there."""
    assert layout.text
    unit, top = coupon_layout.text_unit_mm(design), layout.tile_mm
    # The letters stand in the middle of their tile, whose rim is as wide as a stroke.
    x, y = (low + unit * STROKE_WIDTH * 1.5 for low in layout.text.low)
    for letter in letter_outlines(coupon_layout.LETTERS, STROKE_WIDTH):
        outline, *holes = (tuple((x + unit * u, y + unit * v) for u, v in ring) for ring in letter)
        floor = top - design.mold.engraving_depth_mm
        yield Prism("z", outline, floor, top + _PAST_MM, tuple(holes))


def _place(
    solid: Solid, turns: Literal[-1, 1], point: tuple[float, float, float], at: tuple[float, float, float]
) -> Solid:
    x, y, z = point
    return Placed(solid, turns, (at[0] - x, at[1] + turns * z, at[2] - turns * y))


def _tongue_top_mm(design: Design) -> float:
    return design.mold.nut_depth_mm + _FLOOR_MM


def _socket_top_mm(design: Design) -> float:
    """Height of the socket's mouth above the bed [mm]."""
    return design.mold.key_height_mm + design.mold.key_clearance_mm + _FLOOR_MM


def _hole_count(design: Design) -> int:
    """Count the through holes of the frame: its windows, recess, pocket, the bolt's hole and the Luer cone."""
    layout = coupon_layout.lay_out(design)
    return len(layout.windows) + 2 + len(_sensor_hole(design, layout)) + (layout.luer is not None)


COUPON_PARTS: dict[str, Part] = {
    part.name: part
    for part in (
        Part("coupon", frame_with_fits, _hole_count, (0.80, 0.74, 0.62), True),
        Part("coupon_slice", loose_slice, lambda design: 0, (0.93, 0.89, 0.80), True),
    )
}
