"""The two mold halves, parted at y = 0: cavity, recess of the base, gate, vents, keys, bolts, pry slots, name."""

from __future__ import annotations

import math

from fingertip.cad.shapes import strokes
from fingertip.cad.shapes.core import above_foot, grown
from fingertip.cad.shapes.lettering import STROKE, lines
from fingertip.cad.shapes.skin import cavity
from fingertip.cad.solids import Bar, Box, Cone, Form, Prism, Solid, cylinder, difference, hexagon, intersection, union
from fingertip.conic import ConicBody, CrossSection
from fingertip.design import Design
from fingertip.design.draft import drafted
from fingertip.design.mold_layout import MoldLayout, lay_out

_OVERLAP_MM = 0.25  # solids that are united reach into each other by this, so that no faces merely touch


def block(design: Design) -> Solid:
    """The closed mold's outline."""
    m = lay_out(design, design.dimensions)
    return Box((-m.half_width, -m.palmar_height, m.proximal_z), (m.half_width, m.dorsal_height, m.distal_z))


def openings(design: Design) -> Solid:
    """Everything hollow when the mold is closed, but for bolts, nut traps and the keys' clearance."""
    m = lay_out(design, design.dimensions)
    return union(cavity(design), *base_recess(design, m), *runners(design, m))


def base_recess(design: Design, m: MoldLayout) -> tuple[Solid, ...]:
    """Recess that holds and locates the bone's base and its collar: the fit's clearance all round, and draft.

    Where the outlines stand steeper than the draft, beside the parting plane, straight walls take their place.
    """
    dims, gap, slope = design.dimensions, design.mold.fit_clearance_mm, design.dimensions.draft_slope
    wider, flat = grown(dims.envelope.section, gap), dims.flat_depth + gap
    past = wider.half_width
    low = m.proximal_z - past
    below = Box((-wider.half_width - past, -wider.palmar - past, low - past), (wider.half_width + past, -flat, past))
    base = _bar(wider, slope, low, 0.0, flat)  # through the collar, whose foot is not level
    foot = dims.collar.stations[0][0] - past
    collar = _bar(grown(dims.collar.section, gap), slope, foot, _OVERLAP_MM)
    return difference(base, below), intersection(collar, above_foot(design, gap))


def _bar(section: CrossSection, slope: float, low: float, high: float, flat: float | None = None) -> Solid:
    """The section, with draft if there is to be any, drawn out along z [mm]."""
    if slope == 0.0:
        return Form(ConicBody(section, ((low, 1.0), (high, 1.0))))
    return Bar(drafted(section, slope, flat), low, high)


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
    slope = design.dimensions.draft_slope
    inside, top = m.dorsal_height / 2, -design.mold.key_height_mm - gap_mm
    wider = gap_mm * math.hypot(1.0, slope)  # so that the gap is `gap_mm` at right angles to the drafted wall
    return tuple(
        Cone("y", (z, x), top, inside, root / 2 + wider + slope * top, root / 2 + wider + slope * inside)
        for x, z, root in m.keys
    )


def pry_slots(design: Design, m: MoldLayout) -> tuple[Solid, ...]:
    """Slots for a screwdriver across the parting line, on both sides; half of each lies in either mold half."""
    mold = design.mold
    z0, z1 = m.pry_z - mold.pry_width_mm / 2, m.pry_z + mold.pry_width_mm / 2
    inner, outer = m.half_width - mold.pry_depth_mm, 2 * m.half_width
    below, above = -mold.pry_height_mm, mold.pry_height_mm
    return Box((inner, below, z0), (outer, above, z1)), Box((-outer, below, z0), (-inner, above, z1))


def engraving(design: Design, m: MoldLayout, half: str) -> tuple[Solid, ...]:
    """The design's name and the half's, cut into the outer face so that they read from outside."""
    mold = design.mold
    dorsal = half == "dorsal"
    height = m.dorsal_height if dorsal else m.palmar_height
    floor, past = height - mold.engraving_depth_mm, 2 * height
    low, high = (floor, past) if dorsal else (-past, -floor)
    prisms = []
    for text, unit, foot_x in lines(design, m, half):
        start_z = (m.proximal_z + m.distal_z - unit * strokes.text_width(text)) / 2
        for letter in strokes.letters(text, STROKE):
            # Seen from the back x points up where z points right, seen from the palm it points down.
            rings = (
                [(start_z + unit * u, (foot_x + unit * v) * (1 if dorsal else -1)) for u, v in ring] for ring in letter
            )
            outline, *holes = (tuple(ring if dorsal else ring[::-1]) for ring in rings)
            prisms.append(Prism("y", outline, low, high, tuple(holes)))
    return tuple(prisms)


def cuts(design: Design, m: MoldLayout) -> Solid:
    """Everything cut into the closed mold from outside: bolts, nut traps, pry slots, names."""
    engraved = (*engraving(design, m, "palmar"), *engraving(design, m, "dorsal"))
    return union(*bolts(design, m), *nut_traps(design, m), *pry_slots(design, m), *engraved)


def mold_palmar(design: Design) -> Solid:
    """The half below the parting plane: key sockets and nut traps."""
    m = lay_out(design, design.dimensions)
    half = Box((-m.half_width, -m.palmar_height, m.proximal_z), (m.half_width, 0.0, m.distal_z))
    sockets = keys(design, m, design.mold.key_clearance_mm)
    hollows = (openings(design), *bolts(design, m), *nut_traps(design, m), *sockets, *pry_slots(design, m))
    return difference(half, *hollows, *engraving(design, m, "palmar"))


def mold_dorsal(design: Design) -> Solid:
    """The half above the parting plane: registration keys."""
    m = lay_out(design, design.dimensions)
    half = Box((-m.half_width, 0.0, m.proximal_z), (m.half_width, m.dorsal_height, m.distal_z))
    hollows = (openings(design), *bolts(design, m), *pry_slots(design, m))
    return difference(union(half, *keys(design, m)), *hollows, *engraving(design, m, "dorsal"))
