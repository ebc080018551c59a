"""A sheet of a schematic as data: where symbols stand and where wires run. Lengths in units of 1.27 mm, y downwards."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import pairwise

from fingertip.board.nets import VEE, VMID
from fingertip.board.supplies import Supply

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
    """A power symbol (GND, VCC, VEE), a PWR_FLAG, or what `supplied` makes one of (ZERO, MINUS)."""

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
class GlobalLabel:
    """A net's name in a flag that points this way [degree]: the same net on all sheets, and at every such flag."""

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
    globals: tuple[GlobalLabel, ...] = ()

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


def supplied(sheet: Sheet, supply: Supply) -> Sheet:
    """The sheet with the supply's own symbols and flags for ZERO and MINUS.

    Where ZERO is a flag it hangs down, points up for a mark turned by 180 degrees, and to the right for 90.
    """
    marks, flags = [], list(sheet.globals)
    for mark in sheet.marks:
        net = {"ZERO": supply.zero, "MINUS": supply.minus}.get(mark.name, mark.name)
        if net == VMID:
            flags.append(GlobalLabel(net, mark.x, mark.y, {0: 270, 90: 0, 180: 90}[mark.angle]))
        elif mark.name == "MINUS":
            marks.append(Mark(net, mark.x, mark.y, 180 if net == VEE else 0))
        else:
            marks.append(replace(mark, name=net, angle=0 if mark.angle == 90 else mark.angle))
    return replace(sheet, marks=tuple(marks), globals=tuple(flags))


def _between(a: Point, c: Point, b: Point) -> bool:
    """Whether c lies inside the upright or level piece from a to b."""
    if a[0] == b[0] == c[0]:
        return min(a[1], b[1]) < c[1] < max(a[1], b[1])
    return a[1] == b[1] == c[1] and min(a[0], b[0]) < c[0] < max(a[0], b[0])
