"""Draft of a recess whose outline is a superconic: near the parting plane the outline itself has none."""

from __future__ import annotations

from dataclasses import dataclass

from fingertip.design.geometry.conic import CrossSection, arc_parameter_at_height, arc_parameter_at_slope, arc_point


@dataclass(frozen=True)
class DraftedSection:
    """A section whose arcs give way to straight walls beside the parting plane y = 0.

    From where an arc leans by the draft a straight line runs on to the parting plane, outside the arc, and leans by at
    least as much. Both sides meet there in the wider of their lines' ends, so that the halves' edges do.
    """

    section: CrossSection
    half_width: float
    """At the parting plane [mm]."""
    palmar_start: float
    """Parameter of the palmar arcs where the lines end."""
    dorsal_start: float


def add_draft(section: CrossSection, slope: float, flat: float | None = None) -> DraftedSection:
    """The section with draft.

    Parameters
    ----------
    section
        The outline, half width and half heights [mm].
    slope
        Tangent of the draft, > 0.
    flat
        The palmar side will be cut at y = -`flat` [mm], where the line must begin at the latest; None if it is not.
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
