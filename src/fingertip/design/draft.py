"""Draft of a recess whose outline is a superconic: near the parting plane the outline itself has none."""

from __future__ import annotations

from fingertip.conic import CrossSection

Corner = tuple[float, float]


def drafted_outline(section: CrossSection, slope: float, flat: float | None = None) -> tuple[Corner, ...]:
    """Hexagon that together with the section leans by at least `slope` everywhere, seen from the parting plane y = 0.

    From where an arc leans by that much a straight line runs on to the parting plane, outside the arc. Both sides meet
    there in the wider of their lines' ends, so that the halves' edges do.

    Parameters
    ----------
    section
        The outline, half width and half heights [mm].
    slope
        Tangent of the draft, >= 0.
    flat
        The palmar side is cut at y = -`flat` [mm]; None if it is not.

    Returns
    -------
    corners
        Six (x, y) [mm], counter-clockwise, the first at the right of the palmar side.
    """
    x_d, y_d = section.leaning(section.dorsal, section.dorsal_weight, slope)
    x_p, y_p = section.leaning(section.palmar, section.palmar_weight, slope)
    if flat is not None and y_p > flat:
        x_p, y_p = section.half_width_at(-flat), flat
    widest = max(x_d + slope * y_d, x_p + slope * y_p)
    return (x_p, -y_p), (widest, 0.0), (x_d, y_d), (-x_d, y_d), (-widest, 0.0), (-x_p, -y_p)
