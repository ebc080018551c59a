"""Assembly drawing of a board, five times its size, and its list of parts.

It shows where a part belongs, which value it has, and which way round it goes.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace

from fingertip import __version__
from fingertip.board.circuits.channels import split_name
from fingertip.board.fabrication.bom import list_bom
from fingertip.board.kicad.placement import Box, PlacedPart, Placement
from fingertip.board.parts.circuit import Circuit, Component
from fingertip.pictures.drawing.primitives import (
    Primitive,
    Ring,
    Sheet,
    Style,
    Text,
    line,
    rectangle,
    text_width,
)

SCALE = 5.0
_A4_MM = (297.0, 210.0)
_A3_MM = (420.0, 297.0)
_LIST_WIDTH_MM = 75.0
_MARGIN_MM = 12.0
_TITLE_MM = 3.5
_NOTE_MM = 2.0
_LIST_MM = 2.0
_MOST_MM = 2.2
_LEAST_MM = 1.2
"""Largest and smallest height of the capitals on a part."""
_PART = Style("part", 0.2)
_PAD = Style("pad", 0.1)
_BAR = Style("bar", 0.9)
_BOARD = Style("board", 0.5)
_DOT = Style("dot", 0.25)
_ROW_MM = 4.6
_GAP = 0.35
"""Gap between two lines of text, and beside them, in units of a capital's height."""


@dataclass(frozen=True)
class _Box:
    """Rectangle on the sheet [mm]."""

    left: float
    bottom: float
    right: float
    top: float

    @property
    def size(self) -> tuple[float, float]:
        return self.right - self.left, self.top - self.bottom

    @property
    def middle(self) -> tuple[float, float]:
        return (self.left + self.right) / 2.0, (self.bottom + self.top) / 2.0


def draw_assembly(circuit: Circuit, placement: Placement, title: str) -> Sheet:
    """Draw the front of a board, with a list of what to place."""
    fits_a4 = SCALE * placement.width + _LIST_WIDTH_MM + _MARGIN_MM < _A4_MM[0]
    width, height = _A4_MM if fits_a4 else _A3_MM
    board = _place((0.0, 0.0, placement.width, placement.height), height)
    note = (
        f"Front, {SCALE:g}:1, {placement.width:g} x {placement.height:g} mm; made with fingertip "
        f"{__version__}. "
        "Print at 100 %. Bar: cathode. Dot: pin 1. Parts with neither go in either way, or in one "
        "way only."
    )
    primitives: list[Primitive] = [
        Text(title, (board.left, height - _MARGIN_MM - _TITLE_MM), _TITLE_MM),
        Text(note, (board.left, board.top + 2.5), _NOTE_MM),
        rectangle(
            board.left,
            bottom=board.bottom,
            right=board.right,
            top=board.top,
            style=_BOARD,
        ),
    ]
    for part in circuit.components:
        if part.is_fitted:
            primitives += _draw_part(part, placement.parts[part.reference], height)

    primitives += _draw_list(circuit, board.right + 5.0, board.top)
    return Sheet("assembly", width, height, tuple(primitives))


def _place(box: Box, paper_height: float) -> _Box:
    """Place a rectangle of the board, whose y axis points down, on the sheet."""
    left = _MARGIN_MM
    top = paper_height - _MARGIN_MM - 10.0
    return _Box(
        left + SCALE * box[0], top - SCALE * box[3], left + SCALE * box[2], top - SCALE * box[1]
    )


def _draw_part(part: Component, placed: PlacedPart, paper_height: float) -> Iterator[Primitive]:
    name = part.reference
    pads = [(pad, _place(pad.box, paper_height)) for pad in placed.pads]
    for pad, box in pads:
        diameter = pad.drill or (pad.width if name.startswith("TP") else 0.0)
        if diameter:
            yield Ring(box.middle, SCALE * diameter / 2.0, _PAD)

    if placed.body is None:
        return

    body = _place(placed.body, paper_height)
    if name.startswith("TP"):
        yield from _write(body, name, "")
        return

    yield rectangle(
        body.left,
        bottom=body.bottom,
        right=body.right,
        top=body.top,
        style=_PART,
    )
    if not _is_chip(part):
        for _, box in pads:
            yield from _trim(box, body)

        first_pin = next(box.middle for pad, box in pads if pad.name == "1")
        if len(part.symbol.pins) == 2 and part.symbol.pins[0].name == "K":
            yield _draw_bar(body, first_pin)
        elif len(pads) > 3 or name.startswith("J"):  # what has three legs goes in one way only
            yield from _draw_dot(body, first_pin)

    # A connector's holes stand in its outline; the text stands to their left.
    right = min(
        (box.middle[0] - SCALE * pad.drill / 2.0 for pad, box in pads if pad.drill),
        default=body.right,
    )
    yield from _write(replace(body, right=right), name, _describe_value(part))


def _is_chip(part: Component) -> bool:
    """Return whether a part is a resistor or capacitor, which goes in either way."""
    return part.symbol.name in ("R", "C")


def _describe_value(part: Component) -> str:
    """Write a value, with R behind ohms: a part marked 100 has 10 ohm, one of 100 ohm 101."""
    return f"{part.value}R" if part.symbol.name == "R" and part.value[-1].isdigit() else part.value


def _trim(pad: _Box, body: _Box) -> Iterator[Primitive]:
    """Draw what of a pad lies beside the body, which stays free for the text."""
    left = pad.left
    bottom = pad.bottom
    right = pad.right
    top = pad.top

    if body.bottom < pad.middle[1] < body.top:  # its leg leaves the body sideways
        if right > body.right:
            left = max(left, body.right)
        else:
            right = min(right, body.left)
    elif body.left < pad.middle[0] < body.right:
        if top > body.top:
            bottom = max(bottom, body.top)
        else:
            top = min(top, body.bottom)

    if left < right and bottom < top:
        yield rectangle(
            left,
            bottom=bottom,
            right=right,
            top=top,
            style=_PAD,
        )


def _draw_bar(body: _Box, cathode: tuple[float, float]) -> Primitive:
    """Draw the bar of a diode at its cathode."""
    x, y = cathode
    middle_x, middle_y = body.middle
    wide, high = body.size

    if wide > high:
        bar_x = body.left if x < middle_x else body.right
        return line((bar_x, body.bottom), (bar_x, body.top), _BAR)

    bar_y = body.bottom if y < middle_y else body.top
    return line((body.left, bar_y), (body.right, bar_y), _BAR)


def _draw_dot(body: _Box, pin: tuple[float, float]) -> Iterator[Primitive]:
    """Draw a dot inside the body, as near to the pin as there is room."""
    x, y = pin
    wide, high = body.size
    dx = min(1.0, wide / 6.0)
    dy = min(1.0, high / 6.0)
    dot_x = min(max(x, body.left + dx), body.right - dx)
    dot_y = min(max(y, body.bottom + dy), body.top - dy)
    yield from (Ring((dot_x, dot_y), radius, _DOT) for radius in (0.15, 0.4))


def _write(body: _Box, name: str, value: str) -> Iterator[Primitive]:
    """Write reference and value into a part's outline, along its longer side."""
    lines = [text for text in (name, value) if text]
    wide, high = body.size
    turned = high > wide
    along, across = (high, wide) if turned else (wide, high)
    widest = max(text_width(text, 1.0) for text in lines)
    one_line = text_width(" ".join(lines), 1.0)
    # Two lines in a squat outline, one in a slim one: whichever is larger.
    two = min(along / (widest + 2 * _GAP), across / (len(lines) * (1.0 + _GAP) + _GAP))
    single = min(along / (one_line + 2 * _GAP), across / (1.0 + 2 * _GAP))
    if single > two:
        lines = [" ".join(lines)]

    size = min(max(two, single), _MOST_MM)
    if size < _LEAST_MM and value:  # too long for the part: the list has it
        yield from _write(body, name, "")
        return

    total = (len(lines) * (1.0 + _GAP) - _GAP) * size
    x, y = body.middle
    for i, text in enumerate(lines):
        down = total / 2.0 - size - i * (1.0 + _GAP) * size
        at = (x - down, y) if turned else (x, y + down)
        yield Text(
            text=text,
            at=at,
            height=size,
            anchor="middle",
            turned=turned,
        )


def _draw_list(circuit: Circuit, left: float, top: float) -> Iterator[Primitive]:
    """List what to place: a box to tick, number of parts, value, package and references."""
    fingers = max(split_name(part.reference)[0] for part in circuit.components if part.is_fitted)
    for i, item in enumerate(list_bom(circuit)):
        y = top - (i + 1) * _ROW_MM
        part = item.components[0]
        package = ""

        if _is_chip(part):
            package = item.footprint.split("_")[1]
        elif item.footprint.startswith("JST"):
            package = " ".join(item.footprint.split("_")[:2])

        yield rectangle(
            left,
            bottom=y,
            right=left + _LIST_MM,
            top=y + _LIST_MM,
            style=_PART,
        )
        yield Text(f"{len(item.components)} x", (left + 4.0, y), _LIST_MM)
        yield Text(f"{_describe_value(part)} {package}".strip(), (left + 10.0, y), _LIST_MM)
        first = [name for name in item.references if split_name(name)[0] < 2]
        owned = Counter(channel for channel, _ in map(split_name, item.references) if channel)

        if len(owned) > 1 and len(owned) == fingers and len(set(owned.values())) == 1:
            text = " ".join(first) + "; the same at each finger"
        else:
            text = " ".join(item.references)

        yield Text(text, (left + 33.0, y), _LIST_MM)
