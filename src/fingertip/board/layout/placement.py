"""Where the parts of a board stand, and its outline [mm]: origin in the upper left corner, y downwards."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from fingertip.board.circuit import Circuit
from fingertip.board.kicad.footprints import FOOTPRINTS, Pad


@dataclass(frozen=True)
class Spot:
    """A part's place: its footprint's origin, and by how much it is turned to the left [degree]."""

    x: float
    y: float
    angle: int = 0


@dataclass(frozen=True)
class Placement:
    """A board's outline and places."""

    width: float
    height: float
    spots: dict[str, Spot]
    names: dict[str, tuple[float, float]]
    """Reference -> middle of its print."""
    words: tuple[tuple[str, float, float], ...] = ()
    """Words printed on the board, with their middle; beside the connectors, what their pins carry."""


@dataclass(frozen=True)
class PlacedPad:
    """A pad on the board."""

    reference: str
    pad: Pad
    x: float
    y: float
    half_width: float
    half_height: float
    net: str
    """Empty for a hole, or a pin of no net."""


def turned(angle: int, x: float, y: float) -> tuple[float, float]:
    """An offset within a footprint as an offset on the board."""
    return {0: (x, y), 90: (y, -x), 180: (-x, -y), 270: (-y, x)}[angle]


def placed_pads(circuit: Circuit, placement: Placement) -> Iterator[PlacedPad]:
    """Every pad of the board."""
    nets = {node: net.name for net in circuit.nets for node in net.nodes}
    for part in circuit.parts:
        spot = placement.spots[part.reference]
        for pad in FOOTPRINTS[part.footprint].pads:
            dx, dy = turned(spot.angle, pad.x, pad.y)
            w, h = (pad.width, pad.height) if spot.angle % 180 == 0 else (pad.height, pad.width)
            yield PlacedPad(
                part.reference, pad, spot.x + dx, spot.y + dy, w / 2, h / 2, nets.get((part.reference, pad.number), "")
            )


def crowded(circuit: Circuit, placement: Placement) -> Iterator[tuple[str, str]]:
    """Pairs of parts whose courtyards overlap, and parts with the edge ("edge") beyond which they stick out."""
    boxes = {}
    for part in circuit.parts:
        spot = placement.spots[part.reference]
        left, top, right, bottom = FOOTPRINTS[part.footprint].courtyard
        corners = [turned(spot.angle, x, y) for x in (left, right) for y in (top, bottom)]
        xs, ys = [spot.x + x for x, _ in corners], [spot.y + y for _, y in corners]
        boxes[part.reference] = (min(xs), min(ys), max(xs), max(ys))
    references = list(boxes)
    for i, one in enumerate(references):
        a = boxes[one]
        if a[0] < 0 or a[1] < 0 or a[2] > placement.width or a[3] > placement.height:
            yield one, "edge"
        for other in references[:i]:
            b = boxes[other]
            if min(a[2], b[2]) - max(a[0], b[0]) > 1e-9 and min(a[3], b[3]) - max(a[1], b[1]) > 1e-9:
                if one[0] == "H" or other[0] == "H":  # a hole's courtyard is round
                    hole, box = (a, b) if one[0] == "H" else (b, a)
                    x, y = (hole[0] + hole[2]) / 2, (hole[1] + hole[3]) / 2
                    nearest = (min(max(x, box[0]), box[2]), min(max(y, box[1]), box[3]))
                    if math.dist((x, y), nearest) >= (hole[2] - hole[0]) / 2:
                        continue
                yield one, other
