"""Ways of the silicone into the mold and of the air out of it: inlet, or gate and funnel, and vents."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

from fingertip.cad.kernel.solids import Cone, Prism, Solid, cylinder, union
from fingertip.cad.shapes.insert import axis_z, contact_y
from fingertip.catalogues.syringes import LUER_DEPTH_MM, LUER_MOUTH_MM, LUER_TAPER
from fingertip.design import Design
from fingertip.design.geometry.mold_layout import Inlet
from fingertip.filling.mold_filling import Vent, place_vents

_SPRUE_DRAFT = 0.03
"""Draft of the sprue, which widens towards the parting plane, so that it lifts out: radius per length."""


_VENT_BEGIN = 0.95
"""Beginning of a groove inside the cavity, relative to the cavity's half width at its top."""


_VENT_DEPTH = 0.8
"""Beginning of a hole from above, relative to the height of the cavity at its lowest edge."""
_BELOW_BOSS_MM = 0.2
"""Length by which a vent reaches past the end of the boss [mm]."""


def runners(design: Design) -> tuple[Solid, ...]:
    """Build everything that silicone and air flow through outside the cavity, but for the Luer cone."""
    inlet = design.mold_layout.inlet
    if inlet:
        return sprue(design, inlet), runner(inlet), *vents(design)
    return (*gate_and_funnel(design), *vents(design))


def luer_cone(design: Design) -> tuple[Solid, ...]:
    """Build the cone in the dorsal half on which the syringe sits; none if gravity fills the mold.

    It widens towards the outside, which a casting cannot leave: the nozzle fills most of it.
    """
    inlet, layout = design.mold_layout.inlet, design.mold_layout
    if inlet is None:
        return ()
    mouth, face = LUER_MOUTH_MM / 2, layout.dorsal_height
    slope, low = LUER_TAPER / 2, layout.dorsal_height - LUER_DEPTH_MM
    # It continues past the face at the same taper, so that its mouth has the stated diameter there.
    end = face + LUER_DEPTH_MM
    return (Cone("y", (inlet.z, inlet.x), low, end, mouth - slope * LUER_DEPTH_MM, mouth + slope * (end - face)),)


def sprue(design: Design, inlet: Inlet) -> Solid:
    """Build the sprue from the end of the Luer cone to the parting plane."""
    radius = (LUER_MOUTH_MM - LUER_TAPER * LUER_DEPTH_MM) / 2
    top = design.mold_layout.dorsal_height - LUER_DEPTH_MM
    # It reaches into the cone by a length that leaves no coincident face.
    overlap = LUER_DEPTH_MM / 10
    low = radius + _SPRUE_DRAFT * top
    return Cone("y", (inlet.z, inlet.x), 0.0, top + overlap, low, radius - _SPRUE_DRAFT * overlap)


def runner(inlet: Inlet) -> Solid:
    """Build the runner from the sprue into the cavity: along z in the column of the bolts, then along x."""
    course = ((inlet.x, inlet.z), (inlet.x, inlet.gate_z), (inlet.gate_x, inlet.gate_z))
    return groove(course, inlet.width, inlet.depth)


def groove(course: Sequence[tuple[float, float]], width: float, depth: float) -> Solid:
    """Build a groove in the dorsal half, along a course of points (x, z) whose legs run along x or z.

    Its corners are mitred, so that its outline is one polygon.
    """
    legs = [(_sign(b[0] - a[0]), _sign(b[1] - a[1])) for a, b in pairwise(course)]
    left, right = [], []
    for i, (x, z) in enumerate(course):
        beside = {legs[max(i - 1, 0)], legs[min(i, len(legs) - 1)]}  # the leg before this point and that after it
        shift_x, shift_z = (width / 2 * sum(part) for part in zip(*((-dz, dx) for dx, dz in beside), strict=True))
        left.append((z + shift_z, x + shift_x))
        right.append((z - shift_z, x - shift_x))
    corners = (*left, *reversed(right))
    area = sum(a[0] * b[1] - b[0] * a[1] for a, b in pairwise((*corners, corners[0])))
    return Prism("y", corners if area > 0.0 else corners[::-1], 0.0, depth)


def _sign(value: float) -> float:
    return float((value > 0.0) - (value < 0.0))


def gate_and_funnel(design: Design) -> tuple[Solid, ...]:
    """Build the gate and its funnel on the parting plane of a mold that gravity fills."""
    mold, m = design.mold, design.mold_layout
    end = m.distal_z + mold.funnel_depth_mm
    gate = cylinder("z", (m.gate_x, 0.0), m.inlet_z, end, mold.gate_diameter_mm / 2)
    # The funnel continues past the block at the same slope, so that its mouth has the stated diameter on the block's
    # face.
    mouth, throat = mold.funnel_diameter_mm / 2, mold.gate_diameter_mm / 2
    funnel = Cone("z", (m.gate_x, 0.0), m.distal_z - mold.funnel_depth_mm, end, throat, mouth + (mouth - throat))
    return gate, funnel


def vents(design: Design) -> tuple[Solid, ...]:
    """Build the vents."""
    return tuple(_vent(design, vent) for vent in place_vents(design))


def side_vents(design: Design) -> tuple[Solid, ...]:
    """Build the vents in the parting plane."""
    return tuple(_vent(design, vent) for vent in place_vents(design) if vent.kind == "side")


def _vent(design: Design, vent: Vent) -> Solid:
    """Build one vent. It begins inside the cavity, well below the surface that it cuts."""
    layout, radius = design.mold_layout, vent.diameter_mm / 2
    x, y, z = vent.point_mm
    match vent.kind:
        case "tip":
            return cylinder("z", (x, y), z, layout.distal_z + design.mold.funnel_depth_mm, radius)
        case "dorsal":
            return cylinder("y", (z, x), _begin_dorsal(design, vent), 2 * layout.dorsal_height, radius)
        case "side":
            side, clear = math.copysign(1.0, x), layout.clear_side_z(z, vent.diameter_mm)
            outer, depth = design.dimensions.outer, vent.diameter_mm / 2
            low = min(outer.half_width_at(depth, z + way * radius) for way in (-1.0, 1.0))
            begin, end = side * _VENT_BEGIN * low, side * 2 * layout.half_width
            if clear == z:
                return groove(((begin, z), (end, z)), vent.diameter_mm, depth)
            # Halfway across the land it turns, to pass the bolts and the key.
            land = side * (outer.section.half_width * design.dimensions.shrinkage + design.mold.land_mm / 2)
            return groove(((begin, z), (land, z), (land, clear), (end, clear)), vent.diameter_mm, depth)


def _begin_dorsal(design: Design, vent: Vent) -> float:
    """Height at which a vent from above begins. Where it cuts the boss of the chaplet it does so down to its end."""
    (x, y, z), chaplet, radius = vent.point_mm, design.dimensions.chaplet, vent.diameter_mm / 2
    outer = design.dimensions.outer
    lowest = min(outer.dorsal_height_at(abs(x) + radius, z + way * radius) for way in (-1.0, 1.0))
    y = min(y, _VENT_DEPTH * lowest)  # below the surface of the cavity on all sides of the hole
    if chaplet is None:
        return y
    widest = chaplet.radius + design.dimensions.draft_slope * design.mold_layout.dorsal_height
    near = math.hypot(x, z - axis_z(design)) < widest * design.dimensions.shrinkage + vent.diameter_mm / 2
    return min(y, contact_y(design) - _BELOW_BOSS_MM) if near else y


def openings(design: Design) -> Solid:
    """Build all of it as one solid."""
    return union(*runners(design), *luer_cone(design))


def runners_with_axes(design: Design) -> tuple[tuple[Solid, int], ...]:
    """List these solids with the axis along which each opens to the outside or the parting plane: 0 for x, 1 for y."""
    axes = tuple({"side": 0, "dorsal": 1, "tip": 2}[vent.kind] for vent in place_vents(design))
    beside = tuple(zip(vents(design), axes, strict=True))
    inlet = design.mold_layout.inlet
    if inlet:
        return (sprue(design, inlet), 1), (runner(inlet), 1), *((cone, 1) for cone in luer_cone(design)), *beside
    return (*((solid, 2) for solid in gate_and_funnel(design)), *beside)
