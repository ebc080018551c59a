"""A sheet of a schematic as data: where symbols stand and where wires run. Lengths in units of 1.27 mm, y downwards."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

UNIT_MM = 1.27
"""Half of the grid that KiCad's pins lie on."""

Point = tuple[float, float]
Segment = tuple[Point, Point]


@dataclass(frozen=True)
class Placed:
    """A part's symbol, or one unit of it, on the sheet."""

    reference: str
    x: int
    y: int
    angle: int = 0
    """Turned to the left by this [degree]: 0, 90, 180, 270."""
    unit: int = 1
    mirrored: bool = False
    """Left and right exchanged; only for angle 0."""


@dataclass(frozen=True)
class Mark:
    """A power symbol (GND, VCC, VEE) or a PWR_FLAG."""

    name: str
    x: int
    y: int
    angle: int = 0


@dataclass(frozen=True)
class Label:
    """A net's name on a wire; angle 180 writes to the left of the point."""

    net: str
    x: int
    y: int
    angle: int = 0


@dataclass(frozen=True)
class Sheet:
    """One sheet."""

    placed: tuple[Placed, ...]
    wires: tuple[tuple[Point, ...], ...]
    """Runs of straight, upright or level pieces."""
    marks: tuple[Mark, ...]
    labels: tuple[Label, ...]
    words: tuple[tuple[str, int, int], ...]

    def segments(self, pins: Iterable[Point]) -> list[Segment]:
        """The wires' pieces, cut wherever another wire ends or a pin lies on them: there KiCad wants an end."""
        pieces = [(a, b) for run in self.wires for a, b in pairwise(run) if a != b]
        cuts = {point for piece in pieces for point in piece} | set(pins)
        cuts |= {(mark.x, mark.y) for mark in self.marks}
        found: list[Segment] = []
        for a, b in pieces:
            inside = sorted((c for c in cuts if _between(a, c, b)), key=lambda c: abs(c[0] - a[0]) + abs(c[1] - a[1]))
            chain = [a, *inside, b]
            found += list(pairwise(chain))
        return found


def _between(a: Point, c: Point, b: Point) -> bool:
    """Whether c lies inside the upright or level piece from a to b."""
    if a[0] == b[0] == c[0]:
        return min(a[1], b[1]) < c[1] < max(a[1], b[1])
    return a[1] == b[1] == c[1] and min(a[0], b[0]) < c[0] < max(a[0], b[0])
