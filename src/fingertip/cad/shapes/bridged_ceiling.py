"""Ceiling of a pocket in the face on the printer's bed that prints without supports, around the hole that leads on.

The bottom of a counterbore or nut trap in the face on the printer's bed is a ring around a hole. A printer has nothing
to begin its inner edge on: every thread that meets the hole ends in the air. Three steps in the ceiling replace it,
each of which ends on the one below. The first leaves a slot across the pocket, and two bridges beside it. The second
closes the slot up to a square, by two bridges across the slot. The third cuts the corners of the square, which leaves
an octagon. The round hole follows.
"""

from __future__ import annotations

import math

from fingertip.design.geometry.conic import TANGENT_STEP_MM
from fingertip.design.geometry.solids import Box, Prism, Solid, difference

BRIDGE_STEP_MM = 0.25
"""Height of a step [mm]: more than a layer of 0.2 mm, at the smallest scale of a print too (printer.scale_percent). One
layer at least then lies in each step, wherever its layers begin. Finer layers print a bridge of two of them."""
_STEPS = 3
CEILING_STEPS_MM = _STEPS * BRIDGE_STEP_MM


def bridge_ceiling(
    pocket: Solid, centre: tuple[float, float], ceiling: float, upwards: float, hole_radius: float, reach: float
) -> Solid:
    """Fill the ceiling's steps into a pocket along y [mm], which reaches past its ceiling by `CEILING_STEPS_MM`."""
    z, x = centre
    half = _half_slot(hole_radius)
    first, second, third = (ceiling + upwards * step * BRIDGE_STEP_MM for step in range(_STEPS))
    end = ceiling + upwards * (CEILING_STEPS_MM + reach)

    def box(begin: float, low: tuple[float, float], high: tuple[float, float]) -> Solid:
        """Fill between two corners (z, x) relative to the centre, from a height on."""
        bottom, top = sorted((begin, end))
        return Box((x + low[1], bottom, z + low[0]), (x + high[1], top, z + high[0]))

    def corner(side_z: float, side_x: float) -> Solid:
        """Fill a corner of the square: a triangle with its long side on the octagon."""
        bottom, top = sorted((third, end))
        leg = math.sqrt(2.0) * half
        ring = [(z + side_z * leg, x), (z + side_z * leg, x + side_x * leg), (z, x + side_x * leg)]
        return Prism("y", tuple(ring if side_z * side_x > 0.0 else reversed(ring)), bottom, top)

    return difference(
        pocket,
        box(first, (half, -reach), (reach, reach)), box(first, (-reach, -reach), (-half, reach)),
        box(second, (-reach, half), (reach, reach)), box(second, (-reach, -reach), (reach, -half)),
        *(corner(side_z, side_x) for side_z in (-1.0, 1.0) for side_x in (-1.0, 1.0)),
    )  # fmt: skip


def _half_slot(hole_radius: float) -> float:
    """Half the width of slot, square and octagon [mm]: a little more than the hole's radius."""
    return hole_radius + TANGENT_STEP_MM


def ceiling_steps_volume_mm3(slot_area_mm2: float, hole_radius: float) -> float:
    """Compute the volume [mm3] that the steps add to a pocket and its hole [mm], in closed form."""
    half = _half_slot(hole_radius)
    square, octagon = 4.0 * half**2, 8.0 * (math.sqrt(2.0) - 1.0) * half**2
    return BRIDGE_STEP_MM * (slot_area_mm2 + square + octagon - _STEPS * math.pi * hole_radius**2)


def hexagon_slot_area_mm2(width: float, hole_radius: float) -> float:
    """Compute the area [mm2] of a hexagon, `width` across flats, in the slot of a hole, through two corners."""
    half, radius = _half_slot(hole_radius), width / math.sqrt(3.0)
    return 4.0 * half * radius - 2.0 * half**2 / math.sqrt(3.0)


def disc_slot_area_mm2(radius: float, hole_radius: float) -> float:
    """Compute the area [mm2] of a disc within the slot of a hole in its centre."""
    half = _half_slot(hole_radius)
    return 2.0 * (half * math.sqrt(radius**2 - half**2) + radius**2 * math.asin(half / radius))
