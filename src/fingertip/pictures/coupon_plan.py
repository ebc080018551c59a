"""Plan view of the fit coupon: both pieces from above, with the numbers of the lengths to measure, and the heights."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from fingertip.cad.kernel.mesh import Mesh
from fingertip.cad.shapes.coupon import COUPON_PARTS, list_heights
from fingertip.calibration.readings import Length, Point, list_lengths
from fingertip.design import Design
from fingertip.pictures.raster import Camera, Canvas, Pen, to_png

_WIDTH_PX = 1600
_FONT_PX = 21
_BALLOON_PX = 15
_ARROW_PX = 9
_SIDE_MM, _ABOVE_MM, _BELOW_MM = 10.0, 9.0, 8.0
"""Room on both sides of the pieces, above and below them [mm]."""
_APART_MM = 14.0
_OUTSIDE_MM = 3.5
"""Distance from the frame of the lines that measure the whole of it [mm]."""
_LABEL_MM = 4.5
"""Distance from a thin wall to its number [mm]."""
_RELIEF = 4.0
"""Factor of heights, so that the canvas outlines small steps too. From above nothing else changes."""
_NUMBER_AT = {"x": 0.78, "y": 0.5}
"""Place of the number along its line: lines along y cross those along x in the middle of a block."""
_LENGTH_COLOUR, _HEIGHT_COLOUR = (150, 30, 20), (20, 60, 150)
_BELOW_WALLS_MM = 1.6
"""Step by which the numbers of neighbouring thin walls stand apart [mm]."""


def draw_plan(design: Design, meshes: Mapping[str, Mesh]) -> bytes:
    """Draw both pieces from above, as they lie on the bed, as PNG."""
    low = {name: mesh.vertices.min(axis=0) for name, mesh in meshes.items()}
    high = {name: mesh.vertices.max(axis=0) for name, mesh in meshes.items()}
    frame, piece = COUPON_PARTS
    # The loose piece lies right of the frame, in the middle of its height.
    dx = float(high[frame][0] - low[piece][0]) + _APART_MM
    dy = float((high[frame] + low[frame] - high[piece] - low[piece])[1]) / 2
    shifts = {frame: (0.0, 0.0), piece: (dx, dy)}
    left, right = float(low[frame][0]) - _SIDE_MM, float(high[piece][0]) + dx + _SIDE_MM
    bottom, top = float(low[frame][1]) - _BELOW_MM, float(high[frame][1]) + _ABOVE_MM
    scale = _WIDTH_PX / (right - left)
    height_px = round((top - bottom) * scale)
    camera = Camera(np.eye(3))
    canvas = Canvas(_WIDTH_PX, height_px, scale, camera)
    centre = np.array([(left + right) / 2, top - height_px / scale / 2, 0.0])
    for name, mesh in meshes.items():
        moved = Mesh(mesh.vertices * np.array([1.0, 1.0, _RELIEF]) + np.array([*shifts[name], 0.0]), mesh.triangles)
        canvas.draw(moved, COUPON_PARTS[name].colour, centre)
    picture = Image.fromarray(canvas.image())
    pen, font = ImageDraw.Draw(picture), ImageFont.load_default(size=_FONT_PX)
    growth = design.printer.scale_percent / 100.0  # of the files

    def place(point: Point, piece: str) -> Point:
        x, y = (growth * along + shift for along, shift in zip(point, shifts[piece], strict=True))
        return (x - left) * scale, (top - y) * scale

    title = f"{design.name}: red numbers are the lengths to measure, along x or y; blue are heights, along Z [mm]"
    pen.text((14, 10), title, fill=(40, 40, 40), font=font)
    for number, length in enumerate(list_lengths(design), 1):
        start, end = (place(point, length.piece) for point in length.ends)
        _draw_length(pen, font, scale, number, length, start, end)
    for number, height in enumerate(list_heights(design), 1):
        text = f"Z{number}: {height.height_mm * growth:.2f}"
        x, y = place(height.at, height.piece)
        pen.ellipse([x - 5, y - 5, x + 5, y + 5], fill=_HEIGHT_COLOUR)
        x0, y0, x1, y1 = pen.textbbox((x + 10, y), text, font=font, anchor="lm")
        pen.rectangle([x0 - 3, y0 - 3, x1 + 3, y1 + 3], fill=(255, 255, 255), outline=_HEIGHT_COLOUR)
        pen.text((x + 10, y), text, fill=_HEIGHT_COLOUR, font=font, anchor="lm")
    x, y, reach = 30.0, height_px - 30.0, 60.0
    for end, label in (((x + reach, y), "x"), ((x, y - reach), "y")):
        pen.line([(x, y), end], fill=(40, 40, 40), width=3)
        pen.polygon(_arrow(end, (x, y)), fill=(40, 40, 40))
        pen.text((end[0] + 10, end[1] - 4), label, fill=(40, 40, 40), font=font, anchor="lm")
    return to_png(picture)


def _draw_length(pen: Pen, font: Any, scale: float, number: int, length: Length, start: Point, end: Point) -> None:
    """Draw the line between the jaws and the number: beside the line, or below a wall that is too thin for it."""
    if length.kind == "wall":
        middle = (start[0] + end[0]) / 2
        label = (middle, start[1] + (_LABEL_MM + _BELOW_WALLS_MM * (number % 2)) * scale)
        pen.line([(middle, start[1]), label], fill=_LENGTH_COLOUR, width=2)
        _draw_number(pen, font, label, number)
        return
    if length.name in ("outer_x_mm", "outer_y_mm"):
        outside = _OUTSIDE_MM * scale
        dx, dy = (0.0, -outside) if length.axis == "x" else (outside, 0.0)
        moved = [(x + dx, y + dy) for x, y in (start, end)]
        for near, far in zip((start, end), moved, strict=True):
            pen.line([near, far], fill=_LENGTH_COLOUR, width=1)
        start, end = moved
    pen.line([start, end], fill=_LENGTH_COLOUR, width=3)
    for tip, other in ((start, end), (end, start)):
        pen.polygon(_arrow(tip, other), fill=_LENGTH_COLOUR)
    share = _NUMBER_AT[length.axis]
    _draw_number(pen, font, (start[0] + share * (end[0] - start[0]), start[1] + share * (end[1] - start[1])), number)


def _arrow(tip: Point, other: Point) -> list[Point]:
    """Return the corners of an arrow head at `tip` of a line along an axis."""
    dx, dy = (float(np.sign(b - a)) * _ARROW_PX for a, b in zip(tip, other, strict=True))
    return [tip, *((tip[0] + dx + side * dy / 2, tip[1] + dy + side * dx / 2) for side in (1.0, -1.0))]


def _draw_number(pen: Pen, font: Any, at: Point, number: int) -> None:
    (x, y), r = at, _BALLOON_PX
    pen.ellipse([x - r, y - r, x + r, y + r], fill=(255, 255, 255), outline=_LENGTH_COLOUR, width=2)
    pen.text((x, y), str(number), fill=_LENGTH_COLOUR, font=font, anchor="mm")
