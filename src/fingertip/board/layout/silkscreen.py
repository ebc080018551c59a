"""Silkscreen on the front of a board as boxes [mm]: what a label may not cover, and whose label it reads as.

Connectors, amplifiers, diodes, transistors, test points and trimmers always have their reference on the front;
resistors and capacitors have it where there is room. The list on the back (`back_print.py`) names them all.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from itertools import combinations

from fingertip.board.circuit import Circuit, Component
from fingertip.board.kicad.footprints import (
    FIDUCIAL,
    FOOTPRINTS,
    PIN_1_DOT_MM,
    SILK_CLEARANCE_MM,
    SILK_LINE_MM,
    TEXT_HEIGHT_MM,
    Box,
    Footprint,
    Point,
)
from fingertip.board.layout.placement import Label, Placement, list_fiducials, place_box, rotate_offset

LABEL_CLEARANCE_MM = 0.25
"""Clearance between two labels side by side."""
_ADVANCE_RATIO = 0.92
"""Width of a character relative to the text height, averaged over any word of KiCad's font that is printed here."""
_LINE_RATIO = 1.25
"""Height of a line of text, with the width of its strokes, relative to the text height."""
_DESCENT_RATIO = 0.3
"""Length of the parts of letters below that, relative to the text height."""
_DESCENDING = frozenset("gjpqy,")
EDGE_CLEARANCE_MM = 0.3
"""Clearance of references from the edge."""
_TEXT_EDGE_CLEARANCE_MM = 0.15
"""Clearance of texts from the edge. It is smaller because single letters must fit beside J3."""
_NEARER_MM = 0.03
"""Least difference between the distances of a label from its own component and from any other."""
_UNLABELLED = ("R", "C")
"""Letters of the references that may be missing on the front."""


def needs_label(component: Component) -> bool:
    """Return whether the front must show a component's reference."""
    return bool(component.symbol.pins) and component.reference.rstrip("0123456789") not in _UNLABELLED


def text_size(text: str, angle: int = 0) -> Point:
    """Width and height of a text on the board [mm] that is rotated by an angle [degree]."""
    width, height = len(text) * TEXT_HEIGHT_MM * _ADVANCE_RATIO, TEXT_HEIGHT_MM * _LINE_RATIO
    return (width, height) if angle % 180 == 0 else (height, width)


def text_box(text: str, x: float, y: float, angle: int = 0) -> Box:
    """Box of a text around its centre; one that lies extends further down if it has letters such as y."""
    left, top, right, bottom = _box(x, y, *text_size(text, angle))
    return (left, top, right, bottom + (TEXT_HEIGHT_MM * _DESCENT_RATIO if _DESCENDING & set(text) else 0.0))


def centring_shift(text: str) -> float:
    """Distance by which KiCad must print a text lower, so that its strokes are inside its box [mm]."""
    return 0.0 if "Q" in text else TEXT_HEIGHT_MM * _CENTRING_RATIO


_CENTRING_RATIO = 0.045
"""KiCad centres a line of text with more room below than above; only Q reaches down there."""


def label_places(reference: str, area: Box) -> list[tuple[float, float, int]]:
    """List places of a label around the area of its component: centre, and angle of text that lies or stands."""
    m = _PLACE_GAP_MM
    left, top, right, bottom = area[0] - m, area[1] - m, area[2] + m, area[3] + m
    places = set()
    for angle in (0, 90):
        w, h = text_size(reference, angle)
        for x in _slide(left + w / 2, right - w / 2):
            places |= {(x, top - h / 2, angle), (x, bottom + h / 2, angle)}
        for y in _slide(top + h / 2, bottom - h / 2):
            places |= {(left - w / 2, y, angle), (right + w / 2, y, angle)}
    return sorted(places)


def _slide(first: float, last: float) -> list[float]:
    """Places along one side: both ends, and others between them at equal distances of some millimetres."""
    count = max(2, math.ceil(abs(last - first) / _SLIDE_MM))
    return [first + (last - first) * i / count for i in range(count + 1)]


_SLIDE_MM = 1.5
_PLACE_GAP_MM = 0.01
"""Distance of a label from the area of its component, for the rounding of KiCad's polygons."""


def label_box(reference: str, label: Label) -> Box:
    """Box of a printed reference."""
    return text_box(reference, label.x, label.y, label.angle)


def silkscreen_boxes(placement: Placement) -> dict[str, Box]:
    """Boxes of the printed references, by reference, and of the texts, by number ("text 1")."""
    boxes = {reference: label_box(reference, label) for reference, label in placement.reference_labels.items()}
    boxes |= {f"text {i}": text_box(t, x, y) for i, (t, x, y) in enumerate(placement.texts, start=1)}
    return boxes


def print_area(footprint: Footprint) -> Box:
    """Box around the pads, the silkscreen lines and the body of a footprint, and what a label keeps from them."""
    points = [
        (p.x + sx * (p.width / 2 + p.mask_margin), p.y + sy * (p.height / 2 + p.mask_margin))
        for p in footprint.pads
        for sx in (-1, 1)
        for sy in (-1, 1)
    ]
    points += [(x + s, y + s) for line in footprint.silkscreen for x, y in line for s in (-_HALF_LINE, _HALF_LINE)]
    points += [(x, y) for x in footprint.body[::2] for y in footprint.body[1::2]]
    xs, ys = zip(*points, strict=True)
    c = SILK_CLEARANCE_MM
    return (min(xs) - c, min(ys) - c, max(xs) + c, max(ys) + c)


_HALF_LINE = SILK_LINE_MM / 2


def silkscreen_obstacles(circuit: Circuit, placement: Placement) -> dict[str, Box]:
    """Boxes that labels may not cover: components and fiducial marks by name, and the dots beside pins 1."""
    footprints = {c.reference: (placement.positions[c.reference], FOOTPRINTS[c.footprint]) for c in circuit.components}
    footprints |= {name: (place, FOOTPRINTS[FIDUCIAL]) for name, place in list_fiducials(placement).items()}
    obstacles = {name: place_box(place, print_area(footprint)) for name, (place, footprint) in footprints.items()}
    side = PIN_1_DOT_MM + 2 * SILK_CLEARANCE_MM
    for name, (place, footprint) in footprints.items():
        if footprint.pin_1_dot:
            x, y = rotate_offset(place.angle, *footprint.pin_1_dot)
            obstacles[f"the pin 1 dot of {name}"] = _box(place.x + x, place.y + y, side, side)
    return obstacles


def silkscreen_conflicts(
    circuit: Circuit, placement: Placement, vias: Iterable[Point] = (), via_mm: float = 0.0
) -> Iterator[str]:
    """Describe silkscreen that cannot be read or misleads.

    References are missing, labels overlap something or the edge, or are nearer to another component than to their own.
    """
    required = [component.reference for component in circuit.components if needs_label(component)]
    yield from (f"{ref} has no label on the board" for ref in required if ref not in placement.reference_labels)
    labels, obstacles = silkscreen_boxes(placement), silkscreen_obstacles(circuit, placement)
    for name, box in labels.items():
        left, top, right, bottom = box
        gap = min(left, top, placement.width - right, placement.height - bottom)
        if gap < (_TEXT_EDGE_CLEARANCE_MM if name.startswith("text") else EDGE_CLEARANCE_MM) - 1e-9:
            yield f"{name} is too close to the edge"
        yield from (f"{name} overlaps {other}" for other, obstacle in obstacles.items() if _overlap(box, obstacle))
        for i, (x, y) in enumerate(vias, start=1):
            if _overlap(box, _box(x, y, via_mm, via_mm)):
                yield f"{name} overlaps via {i}"
        if name in obstacles:
            own = box_distance(box, obstacles[name])
            for component in circuit.components:
                other = component.reference
                if other != name and component.symbol.pins and box_distance(box, obstacles[other]) < own + _NEARER_MM:
                    yield f"{name} is not nearer to its component than to {other}"
    for (one, a), (two, b) in combinations(labels.items(), 2):
        if _overlap((a[0] - LABEL_CLEARANCE_MM, a[1], a[2] + LABEL_CLEARANCE_MM, a[3]), b):
            yield f"{one} overlaps or nearly touches {two}"


def box_distance(a: Box, b: Box) -> float:
    """Distance between two boxes; 0 where they overlap."""
    return math.hypot(max(a[0] - b[2], b[0] - a[2], 0.0), max(a[1] - b[3], b[1] - a[3], 0.0))


def _box(x: float, y: float, width: float, height: float) -> Box:
    return (x - width / 2, y - height / 2, x + width / 2, y + height / 2)


def _overlap(a: Box, b: Box) -> bool:
    return min(a[2], b[2]) > max(a[0], b[0]) + 1e-9 and min(a[3], b[3]) > max(a[1], b[1]) + 1e-9
