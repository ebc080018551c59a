"""How much silicone covers the bone in a cross-section: the least distance between two outlines."""

from __future__ import annotations

import math
from itertools import pairwise

from fingertip.conic import CrossSection, arc_point
from fingertip.design.dimensions import Dimensions

_POINTS, _CHORDS = 24, 48  # of a quarter: the chords' sag is 1e-3 mm on a finger


def least_cover(dims: Dimensions, inset_mm: float) -> float:
    """Thinnest silicone [mm] in the sections where the skin begins and where its tip begins.

    Between them both outlines shrink in straight lines, so that no section there is thinner. The tip is left to the
    measure on the solids, which sees all three dimensions.

    Parameters
    ----------
    dims
        Derived lengths of the design.
    inset_mm
        How much smaller than the bone the silicone's inside is [mm]: the interference of a sleeve.
    """
    inner = [(z, s) for z, s in dims.envelope.stations if z >= 0.0]
    return min(
        _gap(dims.outer.section, dims.outer.scale_at(z), dims.envelope.section, s, dims.flat_depth - inset_mm, inset_mm)
        for z, s in inner
    )


def _gap(
    outer: CrossSection, outer_scale: float, inner: CrossSection, inner_scale: float, flat: float, inset: float
) -> float:
    """Least distance [mm] from the inner outline, cut at y = -flat, to the outer one; negative outside it."""
    width, gaps = inner.half_width - inset, []
    for dorsal in (True, False):
        height = (inner.dorsal if dorsal else inner.palmar) - inset
        weight = inner.dorsal_weight if dorsal else inner.palmar_weight
        around = [
            (outer_scale * outer.half_width * x, outer_scale * (outer.dorsal if dorsal else outer.palmar) * y)
            for x, y in _quarter(outer.dorsal_weight if dorsal else outer.palmar_weight, _CHORDS)
        ]
        points = [(inner_scale * width * x, inner_scale * height * y) for x, y in _quarter(weight, _POINTS)]
        if not dorsal:
            edge = inner.half_width_at(-flat, inner_scale)
            points = [(x, y) for x, y in points if y < flat] + [(min(edge, width * inner_scale), flat)]
        gaps += [min(_to_chord(p, a, b) for a, b in pairwise(around)) for p in points]
    return min(gaps)


def _quarter(weight: float, count: int) -> list[tuple[float, float]]:
    return [arc_point(i / count, weight) for i in range(count + 1)]


def _to_chord(p: tuple[float, float], a: tuple[float, float], b: tuple[float, float]) -> float:
    """Distance [mm] of a point from a chord."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    length = dx * dx + dy * dy
    t = ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / length if length else 0.0
    t = min(1.0, max(0.0, t))
    return math.hypot(a[0] + t * dx - p[0], a[1] + t * dy - p[1])
