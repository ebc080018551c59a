"""Silkscreen on the front of a board as boxes [mm]: what a label may not cover, and whose label it reads as.

Connectors, amplifiers, diodes, transistors, test points and trimmers always have their reference on the front;
resistors and capacitors have it where there is room. The list on the back (`back_print.py`) names them all.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

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
from fingertip.board.kicad.placement import Label, Placement, list_fiducials, place_box, place_pads, rotate_offset
from fingertip.board.parts.circuit import (
    Circuit,
    Component,
    format_component_value,
    parse_component_value,
    reference_sort_key,
)
from fingertip.foundation.errors import BoardError

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


# Print on the back of a board: its name, and a list of the values of resistors, capacitors and the trimmer.
#
# The front has no room for all references at a legible height, so whoever solders or repairs a board reads here what
# belongs where.

_LISTED = ("C", "R", "RV")
"""Letters of the references in the list."""
_DIGITS = 3
"""Significant digits of a printed value."""
_EDGE_MM = 0.6
_STEP_MM = 0.5
_ROW_MM, _FIRST_ROW_MM = 1.45, 1.7
"""Distance of rows, and that below the first, whose letters may reach down."""
_COLUMN_GAP_MM, _GAP_MM = 0.6, 0.59
"""Clearance of columns, and of texts on one line, which is smaller by a rounding error."""


@dataclass(frozen=True)
class BackText:
    """Text on the back: the middle of its left end as seen from the back, in the coordinates of the front [mm]."""

    text: str
    x: float
    y: float

    @property
    def box(self) -> Box:
        """Box of the text in the coordinates of the front, where it extends to the left."""
        return text_box(self.text, self.x - text_size(self.text)[0] / 2, self.y)


def back_print(circuit: Circuit, placement: Placement, heading: Sequence[str] = ()) -> list[BackText]:
    """Texts on the back: the lines of the heading above the list of values, clear of holes and pins.

    Raises BoardError.
    """
    obstacles = list(_obstacles(circuit, placement))
    top = _EDGE_MM + text_size("")[1] / 2
    rows = [top, *(top + _FIRST_ROW_MM + _ROW_MM * i for i in range(int(placement.height / _ROW_MM)))]
    starts = [placement.width - _EDGE_MM - _STEP_MM * i for i in range(int(placement.width / _STEP_MM))]
    texts: list[BackText] = []
    for line in heading:
        places = (BackText(line, x, y) for y in rows for x in starts)
        texts += filter(None, [_first_free(places, texts, obstacles, placement)])
    entries = list_values(circuit)
    column = max(text_size(entry)[0] for entry in entries) + _COLUMN_GAP_MM
    # Pins at the edge may cut the first column off, so the columns begin where all values have room.
    for start in starts:
        listed = list(texts)
        slots = ((x, y) for x in _columns(start, column) for y in rows)
        for entry in entries:
            place = _first_free((BackText(entry, x, y) for x, y in slots), texts, obstacles, placement)
            listed += [place] if place else []
        if len(listed) == len(heading) + len(entries):
            return listed
    raise BoardError("the back of the board has no room for the list of values; enlarge the board's outline.")


def _columns(start: float, width: float) -> list[float]:
    return [start - width * i for i in range(int(start / width) + 1)]


def list_values(circuit: Circuit) -> list[str]:
    """List resistors, capacitors and trimmer by reference and value, such as "R4 1.5k"."""
    listed = (c for c in circuit.components if c.reference.rstrip("0123456789") in _LISTED)
    return [f"{c.reference} {_short_value(c.value)}" for c in sorted(listed, key=reference_sort_key)]


def _short_value(value: str) -> str:
    return format_component_value(float(f"{parse_component_value(value):.{_DIGITS}g}"))


def _obstacles(circuit: Circuit, placement: Placement) -> Iterator[Box]:
    """Yield the boxes of the pins that come through, and of the screws' heads."""
    for pad in place_pads(circuit, placement):
        if pad.pad.drill:
            x, y = pad.half_width + SILK_CLEARANCE_MM, pad.half_height + SILK_CLEARANCE_MM
            yield (pad.x - x, pad.y - y, pad.x + x, pad.y + y)
    for component in circuit.components:
        if not component.symbol.pins:
            yield place_box(placement.positions[component.reference], FOOTPRINTS[component.footprint].courtyard)


def _first_free(
    places: Iterator[BackText], texts: Sequence[BackText], obstacles: Sequence[Box], placement: Placement
) -> BackText | None:
    for place in places:
        left, top, right, bottom = place.box
        is_inside = min(left, top, placement.width - right, placement.height - bottom) >= _EDGE_MM - 1e-9
        printed = (text.box for text in texts)
        taken = [*obstacles, *((b[0] - _GAP_MM, b[1], b[2] + _GAP_MM, b[3]) for b in printed)]
        if is_inside and not any(left < b[2] and b[0] < right and top < b[3] and b[1] < bottom for b in taken):
            return place
    return None
