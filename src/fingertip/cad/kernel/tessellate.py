"""Structured grids on the primitives: every vertex lies on the exact surface, no facet strays from it by more than
the tolerance.

Circles and conics are sampled as rational arcs, with additions, multiplications, divisions and square roots only:
these are exactly rounded on every machine, so the same design gives the same bytes everywhere.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from fingertip.cad.solids import Bar, Box, Cone, ElbowTube, Form, Point3, Primitive, Prism, place
from fingertip.conic import ELLIPSE, ConicBody, arc_point

Vertices: TypeAlias = NDArray[np.float64]
Triangles: TypeAlias = NDArray[np.int64]
Point2: TypeAlias = tuple[float, float]


def tessellate(solid: Primitive, tolerance_mm: float) -> tuple[Vertices, Triangles]:
    """Closed triangle mesh of a primitive, outward oriented.

    Returns
    -------
    vertices, triangles
        (n, 3) float64 [mm] and (m, 3) int64.
    """
    match solid:
        case Box(low, high):
            ring = [(low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])]
            return _stack([[(x, y, z) for x, y in ring] for z in (low[2], high[2])])
        case Cone():
            return _cone(solid, tolerance_mm)
        case Prism():
            return _prism(solid)
        case ElbowTube():
            return _elbow(solid, tolerance_mm)
        case Form(body):
            return _form(body, tolerance_mm)
        case Bar():
            return _bar(solid, tolerance_mm)


def arc_segments(a: float, b: float, weight: float, tolerance: float) -> int:
    """Chords needed on the arc from (a, 0) to (0, b) so that none strays by more than `tolerance`.

    The deviation falls with the square of the count: it is measured at a few counts until it holds.
    """
    n = 2
    while (deviation := _chord_deviation(a, b, weight, n)) > tolerance:
        n = max(n + 1, math.ceil(n * math.sqrt(deviation / tolerance)))
    return n


def _chord_deviation(a: float, b: float, weight: float, n: int) -> float:
    worst = 0.0
    previous = (a, 0.0)
    for i in range(1, n + 1):
        x, y = arc_point(i / n, weight)
        point = (a * x, b * y)
        dx, dy = point[0] - previous[0], point[1] - previous[1]
        length = math.hypot(dx, dy)
        for fraction in (0.35, 0.5, 0.65):  # the farthest point of a short conic arc lies near its middle
            mx, my = arc_point((i - 1 + fraction) / n, weight)
            worst = max(worst, abs((a * mx - previous[0]) * dy - (b * my - previous[1]) * dx) / length)
        previous = point
    return worst


def _circle(radius: float, tolerance: float) -> list[Point2]:
    n = arc_segments(radius, radius, ELLIPSE, tolerance)
    quarter = [arc_point(i / n, ELLIPSE) for i in range(n)]
    return [
        (radius * (cx * x - sx * y), radius * (sx * x + cx * y))
        for cx, sx in ((1, 0), (0, 1), (-1, 0), (0, -1))
        for x, y in quarter
    ]


def _cone(c: Cone, tolerance: float) -> tuple[Vertices, Triangles]:
    unit = _circle(1.0, tolerance / max(c.low_radius, c.high_radius))
    u0, v0 = c.centre
    ends = ((c.low, c.low_radius), (c.high, c.high_radius))
    return _stack([[place(c.axis, u0 + r * u, v0 + r * v, w) for u, v in unit] for w, r in ends])


def _prism(p: Prism) -> tuple[Vertices, Triangles]:
    """Walls on every ring; the ends as the kernel divides any polygon, without further vertices."""
    from manifold3d import triangulate

    rings = [p.corners, *p.holes]
    end = triangulate([np.array(ring, dtype=np.float64) for ring in rings]).astype(np.int64)
    n = sum(map(len, rings))
    faces, start = [end[:, ::-1], end + n], 0
    for ring in rings:
        i = start + np.arange(len(ring))
        j = start + (np.arange(len(ring)) + 1) % len(ring)
        faces += [np.column_stack((i, j, j + n)), np.column_stack((i, j + n, i + n))]
        start += len(ring)
    points = [place(p.axis, u, v, w) for w in (p.low, p.high) for ring in rings for u, v in ring]
    return np.array(points, dtype=np.float64), np.concatenate(faces)


def _elbow(e: ElbowTube, tolerance: float) -> tuple[Vertices, Triangles]:
    # Ring sag and path sag add up: half the tolerance each.
    ring = _circle(e.radius, tolerance / 2)
    outer = e.bend_radius + e.radius
    n = arc_segments(outer, outer, ELLIPSE, tolerance / 2)
    centre_y, centre_z = e.start_y + e.bend_radius, e.exit_z + e.bend_radius
    frames: list[tuple[Point2, Point2]] = [((e.start_y, e.start_z), (1.0, 0.0))]  # (centre, normal in the plane)
    for i in range(n + 1):
        c, s = arc_point(i / n, ELLIPSE)
        frames.append(((centre_y - e.bend_radius * c, centre_z - e.bend_radius * s), (c, s)))
    frames.append(((e.end_y, e.exit_z), (0.0, 1.0)))
    return _stack([[(u, y + v * ny, z + v * nz) for v, u in ring] for (y, z), (ny, nz) in frames])


def _form(body: ConicBody, tolerance: float) -> tuple[Vertices, Triangles]:
    section, largest = body.section, max(scale for _, scale in body.stations)
    a = section.half_width * largest
    halves = ((section.palmar, section.palmar_weight), (section.dorsal, section.dorsal_weight))
    share = tolerance / 2 if body.tip else tolerance  # on the tip the sags of both directions add up
    n = max(arc_segments(a, b * largest, w, share) for b, w in halves)
    dorsal = [arc_point(i / n, section.dorsal_weight) for i in range(n + 1)]
    palmar = [arc_point(i / n, section.palmar_weight) for i in range(n + 1)]
    unit = (
        [(section.half_width * x, section.dorsal * y) for x, y in dorsal]
        + [(-section.half_width * x, section.dorsal * y) for x, y in dorsal[-2::-1]]
        + [(-section.half_width * x, -section.palmar * y) for x, y in palmar[1:]]
        + [(section.half_width * x, -section.palmar * y) for x, y in palmar[-2:0:-1]]
    )
    levels = list(body.stations)
    if body.tip:
        length = body.tip.z - body.stations[-1][0]
        radius = max(section.half_width, section.palmar, section.dorsal) * body.tip_control()
        rows = arc_segments(radius, length, body.tip.weight, share)
        levels += [body.tip_point(i / rows) for i in range(1, rows)]
    rings = [[(s * x, s * y, z) for x, y in unit] for z, s in levels]
    return _stack(rings, (0.0, 0.0, body.tip.z) if body.tip else None)


def _bar(bar: Bar, tolerance: float) -> tuple[Vertices, Triangles]:
    section, half_width = bar.section.section, bar.section.half_width
    dorsal, palmar = (
        _rest_of_arc(section.half_width, height, weight, start, tolerance)
        for height, weight, start in (
            (section.dorsal, section.dorsal_weight, bar.section.dorsal_from),
            (section.palmar, section.palmar_weight, bar.section.palmar_from),
        )
    )
    outline = [
        (half_width, 0.0), *dorsal, *((-x, y) for x, y in dorsal[-2::-1]),
        (-half_width, 0.0), *((-x, -y) for x, y in palmar), *((x, -y) for x, y in palmar[-2::-1]),
    ]  # fmt: skip
    return _stack([[(x, y, z) for x, y in outline] for z in (bar.low, bar.high)])


def _rest_of_arc(a: float, b: float, weight: float, start: float, tolerance: float) -> list[Point2]:
    """Points of the arc from parameter `start` to (0, b), as dense as the whole arc needs."""
    n = arc_segments(a, b, weight, tolerance)
    points = (arc_point(start + (1.0 - start) * i / n, weight) for i in range(n + 1))
    return [(a * x, b * y) for x, y in points]


def _stack(rings: Sequence[Sequence[Point3]], apex: Point3 | None = None) -> tuple[Vertices, Triangles]:
    """Skin over equally long rings, closed by fans: to the first ring's middle, and to `apex` or the last's middle.

    The rings run so that (along the ring) x (to the next ring) points outwards. A pole is one vertex, never a ring
    of zero length, so no triangle is degenerate.
    """
    m, k = len(rings[0]), len(rings)
    centres = [_middle(rings[0]), apex or _middle(rings[-1])]
    vertices = np.array([point for ring in rings for point in ring] + centres, dtype=np.float64)
    i = np.arange(m)
    j = (i + 1) % m
    faces = [np.column_stack((np.full(m, m * k), j, i))]
    for row in range(k - 1):
        a, b = row * m, (row + 1) * m
        faces += [np.column_stack((a + i, a + j, b + j)), np.column_stack((a + i, b + j, b + i))]
    last = (k - 1) * m
    faces.append(np.column_stack((last + i, last + j, np.full(m, m * k + 1))))
    return vertices, np.concatenate(faces).astype(np.int64)


def _middle(ring: Sequence[Point3]) -> Point3:
    """A point inside a flat ring that is symmetric or star-shaped about it: the mean of opposite corners' extremes."""
    low, high = (tuple(pick(p[axis] for p in ring) for axis in range(3)) for pick in (min, max))
    return (low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2
