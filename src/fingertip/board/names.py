"""Where references are printed on a board: beside their part, clear of parts, vias, other words and the edge [mm]."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from fingertip.board.circuit import Circuit
from fingertip.board.footprints import FOOTPRINTS
from fingertip.board.placement import Placement, turned

Point = tuple[float, float]
Box = tuple[float, float, float, float]

SIZE_MM = 0.8
"""Height of a capital; the usual least for a legible print."""
_ADVANCE = 0.92
"""Width of a character over its height, the widest of them."""
_GAP_MM = 0.1
_EDGE_MM = 0.3


def name_places(circuit: Circuit, placement: Placement, vias: Iterable[Point], via_mm: float) -> dict[str, Point]:
    """Reference -> middle of its print, for every bought part and test point that has room for it.

    The nearest free place wins: above, below, right, left, then the same shifted sideways. Parts are taken in the
    order of the circuit, so the same board always gives the same places.
    """
    taken = [_box_of(circuit, placement, part.reference) for part in circuit.parts]
    taken += [_box(x, y, via_mm, via_mm) for x, y in vias]
    taken += [_box(x, y, *_extent(words)) for words, x, y in placement.words]
    found: dict[str, Point] = {}
    for part in circuit.parts:
        if not part.symbol.pins:
            continue
        own = _box_of(circuit, placement, part.reference)
        width, height = _extent(part.reference)
        for x, y in _candidates(own, width, height):
            box = _box(x, y, width, height)
            inside = (
                box[0] >= _EDGE_MM
                and box[1] >= _EDGE_MM
                and box[2] <= placement.width - _EDGE_MM
                and box[3] <= placement.height - _EDGE_MM
            )
            if inside and not any(_overlap(box, other) for other in taken):
                found[part.reference] = (round(x, 3), round(y, 3))
                taken.append(box)
                break
    return found


def _extent(words: str) -> Point:
    return (len(words) * SIZE_MM * _ADVANCE, SIZE_MM * 1.25)


def _box(x: float, y: float, width: float, height: float) -> Box:
    return (x - width / 2, y - height / 2, x + width / 2, y + height / 2)


def _box_of(circuit: Circuit, placement: Placement, reference: str) -> Box:
    """Pads, print and body of a part on the board."""
    shape = FOOTPRINTS[circuit.part(reference).footprint]
    spot = placement.spots[reference]
    points = [(p.x + sx * p.width / 2, p.y + sy * p.height / 2) for p in shape.pads for sx in (-1, 1) for sy in (-1, 1)]
    points += [(x, y) for line in shape.silk for x, y in line]
    points += [(x, y) for x in shape.body[::2] for y in shape.body[1::2]]
    xs, ys = zip(*(turned(spot.angle, x, y) for x, y in points), strict=True)
    return (spot.x + min(xs) - 0.1, spot.y + min(ys) - 0.1, spot.x + max(xs) + 0.1, spot.y + max(ys) + 0.1)


def _candidates(own: Box, width: float, height: float) -> Iterator[Point]:
    x, y = (own[0] + own[2]) / 2, (own[1] + own[3]) / 2
    above, below = own[1] - height / 2 - _GAP_MM, own[3] + height / 2 + _GAP_MM
    left, right = own[0] - width / 2 - _GAP_MM, own[2] + width / 2 + _GAP_MM
    yield from ((x, above), (x, below), (right, y), (left, y))
    # Never so far that another part would be nearer.
    for shift in (0.3, 0.6, 0.9, 1.2):
        yield from ((x - shift, above), (x + shift, above), (x - shift, below), (x + shift, below))
        if shift < 0.5:
            yield from ((right, y - shift), (right, y + shift), (left, y - shift), (left, y + shift))


def _overlap(a: Box, b: Box) -> bool:
    return min(a[2], b[2]) > max(a[0], b[0]) and min(a[3], b[3]) > max(a[1], b[1])
