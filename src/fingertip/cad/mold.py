"""The two mold halves, parted at y = 0: cavity, recess of the base, gate, vents, keys and bolts."""

from __future__ import annotations

import math
from dataclasses import replace

from fingertip.cad.solids import Box, Cone, Form, Solid, cylinder, difference, hexagon, union
from fingertip.conic import ConicBody
from fingertip.design import Design
from fingertip.design.mold_layout import MoldLayout, lay_out

_OVERLAP_MM = 0.25  # solids that are united reach into each other by this, so that no faces merely touch


def block(design: Design) -> Solid:
    """The closed mold's outline."""
    m = lay_out(design, design.dimensions)
    return Box((-m.half_width, -m.palmar_height, m.proximal_z), (m.half_width, m.dorsal_height, m.distal_z))


def openings(design: Design) -> Solid:
    """Everything hollow when the mold is closed, but for bolts, nut traps and the keys' clearance."""
    m = lay_out(design, design.dimensions)
    return union(Form(design.dimensions.outer), base_recess(design, m), *runners(design, m))


def base_recess(design: Design, m: MoldLayout) -> Solid:
    """Recess that holds and locates the bone's base, with the fit's clearance all round."""
    dims, gap = design.dimensions, design.mold.fit_clearance_mm
    section = dims.envelope.section
    wider = replace(
        section,
        half_width=section.half_width + gap,
        palmar=section.palmar + gap,
        dorsal=section.dorsal + gap,
    )
    past = section.half_width
    low = m.proximal_z - past
    base = Form(ConicBody(wider, ((low, 1.0), (_OVERLAP_MM, 1.0))))
    below = Box(
        (-wider.half_width - past, -wider.palmar - past, low - past),
        (wider.half_width + past, -dims.flat_depth - gap, past),
    )
    return difference(base, below)


def runners(design: Design, m: MoldLayout) -> tuple[Solid, ...]:
    """Gate with its funnel, and the vents, all on the parting plane."""
    mold = design.mold
    past = m.distal_z + mold.funnel_depth_mm
    gate = cylinder("z", (m.gate_x, 0.0), m.inlet_z, past, mold.gate_diameter_mm / 2)
    # The cone runs on past the block at the same slope: its mouth has the stated diameter at the block's face.
    mouth, throat = mold.funnel_diameter_mm / 2, mold.gate_diameter_mm / 2
    funnel = Cone("z", (m.gate_x, 0.0), m.distal_z - mold.funnel_depth_mm, past, throat, mouth + (mouth - throat))
    vents = (cylinder("z", (x, 0.0), m.inlet_z, past, mold.vent_diameter_mm / 2) for x in m.vents_x)
    return (gate, funnel, *vents)


def bolts(design: Design, m: MoldLayout) -> tuple[Solid, ...]:
    """Clearance holes of the clamp bolts, through both halves."""
    radius, low, high = design.mold.bolt_diameter_mm / 2, -2 * m.palmar_height, 2 * m.dorsal_height
    return tuple(cylinder("y", (z, x), low, high, radius) for x, z in m.bolts)


def nut_traps(design: Design, m: MoldLayout) -> tuple[Solid, ...]:
    """Hexagonal pockets in the palmar half's outer face."""
    low, high = -2 * m.palmar_height, -m.palmar_height + design.mold.nut_depth_mm
    return tuple(hexagon(z, x, design.mold.nut_width_mm, low, high) for x, z in m.bolts)


def keys(design: Design, m: MoldLayout, gap_mm: float = 0.0) -> tuple[Solid, ...]:
    """Registration keys on the dorsal half; grown by `gap_mm` all round, their sockets in the palmar half."""
    mold = design.mold
    slope = math.tan(math.radians(mold.draft_deg))
    inside, top = m.dorsal_height / 2, -mold.key_height_mm - gap_mm
    grown = gap_mm * math.hypot(1.0, slope)  # so that the gap is `gap_mm` at right angles to the drafted wall
    return tuple(
        Cone("y", (z, x), top, inside, root / 2 + grown + slope * top, root / 2 + grown + slope * inside)
        for x, z, root in m.keys
    )


def mold_palmar(design: Design) -> Solid:
    """The half below the parting plane: key sockets and nut traps."""
    m = lay_out(design, design.dimensions)
    half = Box((-m.half_width, -m.palmar_height, m.proximal_z), (m.half_width, 0.0, m.distal_z))
    sockets = keys(design, m, design.mold.key_clearance_mm)
    return difference(half, openings(design), *bolts(design, m), *nut_traps(design, m), *sockets)


def mold_dorsal(design: Design) -> Solid:
    """The half above the parting plane: registration keys."""
    m = lay_out(design, design.dimensions)
    half = Box((-m.half_width, 0.0, m.proximal_z), (m.half_width, m.dorsal_height, m.distal_z))
    return difference(union(half, *keys(design, m)), openings(design), *bolts(design, m))
