"""Feet: the fillets where a thin part of the bone stands on a wider one, drawn as chords of an arc.

Both kernels build a foot from primitives. Its chords run on into the solids on both sides, so that no faces coincide.
"""

from __future__ import annotations

import math
from itertools import pairwise

from fingertip.design.geometry.conic import ConicBody, CrossSection
from fingertip.design.geometry.solids import Axis, Cone, Prism, Solid, SuperconicSolid, union

_CHORDS = 6
"""Chords of a quarter of a circle: the surface bends by 15 degrees at most."""
LEDGE_MM = 0.7
"""Ledge that prints over air without supports [mm]."""
_INTO_MM = 0.1
"""Length by which a foot reaches into the thin part [mm]."""


def foot_line(radius_mm: float, root: float, way: float, reach: float = 0.0) -> list[tuple[float, float]]:
    """List points (z, outward) of the arc, from the thin part to the root; the wide part lies towards `way` [mm].

    With a `reach`, half of the arc and 45 degrees from there on up to it, which prints without supports.
    """
    angles = [math.pi / 2 * i / _CHORDS for i in range((_CHORDS // 2 if reach else _CHORDS) + 1)]
    below = foot_length(radius_mm, reach) - radius_mm
    arc = [(root - way * (below + radius_mm * (1.0 - math.sin(a))), radius_mm * (1.0 - math.cos(a))) for a in angles]
    (z0, out0), (z1, out1) = arc[:2]
    top = [(root, reach)] if reach else []
    return [(z0 - way * _INTO_MM, out0 - _INTO_MM * (out1 - out0) / abs(z1 - z0)), *arc[1:], *top]


def foot_length(radius_mm: float, reach: float) -> float:
    return reach + radius_mm * (math.sqrt(2.0) - 1.0) if reach else radius_mm


def round_foot(centre: tuple[float, float], thin_radius: float, line: list[tuple[float, float]], top: float) -> Solid:
    """Build the foot of a round post along z, whose wide part lies distal to it; it ends at `top` [mm]."""
    cones = []
    for (low, inner), (high, outer) in pairwise(line):
        slope = (outer - inner) / (high - low)
        begin = low - _INTO_MM / 2
        radii = (thin_radius + inner + slope * (z - low) for z in (begin, top))
        cones.append(Cone("z", centre, begin, top, *radii))
    return union(*cones)


def flat_foot(
    axis: Axis, low_side: float, high_side: float, foot: list[tuple[float, float]], end: float, reach: float
) -> Solid:
    """Build the foot of flats along an axis across the finger, between two sides [mm]; it ends at z = `end`."""
    outline = [*foot, (end, foot[-1][1])]
    ring = [(low_side - out, z) for z, out in outline] + [(high_side + out, z) for z, out in reversed(outline)]
    corners = ring if axis == "x" else [(z, x) for x, z in ring]
    area = sum(a[0] * b[1] - b[0] * a[1] for a, b in pairwise((*corners, corners[0])))
    return Prism(axis, tuple(corners if area > 0.0 else corners[::-1]), -reach, reach)


def conic_foot(section: CrossSection, foot: list[tuple[float, float]], end: float) -> Solid:
    """Build the foot of a superconic section; it ends at z = `end` [mm]."""
    stations = [(z, 1.0 + out / section.half_width) for z, out in (*foot, (end, foot[-1][1]))]
    return SuperconicSolid(ConicBody(section, tuple(stations[::-1])))
