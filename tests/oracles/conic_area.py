"""Areas of sections of conic arcs in closed form."""

from __future__ import annotations

import math

from fingertip.models.conic import CrossSection


def arc_area(w: float) -> float:
    """Return the area between the unit arc and the axes: pi/4 for the ellipse, 1/2 at w = 0, 1 in
    the limit of large w.

    The arc is a projective image of the circle's. Integrating x dy gives the closed forms below,
    where d = 1 - w^2 is positive for ellipses and negative for hyperbolas.
    """
    d = 1.0 - w * w
    # Both forms cancel here. The series about their common limit, the parabola, does not.
    if abs(d) < 1e-4:
        return 0.5 + 0.5 * (2.0 / 3.0 + 2.0 / 15.0 * 2.0 * (w - 1.0))
    integral = (
        w / d * (math.acos(w) / math.sqrt(d) - w)
        if d > 0.0
        else w / -d * (w - math.acosh(w) / math.sqrt(-d))
    )
    return 0.5 + 0.5 * integral


def section_area(section: CrossSection) -> float:
    halves = section.palmar * arc_area(section.palmar_weight) + section.dorsal * arc_area(
        section.dorsal_weight
    )
    return 2.0 * section.half_width * halves
