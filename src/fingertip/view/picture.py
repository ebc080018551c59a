"""Picture of a design: exploded views from both sides, a section through the mold, and a joint on the hand.

An arrow points at the place where the bone breaks first.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator, to_canonical_mesh
from fingertip.cad.shapes.bone import sensor_body
from fingertip.cad.shapes.parts import PARTS, parts_by_name
from fingertip.cad.strength.assess import assess_strength
from fingertip.design import Design
from fingertip.view.joint_view import HAND, place_on_hand
from fingertip.view.raster import Camera, Canvas, Colour, bounds

_TOLERANCE_MM = 0.02
_MARGIN_PX = 36
_COLOURS: Mapping[str, Colour] = {
    **{name: part.colour for name, part in PARTS.items()},
    "sensor": (0.86, 0.68, 0.24),
    HAND: (0.80, 0.80, 0.78),
}
"""Colours of the parts and of what lies with them."""
_MARK_REACH_MM = 1.0
"""Distance along the finger within which the surface above a weak section is looked for."""


@dataclass(frozen=True)
class PlacedMesh:
    """Mesh at the position where it is drawn."""

    label: str
    mesh: Mesh
    colour: Colour
    offset_mm: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Distance by which the mesh was moved from where the part lies."""


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
    half, mark = width_px // 2, _mark_weakest(design, evaluator, exploded)
    views: list[tuple[str, list[PlacedMesh], Camera, int]] = [
        ("dorsal view", exploded, Camera.from_angles(28, 24), half),
        ("palmar view", exploded, Camera.from_angles(28, -26), width_px - half),
        ("longitudinal section of the closed mold", _cut_open(design, evaluator), Camera.from_angles(0, 0), width_px),
    ]
    if design.dimensions.joint:
        title = f"finger on the hand: straight, and bent by {design.hand.travel_deg:g} degrees to its stop"
        views.append((title, _place_joint(design, evaluator), Camera.from_angles(0, 0), width_px))
    panels = []
    for title, placed, camera, width in views:
        progress(f"drawing: {title}")
        marks = (mark,) if title == "dorsal view" else ()
        panels.append(_draw_panel(title, placed, camera, width, labelled=placed is exploded, marks=marks))
    top_height = max(panels[0].shape[0], panels[1].shape[0])
    below = panels[2:]
    picture = np.full((top_height + sum(panel.shape[0] for panel in below), width_px, 3), 255, dtype=np.uint8)
    picture[: panels[0].shape[0], :half] = panels[0]
    picture[: panels[1].shape[0], half:] = panels[1]
    for panel in below:
        picture[top_height : top_height + panel.shape[0]] = panel
        top_height += panel.shape[0]
    file = io.BytesIO()
    Image.fromarray(picture).save(file, format="PNG", optimize=True)
    return file.getvalue()


@dataclass(frozen=True)
class Mark:
    """Text with an arrow to a point."""

    text: str
    point_mm: tuple[float, float, float]


def _mark_weakest(design: Design, evaluator: MeshEvaluator, exploded: list[PlacedMesh]) -> Mark:
    """Mark the place where the bone breaks first."""
    found = assess_strength(design, evaluator)
    weakest, vertices = found.weakest, evaluator.mesh(PARTS["bone"].solid(design)).vertices
    (dx, dy, dz) = next(item.offset_mm for item in exploded if item.label == "bone")
    y = _height_of(design, weakest.place)
    if y is None:
        beside = np.abs(vertices[:, 2] - weakest.z_mm) < _MARK_REACH_MM
        y = float(vertices[beside, 1].max(initial=0.0))
    lines = (
        f"weakest: {weakest.place},",
        f"z = {weakest.z_mm:.0f} mm, safety factor {found.grip_safety_factor:.1f}",
        "at the grip force",
    )
    return Mark("\n".join(lines), (dx, y + dy, weakest.z_mm + dz))


def _height_of(design: Design, place: str) -> float | None:
    """Find the height y of a named place of a clevis [mm]; None for a cross-section, which has no single one."""
    joint, anchor = design.dimensions.joint, design.dimensions.anchor
    if anchor and "anchor" in place:
        return anchor.y
    return joint.axis_y if joint and place != "cross-section" else None


def _place_joint(design: Design, evaluator: MeshEvaluator) -> list[PlacedMesh]:
    """Place bone, sensor, lid and skin on the hand."""
    assert design.dimensions.joint
    solids = {
        name: part.solid(design) for name, part in parts_by_name(design).items() if name in ("bone", "lid", "skin")
    }
    solids["sensor"] = sensor_body(design)
    placed = place_on_hand(design, design.dimensions.joint, evaluator, solids)
    return [PlacedMesh(name, mesh, _COLOURS[name]) for name, mesh in placed]


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
    return [
        PlacedMesh(name, Mesh(parts[name].vertices + np.array(offset), parts[name].triangles), _COLOURS[name], offset)
        for name, offset in shift.items()
    ]


def _cut_open(design: Design, evaluator: MeshEvaluator) -> list[PlacedMesh]:
    """Place what lies in the closed mold, without the half of each part on the viewer's side of the plane x = 0."""
    solids = {name: part.solid(design) for name, part in parts_by_name(design).items()}
    if "core" in solids:  # a sleeve is cast around the core, without bone and sensor
        solids = {name: solid for name, solid in solids.items() if name not in ("bone", "lid")}
    else:
        solids["sensor"] = sensor_body(design)
    return [
        PlacedMesh(
            name, to_canonical_mesh(evaluator.manifold(solid).trim_by_plane((1.0, 0.0, 0.0), 0.0)), _COLOURS[name]
        )
        for name, solid in solids.items()
    ]


def _draw_panel(
    title: str,
    placed: list[PlacedMesh],
    camera: Camera,
    width_px: int,
    *,
    labelled: bool,
    marks: tuple[Mark, ...] = (),
) -> NDArray[np.uint8]:
    from PIL import Image, ImageDraw, ImageFont

    font_px = 17
    centre, size = bounds([item.mesh for item in placed], camera)
    scale = (width_px - 2 * _MARGIN_PX) / size[0]
    if not labelled:
        scale *= 0.62  # the section is long and flat, so it need not fill the width
    height_px = int(size[1] * scale) + 2 * _MARGIN_PX + 24
    canvas = Canvas(width_px, height_px, scale, camera)
    for item in placed:
        canvas.draw(item.mesh, item.colour, centre)
    picture = Image.fromarray(canvas.image())
    pen, font = ImageDraw.Draw(picture), ImageFont.load_default(size=font_px)
    pen.text((16, 10), title, fill=(40, 40, 40), font=font)
    for item in placed if labelled else [item for item in placed if item.label == HAND]:
        projected = (item.mesh.vertices - centre) @ camera.axes.T * scale
        (left, low), (right, high) = projected.min(axis=0)[:2], projected.max(axis=0)[:2]
        x, y, anchor = {
            "mold_dorsal": (right, high, "rt"),
            "skin": (right, low - 4, "rt"),
            "lid": (right + 6, (low + high) / 2, "lm"),
            HAND: (left + 4, high - 4, "lt"),
        }.get(item.label, (left, low - 2, "lt"))
        position = (width_px / 2 + x, height_px / 2 - y)
        pen.text(position, item.label.replace("_", " "), fill=(40, 40, 40), font=font, anchor=anchor)
    for mark in marks:
        u, v = ((np.array(mark.point_mm) - centre) @ camera.axes.T * scale)[:2]
        tip = (width_px / 2 + u, height_px / 2 - v)
        # Above the mold's front corner the picture is empty.
        text = (16, 0.24 * height_px)
        pen.multiline_text(text, mark.text, fill=(150, 30, 20), font=font)
        start = (text[0] + 40, text[1] + 4 * font_px)
        pen.line([start, tip], fill=(150, 30, 20), width=2)
        pen.ellipse([tip[0] - 5, tip[1] - 5, tip[0] + 5, tip[1] + 5], outline=(150, 30, 20), width=2)
    return np.asarray(picture)
