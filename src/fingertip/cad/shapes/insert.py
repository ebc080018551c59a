"""Inserts of the mold, around which silicone is cast: the filled bone with its collar, and the core of a sleeve.

Overmolding casts the skin around the bone itself. A sleeve is cast around a core and pulled over the bone afterwards;
the core is smaller than the bone by an interference, which makes the skin fit tightly.
"""

from __future__ import annotations

import math
from dataclasses import replace

from fingertip.cad.solids import Box, Prism, Solid, SuperconicSolid, difference, intersection, scaled, union
from fingertip.design import Design
from fingertip.design.geometry.conic import ConicBody, CrossSection

_STEP_IN_COLLAR_MM = 0.3
"""Depth of the step between both flats in the collar, which rules keep longer than this [mm]."""
_BODY_OVERLAP_MM, _BASE_OVERLAP_MM = 0.2, 0.4
"""Depths to which the body and the base of a sleeve's core reach into the collar [mm]. Solids that only touch would
leave coincident faces."""


def filled_bone(design: Design, inset_mm: float = 0.0) -> Solid:
    """Build the bone with its channel, pocket and holes filled: outline with palmar flat, groove and collar.

    All surfaces but the collar's lie `inset_mm` inside the bone's.
    """
    body = _add_groove(design, _inset(design.dimensions.bone_outline, inset_mm))
    return union(_cut_flat(design, body, inset_mm), collar(design))


def _cut_flat(design: Design, body: ConicBody, inset_mm: float = 0.0) -> Solid:
    """Cut the palmar flat, `inset_mm` deeper than the bone's, and that of the base."""
    section, dims = body.section, design.dimensions
    # The cutting boxes extend past the outline by a length that scales with the design.
    margin = section.half_width

    def below(depth: float, low: float) -> Box:
        return Box(
            (-section.half_width - margin, -section.palmar - margin, low),
            (section.half_width + margin, -depth, design.skin.length_mm + margin),
        )

    flat, base, low = dims.flat_depth - inset_mm, dims.base_flat_depth, body.stations[0][0] - margin
    if base == dims.flat_depth:
        return difference(SuperconicSolid(body), below(flat, low))
    return difference(SuperconicSolid(body), below(base, low), below(flat, -_STEP_IN_COLLAR_MM))


def collar(design: Design) -> Solid:
    """Build the collar: the flange proximal to the skin, on which the skin ends."""
    dims = design.dimensions
    section = dims.collar.section
    low = dims.collar.stations[0][0] - section.half_width  # below the foot, where the intersection cuts it
    flange = SuperconicSolid(ConicBody(section, ((low, 1.0), (0.0, 1.0))))
    return intersection(flange, above_collar_foot(design))


def above_collar_foot(design: Design, gap_mm: float = 0.0) -> Solid:
    """Build the region above the collar's foot, or above the foot of its recess, which lies `gap_mm` lower.

    The foot slopes down towards the parting plane from both sides. The foot of the recess is parallel to it, so that
    the two separate at once when a mold half is pulled off.
    """
    dims, slope = design.dimensions, design.dimensions.draft_slope
    lowest = dims.collar.stations[0][0] - gap_mm * math.hypot(1.0, slope)
    section = dims.collar.section
    reach, top = section.palmar + section.dorsal, section.half_width
    side = lowest + slope * reach
    outline = ((0.0, lowest), (reach, side), (reach, side + top), (-reach, side + top), (-reach, side))
    return Prism("x", outline, -2 * section.half_width, 2 * section.half_width)


def offset_section(section: CrossSection, gap_mm: float) -> CrossSection:
    """Enlarge a section: half width and both half heights grow by `gap_mm` [mm]."""
    return replace(
        section,
        half_width=section.half_width + gap_mm,
        palmar=section.palmar + gap_mm,
        dorsal=section.dorsal + gap_mm,
    )


def sleeve_core(design: Design) -> Solid:
    """Build the core around which a sleeve is cast: printed, without the bone's hollows.

    Inside the skin it is smaller than the bone by the interference and then enlarged to allow for shrinkage. Its base
    and collar equal the bone's, because both fit the same recess of the mold.
    """
    inset = design.mold.sleeve_interference_mm
    above = _core_body(design)
    base, scale = design.dimensions.bone_outline.stations[0]
    below = ConicBody(design.dimensions.bone_outline.section, ((base, scale), (-_BASE_OVERLAP_MM, scale)))
    within_skin = scaled(_cut_flat(design, above, inset), design.dimensions.shrinkage)
    return union(within_skin, _cut_flat(design, below), collar(design))


def insert_body(design: Design) -> tuple[ConicBody, float, float]:
    """Return the insert within the skin: its body with the groove, the depth of its flat [mm], and its scale.

    The flat at y = -depth cuts the body. The scale enlarges both, about the origin.
    """
    dims = design.dimensions
    if design.mold.method != "sleeve":
        return _add_groove(design, dims.bone_outline), dims.flat_depth, 1.0
    return _core_body(design), dims.flat_depth - design.mold.sleeve_interference_mm, dims.shrinkage


def _core_body(design: Design) -> ConicBody:
    """Return the body of a sleeve's core within the skin, before it is enlarged."""
    body = _inset(design.dimensions.bone_outline, design.mold.sleeve_interference_mm)
    (_, scale), *stations = body.stations
    return _add_groove(design, replace(body, stations=((-_BODY_OVERLAP_MM, scale), *stations)))


def mold_insert(design: Design) -> Solid:
    """Build the body that lies in the closed mold while the silicone cures, with its hollows filled."""
    return sleeve_core(design) if design.mold.method == "sleeve" else filled_bone(design)


def skin_interior(design: Design) -> Solid:
    """Build the region that the finished, unstretched skin encloses."""
    return filled_bone(design, design.mold.sleeve_interference_mm if design.mold.method == "sleeve" else 0.0)


def _inset(body: ConicBody, inset: float) -> ConicBody:
    """Shrink section and tip of a body by `inset` [mm]."""
    assert body.tip is not None
    return replace(body, section=offset_section(body.section, -inset), tip=replace(body.tip, z=body.tip.z - inset))


def _add_groove(design: Design, body: ConicBody) -> ConicBody:
    """Add a groove around the bone; silicone fills it and keeps the skin from slipping off.

    The flanks rise at 45 degrees at the sides. Flanks and floor are four more stations of the superconic body, so that
    no boolean is needed and both kernels represent the groove directly.
    """
    bone = design.bone
    if bone.groove_depth_mm == 0.0:
        return body
    base, (z_a, s_a), (z_b, s_b) = body.stations
    taper = (s_a - s_b) / (z_b - z_a)
    rise = 1.0 / body.section.half_width  # slope of a flank: scale per mm
    z0 = bone.groove_distance_mm + bone.groove_depth_mm
    z1 = z0 + bone.groove_width_mm
    floor = 1.0 - bone.groove_depth_mm * rise
    s0, s1 = (body.scale_at(z) * floor for z in (z0, z1))
    # Heights at which the lines of the flanks meet the taper s = s_a - taper (z - z_a).
    low = (s0 + rise * z0 - s_a - taper * z_a) / (rise - taper)
    high = (s_a + taper * z_a - s1 + rise * z1) / (rise + taper)
    edges = ((low, s_a - taper * (low - z_a)), (z0, s0), (z1, s1), (high, s_a - taper * (high - z_a)))
    return replace(body, stations=(base, (z_a, s_a), *edges, (z_b, s_b)))
