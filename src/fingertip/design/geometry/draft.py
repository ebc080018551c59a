"""Draft of a recess whose outline is a superconic. Beside the parting plane the outline itself has no draft."""

from __future__ import annotations

from dataclasses import dataclass

from fingertip.design.geometry.conic import CrossSection, arc_parameter_at_height, arc_parameter_at_slope, arc_point


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

    Parameters
    ----------
    section
        The outline, half width and half heights [mm].
    slope
        Tangent of the draft angle, > 0.
    flat
        Depth [mm] at which the palmar side will be cut, y = -`flat`: the wall reaches at most that far. None if it is
        not cut.
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
