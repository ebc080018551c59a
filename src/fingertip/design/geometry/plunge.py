"""Flow of the silicone past the core that is lowered into the cup, and its pressure."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING

from fingertip.design.geometry.skin_thickness import chord_between, nearest_chord
from fingertip.models.conic import list_arc_points, quarter_outline

if TYPE_CHECKING:
    from fingertip.design.parameters import Tables
    from fingertip.models.dimensions import Dimensions

_SAFE = 1.01
"""Factor on the estimate, which is up to 0.8 % below what sections of the solids give."""
LOWERING_S = 30.0
"""Time in which the core is lowered [s]."""
_SECTIONS = 12
_ARC_POINTS = 4
_CHORDS = 8
_FLAT_POINTS = 4
"""Sections of the core, and points and chords of each quarter
of an outline, and points of the flat.
"""

Point = tuple[float, float]


def estimate_pressure_kpa(design: Tables, dims: Dimensions, pour_z: float) -> float:
    """Compute the pressure at the tip at the end of the way by lubrication: dp/dz = 12 mu v (A + g
    / 2) / c.

    A is the area of the core's section, g and c the integrals of the gap and of its cube around it.
    The recesses of the core are left out: the pressure is up to a tenth larger than with them.
    """
    fallen = 0.0
    assert dims.bone_outline.tip is not None
    length = dims.bone_outline.tip.z - design.mold.core_inset_mm

    for i in range(_SECTIONS):
        z = length * (i + 0.5) / _SECTIONS
        section = dims.outer.section
        across = dims.outer.scale_at(z)
        palmar = dims.outer.palmar_scale_at(z)
        dorsal_side = [(across * x, across * y) for x, y in quarter_outline(section, True, _CHORDS)]
        palmar_side = [
            (across * x, -palmar * y) for x, y in quarter_outline(section, False, _CHORDS)
        ]
        surface = [
            chord_between(a, b) for side in (dorsal_side, palmar_side) for a, b in pairwise(side)
        ]
        area = gaps = cubes = 0.0  # of one side, x >= 0

        for (ax, ay), (bx, by) in pairwise(_outline_core(dims, design.mold.core_inset_mm, z)):
            gap = nearest_chord(((ax + bx) / 2, (ay + by) / 2), surface)[0]
            along = math.hypot(bx - ax, by - ay)
            area += abs(ax * by - ay * bx) / 2
            gaps = gaps + gap * along
            cubes = cubes + gap**3 * along

        fallen += 12.0 * (area + gaps / 2) / cubes * length / _SECTIONS

    speed = (length * dims.shrinkage - pour_z) / LOWERING_S
    return (
        _SAFE
        * 1e-3
        * design.silicone.material.viscosity_pa_s.high
        * speed
        * fallen
        / dims.shrinkage
    )


def _outline_core(dims: Dimensions, inset: float, z: float) -> list[Point]:
    """List points of the core's section at a height, from its dorsal
    side to its palmar flat; one side, x >= 0.
    """
    section = dims.bone_outline.section
    scale = dims.bone_outline.scale_at(z)
    width = scale * (section.half_width - inset)
    flat = dims.flat_depth - inset
    above = list_arc_points(_ARC_POINTS, section.dorsal_weight)[:0:-1]
    below = list_arc_points(_ARC_POINTS, section.palmar_weight)
    points = [(width * x, scale * (section.dorsal - inset) * y) for x, y in above]
    points += [(width * x, scale * (inset - section.palmar) * y) for x, y in below]
    edge = min(section.half_width_at(-flat, scale), width)
    deep = dims.flat_depth_at(z) - inset
    if edge == 0.0:
        return points

    raised = min(edge, max(0.0, dims.platform_half_width_at(z) - inset))
    inner = [(raised or edge) * i / _FLAT_POINTS for i in range(_FLAT_POINTS, -1, -1)]
    return [
        *(point for point in points if point[1] > -flat),
        (edge, -flat),
        *([(raised, -flat)] if raised else []),
        *((x, -(deep if raised else flat)) for x in inner),
    ]
