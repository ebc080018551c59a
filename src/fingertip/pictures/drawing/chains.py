"""Chains of segments: the pieces of projected edges, joined to the lines that they came from."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable

from fingertip.pictures.drawing.primitives import Line2, Point

Segment = tuple[Point, Point]


def chain_segments(segments: Iterable[Segment], straight_mm: float) -> tuple[Line2, ...]:
    """Join segments wherever just two of them end in one point, in an order of their own.

    Points that lie within `straight_mm` of the line between their neighbours are left out.
    """
    neighbours: dict[Point, set[Point]] = defaultdict(set)
    for begin, end in segments:
        if begin != end:
            neighbours[begin].add(end)
            neighbours[end].add(begin)

    lines = []
    ends = sorted(point for point, others in neighbours.items() if len(others) != 2)
    for end in ends:
        while neighbours[end]:
            lines.append(_follow(neighbours, end))

    for point in sorted(neighbours):  # what is left are closed lines
        if neighbours[point]:
            lines.append(_follow(neighbours, point))

    return tuple(sorted(_straighten(line, straight_mm) for line in lines))


def _follow(neighbours: dict[Point, set[Point]], begin: Point) -> list[Point]:
    """Take a chain out of the segments, up to the next point where it ends, forks or is closed."""
    line = [begin]
    point = begin

    while True:
        following = min(neighbours[point])
        neighbours[point].remove(following)
        neighbours[following].remove(point)
        line.append(following)
        point = following
        if len(neighbours[point]) != 1 or point == begin:
            return line


def _straighten(line: list[Point], straight_mm: float) -> Line2:
    """Leave out points on the way straight on."""
    kept = line[:1]
    for i, point in enumerate(line[1:-1], start=1):
        if _distance(point, kept[-1], line[i + 1]) > straight_mm:
            kept.append(point)

    return (*kept, line[-1])


def _distance(point: Point, begin: Point, end: Point) -> float:
    """Compute the distance of a point from the line through two others."""
    along_x = end[0] - begin[0]
    along_y = end[1] - begin[1]
    length = math.hypot(along_x, along_y)
    if length == 0.0:
        return math.inf

    return abs(along_x * (point[1] - begin[1]) - along_y * (point[0] - begin[0])) / length
