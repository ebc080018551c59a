"""Back of a board as SVG, seen from the back: its print, the pins that come through, and where the parts stand."""

from __future__ import annotations

import re

from fingertip.board.kicad.sexpr import Expression
from fingertip.page.html import Markup, element
from fingertip.page.kicad_text import first, lists, numbers, parse, word, words
from fingertip.page.layout_svg import draw_frame, draw_outline, draw_text, mark_part, name_part, pad_boxes

_REFERENCE = re.compile(r"[A-Z]+\d+(?= )")
"""Reference at the beginning of a printed line of the list of values."""
_MARGIN_MM = 0.25
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
    left, top = min(box[0] for box in boxes) - _MARGIN_MM, min(box[1] for box in boxes) - _MARGIN_MM
    right, bottom = max(box[2] for box in boxes) + _MARGIN_MM, max(box[3] for box in boxes) + _MARGIN_MM
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
