"""Bodies of bone and core in the skin: the outline with its retention groove, and inset for a sleeve's core."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from fingertip.design.geometry.conic import (
    ConicBody,
    CrossSection,
    arc_parameter_at_height,
    arc_parameter_at_slope,
    arc_point,
)

if TYPE_CHECKING:
    from fingertip.design.geometry.dimensions import Dimensions
    from fingertip.design.parameters.bone import Bone
    from fingertip.design.parameters.mold import Mold


_BODY_OVERLAP_MM = 0.2
"""Depth to which the body of a sleeve's core reaches into the collar [mm]. Solids that only touch would leave
coincident faces."""


def offset_section(section: CrossSection, gap_mm: float) -> CrossSection:
    """Enlarge a section: half width and both half heights grow by `gap_mm` [mm]."""
    return replace(
        section,
        half_width=section.half_width + gap_mm,
        palmar=section.palmar + gap_mm,
        dorsal=section.dorsal + gap_mm,
    )


def insert_body(mold: Mold, bone: Bone, dims: Dimensions) -> tuple[ConicBody, float, float]:
    """Return the insert within the skin: its body with the groove, the depth of its flat [mm], and its scale.

    The flat at y = -depth cuts the body. The scale enlarges both, about the origin.
    """
    outline = dims.bone_outline
    if mold.method != "sleeve":
        return add_groove(bone, outline), dims.flat_depth, 1.0
    inset = mold.sleeve_interference_mm
    body = inset_body(outline, inset)
    (_, scale), *stations = body.stations
    body = add_groove(bone, replace(body, stations=((-_BODY_OVERLAP_MM, scale), *stations)))
    return body, dims.flat_depth - inset, dims.shrinkage


def inset_body(body: ConicBody, inset: float) -> ConicBody:
    """Shrink section and tip of a body by `inset` [mm]."""
    assert body.tip is not None
    return replace(body, section=offset_section(body.section, -inset), tip=replace(body.tip, z=body.tip.z - inset))


def add_groove(bone: Bone, body: ConicBody) -> ConicBody:
    """Add a groove around the bone; silicone fills it and keeps the skin from slipping off.

    The flanks rise at 45 degrees at the sides. Flanks and floor are four more stations of the superconic body, so that
    no boolean is needed and both kernels represent the groove directly.
    """
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


# Draft of a recess whose outline is a superconic. Beside the parting plane the outline itself has no draft.


@dataclass(frozen=True)
class DraftedSection:
    """Section whose arcs are replaced by straight walls beside the parting plane y = 0.

    Each wall is tangent to its arc where the arc's slope equals the draft. It runs on to the parting plane outside the
    arc, and slopes by at least the draft. Both sides meet the plane at the same half width, the wider of the two, so
    that the edges of the halves coincide.
    """

    section: CrossSection
    half_width: float
    """Half width at the parting plane [mm]."""
    palmar_start: float
    """Parameter of the palmar arcs at which they take over from the straight walls."""
    dorsal_start: float
    """Parameter of the dorsal arcs at which they take over from the straight walls."""


def add_draft(section: CrossSection, slope: float, flat: float | None = None) -> DraftedSection:
    """Replace the steep parts of a section's outline by straight walls with draft.

    Units: `section` [mm], `flat` [mm].
    """
    a = section.half_width
    dorsal = arc_parameter_at_slope(a, section.dorsal, section.dorsal_weight, slope)
    palmar = arc_parameter_at_slope(a, section.palmar, section.palmar_weight, slope)
    if flat is not None:
        palmar = min(palmar, arc_parameter_at_height(flat / section.palmar, section.palmar_weight))
    reach = []
    for height, weight, t in (
        (section.dorsal, section.dorsal_weight, dorsal),
        (section.palmar, section.palmar_weight, palmar),
    ):
        x, y = arc_point(t, weight)
        reach.append(a * x + slope * height * y)
    return DraftedSection(section, max(reach), palmar, dorsal)
