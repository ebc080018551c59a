"""Picture of a finished finger beside a ruler, and of its bone with the sensor, for README and
manual.

`python -m tools.docs_site.finger_and_ruler docs/finger.png` draws `first_finger` on a table, pad
up.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from PIL import Image, ImageChops, ImageDraw, ImageFilter, ImageFont

from fingertip import Design
from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator
from fingertip.foundation.numerics import Array
from fingertip.models.parts import PARTS
from fingertip.models.sensor_pocket import sensor_body
from fingertip.models.solids import Box, union
from fingertip.pictures.raster import Camera, Canvas, Colour, bounds, to_png

_WIDTH_PX = 800
_MARGIN_PX = 26
_OVERSAMPLE = 4
_CAMERA = Camera.looking_from((-0.5, 1.0, 0.3), (1.0, 0.0, 0.0))
"""View on the pads: those of the design point to -y, and are turned over here."""
_SHADOW = np.array((-0.55, -1.0, 0.25))
"""Direction in which shadows fall on the table."""
_RULER_MM = 60
_RULER_WIDTH_MM = 14.0
_RULER_HIGH_MM = 1.6
_GAP_MM = 4.0
_BONE = (0.95, 0.93, 0.88)
_SKIN = (0.90, 0.64, 0.53)
_SENSOR = (0.86, 0.66, 0.2)
_STEEL = (0.66, 0.67, 0.70)
_RULER = (1.06, 1.03, 0.92)
_TICK = (0.2, 0.2, 0.2)
_INK = (40, 40, 40)
_DARKEST = 0.5
_TABLE = (246, 247, 249)
_TAB_PITCH_MM = 2.54
_TAB_MM = 0.6
Item = tuple[Mesh, Colour]


def list_finger(design: Design, evaluator: MeshEvaluator, skin: bool) -> Iterator[Item]:
    """Bone, sensor with its metal legs, and skin, pad up."""
    dims = design.dimensions
    y = dims.pocket_depth - design.sensor.adhesive_thickness_mm - dims.flat_depth - 0.4
    end = dims.tail_end_z
    half = _TAB_PITCH_MM / 2
    far = end - design.sensor.tab_length_mm
    legs = union(
        *(
            Box((x - _TAB_MM / 2, y, far), (x + _TAB_MM / 2, y + 0.3, end + 1.5))
            for x in (-half, half)
        )
    )
    solids = [(PARTS["bone"].solid(design), _BONE), (sensor_body(design), _SENSOR), (legs, _STEEL)]
    for solid, colour in [*solids, (PARTS["skin"].solid(design), _SKIN)][: 4 if skin else 3]:
        yield _move(evaluator.mesh(solid), (0.0, 0.0, 0.0), turned=True), colour


def list_ruler(evaluator: MeshEvaluator, edge: float, table: float, begin: float) -> Iterator[Item]:
    """Ruler that lies on the table at y = `table`: its ticks
    begin at x = `edge` and z = `begin` [mm].
    """
    top = table + _RULER_HIGH_MM
    yield (
        evaluator.mesh(
            Box((edge - _RULER_WIDTH_MM, table, begin - 4), (edge, top, begin + _RULER_MM + 6))
        ),
        _RULER,
    )

    for mm in range(_RULER_MM + 1):
        if mm % 10 == 0:
            long = 5.0
        elif mm % 5 == 0:
            long = 3.8
        else:
            long = 2.5

        z = begin + mm
        yield evaluator.mesh(Box((edge - long, top, z - 0.09), (edge, top + 0.03, z + 0.09))), _TICK


def draw(design: Design) -> bytes:
    """Draw finger, bone and ruler as PNG."""
    evaluator = MeshEvaluator(0.01)
    finger, bone = (list(list_finger(design, evaluator, skin)) for skin in (True, False))
    low = np.min([mesh.vertices.min(axis=0) for mesh, _ in finger], axis=0)
    width = -2 * low[0] + _GAP_MM
    down = max(float(mesh.vertices[:, 1].min()) for mesh, _ in bone[:1]) - low[1]
    items = [*finger, *((_move(mesh, (width, -down, 0.0)), colour) for mesh, colour in bone)]
    edge = low[0] - _GAP_MM
    items += list_ruler(evaluator, edge, low[1], low[2])
    centre, size = bounds([mesh for mesh, _ in items], _CAMERA)
    scale = (_WIDTH_PX - 2 * _MARGIN_PX) / size[0]
    height_px = int(size[1] * scale) + 2 * _MARGIN_PX
    canvas, shadow = (
        Canvas(
            width=_WIDTH_PX,
            height=height_px,
            pixels_per_mm=scale,
            camera=_CAMERA,
            oversample=_OVERSAMPLE,
        )
        for _ in range(2)
    )

    for mesh, colour in items:
        canvas.draw(mesh, colour, centre)
        flat = mesh.vertices + np.outer(mesh.vertices[:, 1] - low[1], -_SHADOW / _SHADOW[1])
        shadow.draw(
            Mesh(flat, np.concatenate((mesh.triangles, mesh.triangles[:, ::-1]))), colour, centre
        )

    soft = Image.fromarray(shadow.cover()).filter(ImageFilter.GaussianBlur(6))
    dark = soft.point([round(255 - _DARKEST * cover) for cover in range(256)])
    picture = Image.new("RGB", (_WIDTH_PX, height_px), _TABLE)
    picture = ImageChops.multiply(picture, Image.merge("RGB", (dark, dark, dark)))
    picture.paste(Image.fromarray(canvas.image()), mask=Image.fromarray(canvas.cover()))
    pen = ImageDraw.Draw(picture)
    font = ImageFont.load_default(size=int(2.6 * scale))

    for mm in range(0, _RULER_MM + 1, 10):
        point = np.array((edge - 7.4, low[1] + _RULER_HIGH_MM, low[2] + mm))
        u, v = ((point - centre) @ _CAMERA.axes.T * scale)[:2]
        text = f"{mm} mm" if mm == _RULER_MM else f"{mm}"
        pen.text((_WIDTH_PX / 2 + u, height_px / 2 - v), text, fill=_INK, font=font, anchor="mm")

    return to_png(picture)


def _move(mesh: Mesh, by_mm: tuple[float, float, float], *, turned: bool = False) -> Mesh:
    """Move a mesh, turned over about z if asked for."""
    over: Array = np.array((-1.0, -1.0, 1.0) if turned else (1.0, 1.0, 1.0))
    return Mesh(mesh.vertices * over + np.array(by_mm), mesh.triangles)


if __name__ == "__main__":
    Path(sys.argv[1]).write_bytes(draw(Design.load("first_finger")))
