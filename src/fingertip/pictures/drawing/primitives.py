"""Views of a part, and the primitives of a sheet, in millimetres on paper from its lower left
corner.

A sheet is a list of lines, rings, texts, arrows and hatching; `svg_and_pdf.py` writes it and
decides nothing. The views are those of first-angle projection (ISO 5456-2). The front view looks at
the finger from its side at -x, with distal to the right and dorsal up.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import chain, pairwise
from typing import ClassVar, Literal, TypeAlias

from fingertip.design.geometry.sizes import ViewName
from fingertip.models.solids import Point3

Point: TypeAlias = tuple[float, float]
Box: TypeAlias = tuple[float, float, float, float]
"""Left, bottom, right and top."""

WIDE_MM = 0.5
NARROW_MM = 0.25
"""Widths of lines (ISO 128-2, line group 0.5)."""
_HEADS_PER_SIZE = 0.718
"""Height of a capital of Helvetica over the size of the font (Adobe's font metrics)."""
_TIP_ANGLE_DEG = 15.0


@dataclass(frozen=True)
class Style:
    name: str
    width_mm: float
    dashes_mm: tuple[float, ...] = ()
    """Lengths of dashes and gaps in turn; empty for a continuous line."""


class Styles:
    EDGE = Style("edge", WIDE_MM)
    HIDDEN = Style("hidden", NARROW_MM, (2.0, 1.0))
    CENTRE = Style("centre", NARROW_MM, (6.0, 1.0, 0.5, 1.0))
    DIMENSION = Style("dimension", NARROW_MM)
    HATCHING = Style("hatching", 0.18)
    FRAME = Style("frame", 0.7)
    GRID = Style("grid", NARROW_MM)


@dataclass(frozen=True)
class Polyline:
    """Polyline, or a line if it has two points.

    Of each primitive, `trace` gives the points of its lines.
    """

    points: tuple[Point, ...]
    style: Style

    def trace(self) -> Iterable[tuple[Point, ...]]:
        return (self.points,)


@dataclass(frozen=True)
class Ring:
    """Circle on paper."""

    centre: Point
    radius: float
    style: Style

    def trace(self) -> Iterable[tuple[Point, ...]]:
        x, y = self.centre
        angles = map(math.radians, range(0, 365, 5))
        points = (
            (x + self.radius * math.cos(angle), y + self.radius * math.sin(angle))
            for angle in angles
        )
        return (tuple(points),)

    def box(self) -> Box:
        x, y = self.centre
        return x - self.radius, y - self.radius, x + self.radius, y + self.radius


@dataclass(frozen=True)
class Arrow:
    tip: Point
    direction_deg: float
    length: float

    def corners(self) -> tuple[Point, Point, Point]:
        """Return the corners, the tip first."""
        x, y = self.tip
        ends = []

        for side in (-0.5, 0.5):
            angle = math.radians(self.direction_deg + 180.0 + side * _TIP_ANGLE_DEG)
            ends.append((x + self.length * math.cos(angle), y + self.length * math.sin(angle)))

        return self.tip, ends[0], ends[1]

    def trace(self) -> Iterable[tuple[Point, ...]]:
        return ((*self.corners(), self.tip),)


@dataclass(frozen=True)
class Text:
    """Line of text in Helvetica."""

    text: str
    at: Point
    """Point on the baseline."""
    height: float
    """Height of a capital."""
    anchor: Literal["start", "middle"] = "start"
    turned: bool = False
    """True if the line runs upwards, to be read from the right."""

    @property
    def size(self) -> float:
        return self.height / _HEADS_PER_SIZE

    @property
    def width(self) -> float:
        return text_width(self.text, self.height)

    @property
    def start(self) -> Point:
        shift = 0.5 * self.width if self.anchor == "middle" else 0.0
        return (self.at[0], self.at[1] - shift) if self.turned else (self.at[0] - shift, self.at[1])

    def box(self) -> Box:
        """Return the box of the line, with its descenders."""
        x, y = self.start
        has_descender = any(character in _BELOW_BASELINE for character in self.text)
        down = _DESCENDER * self.size if has_descender else 0.0
        if self.turned:
            return x - self.height, y, x + down, y + self.width

        return x, y - down, x + self.width, y + self.height

    def trace(self) -> Iterable[tuple[Point, ...]]:
        return ()


@dataclass(frozen=True)
class Hatch:
    """Region filled with parallel lines.

    A ray from a point in it crosses the rings an odd number of times.
    """

    rings: tuple[tuple[Point, ...], ...]
    spacing: float
    angle_deg: float = 45.0
    style: ClassVar = Styles.HATCHING

    def trace(self) -> Iterable[tuple[Point, ...]]:
        return (hatched.points for hatched in self.lines())

    def lines(self) -> Iterator[Polyline]:
        c = math.cos(math.radians(self.angle_deg))
        s = math.sin(math.radians(self.angle_deg))
        rings = [[(x * c + y * s, -x * s + y * c) for x, y in ring] for ring in self.rings]
        edges = [*chain.from_iterable(pairwise((*ring, ring[0])) for ring in rings)]
        heights = [height for (_, height), _ in edges]
        if not heights:
            return

        first = math.ceil(min(heights) / self.spacing)
        last = math.floor(max(heights) / self.spacing)
        for k in range(first, last + 1):
            v = k * self.spacing + 1e-7  # no corner lies exactly on a line
            crossings = sorted(
                a[0] + (v - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
                for a, b in edges
                if (a[1] > v) != (b[1] > v)
            )
            for u0, u1 in zip(crossings[::2], crossings[1::2], strict=False):
                yield Polyline(
                    ((u0 * c - v * s, u0 * s + v * c), (u1 * c - v * s, u1 * s + v * c)), self.style
                )


Primitive: TypeAlias = Polyline | Ring | Arrow | Text | Hatch


@dataclass(frozen=True)
class Sheet:
    name: str
    width: float
    height: float
    primitives: tuple[Primitive, ...]


def line(a: Point, b: Point, style: Style) -> Polyline:
    return Polyline((a, b), style)


def rectangle(
    left: float,
    bottom: float,
    right: float,
    top: float,
    style: Style,
) -> Polyline:
    return Polyline(
        ((left, bottom), (right, bottom), (right, top), (left, top), (left, bottom)), style
    )


def text_width(text: str, height: float) -> float:
    """Compute the width of a line of text in Helvetica."""
    thousandths = sum(_WIDTHS.get(character, _OTHER_WIDTH) for character in text)
    return thousandths / 1000.0 * height / _HEADS_PER_SIZE


_DESCENDER = 0.207
"""Depth of descenders over the size of the font (Adobe's font metrics)."""
_BELOW_BASELINE = "gjpqy,;()/_Q"
_OTHER_WIDTH = 667
_WIDTHS = {
    character: width
    for width, characters in (
        (191, "'"),
        (222, "ijl"),
        (278, " !,./:;I[]\\ft"),
        (333, "()-r`"),
        (355, '"'),
        (400, "°"),
        (469, "^"),
        (500, "Jckxvsyz"),
        (556, "0123456789abdeghnopqu_#$?L–"),
        (584, "+±<=>×~"),
        (611, "FTZ"),
        (667, "ABEKPSVXY&"),
        (722, "CDHNRUw"),
        (778, "GOQØ"),
        (833, "Mm"),
        (889, "%"),
        (944, "W"),
        (1015, "@"),
        (389, "*"),
        (260, "|"),
        (334, "{}"),
    )
    for character in characters
}
"""Width of characters in thousandths of the size of the font (Adobe's metrics of Helvetica)."""

Line2: TypeAlias = tuple[Point, ...]


@dataclass(frozen=True)
class Projection:
    """Directions of a view in the frame of the part: to the right and up on paper."""

    right: Point3
    up: Point3

    @property
    def towards(self) -> Point3:
        """Direction towards the viewer: the cross product of both."""
        a, b, c = self.right
        d, e, f = self.up
        return b * f - c * e, c * d - a * f, a * e - b * d

    def flatten(self, point: Point3) -> Point:
        return sum(map(operator.mul, point, self.right)), sum(map(operator.mul, point, self.up))


PROJECTIONS: dict[ViewName, Projection] = {
    "front": Projection((0.0, 0.0, 1.0), (0.0, 1.0, 0.0)),
    "dorsal": Projection((0.0, 0.0, 1.0), (1.0, 0.0, 0.0)),
    "palmar": Projection((0.0, 0.0, 1.0), (-1.0, 0.0, 0.0)),
    "end": Projection((-1.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
    "section": Projection((0.0, 0.0, 1.0), (0.0, 1.0, 0.0)),
}
"""Views by name; `end` is proximal, `section` the half at x > 0 behind the middle plane."""


@dataclass(frozen=True)
class ProjectedView:
    """Edges of a part in a view [mm], not hidden ones in a section, and the cut outline."""

    visible: tuple[Line2, ...]
    hidden: tuple[Line2, ...]
    cut: tuple[Line2, ...] = ()
    """Closed outlines of the cut faces."""

    def bounds(self) -> Box:
        xs, ys = zip(*chain.from_iterable(self.visible), strict=True)
        return min(xs), min(ys), max(xs), max(ys)
