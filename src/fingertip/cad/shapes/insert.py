"""Inserts of the mold, around which silicone is cast: the filled bone with its collar, and the core of a sleeve.

Overmolding casts the skin around the bone itself. A sleeve is cast around a core and pulled over the bone afterwards;
the core is smaller than the bone by an interference, which makes the skin fit tightly.
"""

from __future__ import annotations

import math

from fingertip.cad.shapes.chaplet import facet_cut, pilot_hole
from fingertip.cad.solids import Box, Prism, Solid, SuperconicSolid, difference, intersection, scaled, union
from fingertip.design import Design
from fingertip.design.geometry.conic import ConicBody
from fingertip.design.geometry.insert_body import add_groove, insert_body, inset_body

_STEP_IN_COLLAR_MM = 0.3
"""Depth of the step between both flats in the collar, which rules keep longer than this [mm]."""
_BASE_OVERLAP_MM = 0.4
"""Depth to which the base of a sleeve's core reaches into the collar [mm]. Solids that only touch would leave
coincident faces."""


def filled_bone(design: Design, inset_mm: float = 0.0) -> Solid:
    """Build the bone with its channel, pocket and holes filled: outline with flats, facet, groove and collar.

    All surfaces but the collar's lie `inset_mm` inside the bone's.
    """
    body = add_groove(design, inset_body(design.dimensions.bone_outline, inset_mm))
    return union(_cut_facets(design, body, inset_mm), collar(design))


def _cut_facets(design: Design, body: ConicBody, inset_mm: float = 0.0) -> Solid:
    """Cut the palmar flats and the facet on which the chaplet stands."""
    cut = _cut_flat(design, body, inset_mm)
    facets = facet_cut(design, inset_mm)
    return difference(cut, *facets) if facets else cut


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


def core(design: Design) -> Solid:
    """Build the printable core of a sleeve, with the hole for the screw of the chaplet."""
    body, holes = sleeve_core(design), pilot_hole(design)
    return difference(body, *(scaled(hole, design.dimensions.shrinkage) for hole in holes)) if holes else body


def sleeve_core(design: Design) -> Solid:
    """Build the core around which a sleeve is cast, filled: without the bone's hollows.

    Inside the skin it is smaller than the bone by the interference and then enlarged to allow for shrinkage. Its base
    and collar equal the bone's, because both fit the same recess of the mold.
    """
    inset = design.mold.sleeve_interference_mm
    above, _, _ = insert_body(design)
    base, scale = design.dimensions.bone_outline.stations[0]
    below = ConicBody(design.dimensions.bone_outline.section, ((base, scale), (-_BASE_OVERLAP_MM, scale)))
    within_skin = scaled(_cut_facets(design, above, inset), design.dimensions.shrinkage)
    return union(within_skin, _cut_flat(design, below), collar(design))


def mold_insert(design: Design) -> Solid:
    """Build the body that lies in the closed mold while the silicone cures, with its hollows filled."""
    return sleeve_core(design) if design.mold.method == "sleeve" else filled_bone(design)


def skin_interior(design: Design) -> Solid:
    """Build the region that the finished, unstretched skin encloses."""
    return filled_bone(design, design.mold.sleeve_interference_mm if design.mold.method == "sleeve" else 0.0)
