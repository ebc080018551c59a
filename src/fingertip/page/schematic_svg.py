"""Schematic of a board as SVG, from the file for KiCad: symbols, wires, labels and texts."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from fingertip.board.kicad.sexpr import Expression
from fingertip.page.html import Markup, element, join
from fingertip.page.kicad_drawing import first, is_hidden, lists, numbers, parse, points, turn, word, words

_MARGIN_MM = 4.0
_WIRE, _SYMBOL, _TEXT = "var(--series-1)", "var(--series-2)", "var(--text)"
_CHARACTER = 0.62
"""Mean width of a character over the size of its font."""
_JUNCTION_MM = 0.45

Place = Callable[[float, float], tuple[float, float]]


class _Ink:
    """SVG elements, and the rectangle that they fill [mm]."""

    def __init__(self) -> None:
        self.parts: list[Markup] = []
        self.xs: list[float] = []
        self.ys: list[float] = []

    def reach(self, *spots: tuple[float, float]) -> None:
        self.xs += [x for x, _ in spots]
        self.ys += [y for _, y in spots]

    def line(self, spots: list[tuple[float, float]], colour: str, width: float = 0.2, fill: str = "none") -> None:
        self.reach(*spots)
        data = "M" + "L".join(f"{_number(x)} {_number(y)}" for x, y in spots)
        self.parts.append(element("path", d=data, stroke=colour, stroke_width=width, fill=fill))

    def circle(self, centre: tuple[float, float], radius: float, colour: str, fill: str) -> None:
        x, y = centre
        self.reach((x - radius, y - radius), (x + radius, y + radius))
        self.parts.append(
            element(
                "circle", cx=_number(x), cy=_number(y), r=_number(radius), stroke=colour, stroke_width=0.2, fill=fill
            )
        )

    def text(
        self, content: str, spot: tuple[float, float], size: float, *, upright: bool = False, justify: list[str]
    ) -> None:
        if not content or content == "~":
            return
        x, y = spot
        anchor = "start" if "left" in justify else "end" if "right" in justify else "middle"
        width = _CHARACTER * size * len(content)
        begin = {"start": 0.0, "end": -width, "middle": -width / 2}[anchor]
        drop = -0.3 * size if "bottom" in justify else 0.36 * size
        if upright:
            self.reach((x - size / 2, y - begin), (x + size / 2, y - begin - width))
            x, y = x + drop, y
            turned = f"rotate(-90 {_number(x)} {_number(y)})"
        else:
            self.reach((x + begin, y - size), (x + begin + width, y + size / 2))
            y, turned = y + drop, None
        self.parts.append(
            element(
                "text", content, x=_number(x), y=_number(y), font_size=_number(size * 1.15),
                text_anchor=None if anchor == "start" else anchor, transform=turned,
            )
        )  # fmt: skip


def render_schematic(text: str, title: str) -> Markup:
    """Render the schematic of a `.kicad_sch` file."""
    sheet, ink = parse(text), _Ink()
    library = {words(symbol)[0]: symbol for symbol in lists(first(sheet, "lib_symbols"), "symbol")}
    for wire in lists(sheet, "wire"):
        ink.line(points(wire), _WIRE)
    for junction in lists(sheet, "junction"):
        x, y = numbers(first(junction, "at"))[:2]
        ink.circle((x, y), _JUNCTION_MM, "none", _WIRE)
    for symbol in lists(sheet, "symbol"):
        _draw_symbol(ink, symbol, library[word(symbol, "lib_id")])
    for label in lists(sheet, "label", "text"):
        _draw_text(ink, words(label)[0], label)
    left, top = min(ink.xs) - _MARGIN_MM, min(ink.ys) - _MARGIN_MM
    width, height = max(ink.xs) + _MARGIN_MM - left, max(ink.ys) + _MARGIN_MM - top
    view = " ".join(_number(value) for value in (left, top, width, height))
    return element("svg", element("title", title), join(ink.parts), viewBox=view, role="img")


def _draw_text(ink: _Ink, content: str, owner: Expression, turned_deg: float = 0.0) -> None:
    x, y, angle = (*numbers(first(owner, "at")), 0.0)[:3]
    effects = first(owner, "effects")
    size = numbers(first(first(effects, "font"), "size"))[0]
    justify = words(first(effects, "justify"))
    if owner[0] == "label" and angle == 180.0:
        justify = ["right", "bottom"]
    for number, row in enumerate(content.split("\\n")):
        upright = (angle + turned_deg) % 180.0 == 90.0
        ink.text(row, (x, y + 1.6 * size * number), size, upright=upright, justify=justify)


def find_place(symbol: Expression) -> Place:
    """Return the function that places points of the library's drawing, whose y points up, on the sheet."""
    x, y, angle = numbers(first(symbol, "at"))
    mirror = word(symbol, "mirror")

    def place(px: float, py: float) -> tuple[float, float]:
        dx, dy = turn(px, -py, angle)
        return x + (-dx if mirror == "y" else dx), y + (-dy if mirror == "x" else dy)

    return place


def list_bodies(symbol: Expression, drawing: Expression) -> Iterator[Expression]:
    """Yield the bodies of the library's drawing that a symbol's unit shows."""
    for body in lists(drawing, "symbol"):
        if words(body)[0].split("_")[-2] in ("0", word(symbol, "unit", "1")):
            yield body


def _draw_symbol(ink: _Ink, symbol: Expression, drawing: Expression) -> None:
    place, angle = find_place(symbol), numbers(first(symbol, "at"))[2]
    show_numbers = not is_hidden(first(drawing, "pin_numbers"))
    show_names = not is_hidden(first(drawing, "pin_names"))
    for body in list_bodies(symbol, drawing):
        _draw_body(ink, body, place, show_numbers, show_names)
    for text in lists(symbol, "property"):
        name, content = words(text)[:2]
        if name in ("Reference", "Value") and not is_hidden(text) and not content.startswith("#"):
            _draw_text(ink, content, text, angle)


def _draw_body(ink: _Ink, body: Expression, place: Place, show_numbers: bool, show_names: bool) -> None:
    for outline in lists(body, "polyline"):
        fill = _SYMBOL if word(first(outline, "fill"), "type") == "outline" else "none"
        ink.line([place(*spot) for spot in points(outline)], _SYMBOL, 0.25, fill)
    for rectangle in lists(body, "rectangle"):
        (x0, y0), (x1, y1) = numbers(first(rectangle, "start")), numbers(first(rectangle, "end"))
        corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)]
        ink.line([place(*corner) for corner in corners], _SYMBOL, 0.25)
    for circle in lists(body, "circle"):
        px, py = numbers(first(circle, "center"))
        ink.circle(place(px, py), numbers(first(circle, "radius"))[0], _SYMBOL, "none")
    for arc in lists(body, "arc"):
        ink.line([place(*numbers(first(arc, name))[:2]) for name in ("start", "mid", "end")], _SYMBOL, 0.25)
    for pin in lists(body, "pin"):
        px, py, angle = numbers(first(pin, "at"))
        length = numbers(first(pin, "length"))[0]
        dx, dy = turn(1.0, 0.0, angle)
        inner = px + dx * length, py - dy * length
        if length:
            ink.line([place(px, py), place(*inner)], _SYMBOL)
        for text, (tx, ty), size in _pin_texts(pin, (px, py), inner, show_numbers, show_names):
            ink.text(text, place(tx, ty), size, justify=[])


def _pin_texts(
    pin: Expression, outer: tuple[float, float], inner: tuple[float, float], show_numbers: bool, show_names: bool
) -> Iterator[tuple[str, tuple[float, float], float]]:
    """Yield text, place and size of a pin's number beside its line and of its name inside."""
    (x0, y0), (x1, y1) = outer, inner
    lies = abs(y1 - y0) < 1e-9
    if show_numbers:
        middle = (x0 + x1) / 2, (y0 + y1) / 2
        yield word(pin, "number"), (middle[0] + (0 if lies else 0.8), middle[1] + (0.8 if lies else 0)), 0.9
    if show_names:
        step = 0.9 + 0.3 * len(word(pin, "name"))
        length = ((x1 - x0) ** 2 + (y1 - y0) ** 2) ** 0.5 or 1.0
        yield word(pin, "name"), (x1 + (x1 - x0) / length * step, y1 + (y1 - y0) / length * step), 1.0


def _number(value: float) -> str:
    return f"{round(value, 2) + 0.0:.2f}".rstrip("0").rstrip(".")
