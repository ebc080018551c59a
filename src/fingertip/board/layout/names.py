"""What is printed on a board, as boxes [mm]: references and words must stay clear of parts, vias and each other."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import combinations

from fingertip.board.circuit import Circuit, Part
from fingertip.board.kicad.footprints import DOT_MM, FOOTPRINTS
from fingertip.board.layout.placement import Placement, turned

Point = tuple[float, float]
Box = tuple[float, float, float, float]
"""Left, top, right, bottom."""

SIZE_MM = 0.8
"""Height of a capital; the usual least for a legible print."""
_ADVANCE = 0.92
"""Width of a character over its height, the widest of them."""
_EDGE_MM = 0.3
_APART_MM = 0.25
"""Between two names side by side."""


def printed(placement: Placement) -> dict[str, Box]:
    """Each printed reference, and each word with its number ("word 1"), as a box."""
    boxes = {reference: _box(x, y, *_extent(reference)) for reference, (x, y) in placement.names.items()}
    boxes |= {f"word {i}": _box(x, y, *_extent(w)) for i, (w, x, y) in enumerate(placement.words, start=1)}
    return boxes


def obscured(circuit: Circuit, placement: Placement, vias: Iterable[Point] = (), via_mm: float = 0.0) -> Iterator[str]:
    """What of the print cannot be read, as sentences: missing names, overlaps with parts, vias, print, the edge."""
    named = [part.reference for part in circuit.parts if part.symbol.pins]
    yield from (f"{reference} has no name on the board" for reference in named if reference not in placement.names)
    boxes = printed(placement)
    things = {f"part {part.reference}": _part_box(circuit, placement, part.reference) for part in circuit.parts}
    things |= {f"the dot of {part.reference}": box for part in circuit.parts for box in _dot(placement, part)}
    things |= {f"via {i}": _box(x, y, via_mm, via_mm) for i, (x, y) in enumerate(vias, start=1)}
    for name, box in boxes.items():
        left, top, right, bottom = box
        gap = min(left, top, placement.width - right, placement.height - bottom)
        # Beside J3 a single letter may come nearer to the edge.
        if gap < (0.15 if name.startswith("word") else _EDGE_MM):
            yield f"{name} lies at the edge"
        yield from (f"{name} lies on {other}" for other, taken in things.items() if _overlap(box, taken))
    for (one, a), (two, b) in combinations(boxes.items(), 2):
        if _overlap((a[0] - _APART_MM, a[1], a[2] + _APART_MM, a[3]), b):
            yield f"{one} lies on {two}, or too near to it to be told apart"


def _extent(words: str) -> Point:
    return (len(words) * SIZE_MM * _ADVANCE, SIZE_MM * 1.25)


def _box(x: float, y: float, width: float, height: float) -> Box:
    return (x - width / 2, y - height / 2, x + width / 2, y + height / 2)


def _part_box(circuit: Circuit, placement: Placement, reference: str) -> Box:
    """Pads, print and body of a part on the board."""
    shape = FOOTPRINTS[circuit.part(reference).footprint]
    spot = placement.spots[reference]
    points = [(p.x + sx * p.width / 2, p.y + sy * p.height / 2) for p in shape.pads for sx in (-1, 1) for sy in (-1, 1)]
    points += [(x, y) for line in shape.silk for x, y in line]
    points += [(x, y) for x in shape.body[::2] for y in shape.body[1::2]]
    xs, ys = zip(*(turned(spot.angle, x, y) for x, y in points), strict=True)
    return (spot.x + min(xs) - 0.1, spot.y + min(ys) - 0.1, spot.x + max(xs) + 0.1, spot.y + max(ys) + 0.1)


def _dot(placement: Placement, part: Part) -> Iterator[Box]:
    """The dot beside pin 1, of a part that has one."""
    if middle := FOOTPRINTS[part.footprint].dot:
        spot = placement.spots[part.reference]
        x, y = turned(spot.angle, *middle)
        yield _box(spot.x + x, spot.y + y, DOT_MM + 0.2, DOT_MM + 0.2)


def _overlap(a: Box, b: Box) -> bool:
    return min(a[2], b[2]) > max(a[0], b[0]) and min(a[3], b[3]) > max(a[1], b[1])
