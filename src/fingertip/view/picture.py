"""Picture of a design: exploded views from the dorsal and palmar sides, and a section along the finger."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator, to_canonical_mesh
from fingertip.cad.shapes.bone import sensor_body
from fingertip.cad.shapes.parts import PARTS, parts_by_name
from fingertip.design import Design
from fingertip.view.raster import Camera, Canvas, Colour, bounds

_TOLERANCE_MM = 0.02
_MARGIN_PX = 36
_SENSOR_COLOUR: Colour = (0.86, 0.68, 0.24)


@dataclass(frozen=True)
class PlacedMesh:
    """Mesh at the position where it is drawn."""

    label: str
    mesh: Mesh
    colour: Colour


def draw(design: Design, width_px: int = 1600, progress: Callable[[str], None] = lambda message: None) -> bytes:
    """Draw two exploded views of a design above a section through the closed mold.

    Parameters
    ----------
    design
        The fingertip.
    width_px
        Width of the picture [pixels]; the height follows from it.
    progress
        Called with a message for each view.

    Returns
    -------
    bytes
        Picture as PNG.
    """
    from PIL import Image

    evaluator = MeshEvaluator(_TOLERANCE_MM)
    parts = {name: evaluator.mesh(part.solid(design)) for name, part in parts_by_name(design).items()}
    parts["sensor"] = evaluator.mesh(sensor_body(design))
    exploded = _explode(parts)
    half = width_px // 2
    panels = []
    for title, placed, camera, width in (
        ("dorsal view", exploded, Camera.from_angles(28, 24), half),
        ("palmar view", exploded, Camera.from_angles(28, -26), width_px - half),
        ("longitudinal section of the closed mold", _cut_open(design, evaluator), Camera.from_angles(0, 0), width_px),
    ):
        progress(f"drawing: {title}")
        panels.append(_draw_panel(title, placed, camera, width, labelled=placed is exploded))
    top_height = max(panels[0].shape[0], panels[1].shape[0])
    picture = np.full((top_height + panels[2].shape[0], width_px, 3), 255, dtype=np.uint8)
    picture[: panels[0].shape[0], :half] = panels[0]
    picture[: panels[1].shape[0], half:] = panels[1]
    picture[top_height:] = panels[2]
    file = io.BytesIO()
    Image.fromarray(picture).save(file, format="PNG", optimize=True)
    return file.getvalue()


def _explode(parts: Mapping[str, Mesh]) -> list[PlacedMesh]:
    """Move the parts apart: mold halves above and below, and between them the bone with its sensor and the skin."""
    size = {name: np.ptp(mesh.vertices, axis=0) for name, mesh in parts.items()}
    gap = 6.0
    spread = size["bone"][1] + size["mold_palmar"][1] / 2 + 2 * gap
    shift = {
        "mold_dorsal": (0.0, spread, 0.0),
        "skin": (0.0, 0.0, size["skin"][2] * 0.55 + gap),
        "bone": (0.0, 2.0, -size["skin"][2] * 0.55),
        "sensor": (0.0, 2.0 - gap, -size["skin"][2] * 0.55),
        "mold_palmar": (0.0, -spread, 0.0),
    }
    if "lid" in parts:
        shift["lid"] = (0.0, 2.0 + gap, -size["skin"][2] * 0.55)
    if "core" in parts:
        shift["core"] = (0.0, 2.0, shift["bone"][2] - size["bone"][2] - 2 * gap)
    colours = {name: part.colour for name, part in PARTS.items()} | {"sensor": _SENSOR_COLOUR}
    return [
        PlacedMesh(name, Mesh(parts[name].vertices + np.array(offset), parts[name].triangles), colours[name])
        for name, offset in shift.items()
    ]


def _cut_open(design: Design, evaluator: MeshEvaluator) -> list[PlacedMesh]:
    """Place what lies in the closed mold, without the half of each part on the viewer's side of the plane x = 0."""
    solids = {name: part.solid(design) for name, part in parts_by_name(design).items()}
    if "core" in solids:  # a sleeve is cast around the core, without bone and sensor
        solids = {name: solid for name, solid in solids.items() if name not in ("bone", "lid")}
    else:
        solids["sensor"] = sensor_body(design)
    colours = {name: part.colour for name, part in PARTS.items()} | {"sensor": _SENSOR_COLOUR}
    return [
        PlacedMesh(
            name, to_canonical_mesh(evaluator.manifold(solid).trim_by_plane((1.0, 0.0, 0.0), 0.0)), colours[name]
        )
        for name, solid in solids.items()
    ]


def _draw_panel(
    title: str, placed: list[PlacedMesh], camera: Camera, width_px: int, *, labelled: bool
) -> NDArray[np.uint8]:
    from PIL import Image, ImageDraw, ImageFont

    centre, size = bounds([item.mesh for item in placed], camera)
    scale = (width_px - 2 * _MARGIN_PX) / size[0]
    if not labelled:
        scale *= 0.62  # the section is long and flat, so it need not fill the width
    height_px = int(size[1] * scale) + 2 * _MARGIN_PX + 24
    canvas = Canvas(width_px, height_px, scale, camera)
    for item in placed:
        canvas.draw(item.mesh, item.colour, centre)
    picture = Image.fromarray(canvas.image())
    pen, font = ImageDraw.Draw(picture), ImageFont.load_default(size=17)
    pen.text((16, 10), title, fill=(40, 40, 40), font=font)
    for item in placed if labelled else []:
        projected = (item.mesh.vertices - centre) @ camera.axes.T * scale
        (left, low), (right, high) = projected.min(axis=0)[:2], projected.max(axis=0)[:2]
        x, y, anchor = {
            "mold_dorsal": (right, high, "rt"),
            "skin": (right, low - 4, "rt"),
        }.get(item.label, (left, low - 2, "lt"))
        position = (width_px / 2 + x, height_px / 2 - y)
        pen.text(position, item.label.replace("_", " "), fill=(40, 40, 40), font=font, anchor=anchor)
    return np.asarray(picture)
