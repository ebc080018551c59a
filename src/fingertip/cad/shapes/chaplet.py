"""Chaplet of the mold: its boss, the hole of its screw, and what both leave in bone, core and skin."""

from __future__ import annotations

from fingertip.cad.shapes.bridged_pocket import CEILING_STEPS_MM, bridge_ceiling
from fingertip.cad.solids import Cone, Solid, cylinder, scaled
from fingertip.design import Design
from fingertip.design.geometry.chaplet import Chaplet

_INTO_HOLLOW_MM = 0.3
"""Length by which holes reach past the faces in which they open [mm]. Faces in one plane would leave slivers."""


def facet_cut(design: Design, inset_mm: float = 0.0) -> tuple[Solid, ...]:
    """Build what the facet cuts off bone or core, whose surface lies `inset_mm` inside the bone's; none without one."""
    chaplet = design.dimensions.chaplet
    if chaplet is None:
        return ()
    top = 2 * design.dimensions.bone_outline.section.dorsal
    return (cylinder("y", (chaplet.z, 0.0), chaplet.facet_y - inset_mm, top, chaplet.facet_radius),)


def pilot_hole(design: Design) -> tuple[Solid, ...]:
    """Build the hole in the bone for the screw; none without a chaplet."""
    chaplet = design.dimensions.chaplet
    if chaplet is None:
        return ()
    low, high = chaplet.facet_y - chaplet.pilot_depth, chaplet.facet_y + _INTO_HOLLOW_MM
    return (cylinder("y", (chaplet.z, 0.0), low, high, chaplet.pilot_radius),)


def boss(design: Design) -> tuple[Solid, ...]:
    """Build the boss as it stands in the mold's cavity, widened by its draft; none without one.

    A sleeve's core, and the boss on it, are enlarged by the shrinkage of the silicone.
    """
    chaplet = design.dimensions.chaplet
    if chaplet is None:
        return ()
    if design.mold.method == "sleeve":
        return (scaled(_boss(design, chaplet, design.mold.sleeve_interference_mm), design.dimensions.shrinkage),)
    return (_boss(design, chaplet),)


def hole_in_skin(design: Design) -> tuple[Solid, ...]:
    """Build the hole that the boss leaves in the finished skin; none without one."""
    chaplet = design.dimensions.chaplet
    if chaplet is None:
        return ()
    return (_boss(design, chaplet, design.mold.sleeve_interference_mm if design.mold.method == "sleeve" else 0.0),)


def _boss(design: Design, chaplet: Chaplet, inset_mm: float = 0.0) -> Solid:
    """Build the boss from the facet to far outside the skin."""
    low, high = chaplet.facet_y - inset_mm, 4 * design.dimensions.outer.section.dorsal
    return Cone(
        "y", (chaplet.z, 0.0), low, high, chaplet.radius, chaplet.radius + design.dimensions.draft_slope * (high - low)
    )


def contact_y(design: Design) -> float:
    """Height of the plane in the closed mold in which boss and facet meet [mm]."""
    chaplet = design.dimensions.chaplet
    assert chaplet
    if design.mold.method == "sleeve":
        return (chaplet.facet_y - design.mold.sleeve_interference_mm) * design.dimensions.shrinkage
    return chaplet.facet_y


def screw_hole(design: Design) -> tuple[Solid, ...]:
    """Build the hole of the screw through the dorsal half, and the counterbore of its head; none without a chaplet.

    The half is printed on its outer face, so the bottom of the counterbore is a ceiling, which prints in bridges.
    """
    chaplet = design.dimensions.chaplet
    if chaplet is None:
        return ()
    centre, high, head = (axis_z(design), 0.0), 2 * design.mold_layout.dorsal_height, head_y(design)
    counterbore = cylinder("y", centre, head - CEILING_STEPS_MM, high, chaplet.head_radius)
    return (
        cylinder("y", centre, contact_y(design) - _INTO_HOLLOW_MM, high, chaplet.hole_radius),
        bridge_ceiling(counterbore, centre, head, -1.0, chaplet.hole_radius, reach=2 * chaplet.head_radius),
    )


def axis_z(design: Design) -> float:
    """Axis of the chaplet in the mold, along the finger [mm]."""
    chaplet = design.dimensions.chaplet
    assert chaplet
    return chaplet.z * (design.dimensions.shrinkage if design.mold.method == "sleeve" else 1.0)


def head_y(design: Design) -> float:
    """Height of the bottom of the counterbore, under the head of the screw [mm]."""
    chaplet = design.dimensions.chaplet
    assert chaplet
    length = chaplet.screw_length(design.mold_layout.dorsal_height)
    return contact_y(design) - chaplet.engaged + length
