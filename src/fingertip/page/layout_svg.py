"""Layout of a board as SVG, from KiCad's file: placement, copper and back.

What belongs to a component stands in a group that names it, so that the list of parts can highlight
it.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator

import numpy as np

from fingertip.board.kicad.placement import find_reference, list_pads, read_reference
from fingertip.board.kicad.sexpr import Node, Point, find_place, first, numbers, points, turn
from fingertip.page.html import Markup, element
from fingertip.page.schematic_svg import draw_frame, is_hidden
from fingertip.page.svg import number, path

_MARGIN_MM = 1.0
_BACK_MARGIN_MM = 0.25
"""Distance of a part's frame on the back from its pads [mm]."""
_ARC_STEPS = 8
_SMALL_MM = 0.75
"""Size of references that are not printed on the board [mm]."""
_FRONT, _BACK, _PAD, _SILK, _HOLE = (
    f"var(--{name})" for name in ("copper-front", "copper-back", "pad", "silk", "ground")
)
_REFERENCE = re.compile(r"[A-Z]+\d+(?= )")
"""Reference at the beginning of a printed line of the list of values."""


def render_placement(board: Node, title: str) -> Markup:
    """Render outline, pads, silkscreen and references of a `.kicad_pcb` file, from the front."""
    parts = []
    for footprint in board.children("footprint"):
        shapes = (*_draw_pads(footprint), *_draw_silkscreen(footprint), *_draw_name(footprint))
        parts.append(_mark_part(read_reference(footprint), shapes))

    for item in board.children("gr_text"):
        if item.word("layer").startswith("F."):
            parts.append(_draw_text(item.words[1], item, (0.0, 0.0)))

    return _draw_board(board, title, parts)


def render_copper(board: Node, title: str) -> Markup:
    """Render copper, pads and vias of a `.kicad_pcb` file, through the board from the front."""
    parts: list[Markup] = []
    for layer, colour in (("B.Cu", _BACK), ("F.Cu", _FRONT)):
        for zone in board.children("zone"):
            for polygon in zone.children("filled_polygon"):
                if polygon.word("layer") == layer:
                    data = path(points(polygon), 3) + "Z"
                    parts.append(element("path", d=data, fill=colour, fill_opacity="0.16"))

        for segment in board.children("segment"):
            if segment.word("layer") == layer:
                data = path(_ends(segment), 3)
                width = segment.word("width")
                parts.append(
                    element(
                        "path",
                        d=data,
                        stroke=colour,
                        stroke_width=width,
                        stroke_linecap="round",
                        fill="none",
                    )
                )

    parts += [
        _mark_part(read_reference(footprint), _draw_pads(footprint))
        for footprint in board.children("footprint")
    ]
    for via in board.children("via"):
        x, y, _ = find_place(via)
        parts += _draw_ring((x, y), float(via.word("size")), float(via.word("drill")))

    return _draw_board(board, title, parts)


def render_back(board: Node, title: str) -> Markup:
    """Render a `.kicad_pcb` file as seen from the back.

    All parts stand on the front; a frame shows where.
    """
    parts: list[Markup] = []
    for footprint in board.children("footprint"):
        shapes = [*_draw_from_back(footprint)]
        if shapes:
            parts.append(_mark_part(read_reference(footprint), shapes))

    for item in board.children("gr_text"):
        if item.word("layer") == "B.SilkS":
            content = item.words[1]
            reference = _REFERENCE.match(content)
            text = _draw_text(content, item, (0.0, 0.0), is_back=True)
            parts.append(_mark_part(reference[0], [text]) if reference else text)

    return _draw_board(board, title, parts, is_back=True)


def _mark_part(reference: str, shapes: Iterable[Markup]) -> Markup:
    """Group the shapes of a component, by whose reference a script highlights it."""
    return element("g", *shapes, data_part=reference or None)


def _draw_board(
    board: Node, title: str, parts: Iterable[Markup], *, is_back: bool = False
) -> Markup:
    """Draw the board with its parts in the file's coordinates, mirrored from the back.

    It is filled within its edge, whose pieces may come in any order.
    """
    pieces: list[list[Point]] = []
    for item in board.children("gr_line", "gr_arc"):
        if item.word("layer") == "Edge.Cuts":
            start, end = _ends(item)
            if item.head == "gr_arc":
                pieces.append(_bend(start, _point(item, "mid"), end))
            else:
                pieces.append([start, end])

    chain = _join_pieces(pieces)
    if is_back:
        chain = [(-x, y) for x, y in chain]

    colours = {"fill": "var(--substrate)", "stroke": "var(--text)"}
    outline = element("path", d=path(chain, 3) + "Z", **colours, stroke_width="0.15")
    return draw_frame(
        title,
        parts=(outline, *parts),
        reached=chain,
        margin_mm=_MARGIN_MM,
        places=3,
    )


def _join_pieces(pieces: list[list[Point]]) -> list[Point]:
    """Join the pieces of an outline in the order in which their ends meet."""
    chain, *remaining = pieces
    while remaining:
        end = chain[-1]
        nearest = min(
            remaining, key=lambda piece: min(math.dist(piece[0], end), math.dist(piece[-1], end))
        )
        remaining.remove(nearest)
        is_forward = math.dist(nearest[0], end) <= math.dist(nearest[-1], end)
        chain = chain + (nearest if is_forward else nearest[::-1])

    return chain


def _point(item: Node, name: str) -> Point:
    x, y = numbers(first(item, name))[:2]
    return x, y


def _ends(item: Node) -> tuple[Point, Point]:
    return _point(item, "start"), _point(item, "end")


def _bend(start: Point, mid: Point, end: Point) -> list[Point]:
    """Divide an arc through three points into straight pieces."""
    ax, ay = start
    bx, by = mid
    cx, cy = end
    d = 2 * (ax * (by - cy) + bx * (cy - ay) + cx * (ay - by))
    if d == 0.0:
        return [start, mid, end]

    squares = ax * ax + ay * ay, bx * bx + by * by, cx * cx + cy * cy
    ux = (squares[0] * (by - cy) + squares[1] * (cy - ay) + squares[2] * (ay - by)) / d
    uy = (squares[0] * (cx - bx) + squares[1] * (ax - cx) + squares[2] * (bx - ax)) / d
    angles = [math.atan2(y - uy, x - ux) for x, y in (start, mid, end)]
    first_turn = (angles[1] - angles[0] + math.pi) % math.tau - math.pi
    second_turn = (angles[2] - angles[1] + math.pi) % math.tau - math.pi
    radius = math.hypot(ax - ux, ay - uy)
    whole = first_turn + second_turn
    steps = (angles[0] + whole * i / _ARC_STEPS for i in range(_ARC_STEPS + 1))

    return [(ux + radius * math.cos(a), uy + radius * math.sin(a)) for a in steps]


def _draw_pads(footprint: Node) -> Iterator[Markup]:
    for pad in list_pads(footprint):
        if pad.shape == "circle":
            yield from _draw_ring(pad.centre, pad.width if pad.is_plated else 0.0, pad.drill)
            continue

        x, y = pad.centre
        centre = f"{number(x, 3)} {number(y, 3)}"
        rounding = 0.5 if pad.shape == "oval" else pad.rounding
        yield element(
            "rect",
            element("title", f"{read_reference(footprint)} pin {pad.name}"),
            x=number(x - pad.width / 2, 3),
            y=number(y - pad.height / 2, 3),
            width=number(pad.width, 3),
            height=number(pad.height, 3),
            rx=number(rounding * min(pad.width, pad.height), 3),
            fill=_PAD,
            transform=f"rotate({number(-pad.turned_deg, 3)} {centre})" if pad.turned_deg else None,
        )
        yield from _draw_ring(pad.centre, 0.0, pad.drill)


def _draw_ring(centre: Point, size: float, drill: float) -> Iterator[Markup]:
    x, y = (number(value, 3) for value in centre)
    for diameter, colour in ((size, _PAD), (drill, _HOLE)):
        if diameter:
            yield element(
                "circle",
                cx=x,
                cy=y,
                r=number(diameter / 2, 3),
                fill=colour,
            )


def _draw_silkscreen(footprint: Node) -> Iterator[Markup]:
    x, y, angle = find_place(footprint)
    for item in footprint.children("fp_line", "fp_rect"):
        if item.word("layer") == "F.SilkS":
            (x0, y0), (x1, y1) = _ends(item)
            corners = [(x0, y0), (x1, y1)]
            if item.head == "fp_rect":
                corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)]

            turned = (turn(px, py, angle) for px, py in corners)
            placed = [(x + dx, y + dy) for dx, dy in turned]
            yield element(
                "path",
                d=path(placed, 3),
                stroke=_SILK,
                stroke_width="0.12",
                fill="none",
            )


def _draw_name(footprint: Node) -> Iterator[Markup]:
    """Draw the printed reference, or a small one on the component if none is printed."""
    text = find_reference(footprint)
    if text is None:
        return

    x, y, angle = find_place(footprint)
    if text.word("layer") == "F.SilkS" and not is_hidden(text):
        yield _draw_text(text.words[2], text, (x, y), angle)
        return

    place = f"{number(x, 3)} {number(y, 3)}"
    # The pads of the footprint, as it is turned, stand above each other rather than side by side.
    spots = [turn(*find_place(pad)[:2], angle) for pad in footprint.children("pad")]
    is_tall = bool(spots) and np.ptp([y for _, y in spots]) > np.ptp([x for x, _ in spots])
    yield element(
        "text",
        text.words[2],
        x=number(x, 3),
        y=number(y, 3),
        dy=number(0.36 * _SMALL_MM, 3),
        font_size=number(_SMALL_MM, 3),
        text_anchor="middle",
        transform=f"rotate(-90 {place})" if is_tall else None,
    )


def _draw_text(
    content: str,
    item: Node,
    origin: Point,
    angle: float = 0.0,
    *,
    is_back: bool = False,
) -> Markup:
    """Draw a printed text of a file in its place; from the back it can be read too."""
    px, py, own = find_place(item)
    dx, dy = turn(px, py, angle)
    x = number((-1.0 if is_back else 1.0) * (origin[0] + dx), 3)
    y = number(origin[1] + dy, 3)
    effects = first(item, "effects")
    size = numbers(first(first(effects, "font"), "size"))[0]
    justify = first(effects, "justify").words
    if "left" in justify:
        anchor = "start"
    elif "right" in justify:
        anchor = "end"
    else:
        anchor = "middle"

    return element(
        "text",
        content,
        x=x,
        y=y,
        dy=number(0.36 * size, 3),
        font_size=number(size * 1.1, 3),
        text_anchor=anchor,
        transform=f"rotate(-90 {x} {y})" if own % 180.0 == 90.0 else None,
    )


def _draw_from_back(footprint: Node) -> Iterator[Markup]:
    """Draw a frame around the pads of a part, and the holes for its pins."""
    pads = [*list_pads(footprint)]
    if pads:
        lefts, tops, rights, bottoms = zip(*(pad.box for pad in pads), strict=True)
        left = min(lefts) - _BACK_MARGIN_MM
        top = min(tops) - _BACK_MARGIN_MM
        right = max(rights) + _BACK_MARGIN_MM
        bottom = max(bottoms) + _BACK_MARGIN_MM
        yield element(
            "rect",
            element("title", read_reference(footprint)),
            x=f"{-right:.3f}",
            y=f"{top:.3f}",
            width=f"{right - left:.3f}",
            height=f"{bottom - top:.3f}",
            class_="place",
        )

    for (x, y), drill in ((pad.centre, pad.drill) for pad in pads if pad.drill):
        place = {"cx": f"{-x:.3f}", "cy": f"{y:.3f}", "r": f"{drill / 2:.3f}"}
        yield element("circle", **place, fill=_HOLE, stroke=_PAD, stroke_width="0.3")
