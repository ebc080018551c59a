"""Holder of a bone that is encapsulated: a plate with the ridges of a core, and a tower around the
bone's base and post.

It stands on its tower while it prints, ridges up. The bone goes in from the ridges, post first, and
the cross bolt holds it: the hole in the tower lies a little behind that of the post, so that the
bolt pulls the collar into its seat of 45 degrees. There the collar keeps the silicone out of all
that lies behind it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import post
from .allowances import PAST_MM
from .bone import find_collar_slope
from .conic import ConicBody, offset_section
from .core import plate, plate_label, ridges
from .cross_bolt import bolt_hole
from .mold import strap_seats
from .mold_layout import PLATE_LEDGE_MM, PLATE_MM
from .solids import Box, Solid, SuperconicSolid, extrude
from .stand import BESIDE_POST_MM, post_gap_mm

if TYPE_CHECKING:
    from .program_types import Finger

SEAT_GAP_MM = 0.05
"""Gap between the collar's slope and its seat in the design [mm]: solids that only touch have
coincident faces.
"""
DRAW_MM = 0.1
"""Length by which the hole in the tower lies behind that of the post: half the play of its bolt
[mm].
"""
WALL_MM = 1.6
"""Least wall of the tower around what is open in it [mm]."""
BESIDE_NUT_MM = 3.5
"""Distance of the walls and the ceiling of the pockets from the axis of the bolt [mm]."""
_BEHIND_WIRES_MM = 1.0
_BEHIND_COLLAR_MM = 0.5
"""Length of the wires' way past their hole, and its least distance from the collar [mm]."""


def holder(finger: Finger) -> Solid:
    r"""Build the holder.

    Section across the finger, as it hangs in the cup, tip down:

                    ______   ______
                   |     |   |     |      post, its end level with the tower's
                  /|=====|===|=====|\     cross bolt, in pockets
                 / |     |   |     | \
                /  |    /     \    |  \   slopes of 45 degrees
               /   |   |       |   |   \
          ____/    |   | base  |   |    \____
         |         |__ |       | __|         |   plate, PLATE_MM thick
         |_______   __/ collar  \__   _______|   z = 0
                 V     |       |     V           ridges
    """
    body = plate(finger).union(_tower(finger), *ridges(finger))
    hollows = (*seat(finger), _wire_way(finger), *_bolt_cuts(finger))

    return body.cut(*strap_seats(finger)[1:], *hollows).cut(*plate_label(finger))


def top_z(finger: Finger) -> float:
    """Height of the tower's end, level with that of the post."""
    return post.low_z(finger)


def top_y(finger: Finger) -> tuple[float, float]:
    """Find the palmar and the dorsal edge of the tower's end."""
    return tower_sides(finger)[1]


def tower_sides(finger: Finger) -> tuple[tuple[float, float], tuple[float, float]]:
    """Find the sides of the tower at its end, along x and y [mm]: as far in as slopes of 45 degrees
    lead from the plate, but with walls around all that is open in it.
    """
    layout = finger.mold_layout
    dims = finger.dimensions
    rise = -PLATE_MM - top_z(finger)
    around = post_gap_mm(finger) + WALL_MM
    wide = max(dims.bone_outline.section.half_width, finger.bone.post_width_mm / 2)
    x = max(layout.half_width + PLATE_LEDGE_MM - rise, wide + around)
    low = max(layout.palmar_height - rise, dims.collar.section.palmar + around)
    high = max(layout.dorsal_height - rise, _wire_way(finger).high[1] + WALL_MM)

    return (-x, x), (-low, high)


def _tower(finger: Finger) -> Solid:
    layout = finger.mold_layout
    (_, x), (low, high) = tower_sides(finger)
    wide = layout.half_width + PLATE_LEDGE_MM
    top = top_z(finger)
    foot = -PLATE_MM + PAST_MM

    def slope(near: float, far: float) -> list[tuple[float, float]]:
        """List points (z, distance) of a side, from the tower's end to within the plate."""
        step = abs(far - near)
        return [(top, near), (-PLATE_MM - step, near), (-PLATE_MM, far), (foot, far)]

    across = slope(x, wide)
    left = [(z, -distance) for z, distance in reversed(across)]
    deep = (*slope(low, -layout.palmar_height), *reversed(slope(high, layout.dorsal_height)))
    far = 2 * (wide + layout.dorsal_height)

    return extrude("y", (*across, *left), -far, far).intersect(extrude("x", deep, -far, far))


def seat(finger: Finger) -> tuple[Solid, ...]:
    """Build what is open around the bone: collar with its slope, base, post, and the knot in both
    wires.
    """
    dims = finger.dimensions
    bone = finger.bone
    gap = post_gap_mm(finger)
    low = -bone.base_length_mm - post.post_foot_length(finger) - gap
    far = 2 * finger.skin.width_mm
    base = SuperconicSolid(
        ConicBody(offset_section(dims.bone_outline.section, gap), ((low, 1.0), (-gap, 1.0)))
    ).cut(Box((-far, -far, low - PAST_MM), (far, -dims.base_flat_depth - gap, PAST_MM)))
    depth = dims.collar.section.palmar + gap
    half = dims.tail_half_width
    knot = Box((-half, -depth, low), (half, 0.0, -bone.collar_length_mm))
    stem = post.post_body(
        finger,
        width=bone.post_width_mm + 2 * gap,
        height=bone.post_height_mm + 2 * flat_play_mm(finger),
        length=bone.post_length_mm + 2 * PAST_MM,
    )

    return base, _collar_seat(finger, gap), knot, stem


def flat_play_mm(finger: Finger) -> float:
    """Play of the post beside each of its flats [mm], which the errors of the print may close: it
    lets the bone turn towards its pad.
    """
    return finger.printer.surface_error_mm + max(0.0, finger.printer.offset_mm)


def _collar_seat(finger: Finger, gap: float) -> Solid:
    """Build what is open around the collar: wider by a gap, and nearer to the tip by as much, so
    that its slope meets that of the collar.
    """
    slope = find_collar_slope(finger)
    section = finger.dimensions.collar.section
    nearer = gap - SEAT_GAP_MM
    half = section.half_width
    share = (half * slope.share + gap) / (half + gap)
    stations = (
        (slope.begin_z - gap, share),
        (slope.begin_z + nearer, share),
        (slope.end_z + nearer, 1.0),
        (PAST_MM + nearer, 1.0),
    )

    return SuperconicSolid(ConicBody(offset_section(section, gap), stations))


def _wire_way(finger: Finger) -> Box:
    """Build the way of the wires on the back of the bone, open at the tower's end."""
    dims = finger.dimensions
    radius = finger.bone.channel_diameter_mm / 2
    high = dims.bone_outline.section.dorsal + post_gap_mm(finger) + finger.bone.channel_diameter_mm
    behind_collar = -finger.bone.collar_length_mm - _BEHIND_COLLAR_MM
    end = min(dims.channel_exit_z + radius + _BEHIND_WIRES_MM, behind_collar)

    return Box((-radius, dims.base_middle_y, top_z(finger) - PAST_MM), (radius, high, end))


def _bolt_cuts(finger: Finger) -> tuple[Solid, ...]:
    """Build the hole of the cross bolt, and the pockets of its head and nut, whose ceilings are
    bridges.
    """
    z = post.cross_bolt_z(finger)
    middle = finger.dimensions.base_middle_y
    near = finger.bone.post_width_mm / 2 + post_gap_mm(finger) + BESIDE_POST_MM
    far = 2 * (finger.mold_layout.half_width + PLATE_LEDGE_MM)
    low = (middle - BESIDE_NUT_MM, top_z(finger) - PAST_MM)
    high = (middle + BESIDE_NUT_MM, z + BESIDE_NUT_MM)
    right, left = (Box((x, *low), (x + far - near, *high)) for x in (near, -far))

    return bolt_hole(finger, z - DRAW_MM), right, left
