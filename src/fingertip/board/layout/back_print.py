"""Print on the back of a board: its name, and a list of the values of resistors, capacitors and the trimmer.

The front has no room for all references at a legible height, so whoever solders or repairs a board reads here what
belongs where.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from fingertip.board.circuit import (
    Circuit,
    format_component_value,
    parse_component_value,
    reference_sort_key,
)
from fingertip.board.kicad.footprints import FOOTPRINTS, SILK_CLEARANCE_MM, Box
from fingertip.board.layout.placement import Placement, place_box, place_pads
from fingertip.board.layout.silkscreen import text_box, text_size
from fingertip.errors import BoardError

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

    Raises
    ------
    BoardError
        If there is no room for all of them.
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
