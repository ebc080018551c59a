"""Layout of a board as SVG, from the file for KiCad: where each component stands, and its copper.

What belongs to a component stands in a group that names it, so that the list of parts can highlight it.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence

from fingertip.board.kicad.sexpr import Expression
from fingertip.page.html import Markup, element, join
from fingertip.page.kicad_drawing import first, is_hidden, lists, numbers, parse, points, turn, word, words

_MARGIN_MM = 1.0
_ARC_STEPS = 8
_SMALL_MM = 0.75
"""Size of references that are not printed on the board [mm]."""
_FRONT, _BACK, _PAD, _SILK = "var(--copper-front)", "var(--copper-back)", "var(--pad)", "var(--silk)"


def render_placement(text: str, title: str) -> Markup:
    """Render outline, pads, silkscreen and references of a `.kicad_pcb` file, seen from the front."""
    board = parse(text)
    parts = [draw_outline(board)]
    for footprint in lists(board, "footprint"):
        drawn = [*_draw_pads(footprint), *_draw_graphics(footprint, "F.SilkS"), *_draw_names(footprint)]
        parts.append(mark_part(name_part(footprint), drawn))
    parts += [draw_text(words(item)[0], item, (0.0, 0.0, 0.0)) for item in lists(board, "gr_text") if _is_front(item)]
    return draw_frame(board, title, parts)


def render_copper(text: str, title: str) -> Markup:
    """Render copper, pads and vias of a `.kicad_pcb` file, seen through the board from the front."""
    board = parse(text)
    parts = [draw_outline(board)]
    for layer, colour in (("B.Cu", _BACK), ("F.Cu", _FRONT)):
        for zone in lists(board, "zone"):
            for polygon in lists(zone, "filled_polygon"):
                if word(polygon, "layer") == layer:
                    data = _path(points(polygon)) + "Z"
                    parts.append(element("path", d=data, fill=colour, fill_opacity="0.16"))
        for segment in lists(board, "segment"):
            if word(segment, "layer") == layer:
                ends = [tuple(numbers(first(segment, end))[:2]) for end in ("start", "end")]
                data = "M" + "L".join(f"{_number(x)} {_number(y)}" for x, y in ends)
                width = word(segment, "width")
                parts.append(
                    element("path", d=data, stroke=colour, stroke_width=width, stroke_linecap="round", fill="none")
                )
    for footprint in lists(board, "footprint"):
        parts.append(mark_part(name_part(footprint), _draw_pads(footprint)))
    for via in lists(board, "via"):
        x, y = numbers(first(via, "at"))[:2]
        parts += _draw_ring((x, y), float(word(via, "size")), float(word(via, "drill")))
    return draw_frame(board, title, parts)


def mark_part(reference: str, drawn: Sequence[Markup]) -> Markup:
    """Group what belongs to a component."""
    return element("g", *drawn, data_part=reference or None)


def draw_frame(board: Expression, title: str, parts: list[Markup], *, is_back: bool = False) -> Markup:
    """Draw the picture that holds the parts; its coordinates are the file's, mirrored if it is seen from the back."""
    spots = _trace_outline(board)
    xs, ys = [-x if is_back else x for x, _ in spots], [y for _, y in spots]
    left, top = min(xs) - _MARGIN_MM, min(ys) - _MARGIN_MM
    view = (left, top, max(xs) + _MARGIN_MM - left, max(ys) + _MARGIN_MM - top)
    return element(
        "svg", element("title", title), join(parts), viewBox=" ".join(_number(value) for value in view), role="img"
    )


def _is_front(item: Expression) -> bool:
    return word(item, "layer").startswith("F.")


def _trace_outline(board: Expression) -> list[tuple[float, float]]:
    """List the points of the board's edge, piece by piece."""
    return [spot for piece in _edge_pieces(board) for spot in piece]


def _edge_pieces(board: Expression) -> list[list[tuple[float, float]]]:
    pieces = []
    for item in lists(board, "gr_line", "gr_arc"):
        if word(item, "layer") == "Edge.Cuts":
            names = ("start", "mid", "end") if item[0] == "gr_arc" else ("start", "end")
            spots = [(x, y) for x, y in (numbers(first(item, name))[:2] for name in names)]
            pieces.append(_bend(*spots) if len(spots) == 3 else spots)
    return pieces


def _bend(start: tuple[float, float], mid: tuple[float, float], end: tuple[float, float]) -> list[tuple[float, float]]:
    """Divide an arc through three points into straight pieces."""
    (ax, ay), (bx, by), (cx, cy) = start, mid, end
    d = 2 * (ax * (by - cy) + bx * (cy - ay) + cx * (ay - by))
    if d == 0.0:
        return [start, mid, end]
    squares = ax * ax + ay * ay, bx * bx + by * by, cx * cx + cy * cy
    ux = (squares[0] * (by - cy) + squares[1] * (cy - ay) + squares[2] * (ay - by)) / d
    uy = (squares[0] * (cx - bx) + squares[1] * (ax - cx) + squares[2] * (bx - ax)) / d
    angles = [math.atan2(y - uy, x - ux) for x, y in (start, mid, end)]
    first_turn = (angles[1] - angles[0] + math.pi) % math.tau - math.pi
    second_turn = (angles[2] - angles[1] + math.pi) % math.tau - math.pi
    radius, whole = math.hypot(ax - ux, ay - uy), first_turn + second_turn
    steps = (angles[0] + whole * i / _ARC_STEPS for i in range(_ARC_STEPS + 1))
    return [(ux + radius * math.cos(a), uy + radius * math.sin(a)) for a in steps]


def draw_outline(board: Expression, *, is_back: bool = False) -> Markup:
    """Fill the board within its edge, whose pieces may come in any order."""
    pieces = _edge_pieces(board)
    chain = pieces.pop(0)
    while pieces:
        end = chain[-1]
        nearest = min(pieces, key=lambda piece: min(math.dist(piece[0], end), math.dist(piece[-1], end)))
        pieces.remove(nearest)
        chain = chain + (nearest if math.dist(nearest[0], end) <= math.dist(nearest[-1], end) else nearest[::-1])
    if is_back:
        chain = [(-x, y) for x, y in chain]
    return element("path", d=_path(chain) + "Z", fill="var(--substrate)", stroke="var(--text)", stroke_width="0.15")


def _place(footprint: Expression) -> tuple[float, float, float]:
    x, y, angle = (*numbers(first(footprint, "at")), 0.0)[:3]
    return x, y, angle


def pad_boxes(footprint: Expression) -> Iterator[tuple[float, float, float, float]]:
    """Yield left, top, right and bottom of each pad of a component [mm], with its size as it is turned."""
    x, y, angle = _place(footprint)
    for pad in lists(footprint, "pad"):
        px, py, own = (*numbers(first(pad, "at")), 0.0)[:3]
        dx, dy = turn(px, py, angle)
        width, height = numbers(first(pad, "size"))
        if own % 180.0 == 90.0:
            width, height = height, width
        yield (x + dx - width / 2, y + dy - height / 2, x + dx + width / 2, y + dy + height / 2)


def _draw_pads(footprint: Expression) -> list[Markup]:
    x, y, angle = _place(footprint)
    parts = []
    for pad in lists(footprint, "pad"):
        px, py, own = (*numbers(first(pad, "at")), 0.0)[:3]
        dx, dy = turn(px, py, angle)
        width, height = numbers(first(pad, "size"))
        name, kind, shape = words(pad)[:3]
        if shape == "circle":
            drill = numbers(first(pad, "drill"))
            parts += _draw_ring((x + dx, y + dy), 0.0 if kind == "np_thru_hole" else width, drill[0] if drill else 0.0)
            continue
        ratio = float(word(pad, "roundrect_rratio", "0"))
        centre = f"{_number(x + dx)} {_number(y + dy)}"
        parts.append(
            element(
                "rect", element("title", f"{name_part(footprint)} pin {name}"), x=_number(x + dx - width / 2),
                y=_number(y + dy - height / 2), width=_number(width), height=_number(height),
                rx=_number(ratio * min(width, height)), fill=_PAD,
                transform=f"rotate({_number(-own)} {centre})" if own else None,
            )
        )  # fmt: skip
        if drill := numbers(first(pad, "drill")):
            parts += _draw_ring((x + dx, y + dy), 0.0, drill[0])
    return parts


def _draw_ring(centre: tuple[float, float], size: float, drill: float) -> list[Markup]:
    x, y = (_number(value) for value in centre)
    ring = [element("circle", cx=x, cy=y, r=_number(size / 2), fill=_PAD)] if size else []
    hole = [element("circle", cx=x, cy=y, r=_number(drill / 2), fill="var(--ground)")] if drill else []
    return [*ring, *hole]


def _draw_graphics(footprint: Expression, layer: str) -> list[Markup]:
    x, y, angle = _place(footprint)
    parts = []
    for item in lists(footprint, "fp_line", "fp_rect"):
        if word(item, "layer") != layer:
            continue
        (x0, y0), (x1, y1) = numbers(first(item, "start")), numbers(first(item, "end"))
        spots = [(x0, y0), (x1, y1)]
        if item[0] == "fp_rect":
            spots = [(x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)]
        placed = [(x + dx, y + dy) for dx, dy in (turn(px, py, angle) for px, py in spots)]
        parts.append(element("path", d=_path(placed), stroke=_SILK, stroke_width="0.12", fill="none"))
    return parts


def name_part(footprint: Expression) -> str:
    """Return the reference of a component."""
    return next((words(text)[1] for text in lists(footprint, "property") if words(text)[0] == "Reference"), "")


def _draw_names(footprint: Expression) -> list[Markup]:
    """Draw the reference where it is printed, or small on the component itself if there was no room to print it."""
    text = next((text for text in lists(footprint, "property") if words(text)[0] == "Reference"), None)
    if text is None:
        return []
    x, y, angle = _place(footprint)
    if word(text, "layer") == "F.SilkS" and not is_hidden(text):
        return [draw_text(words(text)[1], text, (x, y, angle))]
    upright = _is_taller(footprint, angle)
    at, transform = (_number(x), _number(y)), f"rotate(-90 {_number(x)} {_number(y)})" if upright else None
    return [
        element(
            "text", words(text)[1], x=at[0], y=at[1], dy=_number(0.36 * _SMALL_MM), font_size=_number(_SMALL_MM),
            text_anchor="middle", transform=transform,
        )
    ]  # fmt: skip


def _is_taller(footprint: Expression, angle: float) -> bool:
    """Return whether the pads of a footprint, as it is turned, stand above each other rather than side by side."""
    centres = [numbers(first(pad, "at")) for pad in lists(footprint, "pad")]
    spots = [turn(x, y, angle) for x, y, *_ in centres]
    xs, ys = [x for x, _ in spots], [y for _, y in spots]
    return bool(spots) and max(ys) - min(ys) > max(xs) - min(xs)


def draw_text(content: str, item: Expression, place: tuple[float, float, float], *, is_back: bool = False) -> Markup:
    """Draw a printed text of a file, in the place of its component; from the back it reads as from the front."""
    px, py, own = (*numbers(first(item, "at")), 0.0)[:3]
    dx, dy = turn(px, py, place[2])
    x, y = (-1.0 if is_back else 1.0) * (place[0] + dx), place[1] + dy
    size = numbers(first(first(first(item, "effects"), "font"), "size"))[0]
    upright = own % 180.0 == 90.0
    justify = words(first(first(item, "effects"), "justify"))
    anchor = "start" if "left" in justify else "end" if "right" in justify else "middle"
    return element(
        "text", content, x=_number(x), y=_number(y), dy=_number(0.36 * size), font_size=_number(size * 1.1),
        text_anchor=anchor, transform=f"rotate(-90 {_number(x)} {_number(y)})" if upright else None,
    )  # fmt: skip


def _path(spots: list[tuple[float, float]]) -> str:
    return "M" + "L".join(f"{_number(x)} {_number(y)}" for x, y in spots)


def _number(value: float) -> str:
    return f"{round(value, 3) + 0.0:.3f}".rstrip("0").rstrip(".")


# Back of a board as SVG, seen from the back: its print, the pins that come through, and where the parts stand.


_REFERENCE = re.compile(r"[A-Z]+\d+(?= )")
"""Reference at the beginning of a printed line of the list of values."""
_BACK_MARGIN_MM = 0.25
"""Distance of a part's frame from its pads [mm]."""


def render_back(text: str, title: str) -> Markup:
    """Render a `.kicad_pcb` file as seen from the back. All parts stand on the front; a frame shows where."""
    board = parse(text)
    parts = [draw_outline(board, is_back=True)]
    for footprint in lists(board, "footprint"):
        if shapes := [*_draw_place(footprint), *_draw_pins(footprint)]:
            parts.append(mark_part(name_part(footprint), shapes))
    for item in lists(board, "gr_text"):
        if word(item, "layer") == "B.SilkS":
            content = words(item)[0]
            reference = _REFERENCE.match(content)
            drawn = draw_text(content, item, (0.0, 0.0, 0.0), is_back=True)
            parts.append(mark_part(reference[0], [drawn]) if reference else drawn)
    return draw_frame(board, title, parts, is_back=True)


def _draw_place(footprint: Expression) -> list[Markup]:
    """Draw a frame around the pads of a part."""
    boxes = list(pad_boxes(footprint))
    if not boxes:
        return []
    left, top = min(box[0] for box in boxes) - _BACK_MARGIN_MM, min(box[1] for box in boxes) - _BACK_MARGIN_MM
    right, bottom = max(box[2] for box in boxes) + _BACK_MARGIN_MM, max(box[3] for box in boxes) + _BACK_MARGIN_MM
    return [
        element(
            "rect", element("title", name_part(footprint)), x=f"{-right:.3f}", y=f"{top:.3f}",
            width=f"{right - left:.3f}", height=f"{bottom - top:.3f}", class_="place",
        )
    ]  # fmt: skip


def _draw_pins(footprint: Expression) -> list[Markup]:
    """Draw the pads that come through the board."""
    through = [words(pad)[1] in ("thru_hole", "np_thru_hole") for pad in lists(footprint, "pad")]
    drills = [numbers(first(pad, "drill")) for pad in lists(footprint, "pad")]
    return [
        element(
            "circle", cx=f"{-(left + right) / 2:.3f}", cy=f"{(top + bottom) / 2:.3f}", r=f"{drill[0] / 2:.3f}",
            fill="var(--ground)", stroke="var(--pad)", stroke_width="0.3",
        )
        for is_through, drill, (left, top, right, bottom) in zip(through, drills, pad_boxes(footprint), strict=True)
        if is_through and drill
    ]  # fmt: skip
