"""Two-part mold with its parting plane at y = 0.

The halves hold the cavity, the recess for the bone's base, inlet, vents, registration keys, clamp bolts with nut traps,
pry slots, and engraved text.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

from fingertip.cad.shapes.bridged_ceiling import CEILING_STEPS_MM, bridge_ceiling
from fingertip.cad.shapes.engraving import STROKE_WIDTH, engraved_lines, letter_outlines, signed_area, text_width
from fingertip.cad.shapes.insert import above_collar_foot, axis_z, cavity, contact_y, screw_hole
from fingertip.catalogues.hardware import LUER_DEPTH_MM, LUER_MOUTH_MM, LUER_TAPER
from fingertip.design import Design
from fingertip.design.geometry.conic import ConicBody, CrossSection, add_draft, offset_section
from fingertip.design.geometry.mold_layout import Inlet
from fingertip.design.geometry.solids import (
    Box,
    Cone,
    DraftedExtrusion,
    Prism,
    Solid,
    SuperconicSolid,
    cylinder,
    difference,
    hexagon,
    intersection,
    union,
)
from fingertip.filling.mold_filling import Vent, place_vents

_SPRUE_DRAFT = 0.03
"""Draft of the sprue, which widens towards the parting plane, so that it lifts out: radius per length."""


_VENT_BEGIN = 0.95
"""Beginning of a groove inside the cavity, relative to the cavity's half width at its top."""


_VENT_DEPTH = 0.8
"""Beginning of a hole from above, relative to the height of the cavity at its lowest edge."""
_BELOW_BOSS_MM = 0.2
"""Length by which a vent reaches past the end of the boss [mm]."""
_PRY_TO_VENT_MM = 2.0
"""Length of the mold's side between a pry slot and the opening of a side vent, where there is room [mm]."""
_BESIDE_PRY_MM = 1.0
"""Least length of the mold's side at both ends of a pry slot [mm]."""


def runners(design: Design) -> tuple[Solid, ...]:
    """Build everything that silicone and air flow through outside the cavity, but for the Luer cone."""
    inlet = design.mold_layout.inlet
    return sprue(design, inlet), runner(inlet), *vents(design)


def luer_cone(design: Design) -> Solid:
    """Build the cone of the syringe's nozzle, which fills most of it."""
    inlet, layout = design.mold_layout.inlet, design.mold_layout
    mouth, face = LUER_MOUTH_MM / 2, layout.dorsal_height
    slope, low = LUER_TAPER / 2, layout.dorsal_height - LUER_DEPTH_MM
    # It continues past the face at the same taper, so that its mouth has the stated diameter there.
    end = face + LUER_DEPTH_MM
    return Cone("y", (inlet.z, inlet.x), low, end, mouth - slope * LUER_DEPTH_MM, mouth + slope * (end - face))


def sprue(design: Design, inlet: Inlet) -> Solid:
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
    """Build a groove with mitred corners in the dorsal half, along points (x, z) whose legs run along x or z."""
    legs = [(_sign(b[0] - a[0]), _sign(b[1] - a[1])) for a, b in pairwise(course)]
    left, right = [], []
    for i, (x, z) in enumerate(course):
        beside = {legs[max(i - 1, 0)], legs[min(i, len(legs) - 1)]}  # the leg before this point and that after it
        shift_x, shift_z = (width / 2 * sum(part) for part in zip(*((-dz, dx) for dx, dz in beside), strict=True))
        left.append((z + shift_z, x + shift_x))
        right.append((z - shift_z, x - shift_x))
    corners = (*left, *reversed(right))
    return Prism("y", corners if signed_area(corners) > 0.0 else corners[::-1], 0.0, depth)


def _sign(value: float) -> float:
    return float((value > 0.0) - (value < 0.0))


def vents(design: Design) -> tuple[Solid, ...]:
    return tuple(_vent(design, vent) for vent in place_vents(design))


def side_vents(design: Design) -> tuple[Solid, ...]:
    return tuple(_vent(design, vent) for vent in place_vents(design) if vent.kind == "side")


def _vent(design: Design, vent: Vent) -> Solid:
    """Build one vent. It begins inside the cavity, well below the surface that it cuts."""
    layout, radius = design.mold_layout, vent.diameter_mm / 2
    x, _, z = vent.point_mm
    match vent.kind:
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
    return union(*runners(design), luer_cone(design))


def runners_with_axes(design: Design) -> tuple[tuple[Solid, int], ...]:
    """List these solids with the axis along which each opens to the outside or the parting plane: 0 for x, 1 for y."""
    axes = tuple({"side": 0, "dorsal": 1}[vent.kind] for vent in place_vents(design))
    inlet = design.mold_layout.inlet
    return (
        (sprue(design, inlet), 1), (runner(inlet), 1), (luer_cone(design), 1), *zip(vents(design), axes, strict=True)
    )  # fmt: skip


_OVERLAP_MM = 0.25  # united solids overlap by this length: solids that only touch would leave coincident faces


def block(design: Design) -> Solid:
    """Build the outer shape of the closed mold."""
    m = design.mold_layout
    return Box((-m.half_width, -m.palmar_height, m.proximal_z), (m.half_width, m.dorsal_height, m.distal_z))


def hollow(design: Design) -> Solid:
    """Build cavity, recess, inlet and vents of the closed mold, without bolts, nut traps and the keys' clearance."""
    return union(cast_hollow(design), luer_cone(design))


def cast_hollow(design: Design) -> Solid:
    """Build the hollow without the Luer cone: what is cast in it must leave both halves."""
    return union(cavity(design), *base_recess(design), *runners(design))


def base_recess(design: Design, gap_mm: float | None = None) -> tuple[Solid, ...]:
    """Build the recess that holds and locates the base and the collar, with clearance all round and with draft.

    Near the parting plane the outlines have less than the draft angle. Straight drafted walls replace them there.
    """
    dims, gap = design.dimensions, design.mold.fit_clearance_mm if gap_mm is None else gap_mm
    slope = dims.draft_slope if gap else 0.0
    section, flat = offset_section(dims.bone_outline.section, gap), dims.base_flat_depth + gap
    margin = section.half_width
    low = design.mold_layout.proximal_z - margin
    side, bottom = section.half_width + margin, -section.palmar - margin
    below_flat = Box((-side, bottom, low - margin), (side, -flat, margin))
    # The base extends up through the collar, whose foot is not level.
    base = _drafted_extrusion(section, slope, low, 0.0, flat)
    foot = dims.collar.stations[0][0] - margin
    collar = _drafted_extrusion(offset_section(dims.collar.section, gap), slope, foot, _OVERLAP_MM)
    return difference(base, below_flat), intersection(collar, above_collar_foot(design, gap))


def recess_half_width(design: Design, *, of_collar: bool = False) -> float:
    """Half width of the recess of base or collar at the parting plane [mm], where its draft makes it widest."""
    dims, gap = design.dimensions, design.mold.fit_clearance_mm
    section = offset_section((dims.collar if of_collar else dims.bone_outline).section, gap)
    if dims.draft_slope == 0.0:
        return section.half_width
    return add_draft(section, dims.draft_slope, None if of_collar else dims.base_flat_depth + gap).half_width


def _drafted_extrusion(
    section: CrossSection, slope: float, low: float, high: float, flat: float | None = None
) -> Solid:
    """Extrude a section along z, with draft unless `slope` is zero [mm]."""
    if slope == 0.0:
        return SuperconicSolid(ConicBody(section, ((low, 1.0), (high, 1.0))))
    return DraftedExtrusion(add_draft(section, slope, flat), low, high)


def bolt_holes(design: Design) -> tuple[Solid, ...]:
    m = design.mold_layout
    radius, low, high = design.mold.bolt_diameter_mm / 2, -2 * m.palmar_height, 2 * m.dorsal_height
    return tuple(cylinder("y", (z, x), low, high, radius) for x, z in m.bolts)


def nut_traps(design: Design) -> tuple[Solid, ...]:
    """Build the hexagonal pockets for the nuts, in the outer face of the palmar half, with ceilings that print."""
    m, width, hole = design.mold_layout, design.mold.nut_width_mm, design.mold.bolt_diameter_mm / 2
    low, ceiling = -2 * m.palmar_height, -m.palmar_height + design.mold.nut_depth_mm
    return tuple(
        bridge_ceiling(
            hexagon(z, x, width, low, ceiling + CEILING_STEPS_MM), (z, x), ceiling, 1.0, hole, reach=width
        )
        for x, z in m.bolts
    )  # fmt: skip


def key_sockets(design: Design) -> tuple[Solid, ...]:
    return key_frustums(design, design.mold.key_clearance_mm)


def key_frustums(design: Design, clearance_mm: float = 0.0) -> tuple[Solid, ...]:
    """Build the registration keys of the dorsal half, enlarged by a clearance [mm] on all sides but the root."""
    m, slope = design.mold_layout, design.dimensions.draft_slope
    inside, top = m.dorsal_height / 2, -design.mold.key_height_mm - clearance_mm
    offset = clearance_mm * math.hypot(1.0, slope)  # the clearance is measured perpendicular to the drafted wall
    return tuple(
        Cone("y", (z, x), top, inside, root / 2 + offset + slope * top, root / 2 + offset + slope * inside)
        for x, z, root in m.keys
    )


def pry_slots_z(design: Design) -> float:
    """Find the middle of the pry slots: that of the mold's side, or beside the opening of a side vent [mm]."""
    m, half = design.mold_layout, design.mold.pry_width_mm / 2
    z = m.pry_z
    for vent in place_vents(design):
        if vent.kind == "side":
            opening, apart = m.clear_side_z(vent.point_mm[2], vent.diameter_mm), half + vent.diameter_mm / 2
            if abs(z - opening) < apart + _PRY_TO_VENT_MM:
                z = opening + math.copysign(apart + _PRY_TO_VENT_MM, z - opening)
    return min(max(z, m.proximal_z + half + _BESIDE_PRY_MM), m.distal_z - half - _BESIDE_PRY_MM)


def pry_slots(design: Design) -> tuple[Solid, ...]:
    """Build the slots for a screwdriver on both sides; each lies half above and half below the parting plane."""
    mold, m, z = design.mold, design.mold_layout, pry_slots_z(design)
    z0, z1 = z - mold.pry_width_mm / 2, z + mold.pry_width_mm / 2
    inner, outer = m.half_width - mold.pry_depth_mm, 2 * m.half_width
    below, above = -mold.pry_height_mm, mold.pry_height_mm
    return Box((inner, below, z0), (outer, above, z1)), Box((-outer, below, z0), (-inner, above, z1))


def engraved_text(design: Design, half: str) -> tuple[Prism, ...]:
    """Build the letters cut into the outer face of a half: the names of design and half, readable from outside."""
    mold, m = design.mold, design.mold_layout
    dorsal = half == "dorsal"
    height = m.dorsal_height if dorsal else m.palmar_height
    floor, outside = height - mold.engraving_depth_mm, 2 * height
    low, high = (floor, outside) if dorsal else (-outside, -floor)
    prisms = []
    for line in engraved_lines(design, half):
        unit, baseline_x = line.unit_mm, line.baseline_mm
        start_z = line.centre_z_mm - unit * text_width(line.text) / 2
        for letter in letter_outlines(line.text, STROKE_WIDTH):
            # With z to the right, x points up as seen from the dorsal side, and down as seen from the palmar side.
            rings = (
                [(start_z + unit * u, (baseline_x + unit * v) * (1 if dorsal else -1)) for u, v in ring]
                for ring in letter
            )
            outline, *holes = (tuple(ring if dorsal else ring[::-1]) for ring in rings)
            prisms.append(Prism("y", outline, low, high, tuple(holes)))
    return tuple(prisms)


def outer_cutouts(design: Design) -> Solid:
    """Build everything that is cut into the closed mold from outside: bolt holes, nut traps, pry slots, text."""
    text = (*engraved_text(design, "palmar"), *engraved_text(design, "dorsal"))
    return union(*bolt_holes(design), *nut_traps(design), *pry_slots(design), *text)


def outer_cutouts_and_screw(design: Design) -> Solid:
    """Build all of it with the hole of the chaplet's screw, which alone reaches the cavity."""
    return union(outer_cutouts(design), *screw_hole(design))


def mold_palmar(design: Design) -> Solid:
    """Build the half below the parting plane, with key sockets and nut traps."""
    m = design.mold_layout
    half = Box((-m.half_width, -m.palmar_height, m.proximal_z), (m.half_width, 0.0, m.distal_z))
    subtracted = (hollow(design), *bolt_holes(design), *nut_traps(design), *key_sockets(design), *pry_slots(design))
    return difference(half, *subtracted, *engraved_text(design, "palmar"))


def mold_dorsal(design: Design) -> Solid:
    """Build the half above the parting plane, with the registration keys."""
    m = design.mold_layout
    half = Box((-m.half_width, 0.0, m.proximal_z), (m.half_width, m.dorsal_height, m.distal_z))
    subtracted = (hollow(design), *bolt_holes(design), *pry_slots(design), *screw_hole(design))
    return difference(union(half, *key_frustums(design)), *subtracted, *engraved_text(design, "dorsal"))
