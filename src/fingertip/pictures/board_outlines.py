"""Parts on the assembly drawing of a board: outline, pads, polarity, reference and value."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from fingertip.board.kicad.placement import Pad, PlacedPart
from fingertip.board.parts.circuit import Component
from fingertip.pictures.board_part_list import describe_value, is_chip
from fingertip.pictures.board_sheet import SCALE, BoardOnSheet, SheetBox
from fingertip.pictures.drawing.primitives import (
    Point,
    Primitive,
    Ring,
    Style,
    Text,
    line,
    text_width,
)

_PART = Style("part", 0.2)
"""Line around a part's body."""
_PAD = Style("pad", 0.1)
"""Line around pads and holes."""
_BAR = Style("bar", 0.9)
"""Line at the cathode of a diode."""
_DOT = Style("dot", 0.25)
"""Line of the dot at pin 1."""
_DOT_RADII_MM = (0.15, 0.4)
"""Radii of the rings that make up a dot."""
_DOT_INSET_MM = 1.0
"""Distance of a dot from the edges of a part, where the part is large enough."""
_DOT_INSET_SHARE = 6.0
"""Length of a small part's edge over the distance of its dot from the next edge."""
_MAX_CAPITAL_MM = 2.2
"""Largest height of the capitals on a part."""
_MIN_CAPITAL_MM = 1.2
"""Smallest height of the capitals on a part that has a value."""
_GAP = 0.35
"""Gap between two lines of text, and beside them, in units of a capital's height."""


def draw_part(part: Component, placed: PlacedPart, board: BoardOnSheet) -> Iterator[Primitive]:
    """Draw a part in its place: which it is, which value it has, and which way round it goes."""
    yield from _draw_holes(part, placed, board)
    if placed.body is None:
        return

    body = board.place(placed.body)
    if _is_test_point(part):
        yield from _write(body, part.reference, "")
        return

    yield body.outline(_PART)
    if not is_chip(part):
        yield from _draw_uncovered_pads(placed.pads, body, board)
        yield from _draw_polarity(part, placed.pads, body, board)

    room = _left_of_holes(placed.pads, body, board)
    yield from _write(room, part.reference, describe_value(part))


def _is_test_point(part: Component) -> bool:
    """Return whether a part is a test point, which is a round pad alone."""
    return part.reference.startswith("TP")


def _draw_holes(part: Component, placed: PlacedPart, board: BoardOnSheet) -> Iterator[Primitive]:
    """Draw the holes of a part, and the round pad of a test point."""
    for pad in placed.pads:
        diameter = pad.drill
        if not diameter and _is_test_point(part):
            diameter = pad.width

        if diameter:
            yield Ring(board.place(pad.box).middle, SCALE * diameter / 2.0, _PAD)


def _draw_uncovered_pads(
    pads: Sequence[Pad], body: SheetBox, board: BoardOnSheet
) -> Iterator[Primitive]:
    """Draw what of the pads lies beside the body, which stays free for the text."""
    for pad in pads:
        uncovered = _cut_off_body(board.place(pad.box), body)
        if uncovered.width > 0.0 and uncovered.height > 0.0:
            yield uncovered.outline(_PAD)


def _cut_off_body(pad: SheetBox, body: SheetBox) -> SheetBox:
    """Return what of a pad lies beside the body; it has no width or height if nothing does."""
    x, y = pad.middle
    leaves_sideways = body.bottom < y < body.top
    leaves_upwards = body.left < x < body.right

    if leaves_sideways and pad.right > body.right:
        return replace(pad, left=max(pad.left, body.right))
    if leaves_sideways:
        return replace(pad, right=min(pad.right, body.left))
    if leaves_upwards and pad.top > body.top:
        return replace(pad, bottom=max(pad.bottom, body.top))
    if leaves_upwards:
        return replace(pad, top=min(pad.top, body.bottom))

    return pad


def _draw_polarity(
    part: Component, pads: Sequence[Pad], body: SheetBox, board: BoardOnSheet
) -> Iterator[Primitive]:
    """Draw a bar at a diode's cathode, or a dot at pin 1.

    Neither marks a part with three legs, which goes in one way only.
    """
    first_pad = next(pad for pad in pads if pad.name == "1")
    first_pin = board.place(first_pad.box).middle
    symbol_pins = part.symbol.pins

    if len(symbol_pins) == 2 and symbol_pins[0].name == "K":
        yield _draw_bar(body, first_pin)
    elif len(pads) > 3 or part.reference.startswith("J"):
        yield from _draw_dot(body, first_pin)


def _draw_bar(body: SheetBox, cathode: Point) -> Primitive:
    """Draw the bar of a diode along the short edge at its cathode."""
    x, y = cathode
    middle_x, middle_y = body.middle

    if body.width > body.height:
        bar_x = body.left if x < middle_x else body.right
        return line((bar_x, body.bottom), (bar_x, body.top), _BAR)

    bar_y = body.bottom if y < middle_y else body.top
    return line((body.left, bar_y), (body.right, bar_y), _BAR)


def _draw_dot(body: SheetBox, pin: Point) -> Iterator[Primitive]:
    """Draw a dot inside the body, as near to the pin as there is room."""
    x, y = pin
    inset_x = min(_DOT_INSET_MM, body.width / _DOT_INSET_SHARE)
    inset_y = min(_DOT_INSET_MM, body.height / _DOT_INSET_SHARE)
    dot_x = min(max(x, body.left + inset_x), body.right - inset_x)
    dot_y = min(max(y, body.bottom + inset_y), body.top - inset_y)

    for radius in _DOT_RADII_MM:
        yield Ring((dot_x, dot_y), radius, _DOT)


def _left_of_holes(pads: Sequence[Pad], body: SheetBox, board: BoardOnSheet) -> SheetBox:
    """Return the room for text: a connector's holes stand in its outline, at the right."""
    right = body.right
    hole_edges = [
        board.place(pad.box).middle[0] - SCALE * pad.drill / 2.0 for pad in pads if pad.drill
    ]
    if hole_edges:
        right = min(hole_edges)

    return replace(body, right=right)


@dataclass(frozen=True)
class _FittedText:
    """Lines of text, with the height of capitals at which they fit."""

    lines: tuple[str, ...]
    capital_mm: float

    @property
    def pitch_mm(self) -> float:
        """Distance of two baselines."""
        return (1.0 + _GAP) * self.capital_mm

    @property
    def height_mm(self) -> float:
        """Height of all lines."""
        return (len(self.lines) * (1.0 + _GAP) - _GAP) * self.capital_mm


def _write(room: SheetBox, name: str, value: str) -> Iterator[Primitive]:
    """Write reference and value into a part's outline, along its longer side."""
    is_turned = room.height > room.width
    along_mm = max(room.width, room.height)
    across_mm = min(room.width, room.height)

    text = _fit_name_and_value(name, value, along_mm, across_mm)
    if value and text.capital_mm < _MIN_CAPITAL_MM:
        # The value is too long for the part; the list has it.
        text = _fit_name_and_value(name, "", along_mm, across_mm)

    x, y = room.middle
    for number, words in enumerate(text.lines):
        up = text.height_mm / 2.0 - text.capital_mm - number * text.pitch_mm
        yield Text(
            text=words,
            at=(x - up, y) if is_turned else (x, y + up),
            height=text.capital_mm,
            anchor="middle",
            turned=is_turned,
        )


def _fit_name_and_value(name: str, value: str, along_mm: float, across_mm: float) -> _FittedText:
    """Return name and value in the larger of two forms: two lines, or one in a slim outline."""
    words = tuple(text for text in (name, value) if text)
    stacked = _fit_lines(words, along_mm, across_mm)
    joined = _fit_lines((" ".join(words),), along_mm, across_mm)
    larger = joined if joined.capital_mm > stacked.capital_mm else stacked

    return replace(larger, capital_mm=min(larger.capital_mm, _MAX_CAPITAL_MM))


def _fit_lines(lines: tuple[str, ...], along_mm: float, across_mm: float) -> _FittedText:
    """Return lines with the largest capitals at which they fit, with gaps on all sides."""
    widest = max(text_width(words, 1.0) for words in lines)
    along_capitals = widest + 2 * _GAP
    across_capitals = len(lines) + (len(lines) + 1) * _GAP
    capital_mm = min(along_mm / along_capitals, across_mm / across_capitals)

    return _FittedText(lines, capital_mm)
