"""Scene of shaded meshes with labels and arrows, drawn as PNG.

Labels stand in the margins, on the side of what they name, one below the other, so that none covers
the parts or another label.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from fingertip.cad.kernel.mesh import Mesh
from fingertip.foundation.numerics import Array
from fingertip.models.solids import Point3
from fingertip.pictures.raster import Camera, Canvas, Colour, Pen, bounds, to_png
from fingertip.pictures.section import spread

Pixel: TypeAlias = tuple[float, float]
"""Point of a picture [pixels], to the right and down from its upper left corner."""

_WIDTH_PX = 900
"""Width of every picture."""
_MAX_SCENE_HEIGHT_PX = 512
"""Largest height of the meshes and arrows in a picture."""
MARGIN_PX = 200
"""Width of the margin for labels on each side."""
_PADDING_PX = 24
"""Width of the empty edge on all sides."""
_COLOURS = 128
"""Number of colours in the palette of a picture."""

_FONT_PX = 16
"""Size of the font of labels."""
_LINE_PX = 20
"""Distance between two baselines of a label."""
_GAP_LINES = 0.6
"""Least gap between two labels, in lines."""
_WISHED_GAP_LINES = 1
"""Gap between two labels for which a picture has room, in lines."""
_INK = (35, 35, 40)
"""Colour of labels, and of the dots that their leaders end at."""

_LEADER = (115, 115, 120)
"""Colour of the lines between labels and what they name."""
_LEADER_GAP_PX = 6
"""Gap between a label and its leader."""
_DOT_RADIUS_PX = 3
"""Radius of the dot at the end of a leader."""

_ARROW = (176, 44, 24)
"""Colour of arrows."""
_SHAFT_PX = 4
"""Width of an arrow's shaft."""
_HEAD_PX = 13.0
"""Length of the edges of an arrow's head."""
_HEAD_ANGLE = math.radians(24.0)
"""Angle between an edge of an arrow's head and its shaft."""
_TIP_PX = 4
"""Length of an arrow's head past the end of its shaft."""


@dataclass(frozen=True)
class PaintedMesh:
    """Mesh with its colour."""

    mesh: Mesh
    colour: Colour


@dataclass(frozen=True)
class Label:
    """Text with a line to a point of the scene."""

    text: str
    """One line, or several that are separated by line feeds."""
    point_mm: Point3

    @property
    def line_count(self) -> int:
        """Number of lines of the text."""
        return self.text.count("\n") + 1


@dataclass(frozen=True)
class Arrow:
    """Motion of a part or a force on it."""

    start_mm: Point3
    end_mm: Point3


class Scene:
    """Content of a picture: meshes, their camera, and what is written beside them."""

    def __init__(
        self, meshes: Iterable[PaintedMesh], camera: Camera, *marks: Label | Arrow
    ) -> None:
        self.meshes = tuple(meshes)
        self.camera = camera
        self.labels = [mark for mark in marks if isinstance(mark, Label)]
        self.arrows = [mark for mark in marks if isinstance(mark, Arrow)]


@dataclass(frozen=True)
class _Margin:
    """Margin for labels at one edge of a picture."""

    text_x: int
    """Coordinate at which the labels begin or end [pixels]."""
    inwards: int
    """Direction from the edge to the scene: 1 to the right, -1 to the left."""
    anchor: Literal["lm", "rm"]
    """Point of a label that lies at `text_x`, as Pillow names it."""
    align: Literal["left", "right"]
    """Alignment of a label's lines."""


_LEFT = _Margin(text_x=_PADDING_PX, inwards=1, anchor="lm", align="left")
"""Margin at the left edge."""
_RIGHT = _Margin(text_x=_WIDTH_PX - _PADDING_PX, inwards=-1, anchor="rm", align="right")
"""Margin at the right edge."""
_MARGINS = (_LEFT, _RIGHT)


@dataclass(frozen=True)
class _Frame:
    """Height of a scene's picture, and where it shows the points of the scene."""

    camera: Camera
    centre_mm: Array
    """Point that lies in the middle of the picture."""
    pixels_per_mm: float
    height_px: int

    def to_pixel(self, point_mm: Point3) -> Pixel:
        """Return where a point of the scene appears."""
        from_centre = np.array(point_mm) - self.centre_mm
        right, up, _ = from_centre @ self.camera.axes.T * self.pixels_per_mm
        return _WIDTH_PX / 2 + float(right), self.height_px / 2 - float(up)


def draw_scene(scene: Scene) -> bytes:
    """Draw a scene as PNG, 900 pixels wide and as high as it needs."""
    frame = _frame_scene(scene)
    picture = Image.fromarray(_render_meshes(scene, frame))
    pen = ImageDraw.Draw(picture)

    for arrow in scene.arrows:
        _draw_arrow(pen, frame.to_pixel(arrow.start_mm), frame.to_pixel(arrow.end_mm))

    for margin in _MARGINS:
        labels = _labels_in(margin, scene, frame.centre_mm)
        _draw_labels(pen, margin, labels, frame)

    palette_picture = picture.quantize(
        _COLOURS, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE
    )
    return to_png(palette_picture)


def _frame_scene(scene: Scene) -> _Frame:
    """Return the frame in which meshes and arrows fit between the margins, and labels into them."""
    centre_mm, size_mm = bounds(_extent(scene), scene.camera)
    pixels_per_mm = min(
        (_WIDTH_PX - 2 * MARGIN_PX) / size_mm[0],
        _MAX_SCENE_HEIGHT_PX / size_mm[1],
    )

    scene_height_px = int(size_mm[1] * pixels_per_mm)
    label_height_px = max(
        _wished_height_px(_labels_in(margin, scene, centre_mm)) for margin in _MARGINS
    )
    height_px = max(scene_height_px, label_height_px) + 2 * _PADDING_PX

    return _Frame(scene.camera, centre_mm, pixels_per_mm, height_px)


def _extent(scene: Scene) -> list[Mesh]:
    """Return what a picture must show whole: the meshes, and the ends of all arrows."""
    meshes = [item.mesh for item in scene.meshes]
    ends: list[Point3] = []

    for arrow in scene.arrows:
        ends += (arrow.start_mm, arrow.end_mm)

    points = Mesh(np.array(ends).reshape(-1, 3), np.zeros((0, 3), dtype=np.int32))
    return [*meshes, points]


def _wished_height_px(labels: Iterable[Label]) -> int:
    """Return the height of labels one below the other, each with a line of gap."""
    return _LINE_PX * sum(label.line_count + _WISHED_GAP_LINES for label in labels)


def _render_meshes(scene: Scene, frame: _Frame) -> NDArray[np.uint8]:
    """Return the picture of the meshes alone, of shape (height, width, 3)."""
    canvas = Canvas(_WIDTH_PX, frame.height_px, frame.pixels_per_mm, frame.camera)
    for item in scene.meshes:
        canvas.draw(item.mesh, item.colour, frame.centre_mm)

    return canvas.image()


def _labels_in(margin: _Margin, scene: Scene, centre_mm: Array) -> list[Label]:
    """Return the labels of what lies on the side of a margin, from top to bottom."""
    right, up, _ = scene.camera.axes

    def lies_right(label: Label) -> bool:
        return bool((np.array(label.point_mm) - centre_mm) @ right > 0)

    def height_mm(label: Label) -> float:
        return float(np.array(label.point_mm) @ up)

    labels = [label for label in scene.labels if lies_right(label) == (margin is _RIGHT)]
    return sorted(labels, key=lambda label: -height_mm(label))


def _draw_labels(pen: Pen, margin: _Margin, labels: list[Label], frame: _Frame) -> None:
    """Write labels into a margin, each as near as it can be to the height of its point."""
    font = ImageFont.load_default(size=_FONT_PX)
    tips = [frame.to_pixel(label.point_mm) for label in labels]
    heights = [_LINE_PX * (label.line_count + _GAP_LINES) for label in labels]
    middles = spread(heights, [y for _, y in tips], frame.height_px)

    for label, tip, middle_y in zip(labels, tips, middles, strict=True):
        pen.multiline_text(
            (margin.text_x, middle_y),
            label.text,
            fill=_INK,
            font=font,
            anchor=margin.anchor,
            spacing=_LINE_PX - _FONT_PX,
            align=margin.align,
        )
        text_width = max(font.getlength(line) for line in label.text.split("\n"))
        leader_x = margin.text_x + margin.inwards * (text_width + _LEADER_GAP_PX)
        _draw_leader(pen, (leader_x, middle_y), tip)


def _draw_leader(pen: Pen, start: Pixel, tip: Pixel) -> None:
    """Draw the line from a label to the point that it names, with a dot on the point."""
    x, y = tip
    dot = (x - _DOT_RADIUS_PX, y - _DOT_RADIUS_PX, x + _DOT_RADIUS_PX, y + _DOT_RADIUS_PX)

    pen.line([start, tip], fill=_LEADER, width=1)
    pen.ellipse(dot, fill=_INK)


def _draw_arrow(pen: Pen, start: Pixel, end: Pixel) -> None:
    """Draw an arrow whose head reaches a little past its end."""
    x, y = end
    angle = math.atan2(y - start[1], x - start[0])

    def from_end(distance_px: float, direction: float) -> Pixel:
        return x + distance_px * math.cos(direction), y + distance_px * math.sin(direction)

    head = [
        from_end(_TIP_PX, angle),
        from_end(-_HEAD_PX, angle - _HEAD_ANGLE),
        from_end(-_HEAD_PX, angle + _HEAD_ANGLE),
    ]
    pen.line([start, end], fill=_ARROW, width=_SHAFT_PX)
    pen.polygon(head, fill=_ARROW)
