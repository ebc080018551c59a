"""Flow of the silicone past the core that is lowered into the cup: its pressure, and how far that bends the core."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING

from fingertip.design.geometry.conic import arc_point, quarter_outline

if TYPE_CHECKING:
    from fingertip.design.geometry import DesignTables

LOWERING_S = 30.0
"""Time in which the core is lowered [s]."""
BAND_N = 1.0
"""Force of a rubber band [N]: two go twice across the seam, one holds the core down. An assumption."""
MAX_BENDING_MM = 0.01
_SECTIONS, _ARC_POINTS, _CHORDS, _FLAT_POINTS = 12, 4, 8, 4
"""Sections of the core, and points and chords of each quarter of an outline, and points of the flat."""

Point = tuple[float, float]


def estimate_pressure_kpa(design: DesignTables) -> float:
    """Compute the pressure at the tip at the end of the way by lubrication: dp/dz = 12 mu v (A + g / 2) / c.

    A is the area of the core's section, g and c the integrals of the gap and of its cube around it. The recesses of
    the core are left out: the pressure is up to a tenth larger than with them.
    """
    dims, fallen = design.dimensions, 0.0
    assert dims.bone_outline.tip is not None
    length = dims.bone_outline.tip.z - design.mold.core_inset_mm
    for i in range(_SECTIONS):
        z = length * (i + 0.5) / _SECTIONS
        section, across, palmar = dims.outer.section, dims.outer.scale_at(z), dims.outer.palmar_scale_at(z)
        dorsal_side = [(across * x, across * y) for x, y in quarter_outline(section, True, _CHORDS)]
        palmar_side = [(across * x, -palmar * y) for x, y in quarter_outline(section, False, _CHORDS)]
        surface = [*pairwise(dorsal_side), *pairwise(palmar_side)]
        area = gaps = cubes = 0.0  # of one side, x >= 0
        for (ax, ay), (bx, by) in pairwise(_outline_core(design, z)):
            gap, along = _measure_gap((ax + bx) / 2, (ay + by) / 2, surface), math.hypot(bx - ax, by - ay)
            area += abs(ax * by - ay * bx) / 2
            gaps, cubes = gaps + gap * along, cubes + gap**3 * along
        fallen += 12.0 * (area + gaps / 2) / cubes * length / _SECTIONS
    speed = (length * dims.shrinkage - design.mold_layout.pour_z) / LOWERING_S
    return 1e-3 * design.silicone.material.viscosity_pa_s.high * speed * fallen / dims.shrinkage


def max_pressure_kpa(design: DesignTables) -> float:
    """Compute the pressure at which the cup opens against its bands."""
    return 4e3 * BAND_N / (design.mold_layout.foot_z * design.mold_layout.cavity_half_width * 2)


def core_bending_mm(design: DesignTables, pressure_kpa: float) -> float:
    """Compute the deflection of the core's tip if the pressure acted on all of one side, and none on the other.

    Of its section half counts: the middle is infill.
    """
    section, dims = design.dimensions.bone_outline.section, design.dimensions
    height, width = section.dorsal + dims.flat_depth, 2 * section.half_width
    stiffness = design.strength.material.modulus_mpa * 0.5 * width * height**3 / 12
    return 1e-3 * pressure_kpa * width * (design.skin.length_mm - design.skin.thickness_tip_mm) ** 4 / (8 * stiffness)


def _outline_core(design: DesignTables, z: float) -> list[Point]:
    """List points of the core's section at a height, from its dorsal side to its palmar flat; one side, x >= 0."""
    dims, inset = design.dimensions, design.mold.core_inset_mm
    section, scale = dims.bone_outline.section, dims.bone_outline.scale_at(z)
    width, flat = scale * (section.half_width - inset), dims.flat_depth - inset
    arcs = [(1.0 - i / _ARC_POINTS, section.dorsal_weight, section.dorsal - inset) for i in range(_ARC_POINTS)]
    arcs += [(i / _ARC_POINTS, section.palmar_weight, inset - section.palmar) for i in range(_ARC_POINTS + 1)]
    points = [(width * x, scale * height * y) for t, weight, height in arcs for x, y in [arc_point(t, weight)]]
    edge, deep = min(section.half_width_at(-flat, scale), width), dims.flat_depth_at(z) - inset
    if edge == 0.0:
        return points
    raised = min(edge, max(0.0, dims.platform_half_width_at(z) - inset))
    inner = [(raised or edge) * i / _FLAT_POINTS for i in range(_FLAT_POINTS, -1, -1)]
    return [*(point for point in points if point[1] > -flat), (edge, -flat), *([(raised, -flat)] if raised else []),
            *((x, -(deep if raised else flat)) for x in inner)]  # fmt: skip


def _measure_gap(x: float, y: float, surface: list[tuple[Point, Point]]) -> float:
    """Measure the distance from a point to the nearest chord of an outline [mm]."""
    nearest = math.inf
    for (ax, ay), (bx, by) in surface:
        dx, dy = bx - ax, by - ay
        share = ((x - ax) * dx + (y - ay) * dy) / max(dx * dx + dy * dy, 1e-12)
        share = min(max(share, 0.0), 1.0)
        nearest = min(nearest, math.hypot(ax + share * dx - x, ay + share * dy - y))
    return nearest
