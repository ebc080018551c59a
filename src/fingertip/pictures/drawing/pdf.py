"""Renderer of sheets to one PDF, a page each, with reportlab."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import Any

from fingertip.foundation import extras
from fingertip.foundation.version import __version__
from fingertip.pictures.drawing.primitives import Arc, Arrow, Hatch, Point, Polyline, Primitive, Sheet, Style, Text

_POINTS_PER_MM = 72.0 / 25.4
_FONT = "Helvetica"
"""One of the fonts that every viewer has, so that none is embedded."""


def render_pdf(sheets: Sequence[Sheet], title: str) -> bytes:
    """Render sheets. The file holds no date and no random identifier. Raises MissingLibraryError."""
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
            _render(page, primitive)
        page.showPage()
    page.save()
    return buffer.getvalue()


def _render(page: Any, primitive: Primitive) -> None:
    match primitive:
        case Polyline(points, style):
            _stroke(page, points, style)
        case Arc(_, _, _, _, style):
            _stroke(page, primitive.points(), style)
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
        case Hatch():
            for hatched in primitive.lines():
                _render(page, hatched)


def _stroke(page: Any, points: Sequence[Point], style: Style) -> None:
    page.setLineWidth(style.width_mm)
    page.setDash(list(style.dashes_mm))
    page.setLineCap(0 if style.dashes_mm else 1)
    page.drawPath(_path(page, points), stroke=1, fill=0)


def _path(page: Any, points: Sequence[Point]) -> Any:
    path = page.beginPath()
    path.moveTo(*(round(v, 3) for v in points[0]))
    for point in points[1:]:
        path.lineTo(*(round(v, 3) for v in point))
    return path
