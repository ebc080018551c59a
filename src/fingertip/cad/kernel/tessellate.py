"""Tessellation of primitives: structured triangle grids within a tolerance of the exact surface.

Every vertex lies on the exact surface, and no facet deviates from it by more than the tolerance.

Circles and conics are sampled as rational Bezier arcs, with additions, multiplications, divisions
and square roots only. IEEE 754 defines these as correctly rounded, so the same design gives the
same bytes on every machine.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from fingertip.foundation.numerics import Array
from fingertip.models import solids
from fingertip.models.conic import ELLIPSE, ConicBody, CrossSection, list_arc_points
from fingertip.models.profile import Control, Span, arc_point, conic_point

Triangles: TypeAlias = NDArray[np.int64]
Point2: TypeAlias = tuple[float, float]


def tessellate(solid: solids.Solid, tolerance_mm: float) -> tuple[Array, Triangles]:
    """Tessellate a primitive: points (n, 3) [mm], and indices (m, 3)
    of triangles counter-clockwise from outside.
    """
    match solid:
        case solids.Box(low, high):
            ring = [(low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])]
            return _connect_rings([[(x, y, z) for x, y in ring] for z in (low[2], high[2])])
        case solids.Cone():
            return _cone(solid, tolerance_mm)
        case solids.Prism():
            return _prism(solid)
        case solids.ElbowTube():
            return _elbow(solid, tolerance_mm)
        case solids.SuperconicSolid(body):
            return _superconic(body, tolerance_mm)
        case solids.Placed():
            return solid.move(), solid.body.triangles

    raise TypeError(f"{type(solid).__name__} is no primitive")


def arc_segments(a: float, b: float, weight: float, tolerance: float) -> int:
    """Count the chords needed on a conic arc so that none deviates from it by more than `tolerance`
    [mm].

    The arc runs from (`a`, 0) to (0, `b`). The deviation of a chord falls with the square of the
    number of chords. The count is therefore extrapolated from a measured deviation, and measured
    again until it is sufficient.
    """
    return _count_chords((a, a, 0.0), (0.0, b, b), weight, tolerance)


@lru_cache(maxsize=1024)
def _count_chords(first: Control, second: Control, weight: float, tolerance: float) -> int:
    """Count the chords that a conic arc between three control
    points, given by their coordinates, needs.
    """
    n = 2
    while (deviation := _chord_deviation(first, second, weight, n)) > tolerance:
        n = math.floor(n * math.sqrt(deviation / tolerance)) + 1

    return n


def _chord_deviation(first: Control, second: Control, weight: float, n: int) -> float:
    """Measure the largest distance [mm] between the arc and any of its `n` chords."""
    worst = 0.0
    start = conic_point(0.0, weight, first, second)

    for i in range(1, n + 1):
        end = conic_point(i / n, weight, first, second)
        dx = end[0] - start[0]
        dy = end[1] - start[1]
        length = math.hypot(dx, dy)

        # A short conic arc is farthest from its chord near the middle.
        for fraction in (
            0.35,
            0.5,
            0.65,
        ):
            mx, my = conic_point((i - 1 + fraction) / n, weight, first, second)
            worst = max(worst, abs((mx - start[0]) * dy - (my - start[1]) * dx) / length)

        start = end

    return worst


def _circle(radius: float, tolerance: float) -> list[Point2]:
    """Sample a circle of this radius [mm] counter-clockwise, as four quarter arcs."""
    n = arc_segments(radius, radius, ELLIPSE, tolerance)
    quarter = [arc_point(i / n, ELLIPSE) for i in range(n)]
    return [
        (radius * (cx * x - sx * y), radius * (sx * x + cx * y))
        for cx, sx in ((1, 0), (0, 1), (-1, 0), (0, -1))
        for x, y in quarter
    ]


def _cone(c: solids.Cone, tolerance: float) -> tuple[Array, Triangles]:
    unit = _circle(1.0, tolerance / max(c.low_radius, c.high_radius, c.around_radius))
    u0, v0 = c.centre
    ends = ((c.low, c.low_radius), (c.high, c.high_radius))
    return _connect_rings(
        [[solids.axis_point(c.axis, u0 + r * u, v0 + r * v, w) for u, v in unit] for w, r in ends]
    )


def _prism(p: solids.Prism) -> tuple[Array, Triangles]:
    """Tessellate a prism: manifold3d triangulates the end polygons
    without adding vertices, every edge gets a wall.
    """
    from manifold3d import triangulate  # noqa: PLC0415

    rings = [p.corners, *p.holes]
    end = triangulate([np.array(ring, dtype=np.float64) for ring in rings]).astype(np.int64)
    n = sum(map(len, rings))
    faces = [end[:, ::-1], end + n]
    start = 0

    for ring in rings:
        i = start + np.arange(len(ring))
        j = start + (np.arange(len(ring)) + 1) % len(ring)
        faces += [np.column_stack((i, j, j + n)), np.column_stack((i, j + n, i + n))]
        start += len(ring)

    points = [
        solids.axis_point(p.axis, u, v, w)
        for w in (p.low, p.high)
        for ring in rings
        for u, v in ring
    ]
    return np.array(points, dtype=np.float64), np.concatenate(faces)


def _elbow(e: solids.ElbowTube, tolerance: float) -> tuple[Array, Triangles]:
    # The deviations along the ring and along the bend add up: each may use half the tolerance.
    ring = _circle(e.radius, tolerance / 2)
    outer = e.bend_radius + e.radius
    n = arc_segments(outer, outer, ELLIPSE, tolerance / 2)
    centre_y = e.start_y + e.bend_radius
    centre_z = e.exit_z + e.bend_radius
    # Centre (y, z) of each ring and the unit vector in the plane x = 0 that its first axis points
    # along.
    frames: list[tuple[Point2, Point2]] = [((e.start_y, e.start_z), (1.0, 0.0))]

    for i in range(n + 1):
        c, s = arc_point(i / n, ELLIPSE)
        frames.append(((centre_y - e.bend_radius * c, centre_z - e.bend_radius * s), (c, s)))

    frames.append(((e.end_y, e.exit_z), (0.0, 1.0)))
    return _connect_rings(
        [[(u, y + v * ny, z + v * nz) for v, u in ring] for (y, z), (ny, nz) in frames]
    )


def _superconic(body: ConicBody, tolerance: float) -> tuple[Array, Triangles]:
    section = body.section
    largest = max(scale for _, scale in body.stations)
    a = section.half_width * largest
    halves = ((section.palmar, section.palmar_weight), (section.dorsal, section.dorsal_weight))
    # On the tip the deviations of both directions add up.
    share = tolerance / 2 if body.tip else tolerance
    n = max(arc_segments(a, b * largest, w, share) for b, w in halves)
    dorsal = list_arc_points(n, section.dorsal_weight)
    palmar = list_arc_points(n, section.palmar_weight)
    # Outline at scale 1, counter-clockwise from the right: dorsal right, dorsal left, palmar left,
    # palmar right.
    unit = (
        [(section.half_width * x, section.dorsal * y) for x, y in dorsal]
        + [(-section.half_width * x, section.dorsal * y) for x, y in dorsal[-2::-1]]
        + [(-section.half_width * x, -section.palmar * y) for x, y in palmar[1:]]
        + [(section.half_width * x, -section.palmar * y) for x, y in palmar[-2:0:-1]]
    )
    # Rings at the ends of straight spans, and along curved ones as many as their profile needs.
    levels = [(body.spans[0].z[0], body.spans[0].scale[0], body.spans[0].palmar[0])]

    for span in body.spans:
        rows = 1 if span.is_straight else _count_rows(section, span, share)
        levels += [span.evaluate(i / rows) for i in range(1, rows)]
        levels.append((span.z[2], span.scale[2], span.palmar[2]))

    if body.tip:
        levels.pop()

    rings = [[(s * x, (c if y < 0.0 else s) * y, z) for x, y in unit] for z, s, c in levels]
    return _connect_rings(rings, (0.0, 0.0, body.tip.z) if body.tip else None)


def _count_rows(section: CrossSection, span: Span, tolerance: float) -> int:
    """Count the chords needed on a curved span so that none of its
    profiles deviates by more than `tolerance` [mm].
    """
    profiles = (
        (section.half_width, span.scale),
        (section.dorsal, span.scale),
        (section.palmar, span.palmar),
    )
    return max(
        _count_chords((r * s[0], r * s[1], r * s[2]), span.z, span.weight, tolerance)
        for r, s in profiles
    )


def _connect_rings(
    rings: Sequence[Sequence[solids.Point3]], apex: solids.Point3 | None = None
) -> tuple[Array, Triangles]:
    """Connect rings of equal length by triangles and close both ends with fans of triangles.

    The first fan meets in the centre of the first ring, the last one in `apex` or in the centre of
    the last ring. The direction along a ring crossed with the direction to the next ring must point
    outwards. A pole is a single vertex, not a ring of zero length, so that no triangle is
    degenerate.
    """
    m = len(rings[0])
    k = len(rings)
    poles = [_bounding_box_centre(rings[0]), apex or _bounding_box_centre(rings[-1])]
    vertices = np.array([point for ring in rings for point in ring] + poles, dtype=np.float64)
    i = np.arange(m)
    j = (i + 1) % m
    faces = np.empty((2 * k, m, 3), dtype=np.int64)
    faces[0] = np.stack((np.full(m, m * k), j, i), axis=1)
    # Two triangles of a square between the first two rings, repeated from ring to ring.
    square = np.stack((np.stack((i, j, m + j), axis=1), np.stack((i, m + j, m + i), axis=1)))
    faces[1:-1] = (square + m * np.arange(k - 1)[:, None, None, None]).reshape(-1, m, 3)
    last = (k - 1) * m
    faces[-1] = np.stack((last + i, last + j, np.full(m, m * k + 1)), axis=1)

    return vertices, faces.reshape(-1, 3)


def _bounding_box_centre(ring: Sequence[solids.Point3]) -> solids.Point3:
    """Compute the centre of a ring's bounding box; it must lie inside the ring."""
    x, y, z = ((min(along) + max(along)) / 2 for along in zip(*ring, strict=True))
    return x, y, z
