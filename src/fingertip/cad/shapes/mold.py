"""Two-part mold with its parting plane at y = 0.

The halves hold the cavity, the recess for the bone's base, inlet, vents, registration keys, clamp bolts with nut traps,
pry slots, and engraved text.
"""

from __future__ import annotations

import math

from fingertip.cad.kernel.solids import (
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
from fingertip.cad.shapes.bridged_pocket import CEILING_STEPS_MM, bridge_ceiling
from fingertip.cad.shapes.engraving import STROKE_WIDTH, engraved_lines, letter_outlines, text_width
from fingertip.cad.shapes.insert import above_collar_foot, cavity, screw_hole
from fingertip.cad.shapes.runners import luer_cone, runners
from fingertip.design import Design
from fingertip.design.geometry.conic import ConicBody, CrossSection
from fingertip.design.geometry.insert_body import add_draft, offset_section

_OVERLAP_MM = 0.25  # united solids overlap by this length: solids that only touch would leave coincident faces


def block(design: Design) -> Solid:
    """Build the outer shape of the closed mold."""
    m = design.mold_layout
    return Box((-m.half_width, -m.palmar_height, m.proximal_z), (m.half_width, m.dorsal_height, m.distal_z))


def hollow(design: Design) -> Solid:
    """Build the hollow of the closed mold: cavity, recess, inlet and vents.

    Bolt holes, nut traps and the clearance of the keys are not part of it.
    """
    return union(cast_hollow(design), *luer_cone(design))


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


def recess_half_width(design: Design) -> float:
    """Half width of the base's recess at the parting plane [mm], where its draft makes it widest."""
    dims, gap = design.dimensions, design.mold.fit_clearance_mm
    section = offset_section(dims.bone_outline.section, gap)
    if dims.draft_slope == 0.0:
        return section.half_width
    return add_draft(section, dims.draft_slope, dims.base_flat_depth + gap).half_width


def _drafted_extrusion(
    section: CrossSection, slope: float, low: float, high: float, flat: float | None = None
) -> Solid:
    """Extrude a section along z, with draft unless `slope` is zero [mm]."""
    if slope == 0.0:
        return SuperconicSolid(ConicBody(section, ((low, 1.0), (high, 1.0))))
    return DraftedExtrusion(add_draft(section, slope, flat), low, high)


def bolt_holes(design: Design) -> tuple[Solid, ...]:
    """Build the clearance holes for the clamp bolts, through both halves."""
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


def keys(design: Design) -> tuple[Solid, ...]:
    """Build the registration keys of the dorsal half."""
    return key_frustums(design, 0.0)


def key_sockets(design: Design) -> tuple[Solid, ...]:
    """Build the sockets of the palmar half: the keys, larger by their clearance."""
    return key_frustums(design, design.mold.key_clearance_mm)


def key_frustums(design: Design, clearance_mm: float) -> tuple[Solid, ...]:
    """Build the frustums of the registration keys, enlarged by a clearance [mm] on all sides but the root."""
    m, slope = design.mold_layout, design.dimensions.draft_slope
    inside, top = m.dorsal_height / 2, -design.mold.key_height_mm - clearance_mm
    offset = clearance_mm * math.hypot(1.0, slope)  # the clearance is measured perpendicular to the drafted wall
    return tuple(
        Cone("y", (z, x), top, inside, root / 2 + offset + slope * top, root / 2 + offset + slope * inside)
        for x, z, root in m.keys
    )


def pry_slots(design: Design) -> tuple[Solid, ...]:
    """Build the slots for a screwdriver on both sides; each lies half above and half below the parting plane."""
    mold, m = design.mold, design.mold_layout
    z0, z1 = m.pry_z - mold.pry_width_mm / 2, m.pry_z + mold.pry_width_mm / 2
    inner, outer = m.half_width - mold.pry_depth_mm, 2 * m.half_width
    below, above = -mold.pry_height_mm, mold.pry_height_mm
    return Box((inner, below, z0), (outer, above, z1)), Box((-outer, below, z0), (-inner, above, z1))


def engraved_text(design: Design, half: str) -> tuple[Solid, ...]:
    """Build the letters cut into the outer face of a half: the names of the design and of the half.

    The text reads correctly from outside.
    """
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
    return difference(union(half, *keys(design)), *subtracted, *engraved_text(design, "dorsal"))
