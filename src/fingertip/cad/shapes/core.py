"""The core: the bone's outer form with everything let into it filled. The silicone flows around it.

Overmolding casts around the bone itself; a sleeve is cast around a dummy core, smaller by the interference that makes
the skin sit tight, and pulled over the bone afterwards.
"""

from __future__ import annotations

import math
from dataclasses import replace

from fingertip.cad.solids import Box, Form, Prism, Solid, difference, intersection, scaled, union
from fingertip.conic import ConicBody, CrossSection
from fingertip.design import Design

_BODY_ENDS_MM, _BASE_ENDS_MM = 0.2, 0.4
"""Body and base of a dummy core end this deep within the collar, whose draft leaves more of it everywhere: no faces
merely touch."""


def core(design: Design, inset_mm: float = 0.0) -> Solid:
    """Envelope with palmar flat, groove and collar; smaller by `inset_mm` all round, but for the collar."""
    body = _grooved(design, _smaller(design.dimensions.envelope, inset_mm))
    return union(_flattened(design, body, inset_mm), collar(design))


def _flattened(design: Design, body: ConicBody, inset_mm: float = 0.0) -> Solid:
    """The body, cut at the palmar flat, which lies `inset_mm` deeper than the bone's."""
    section = body.section
    # The cutting box reaches past the envelope by a length of its own size, never by a literal "big" number.
    past = section.half_width
    below = Box(
        (-section.half_width - past, -section.palmar - past, body.stations[0][0] - past),
        (section.half_width + past, -design.dimensions.flat_depth + inset_mm, design.skin.length_mm + past),
    )
    return difference(Form(body), below)


def collar(design: Design) -> Solid:
    """The flange the skin ends on."""
    dims = design.dimensions
    section = dims.collar.section
    low = dims.collar.stations[0][0] - section.half_width  # past the foot, which the intersection cuts
    flange = Form(ConicBody(section, ((low, 1.0), (0.0, 1.0))))
    return intersection(flange, above_foot(design))


def above_foot(design: Design, gap_mm: float = 0.0) -> Solid:
    """Everything above the foot of the collar, or above its recess's, which lies `gap_mm` lower.

    The foot falls towards the parting plane from both sides: the recess's is parallel to it, and leaves it at once
    when a half is pulled off.
    """
    dims, slope = design.dimensions, design.dimensions.draft_slope
    lowest = dims.collar.stations[0][0] - gap_mm * math.hypot(1.0, slope)
    section = dims.collar.section
    reach, top = section.palmar + section.dorsal, section.half_width
    side = lowest + slope * reach
    outline = ((0.0, lowest), (reach, side), (reach, side + top), (-reach, side + top), (-reach, side))
    return Prism("x", outline, -2 * section.half_width, 2 * section.half_width)


def grown(section: CrossSection, gap_mm: float) -> CrossSection:
    """The section with `gap_mm` more half width and half heights [mm]."""
    return replace(
        section,
        half_width=section.half_width + gap_mm,
        palmar=section.palmar + gap_mm,
        dorsal=section.dorsal + gap_mm,
    )


def dummy_core(design: Design) -> Solid:
    """The core a sleeve is cast around: printed, without the bone's hollows.

    What the silicone surrounds is smaller by the interference and larger by the shrinkage. Base and collar are the
    bone's own: they lie in the mold's recess, which must fit both.
    """
    inset = design.mold.sleeve_interference_mm
    body = _smaller(design.dimensions.envelope, inset)
    (base, scale), *rest = body.stations
    above = _grooved(design, replace(body, stations=((-_BODY_ENDS_MM, scale), *rest)))
    below = ConicBody(design.dimensions.envelope.section, ((base, scale), (-_BASE_ENDS_MM, scale)))
    within_skin = scaled(_flattened(design, above, inset), design.dimensions.shrinkage)
    return union(within_skin, _flattened(design, below), collar(design))


def cast_around(design: Design) -> Solid:
    """What lies in the closed mold while the silicone cures, its hollows filled."""
    return dummy_core(design) if design.mold.method == "sleeve" else core(design)


def inside_skin(design: Design) -> Solid:
    """What the finished skin, relaxed, surrounds."""
    return core(design, design.mold.sleeve_interference_mm if design.mold.method == "sleeve" else 0.0)


def _smaller(body: ConicBody, inset: float) -> ConicBody:
    assert body.tip is not None
    return replace(body, section=grown(body.section, -inset), tip=replace(body.tip, z=body.tip.z - inset))


def _grooved(design: Design, body: ConicBody) -> ConicBody:
    """The body with a ring whose silicone keeps the skin from slipping off; its flanks rise at 45 degrees at the sides.

    Floor and flanks are four more stations between the skin's end and the tip: no boolean, and both kernels' forms.
    """
    bone = design.bone
    if bone.groove_depth_mm == 0.0:
        return body
    base, (z_a, s_a), (z_b, s_b) = body.stations
    taper = (s_a - s_b) / (z_b - z_a)
    rise = 1.0 / body.section.half_width  # of a flank, in scale per length
    z0 = bone.groove_distance_mm + bone.groove_depth_mm
    z1 = z0 + bone.groove_width_mm
    floor = 1.0 - bone.groove_depth_mm * rise
    s0, s1 = (body.scale_at(z) * floor for z in (z0, z1))
    # Where the flanks' lines meet the taper's, s = s_a - taper (z - z_a).
    low = (s0 + rise * z0 - s_a - taper * z_a) / (rise - taper)
    high = (s_a + taper * z_a - s1 + rise * z1) / (rise + taper)
    edges = ((low, s_a - taper * (low - z_a)), (z0, s0), (z1, s1), (high, s_a - taper * (high - z_a)))
    return replace(body, stations=(base, (z_a, s_a), *edges, (z_b, s_b)))
