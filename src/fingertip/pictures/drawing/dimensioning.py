"""Placement of dimensions: extension and dimension lines, arrows, and text where nothing else lies.

Dimension lines lie in lanes beside their view, short ones inside. Diameters get a leader. For each
size many places are tried, and the one of least cost among those whose text is clear of everything
is taken (ISO 129-1 for the form).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from fingertip.design.geometry.sizes import Circle, Length
from fingertip.pictures.drawing.primitives import (
    Arrow,
    Box,
    Point,
    Primitive,
    Ring,
    Styles,
    Text,
    line,
    text_width,
)

_CELL_MM = 0.25


class Occupancy:
    """Raster of a sheet with three layers: lines of views, lines of dimensions, and text."""

    def __init__(self, width: float, height: float) -> None:
        shape = (math.ceil(height / _CELL_MM) + 1, math.ceil(width / _CELL_MM) + 1)
        self.edges, self.lines, self.texts = (np.zeros(shape, dtype=bool) for _ in range(3))

    def add(self, primitives: Iterable[Primitive], *, is_view: bool = False) -> None:
        layer = self.edges if is_view else self.lines
        for primitive in primitives:
            if isinstance(primitive, Text):
                self.block(primitive.box())

            for points in primitive.trace():
                layer[self._under(points)] = True

    def block(self, box: Box) -> None:
        self.texts[self._cells(box, 0.0)] = True

    def is_free(self, box: Box, margin: float) -> bool:
        """Return whether a box with a margin is empty, and the box within the sheet."""
        left, bottom, right, top = box
        height, width = ((count - 1) * _CELL_MM for count in self.texts.shape)
        if left < margin or bottom < margin or right > width - margin or top > height - margin:
            return False

        cells = self._cells(box, margin)
        return not any(layer[cells].any() for layer in (self.edges, self.lines, self.texts))

    def crosses_text(self, points: Iterable[Point]) -> bool:
        return bool(self.texts[self._under(points)].any())

    def crossings(self, points: Iterable[Point]) -> tuple[int, int]:
        """Count the cells of edges and of other lines that a polyline crosses."""
        under = self._under(points)
        return int(self.edges[under].sum()), int(self.lines[under].sum())

    def _cells(self, box: Box, margin: float) -> tuple[slice, slice]:
        left, bottom, right, top = box
        return (
            slice(
                max(0, int((bottom - margin) / _CELL_MM)),
                max(0, math.ceil((top + margin) / _CELL_MM)) + 1,
            ),
            slice(
                max(0, int((left - margin) / _CELL_MM)),
                max(0, math.ceil((right + margin) / _CELL_MM)) + 1,
            ),
        )

    def _under(self, points: Iterable[Point]) -> tuple[np.ndarray, np.ndarray]:
        """Return rows and columns of the sheet's cells under a polyline."""
        corners = np.array(list(points), dtype=float).reshape(-1, 2)
        begins = corners[:-1]
        steps = corners[1:] - begins
        intervals = np.maximum(1, np.ceil(np.hypot(*steps.T) / (0.7 * _CELL_MM)).astype(int))
        segment = np.repeat(np.arange(len(steps)), intervals + 1)
        first = np.repeat(np.cumsum(intervals + 1) - intervals - 1, intervals + 1)
        share = (np.arange(len(segment)) - first) / intervals[segment]
        sampled = begins[segment] + share[:, None] * steps[segment]

        cells = (sampled / _CELL_MM).astype(int)
        columns, rows = cells[((cells >= 0) & (cells < self.texts.shape[::-1])).all(axis=1)].T
        return rows, columns


TEXT_MM = 2.5
"""Height of dimensions (ISO 3098-1)."""
FIRST_LANE_MM = 9.0
LANE_MM = 7.0
"""Distance of the first dimension line from its view, and of the next one from it."""
_MAX_LANES = 12
_LANE_COST = 3.0
_ARROW_MM = 2.5
_GAP_MM = 0.8
_PAST_MM = 1.5
"""Gap between outline and extension line, and its length past the dimension line."""
_ABOVE_LINE_MM = 0.9
_BALLOON_ABOVE_MM = 1.3
_BALLOON_RADIUS_MM = 2.3
_BALLOON_GAP_MM = 0.8
_MARGIN_MM = 0.6
"""Free space around text."""
_LEADER_ANGLES_DEG = (
    45, 135, 225, 315, 60, 120, 240, 300, 30, 150,
    210, 330, 75, 105, 255, 285, 15, 165, 195, 345,
)  # fmt: skip
_LEADER_LENGTHS_MM = (5, 7, 9, 12, 15, 18, 21, 25, 30, 35, 40, 45, 50, 60, 70, 80)
_MAX_ALONG = 10
"""Cells of other lines under a dimension line from which on both would run along each other."""


class NoRoomError(Exception):
    """A size finds no place on a sheet of this scale."""


@dataclass(frozen=True)
class PlacedLength:
    """Length on paper: its ends, the side and edge of the view, and its text."""

    size: Length
    start: Point
    end: Point
    edge: float
    """Coordinate of the view's edge on the side of the dimension line."""
    balloon: int

    @property
    def is_level(self) -> bool:
        return self.size.side in ("above", "below")

    @property
    def span(self) -> float:
        i = 0 if self.is_level else 1
        return abs(self.end[i] - self.start[i])


def place_lengths(lengths: Sequence[PlacedLength], occupancy: Occupancy) -> Iterator[Primitive]:
    """Place all lengths on one side of a view. Raises NoRoomError."""
    pending = sorted(lengths, key=lambda placed: (round(placed.span, 3), placed.size.name))
    while pending:
        placed = pending.pop(0)
        index = 0 if placed.is_level else 1
        own = (placed.start[index], placed.end[index])
        coming = itertools.chain.from_iterable((length.start, length.end) for length in pending)
        reserved = [
            end[index] for end in coming if min(abs(end[index] - place) for place in own) > 0.05
        ]
        primitives = _place_length(placed, occupancy, reserved)
        occupancy.add(primitives)
        yield from primitives


def _place_length(
    placed: PlacedLength, occupancy: Occupancy, reserved: Sequence[float]
) -> tuple[Primitive, ...]:
    """Place one length; `reserved` are the coordinates of extension lines to come."""
    best: tuple[float, tuple[Primitive, ...]] | None = None
    for lane in range(_MAX_LANES):
        if best and best[0] <= _LANE_COST * lane:
            break

        for cost, primitives in _propose_in_lane(placed, lane, occupancy, reserved):
            if best is None or cost < best[0]:
                best = cost, primitives

    if best is None:
        raise NoRoomError(placed.size.name)

    return best[1]


def _propose_in_lane(
    placed: PlacedLength, lane: int, occupancy: Occupancy, reserved: Sequence[float]
) -> Iterator[tuple[float, tuple[Primitive, ...]]]:
    """List ways to draw a length in a lane, with what each costs."""
    index = 0 if placed.is_level else 1
    out = 1.0 if placed.size.side in ("above", "right") else -1.0
    low, high = sorted((placed.start[index], placed.end[index]))
    width = _group_width(placed.size.text(), placed.balloon)

    def at(u: float, v: float) -> Point:
        return (u, v) if placed.is_level else (v, u)

    v = placed.edge + out * (FIRST_LANE_MM + lane * LANE_MM)
    narrow = high - low < 2 * _ARROW_MM + 1.5
    outside = _ARROW_MM + 1.5 if narrow else 0.0
    turn = 0.0 if placed.is_level else 90.0
    extensions = []
    for point in (placed.start, placed.end):
        u = point[index]
        from_v = point[1 - index] + out * _GAP_MM
        extensions.append((at(u, from_v), at(u, v + out * _PAST_MM)))

    inwards = (
        (at(low, v), turn + (0.0 if narrow else 180.0)),
        (at(high, v), turn + (180.0 if narrow else 0.0)),
    )
    arrows = tuple(Arrow(tip, direction, _ARROW_MM) for tip, direction in inwards)

    for middle, penalty in _text_middles(low, high, width):
        begin = middle - width / 2
        end = middle + width / 2
        if any(begin - _MARGIN_MM < u < end + _MARGIN_MM for u in reserved):
            continue

        text = _text_group(
            placed.size.text(), placed.balloon, at(begin, v), turned=not placed.is_level
        )
        if not all(occupancy.is_free(part.box(), _MARGIN_MM) for part in text):
            continue

        along = (at(min(low - outside, begin), v), at(max(high + outside, end), v))
        if any(occupancy.crosses_text(ends) for ends in (along, *extensions)):
            continue

        edges, lines = occupancy.crossings(along)
        if lines > _MAX_ALONG:
            continue

        crossed = sum(sum(occupancy.crossings(ends)) for ends in extensions)
        cost = _LANE_COST * lane + penalty + 0.4 * edges + 0.6 * lines + 0.01 * crossed
        drawn = (line(*ends, Styles.DIMENSION) for ends in (along, *extensions))
        yield cost, (*drawn, *arrows, *text)


def _text_middles(low: float, high: float, width: float) -> Iterator[tuple[float, float]]:
    """List places for the middle of a text along a dimension line, with what each costs."""
    middle = (low + high) / 2
    span = high - low

    if width <= span - 2 * _ARROW_MM - 1.0:
        room = (span - width) / 2 - _ARROW_MM
        for share in (0.0, 0.25, -0.25, 0.5, -0.5, 0.75, -0.75, 1.0, -1.0):
            yield middle + share * room, 0.5 * abs(share)

    beyond = _ARROW_MM + 2.0 + width / 2
    # Far from its dimension a text is hard to find: only where no lane has room for it nearer.
    for further, penalty in ((0.0, 0.0), (6.0, 0.6), (14.0, 1.4), (24.0, 50.0), (36.0, 60.0)):
        yield high + beyond + further, 1.5 + penalty
        yield low - beyond - further, 1.7 + penalty


def place_circle(
    size: Circle,
    centre: Point,
    radius: float,
    balloon: int,
    occupancy: Occupancy,
) -> tuple[Primitive, ...]:
    """Place a diameter or a radius with a leader.

    The radius is that on paper. Raises NoRoomError.
    """
    best: tuple[float, tuple[Primitive, ...]] | None = None
    width = _group_width(size.text(), balloon)
    directions = [angle for angle in _LEADER_ANGLES_DEG if size.has_edge_at(angle)]

    for order, angle_deg in enumerate(directions):
        c = math.cos(math.radians(angle_deg))
        s = math.sin(math.radians(angle_deg))
        tip = (centre[0] + radius * c, centre[1] + radius * s)

        for length in _LEADER_LENGTHS_MM:
            knee = (tip[0] + length * c, tip[1] + length * s)
            way = 1.0 if c > 0.0 else -1.0
            landing = (knee[0] + way * (width + 1.0), knee[1])
            begin = min(knee[0], landing[0]) + 0.5
            text = _text_group(size.text(), balloon, (begin, knee[1]), turned=False)
            if not all(occupancy.is_free(part.box(), _MARGIN_MM) for part in text):
                continue

            path = (tip, knee, landing)
            if occupancy.crosses_text(path):
                continue

            # Past the arrow the leader no longer touches the circle.
            edges, lines = occupancy.crossings(((tip[0] + c, tip[1] + s), knee, landing))
            cost = 0.12 * length + 0.5 * edges + 0.5 * lines + 0.05 * order
            if best and cost >= best[0]:
                continue

            arrow = Arrow(tip, angle_deg + 180.0, _ARROW_MM)
            leader = (line(tip, knee, Styles.DIMENSION), line(knee, landing, Styles.DIMENSION))
            best = (cost, (*leader, arrow, *text))

    if best is None:
        raise NoRoomError(size.name)

    occupancy.add(best[1])
    return best[1]


def _group_width(text: str, balloon: int) -> float:
    """Return the width of a text and its balloon, if it has one [mm]."""
    balloon_mm = 2 * _BALLOON_RADIUS_MM + _BALLOON_GAP_MM if balloon else 0.0
    return text_width(text, TEXT_MM) + balloon_mm


def _text_group(text: str, balloon: int, start: Point, *, turned: bool) -> tuple[Ring | Text, ...]:
    """Arrange a text and its balloon along a line from `start`, above it or at its left."""
    above = _BALLOON_ABOVE_MM if balloon else _ABOVE_LINE_MM

    def to_paper(u: float, v: float) -> Point:
        return (start[0] - v, start[1] + u) if turned else (start[0] + u, start[1] + v)

    if not balloon:
        return (Text(text, to_paper(0.0, above), TEXT_MM, turned=turned),)

    r = _BALLOON_RADIUS_MM
    middle = above + TEXT_MM / 2
    return (
        Ring(to_paper(r, middle), r, Styles.DIMENSION),
        Text(
            text=str(balloon),
            at=to_paper(r, above),
            height=TEXT_MM,
            anchor="middle",
            turned=turned,
        ),
        Text(text, to_paper(2 * r + _BALLOON_GAP_MM, above), TEXT_MM, turned=turned),
    )
