"""How much silicone covers the bone in a cross-section: the least distance between two outlines."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

from fingertip.design.geometry.conic import CrossSection, arc_point
from fingertip.design.geometry.dimensions import Dimensions

_POINTS, _CHORDS = 24, 48  # of a quarter: the chords' sag is 1e-3 mm on a finger


@dataclass(frozen=True)
class Cover:
    """The silicone over one point of the bone's outline, in a section across the finger."""

    gap_mm: float
    x: float
    y: float
    """Unit vector from the bone to the nearest place of the surface."""
    reach_mm: float
    """How far the surface reaches there in that direction, from the middle."""


def min_skin_thickness(dims: Dimensions, inset_mm: float) -> float:
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
    heights = (z for z, _ in dims.envelope.stations if z >= 0.0)
    return min(cover.gap_mm for z in heights for cover in skin_thicknesses(dims, z, inset_mm))


def skin_thicknesses(
    dims: Dimensions, z: float, inset_mm: float, points: int = _POINTS, chords: int = _CHORDS
) -> Iterator[Cover]:
    """The silicone over points of the bone's outline at height z [mm], cut at its flat; of one side, x >= 0."""
    outer, outer_scale = dims.outer.section, dims.outer.scale_at(z)
    inner, inner_scale = dims.envelope.section, dims.envelope.scale_at(z)
    width, flat = inner.half_width - inset_mm, dims.flat_depth - inset_mm
    for dorsal in (True, False):
        height = (inner.dorsal if dorsal else inner.palmar) - inset_mm
        weight = inner.dorsal_weight if dorsal else inner.palmar_weight
        around = [(outer_scale * x, outer_scale * y) for x, y in quarter(outer, dorsal, chords)]
        within = [
            (inner_scale * width * x, inner_scale * height * y)
            for x, y in (arc_point(i / points, weight) for i in range(points + 1))
        ]
        if not dorsal:
            edge = inner.half_width_at(-flat, inner_scale)
            within = [(x, y) for x, y in within if y < flat]
            within += [(min(edge, width * inner_scale), flat)] if edge > 0.0 else []
        for p in within:
            gap, (ax, ay), (bx, by) = min((_to_chord(p, a, b), a, b) for a, b in pairwise(around))
            length = math.hypot(bx - ax, by - ay) or 1.0
            x, y = (by - ay) / length, (ax - bx) / length
            yield Cover(gap, x, y if dorsal else -y, ax * x + ay * y)


def quarter(section: CrossSection, dorsal: bool, count: int) -> list[tuple[float, float]]:
    """Points [mm] of one quarter of a section's outline, from its side to its back or pad, both taken upwards."""
    height, weight = (section.dorsal, section.dorsal_weight) if dorsal else (section.palmar, section.palmar_weight)
    return [(section.half_width * x, height * y) for x, y in (arc_point(i / count, weight) for i in range(count + 1))]


def _to_chord(p: tuple[float, float], a: tuple[float, float], b: tuple[float, float]) -> float:
    """Distance [mm] of a point from a chord."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    length = dx * dx + dy * dy
    t = ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / length if length else 0.0
    t = min(1.0, max(0.0, t))
    return math.hypot(a[0] + t * dx - p[0], a[1] + t * dy - p[1])
