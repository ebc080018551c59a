"""Scenes of the casting steps, drawn as PNG: parts and tools as shaded meshes, with arrows and
labels.

Labels stand in the margins, on the side of what they name, one below the other, so that none covers
the parts or another label.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator, to_canonical_mesh
from fingertip.design import Design
from fingertip.foundation.numerics import Array
from fingertip.models.parts import PARTS
from fingertip.models.sensor_pocket import sensor_body
from fingertip.models.solids import Box, Point3, Solid, cylinder
from fingertip.pictures.raster import Camera, Canvas, Colour, Pen, bounds, to_png
from fingertip.pictures.section import spread

Pixel: TypeAlias = tuple[float, float]

_WIDTH_PX = 900
MARGIN_PX = 200
_PADDING_PX = 24
"""Widths of a picture, of the margins for labels, and of the empty edge."""
_MAX_HEIGHT_PX = 560
_FONT_PX = 16
_LINE_PX = 20
_INK = (35, 35, 40)
_LEADER = (115, 115, 120)
_ARROW = (176, 44, 24)
_HEAD_PX = 13.0
_HEAD_ANGLE = math.radians(24.0)
"""Length of an arrow's head, and the angle between its edge and the arrow."""


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


def draw_scene(scene: Scene) -> bytes:
    ends = np.array([(arrow.start_mm, arrow.end_mm) for arrow in scene.arrows]).reshape(-1, 3)
    arrows = Mesh(ends, np.zeros((0, 3), dtype=np.int32))
    centre, size = bounds([*(item.mesh for item in scene.meshes), arrows], scene.camera)
    room = _WIDTH_PX - 2 * MARGIN_PX, _MAX_HEIGHT_PX - 2 * _PADDING_PX
    scale = min(room[0] / size[0], room[1] / size[1])
    height = int(size[1] * scale) + 2 * _PADDING_PX
    lines = (
        sum(label.text.count("\n") + 2 for label in _labels_on(scene, side, centre))
        for side in (-1, 1)
    )
    height = max(height, _PADDING_PX * 2 + _LINE_PX * max(lines))

    canvas = Canvas(_WIDTH_PX, height, scale, scene.camera)
    for item in scene.meshes:
        canvas.draw(item.mesh, item.colour, centre)

    picture = Image.fromarray(canvas.image())
    pen = ImageDraw.Draw(picture)
    font = ImageFont.load_default(size=_FONT_PX)

    def place(point: Point3) -> Pixel:
        u, v = ((np.array(point) - centre) @ scene.camera.axes.T * scale)[:2]
        return _WIDTH_PX / 2 + float(u), height / 2 - float(v)

    for arrow in scene.arrows:
        _draw_arrow(pen, place(arrow.start_mm), place(arrow.end_mm))

    for side in (-1, 1):
        entries = [(place(label.point_mm), label.text) for label in _labels_on(scene, side, centre)]
        sizes = [_LINE_PX * (text.count("\n") + 1.6) for _, text in entries]
        middles = spread(sizes, [tip[1] for tip, _ in entries], height)
        for y, (tip, text) in zip(middles, entries, strict=True):
            x = _PADDING_PX if side < 0 else _WIDTH_PX - _PADDING_PX
            pen.multiline_text(
                (x, y),
                text,
                fill=_INK,
                font=font,
                anchor="lm" if side < 0 else "rm",
                spacing=_LINE_PX - _FONT_PX,
                align="left" if side < 0 else "right",
            )
            end = x - side * (max(font.getlength(line) for line in text.split("\n")) + 6)
            pen.line([(end, y), tip], fill=_LEADER, width=1)
            pen.ellipse([tip[0] - 3, tip[1] - 3, tip[0] + 3, tip[1] + 3], fill=_INK)

    return to_png(picture.quantize(128, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE))


def _labels_on(scene: Scene, side: int, centre: Array) -> list[Label]:
    """Return the labels of one side of the picture, from top to bottom."""
    right, up = scene.camera.axes[:2]
    chosen = [
        label
        for label in scene.labels
        if (1 if (np.array(label.point_mm) - centre) @ right > 0 else -1) == side
    ]
    return sorted(chosen, key=lambda label: -float(np.array(label.point_mm) @ up))


def _draw_arrow(pen: Pen, start: Pixel, end: Pixel) -> None:
    pen.line([start, end], fill=_ARROW, width=4)
    angle = math.atan2(end[1] - start[1], end[0] - start[0])
    head = [
        (end[0] - _HEAD_PX * math.cos(angle + turn), end[1] - _HEAD_PX * math.sin(angle + turn))
        for turn in (-_HEAD_ANGLE, _HEAD_ANGLE)
    ]
    ahead = end[0] + 4 * math.cos(angle), end[1] + 4 * math.sin(angle)
    pen.polygon([ahead, *head], fill=_ARROW)


class View:
    """Cameras that several scenes share, with distal (z) to the right."""

    DORSAL = Camera.from_angles(28, 24)
    PALMAR = Camera.from_angles(28, -38)
    CUT_FROM_BELOW = Camera.from_angles(24, -24)
    """Camera on the cut face of a section and on the palmar side, where the sensor lies."""


class Paint:
    """Colours of what lies beside the parts."""

    SENSOR = (0.86, 0.68, 0.24)
    WIRE = (0.72, 0.20, 0.16)
    STEEL = (0.62, 0.63, 0.66)
    GLASS = (0.80, 0.86, 0.90)
    SILICONE = PARTS["skin"].colour
    PAPER = (0.93, 0.91, 0.86)


_TOLERANCE_MM = 0.05
_WALL_MM = 0.8
"""Tolerance of the meshes, and wall of drawn cups [mm]."""
CUP_RADIUS_MM = 22.0
_CUP_HEIGHT_MM = 45.0


class Workbench:
    """Parts of one design and what lies with them, as meshes."""

    def __init__(self, design: Design) -> None:
        self.design = design
        self.dims = design.dimensions
        self.evaluator = MeshEvaluator(_TOLERANCE_MM)
        self._meshes: dict[tuple[Solid, bool], Mesh] = {}

    @property
    def head(self) -> Point3:
        """Middle of the sensor's head, on the flat or its platform."""
        return 0.0, -self.dims.platform_depth, self.dims.sensor_z

    def solid(
        self,
        solid: Solid,
        colour: Colour,
        shift: Point3 = (0.0, 0.0, 0.0),
        *,
        cut: bool = False,
    ) -> PaintedMesh:
        """Show a solid, shifted, and cut open along x = 0 if asked for."""
        mesh = self._meshes.get((solid, cut))
        if mesh is None:
            manifold = self.evaluator.manifold(solid)
            if cut:
                manifold = manifold.trim_by_plane((1.0, 0.0, 0.0), 0.0)

            mesh = to_canonical_mesh(manifold)
            self._meshes[solid, cut] = mesh

        return PaintedMesh(Mesh(mesh.vertices + np.array(shift), mesh.triangles), colour)

    def part(self, name: str, shift: Point3 = (0.0, 0.0, 0.0), *, cut: bool = False) -> PaintedMesh:
        return self.solid(PARTS[name].solid(self.design), PARTS[name].colour, shift, cut=cut)

    def sensor(self, shift: Point3 = (0.0, 0.0, 0.0)) -> PaintedMesh:
        return self.solid(sensor_body(self.design), Paint.SENSOR, shift)

    def turned_up_skin(self, fold_z: float, shift_z: float) -> list[PaintedMesh]:
        """Show half of the skin, shifted, its edge turned inside out up to a height there."""
        outer = self.dims.outer.section
        skin = PARTS["skin"]
        whole = self.evaluator.manifold(skin.solid(self.design)).translate((0.0, 0.0, shift_z))
        half = whole.trim_by_plane((1.0, 0.0, 0.0), 0.0)
        tip, edge = (
            to_canonical_mesh(half.trim_by_plane((0.0, 0.0, way), way * fold_z))
            for way in (1.0, -1.0)
        )
        x, y, z = edge.vertices.T
        height = np.where(y < 0.0, outer.palmar, outer.dorsal)
        out = 2.0 / np.hypot(x / outer.half_width, y / height) - 1.0
        turned = Mesh(np.stack((x * out, y * out, 2.0 * fold_z - z), axis=1), edge.triangles)

        return [PaintedMesh(tip, skin.colour), PaintedMesh(turned, skin.colour)]

    def assembled_bone(self) -> list[PaintedMesh]:
        return [self.part("bone"), self.sensor()]

    def cup(self, level: float) -> list[PaintedMesh]:
        """Show a cup that stands on z = 0, cut open, filled to a level [mm]."""
        middle = (0.0, 0.0)
        reach = 2 * CUP_RADIUS_MM
        outside = cylinder(
            "z",
            centre=middle,
            low=0.0,
            high=_CUP_HEIGHT_MM,
            radius=CUP_RADIUS_MM + _WALL_MM,
        )
        inside = cylinder(
            "z",
            centre=middle,
            low=_WALL_MM,
            high=_CUP_HEIGHT_MM + 1.0,
            radius=CUP_RADIUS_MM,
        )
        front = Box((-reach, -reach, _WALL_MM), (reach, 0.0, _CUP_HEIGHT_MM + 1.0))
        content = cylinder(
            "z",
            centre=middle,
            low=_WALL_MM,
            high=_WALL_MM + level,
            radius=0.99 * CUP_RADIUS_MM,
        )

        return [
            self.solid(outside.cut(inside, front), Paint.GLASS),
            self.solid(content, Paint.SILICONE),
        ]
