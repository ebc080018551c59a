"""Print on the back of a board: the values of resistors, capacitors and the trimmer.

The front has no room for all references at a legible height, so whoever solders or repairs a board
reads here what belongs where.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from fingertip.board.circuits.channels import split_name
from fingertip.board.kicad.placement import Box, Placement, PrintedText
from fingertip.board.kicad.sexpr import Node, Span, find_word, first, number, quote
from fingertip.board.parts.circuit import (
    Circuit,
    format_component_value,
    parse_component_value,
    reference_sort_key,
)
from fingertip.foundation.errors import BoardError

_LISTED = ("C", "R", "RV")
_DIGITS = 3
"""Letters of the references in the list, and significant digits of their values."""
_EDGE_MM = 0.6
_STEP_MM = 0.5
_ROW_MM = 1.45
_FIRST_ROW_MM = 1.7
"""Distance of rows, and that below the first, whose letters may reach down."""
_COLUMN_GAP_MM = 0.6
_GAP_MM = 0.59
"""Clearance of columns, and of texts on one line, which is smaller by a rounding error."""
_PAD_CLEARANCE_MM = 0.15
"""Least distance of silkscreen from pads: the usual minimum of board houses."""

_TEXT_HEIGHT_MM = 1.0
"""Height of a printed capital letter: the usual minimum of board houses."""
_ADVANCE_RATIO = 0.92
"""Width of a character over the text height, averaged over the words printed here."""
_LINE_RATIO = 1.25
"""Height of a line of text, with the width of its strokes, relative to the text height."""
_DESCENT_RATIO = 0.3
"""Length of the parts of letters below that, relative to the text height."""
_DESCENDING = frozenset("gjpqy,")
_CENTRING_MM = 0.045
"""Distance by which KiCad must print a text lower, so that its strokes are inside its box. KiCad
centres a line of text with more room below than above; only Q reaches down there, and is not
printed here.
"""


def print_values(
    layout: str, board: Node, circuit: Circuit, placement: Placement
) -> dict[Span, str]:
    """Change the values printed on the back of a layout, and their places, to a circuit's.

    Raises BoardError.
    """
    texts = {item.text.partition(" ")[0]: item for item in list_back_texts(circuit, placement)}
    changes: dict[Span, str] = {}

    for printed in board.children("gr_text"):
        reference, _, value = printed.words[1].partition(" ")
        item = texts.pop(reference, None) if value else None
        if item:
            x = placement.corner[0] + item.x
            y = placement.corner[1] + item.y + _CENTRING_MM
            place = first(printed, "at")
            changes[find_word(layout, printed, 1)] = quote(item.text)
            changes[place.start, place.end] = f"(at {number(x)} {number(y)} 0)"

    if texts:
        raise BoardError(
            f"the layout prints no value of {', '.join(texts)} on its back; add a text there in "
            "KiCad."
        )

    return changes


def list_back_texts(circuit: Circuit, placement: Placement) -> list[PrintedText]:
    """List the printed values with their places, clear of holes, pins and the other texts.

    Raises BoardError.
    """
    entries = list_values(circuit)
    obstacles = [*_list_obstacles(placement), *_list_other_texts(placement, entries)]
    top = _EDGE_MM + _TEXT_HEIGHT_MM * _LINE_RATIO / 2
    rows = [
        top,
        *(top + _FIRST_ROW_MM + _ROW_MM * i for i in range(int(placement.height / _ROW_MM))),
    ]
    column = max(map(_text_width, entries)) + _COLUMN_GAP_MM

    # Pins at the edge may cut the first column off, so the columns begin where all values have
    # room.
    for i in range(int(placement.width / _STEP_MM)):
        start = placement.width - _EDGE_MM - _STEP_MM * i
        columns = [start - column * k for k in range(int(start / column) + 1)]
        slots = itertools.product(columns, rows)
        texts = []
        for entry in entries:
            # Each entry goes on from the slot of the one before it.
            candidates = (PrintedText(entry, x, y) for x, y in slots)
            text = _first_free(candidates, obstacles, placement)
            if text:
                texts.append(text)

        if len(texts) == len(entries):
            return texts

    raise BoardError(
        "the back of the board has no room for the list of values; enlarge the board's outline."
    )


def _list_other_texts(placement: Placement, entries: Sequence[str]) -> Iterator[Box]:
    """Yield the boxes of the printed texts outside the list of values, with their clearance."""
    references = {entry.partition(" ")[0] for entry in entries}
    for text in placement.back:
        if text.text.partition(" ")[0] not in references:
            box = find_text_box(PrintedText(text.text, text.x, text.y - _CENTRING_MM))
            yield (box[0] - _GAP_MM, box[1], box[2] + _GAP_MM, box[3])


def list_values(circuit: Circuit) -> list[str]:
    """List resistors, capacitors and trimmer, such as "R4 1.5k"; equal channels once."""
    parts = []
    for part in circuit.components:
        channel, own = split_name(part.reference)
        if part.reference.rstrip("0123456789") in _LISTED and channel < 2:
            parts.append(replace(part, reference=own))

    values = {
        part.reference: parse_component_value(part.value)
        for part in sorted(parts, key=reference_sort_key)
    }

    return [
        f"{name} {format_component_value(float(f'{value:.{_DIGITS}g}'))}"
        for name, value in values.items()
    ]


def find_text_box(item: PrintedText) -> Box:
    """Return the box of a text seen from the front, where it extends to the left."""
    half = _TEXT_HEIGHT_MM * _LINE_RATIO / 2
    descent = _TEXT_HEIGHT_MM * _DESCENT_RATIO if _DESCENDING & set(item.text) else 0.0
    return (item.x - _text_width(item.text), item.y - half, item.x, item.y + half + descent)


def _text_width(text: str) -> float:
    return len(text) * _TEXT_HEIGHT_MM * _ADVANCE_RATIO


def _list_obstacles(placement: Placement) -> Iterator[Box]:
    """Yield the boxes of the pins that come through, and of the screws' heads."""
    gap = _PAD_CLEARANCE_MM
    for part in placement.parts.values():
        for pad in part.pads:
            x, y = pad.centre
            left, top, right, bottom = pad.box
            radius = part.courtyard_radius
            if not pad.is_plated:
                yield (x - radius, y - radius, x + radius, y + radius)
            elif pad.drill:
                yield (left - gap, top - gap, right + gap, bottom + gap)


def _first_free(
    places: Iterable[PrintedText], obstacles: Sequence[Box], placement: Placement
) -> PrintedText | None:
    """Return the first of these texts that lies on the board and overlaps no obstacle."""
    for place in places:
        left, top, right, bottom = find_text_box(place)
        is_inside = (
            min(left, top, placement.width - right, placement.height - bottom) >= _EDGE_MM - 1e-9
        )
        if is_inside and not any(
            left < box[2] and box[0] < right and top < box[3] and box[1] < bottom
            for box in obstacles
        ):
            return place

    return None
