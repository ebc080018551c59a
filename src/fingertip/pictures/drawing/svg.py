"""Renderer of a sheet to SVG, in millimetres."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape

from fingertip.pictures.drawing.primitives import Arc, Arrow, Hatch, Point, Polyline, Primitive, Sheet, Style, Text


def render_svg(sheet: Sheet) -> bytes:
    """Render a sheet. Every line of text is as wide as the layout assumes, whatever font the viewer has."""
    width, height = _number(sheet.width), _number(sheet.height)
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}mm" height="{height}mm" '
        f'viewBox="0 0 {width} {height}">',
        f"<title>{escape(sheet.name, quote=False)}</title>",
        f'<rect width="{width}" height="{height}" fill="white"/>',
        '<g fill="none" stroke="black" stroke-linecap="round" stroke-linejoin="round" '
        'font-family="Helvetica, Arial, sans-serif">',
    ]
    for primitive in sheet.primitives:
        lines += _render(primitive, sheet.height)
    return ("\n".join([*lines, "</g>", "</svg>"]) + "\n").encode()


def _render(primitive: Primitive, height: float) -> Iterable[str]:
    match primitive:
        case Polyline(points, style):
            yield f'<path d="{_path(points, height)}"{_stroke(style)}/>'
        case Arc(_, _, _, _, style):
            yield _arc(primitive, height, style)
        case Arrow():
            yield f'<path d="{_path(primitive.corners(), height)}Z" fill="black" stroke="none"/>'
        case Text(text, _, _, _, turned):
            x, y = primitive.start
            place = f"{_number(x)} {_number(height - y)}"
            turn = f' transform="rotate(-90 {place})"' if turned else ""
            yield (
                f'<text x="{_number(x)}" y="{_number(height - y)}" font-size="{_number(primitive.size)}" '
                f'textLength="{_number(primitive.width)}" lengthAdjust="spacingAndGlyphs" fill="black" stroke="none"'
                f"{turn}>{escape(text, quote=False)}</text>"
            )
        case Hatch():
            for hatched in primitive.lines():
                yield from _render(hatched, height)


def _arc(arc: Arc, height: float, style: Style) -> str:
    (x, y), r = arc.centre, _number(arc.radius)
    if arc.end_deg - arc.start_deg >= 360.0:
        return f'<circle cx="{_number(x)}" cy="{_number(height - y)}" r="{r}"{_stroke(style)}/>'
    (x0, y0), (x1, y1) = arc.points(1)
    large = int(arc.end_deg - arc.start_deg > 180.0)
    start, end = f"{_number(x0)} {_number(height - y0)}", f"{_number(x1)} {_number(height - y1)}"
    return f'<path d="M{start}A{r} {r} 0 {large} 0 {end}"{_stroke(style)}/>'


def _path(points: Iterable[Point], height: float) -> str:
    return "M" + "L".join(f"{_number(x)} {_number(height - y)}" for x, y in points)


def _stroke(style: Style) -> str:
    dashes = " ".join(_number(length) for length in style.dashes_mm)
    cap = ' stroke-linecap="butt"' if dashes else ""
    return f' stroke-width="{style.width_mm:g}"' + (f' stroke-dasharray="{dashes}"{cap}' if dashes else "")


def _number(value: float) -> str:
    """Format a length to a thousandth of a millimetre."""
    return f"{round(value, 3) + 0.0:.3f}".rstrip("0").rstrip(".")
