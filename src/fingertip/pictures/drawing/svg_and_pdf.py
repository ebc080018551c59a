"""Renderers of sheets [mm]: to SVG, and to one PDF with a page for each, by reportlab."""

from __future__ import annotations

import io
from collections.abc import Iterable, Sequence
from html import escape
from typing import Any

from fingertip import __version__
from fingertip.foundation import extras
from fingertip.pictures.drawing.primitives import (
    Arrow,
    Hatch,
    Point,
    Polyline,
    Primitive,
    Ring,
    Sheet,
    Style,
    Text,
)

_POINTS_PER_MM = 72.0 / 25.4
_FONT = "Helvetica"
"""One of the fonts that every viewer has, so that none is embedded."""


def render_svg(sheet: Sheet) -> bytes:
    """Render a sheet.

    Every line of text is as wide as the layout assumes, whatever font the viewer has.
    """
    width = _number(sheet.width)
    height = _number(sheet.height)
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}mm" height="{height}mm" '
        f'viewBox="0 0 {width} {height}">',
        f"<title>{escape(sheet.name, quote=False)}</title>",
        f'<rect width="{width}" height="{height}" fill="white"/>',
        '<g fill="none" stroke="black" stroke-linecap="round" stroke-linejoin="round" '
        'font-family="Helvetica, Arial, sans-serif">',
    ]
    for primitive in sheet.primitives:
        lines += _svg_lines(primitive, sheet.height)

    return ("\n".join([*lines, "</g>", "</svg>"]) + "\n").encode()


def _svg_lines(primitive: Primitive, height: float) -> Iterable[str]:
    match primitive:
        case Polyline(points, style):
            yield f'<path d="{_svg_path(points, height)}"{_svg_stroke(style)}/>'
        case Ring((x, y), radius, style):
            centre = f'cx="{_number(x)}" cy="{_number(height - y)}"'
            yield f'<circle {centre} r="{_number(radius)}"{_svg_stroke(style)}/>'
        case Arrow():
            yield (
                f'<path d="{_svg_path(primitive.corners(), height)}Z" fill="black" stroke="none"/>'
            )
        case Text(text, _, _, _, turned):
            x, y = primitive.start
            place = f"{_number(x)} {_number(height - y)}"
            turn = f' transform="rotate(-90 {place})"' if turned else ""
            yield (
                f'<text x="{_number(x)}" y="{_number(height - y)}" '
                f'font-size="{_number(primitive.size)}" '
                f'textLength="{_number(primitive.width)}" lengthAdjust="spacingAndGlyphs" '
                'fill="black" stroke="none"'
                f"{turn}>{escape(text, quote=False)}</text>"
            )
        case Hatch():
            for hatched in primitive.lines():
                yield from _svg_lines(hatched, height)


def _svg_path(points: Iterable[Point], height: float) -> str:
    return "M" + "L".join(f"{_number(x)} {_number(height - y)}" for x, y in points)


def _svg_stroke(style: Style) -> str:
    stroke = f' stroke-width="{style.width_mm:g}"'
    dashes = " ".join(_number(length) for length in style.dashes_mm)
    if dashes:
        stroke += f' stroke-dasharray="{dashes}" stroke-linecap="butt"'

    return stroke


def _number(value: float) -> str:
    return f"{round(value, 3) + 0.0:.3f}".rstrip("0").rstrip(".")


def render_pdf(sheets: Sequence[Sheet], title: str) -> bytes:
    """Render sheets.

    The file holds no date and no random identifier. Raises MissingLibraryError.
    """
    module = extras.load("reportlab.pdfgen.canvas", "drawing.pdf")
    buffer = io.BytesIO()
    page = module.Canvas(buffer, invariant=1, pageCompression=1)
    page.setTitle(title)
    page.setAuthor("")
    page.setCreator(f"fingertip {__version__}")

    for sheet in sheets:
        page.setPageSize((sheet.width * _POINTS_PER_MM, sheet.height * _POINTS_PER_MM))
        page.scale(_POINTS_PER_MM, _POINTS_PER_MM)
        page.setLineCap(1)
        page.setLineJoin(1)
        for primitive in sheet.primitives:
            _draw(page, primitive)

        page.showPage()

    page.save()
    return buffer.getvalue()


def _draw(page: Any, primitive: Primitive) -> None:
    match primitive:
        case Arrow():
            path = _path(page, primitive.corners())
            path.close()
            page.drawPath(path, stroke=0, fill=1)
        case Text(text, _, _, _, turned):
            page.saveState()
            page.translate(*(round(v, 3) for v in primitive.start))
            if turned:
                page.rotate(90)

            page.setFont(_FONT, primitive.size)
            page.drawString(0, 0, text)
            page.restoreState()
        case _:
            for points in primitive.trace():
                page.setLineWidth(primitive.style.width_mm)
                page.setDash(list(primitive.style.dashes_mm))
                page.setLineCap(0 if primitive.style.dashes_mm else 1)
                page.drawPath(_path(page, points), stroke=1, fill=0)


def _path(page: Any, points: Sequence[Point]) -> Any:
    path = page.beginPath()
    path.moveTo(*(round(v, 3) for v in points[0]))
    for point in points[1:]:
        path.lineTo(*(round(v, 3) for v in point))

    return path
