"""Schematic of a board as SVG, from KiCad's file."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence

from fingertip.board.kicad.sexpr import Node, Point, find_place, first, numbers, points, turn
from fingertip.page.html import Markup, element, join
from fingertip.page.svg import number, path

_MARGIN_MM = 4.0
_WIRE = "var(--series-1)"
_SYMBOL = "var(--series-2)"
_CHARACTER = 0.62
"""Mean width of a character over the size of its font."""
_JUNCTION_MM = 0.45

Place = Callable[[float, float], Point]


def is_hidden(node: Node) -> bool:
    return any(place.word("hide") == "yes" for place in (node, first(node, "effects")))


class _Ink:
    """SVG elements, and the rectangle that they fill [mm]."""

    def __init__(self) -> None:
        self.parts: list[Markup] = []
        self.reached: list[Point] = []

    def line(
        self,
        spots: list[Point],
        colour: str,
        width: float = 0.2,
        fill: str = "none",
    ) -> None:
        self.reached += spots
        self.parts.append(
            element(
                "path",
                d=path(spots, 2),
                stroke=colour,
                stroke_width=width,
                fill=fill,
            )
        )

    def circle(
        self,
        centre: Point,
        radius: float,
        colour: str,
        fill: str,
    ) -> None:
        x, y = centre
        self.reached += [(x - radius, y - radius), (x + radius, y + radius)]
        cx, cy, r = (number(value, 2) for value in (x, y, radius))
        self.parts.append(
            element(
                "circle",
                cx=cx,
                cy=cy,
                r=r,
                stroke=colour,
                stroke_width=0.2,
                fill=fill,
            )
        )

    def text(
        self,
        content: str,
        spot: Point,
        size: float,
        *,
        upright: bool = False,
        justify: Sequence[str] = (),
    ) -> None:
        if not content or content == "~":
            return

        x, y = spot
        if "left" in justify:
            anchor = "start"
        elif "right" in justify:
            anchor = "end"
        else:
            anchor = "middle"

        width = _CHARACTER * size * len(content)
        begin = {"start": 0.0, "end": -width, "middle": -width / 2}[anchor]
        drop = -0.3 * size if "bottom" in justify else 0.36 * size

        if upright:
            self.reached += [(x - size / 2, y - begin), (x + size / 2, y - begin - width)]
            x += drop
        else:
            self.reached += [(x + begin, y - size), (x + begin + width, y + size / 2)]
            y += drop

        self.parts.append(
            element(
                "text",
                content,
                x=number(x, 2),
                y=number(y, 2),
                font_size=number(size * 1.15, 2),
                text_anchor=None if anchor == "start" else anchor,
                transform=f"rotate(-90 {number(x, 2)} {number(y, 2)})" if upright else None,
            )
        )


def render_schematic(sheet: Node, title: str) -> Markup:
    ink = _Ink()
    library = {symbol.words[1]: symbol for symbol in first(sheet, "lib_symbols").children("symbol")}
    for wire in sheet.children("wire"):
        ink.line(points(wire), _WIRE)

    for junction in sheet.children("junction"):
        ink.circle(find_place(junction)[:2], _JUNCTION_MM, "none", _WIRE)

    for symbol in sheet.children("symbol"):
        _draw_symbol(ink, symbol, library[symbol.word("lib_id")])

    for label in sheet.children("label", "global_label", "hierarchical_label", "text"):
        _draw_text(ink, label.words[1], label)

    for inner in sheet.children("sheet"):
        _draw_sheet(ink, inner)

    return draw_frame(
        title,
        parts=ink.parts,
        reached=ink.reached,
        margin_mm=_MARGIN_MM,
        places=2,
    )


def _draw_sheet(ink: _Ink, sheet: Node) -> None:
    x, y, _ = find_place(sheet)
    width, height = numbers(first(sheet, "size"))
    ink.line(
        [(x, y), (x + width, y), (x + width, y + height), (x, y + height), (x, y)], _SYMBOL, 0.25
    )
    name = next(text for text in sheet.children("property") if text.words[1] == "Sheetname")
    _draw_text(ink, name.words[2], name)
    for pin in sheet.children("pin"):
        _draw_text(ink, f" {pin.words[1]} ", pin)


def draw_frame(
    title: str,
    parts: Iterable[Markup],
    reached: Iterable[Point],
    margin_mm: float,
    places: int,
) -> Markup:
    """Draw the picture that holds some parts, within a margin around the points that they reach."""
    xs, ys = zip(*reached, strict=True)
    left = min(xs) - margin_mm
    top = min(ys) - margin_mm
    view = (left, top, max(xs) + margin_mm - left, max(ys) + margin_mm - top)
    box = " ".join(number(value, places) for value in view)

    return element("svg", element("title", title), join(parts), viewBox=box, role="img")


def _draw_text(ink: _Ink, content: str, owner: Node, turned_deg: float = 0.0) -> None:
    x, y, angle = find_place(owner)
    effects = first(owner, "effects")
    size = numbers(first(first(effects, "font"), "size"))[0]
    justify = first(effects, "justify").words
    if owner.head == "label" and angle == 180.0:
        justify = ["right", "bottom"]

    upright = (angle + turned_deg) % 180.0 == 90.0
    for i, row in enumerate(content.split("\n")):
        ink.text(row, (x, y + 1.6 * size * i), size, upright=upright, justify=justify)


def find_way(symbol: Node) -> Place:
    """Return the function that places points of a library's drawing on the sheet."""
    x, y, angle = find_place(symbol)
    mirror = symbol.word("mirror")

    def place(px: float, py: float) -> Point:
        dx, dy = turn(px, -py, angle)
        return x + (-dx if mirror == "y" else dx), y + (-dy if mirror == "x" else dy)

    return place


def list_bodies(symbol: Node, drawing: Node) -> Iterator[Node]:
    """Yield the bodies of the library's drawing that a symbol's unit shows."""
    for body in drawing.children("symbol"):
        if body.words[1].split("_")[-2] in ("0", symbol.word("unit") or "1"):
            yield body


def _draw_symbol(ink: _Ink, symbol: Node, drawing: Node) -> None:
    show_numbers, show_names = (
        not is_hidden(first(drawing, name)) for name in ("pin_numbers", "pin_names")
    )
    for body in list_bodies(symbol, drawing):
        _draw_body(
            ink,
            body=body,
            place=find_way(symbol),
            show_numbers=show_numbers,
            show_names=show_names,
        )

    for text in symbol.children("property"):
        name, content = text.words[1:3]
        if name in ("Reference", "Value") and not is_hidden(text) and not content.startswith("#"):
            _draw_text(ink, content, text, find_place(symbol)[2])


def _draw_body(
    ink: _Ink,
    body: Node,
    place: Place,
    show_numbers: bool,
    show_names: bool,
) -> None:
    for outline in body.children("polyline"):
        fill = _SYMBOL if first(outline, "fill").word("type") == "outline" else "none"
        ink.line([place(*spot) for spot in points(outline)], _SYMBOL, 0.25, fill)

    for rectangle in body.children("rectangle"):
        x0, y0 = numbers(first(rectangle, "start"))
        x1, y1 = numbers(first(rectangle, "end"))
        corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)]
        ink.line([place(*corner) for corner in corners], _SYMBOL, 0.25)

    for circle in body.children("circle"):
        px, py = numbers(first(circle, "center"))
        ink.circle(place(px, py), numbers(first(circle, "radius"))[0], _SYMBOL, "none")

    for arc in body.children("arc"):
        ink.line(
            [place(*numbers(first(arc, name))[:2]) for name in ("start", "mid", "end")],
            _SYMBOL,
            0.25,
        )

    for pin in body.children("pin"):
        _draw_pin(
            ink,
            pin=pin,
            place=place,
            show_number=show_numbers,
            show_name=show_names,
        )


def _draw_pin(
    ink: _Ink,
    pin: Node,
    place: Place,
    show_number: bool,
    show_name: bool,
) -> None:
    x0, y0, angle = find_place(pin)
    length = numbers(first(pin, "length"))[0]
    dx, dy = turn(1.0, 0.0, angle)
    x1 = x0 + dx * length
    y1 = y0 - dy * length
    if length:
        ink.line([place(x0, y0), place(x1, y1)], _SYMBOL)

    if show_number:
        lies = abs(y1 - y0) < 1e-9
        middle = (x0 + x1) / 2 + (0 if lies else 0.8), (y0 + y1) / 2 + (0.8 if lies else 0)
        ink.text(pin.word("number"), place(*middle), 0.9)

    if show_name:
        name = pin.word("name")
        share = (0.9 + 0.3 * len(name)) / (math.hypot(x1 - x0, y1 - y0) or 1.0)
        ink.text(name, place(x1 + (x1 - x0) * share, y1 + (y1 - y0) * share), 1.0)
