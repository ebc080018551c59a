"""The picture of a design: exploded from the back, exploded from the palm, and cut along the finger."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from fingertip.cad.kernel.mesh import Evaluator, Mesh, canonical
from fingertip.cad.shapes.bone import sensor_body
from fingertip.cad.shapes.parts import PARTS, parts_of
from fingertip.design import Design
from fingertip.view.raster import Camera, Canvas, Colour, bounds

_TOLERANCE_MM = 0.02
_MARGIN_PX = 36
_SENSOR_COLOUR: Colour = (0.86, 0.68, 0.24)


@dataclass(frozen=True)
class Placed:
    """A mesh where it is drawn."""

    label: str
    mesh: Mesh
    colour: Colour


def draw(design: Design, width_px: int = 1600, progress: Callable[[str], None] = lambda message: None) -> bytes:
    """PNG of a design: two exploded views over a section through the closed mold.

    Parameters
    ----------
    design
        The fingertip.
    width_px
        Width of the picture [px]; its height follows.
    progress
        Called with a sentence at each step.
    """
    from PIL import Image

    evaluator = Evaluator(_TOLERANCE_MM)
    parts = {name: evaluator.mesh(part.describe(design)) for name, part in parts_of(design).items()}
    parts["sensor"] = evaluator.mesh(sensor_body(design))
    exploded = _explode(parts)
    half = width_px // 2
    panels = []
    for title, placed, camera, width in (
        ("from the back", exploded, Camera.looking(28, 24), half),
        ("from the palm", exploded, Camera.looking(28, -26), width_px - half),
        ("cut along the finger, mold closed", _cut(design, evaluator), Camera.looking(0, 0), width_px),
    ):
        progress(f"drawing: {title}")
        panels.append(_panel(title, placed, camera, width, labelled=placed is exploded))
    top_height = max(panels[0].shape[0], panels[1].shape[0])
    sheet = np.full((top_height + panels[2].shape[0], width_px, 3), 255, dtype=np.uint8)
    sheet[: panels[0].shape[0], :half] = panels[0]
    sheet[: panels[1].shape[0], half:] = panels[1]
    sheet[top_height:] = panels[2]
    file = io.BytesIO()
    Image.fromarray(sheet).save(file, format="PNG", optimize=True)
    return file.getvalue()


def _explode(parts: Mapping[str, Mesh]) -> list[Placed]:
    """Halves above and below, the bone with its sensor and the skin drawn apart between them."""
    size = {name: np.ptp(mesh.vertices, axis=0) for name, mesh in parts.items()}
    gap = 6.0
    back = size["bone"][1] + size["mold_palmar"][1] / 2 + 2 * gap
    shift = {
        "mold_dorsal": (0.0, back, 0.0),
        "skin": (0.0, 0.0, size["skin"][2] * 0.55 + gap),
        "bone": (0.0, 2.0, -size["skin"][2] * 0.55),
        "sensor": (0.0, 2.0 - gap, -size["skin"][2] * 0.55),
        "mold_palmar": (0.0, -back, 0.0),
    }
    if "core" in parts:
        shift["core"] = (0.0, 2.0, shift["bone"][2] - size["bone"][2] - 2 * gap)
    colours = {name: part.colour for name, part in PARTS.items()} | {"sensor": _SENSOR_COLOUR}
    return [
        Placed(name, Mesh(parts[name].vertices + np.array(offset), parts[name].triangles), colours[name])
        for name, offset in shift.items()
    ]


def _cut(design: Design, evaluator: Evaluator) -> list[Placed]:
    """What lies in the closed mold, less the half nearer to the viewer."""
    expressions = {name: part.describe(design) for name, part in parts_of(design).items()}
    if "core" in expressions:  # a sleeve is cast around it, without bone and sensor
        del expressions["bone"]
    else:
        expressions["sensor"] = sensor_body(design)
    colours = {name: part.colour for name, part in PARTS.items()} | {"sensor": _SENSOR_COLOUR}
    return [
        Placed(name, canonical(evaluator.manifold(solid).trim_by_plane((1.0, 0.0, 0.0), 0.0)), colours[name])
        for name, solid in expressions.items()
    ]


def _panel(
    title: str, placed: list[Placed], camera: Camera, width_px: int, *, labelled: bool
) -> np.ndarray[tuple[int, ...], np.dtype[np.uint8]]:
    from PIL import Image, ImageDraw, ImageFont

    middle, size = bounds([item.mesh for item in placed], camera)
    scale = (width_px - 2 * _MARGIN_PX) / size[0]
    if not labelled:
        scale *= 0.62  # the section is long and flat: it need not fill the sheet
    height_px = int(size[1] * scale) + 2 * _MARGIN_PX + 24
    canvas = Canvas(width_px, height_px, scale, camera)
    for item in placed:
        canvas.draw(item.mesh, item.colour, middle)
    picture = Image.fromarray(canvas.image())
    pen, font = ImageDraw.Draw(picture), ImageFont.load_default(size=17)
    pen.text((16, 10), title, fill=(40, 40, 40), font=font)
    for item in placed if labelled else []:
        seen = (item.mesh.vertices - middle) @ camera.axes.T * scale
        (left, low), (right, high) = seen.min(axis=0)[:2], seen.max(axis=0)[:2]
        x, y, anchor = {
            "mold_dorsal": (right, high, "rt"),
            "skin": (right, low - 4, "rt"),
        }.get(item.label, (left, low - 2, "lt"))
        place = (width_px / 2 + x, height_px / 2 - y)
        pen.text(place, item.label.replace("_", " "), fill=(40, 40, 40), font=font, anchor=anchor)
    return np.asarray(picture)
