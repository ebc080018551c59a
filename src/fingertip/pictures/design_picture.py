"""Picture of a design: exploded views, a section through the mold, and a joint on the hand.

An arrow points at the place where the bone breaks first.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator, to_canonical_mesh
from fingertip.cad.verification.joint import turn_about_pin
from fingertip.cad.verification.strength import assess_strength
from fingertip.cad.verification.walls import find_thin_walls
from fingertip.design import Design
from fingertip.foundation.display import Picture
from fingertip.foundation.errors import Issue, TraceError, checked, raise_issues
from fingertip.foundation.numerics import Array
from fingertip.foundation.progress import Work
from fingertip.models.clevis import knuckle
from fingertip.models.joint import Joint
from fingertip.models.parts import PARTS, parts_by_name
from fingertip.models.sensor_pocket import sensor_body
from fingertip.models.solids import Point3, Solid
from fingertip.pictures import cameras, colours
from fingertip.pictures.raster import Camera, Canvas, Colour, Pen, bounds, to_png
from fingertip.pictures.section import draw_scale_bar, draw_section, list_sections

HAND = "hand"
"""Name of the hand's part of the joint."""
_GAP_MM = 12.0


def place_on_hand(
    design: Design, joint: Joint, evaluator: MeshEvaluator, parts: Mapping[str, Solid]
) -> list[tuple[str, Mesh]]:
    """Place parts, cut at x = 0, on the hand: straight and bent to the end of travel."""
    placed: list[tuple[str, Mesh]] = []
    shift = 0.0

    for angle_deg in (0.0, design.hand.travel_deg) if design.hand.travel_deg else (0.0,):
        turned = {}
        for name, solid in parts.items():
            cut = evaluator.manifold(solid).trim_by_plane((1.0, 0.0, 0.0), 0.0)
            turned[name] = to_canonical_mesh(turn_about_pin(cut, joint, angle_deg))

        hand = evaluator.manifold(knuckle(design, joint)).trim_by_plane((1.0, 0.0, 0.0), 0.0)
        hand = hand.trim_by_plane((0.0, 0.0, 1.0), joint.axis_z - 3 * joint.radius)
        hand = hand.trim_by_plane((0.0, -1.0, 0.0), -design.dimensions.collar.section.dorsal)
        turned[HAND] = to_canonical_mesh(hand)
        high = max(float(mesh.vertices[:, 2].max()) for mesh in turned.values())
        low = min(float(mesh.vertices[:, 2].min()) for mesh in turned.values())
        along = np.array((0.0, 0.0, shift - low))
        placed += [
            (name, Mesh(mesh.vertices + along, mesh.triangles)) for name, mesh in turned.items()
        ]
        shift += high - low + _GAP_MM

    return placed


_TOLERANCE_MM = 0.02
_MARGIN_PX = 36
_CAPTION_PX = 24
_FONT_PX = 17
_CLEAR_PX = 5
_INK = (40, 40, 40)
_MARK_INK = (150, 30, 20)
_MEASURED = ("bone", "skin")
"""Parts whose thin walls are marked."""
_THIN = "red: too thin"
_THIN_COLOUR = (0.85, 0.1, 0.1)
_LABELS = (*PARTS, "sensor", _THIN)
_COLOURS: Mapping[str, Colour] = {
    **{name: part.colour for name, part in PARTS.items()},
    "sensor": colours.SENSOR,
    HAND: (0.80, 0.80, 0.78),
}
_MARK_REACH_MM = 1.0
"""Distance along the finger within which the surface above a weak section is looked for."""

Mark = tuple[str, Point3]
"""Text with an arrow to a point [mm]."""


@dataclass(frozen=True)
class PlacedMesh:
    """Mesh of a part in its place in a picture."""

    label: str
    mesh: Mesh
    colour: Colour
    offset_mm: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Distance by which the mesh was moved from where the part lies."""


def find_width_issues(width_px: int) -> Iterator[Issue]:
    if not 400 <= width_px <= 6000:
        yield Issue("--width-px", f"{width_px} is out of range; choose 400 to 6000.")


@checked
def draw(
    design: Design, width_px: int, progress: Callable[[str], None] = lambda message: None
) -> bytes:
    """Draw two exploded views of a design above a section through the closed mold."""
    raise_issues(TraceError, find_width_issues(width_px))
    evaluator = MeshEvaluator(_TOLERANCE_MM)
    parts = {
        name: evaluator.mesh(part.solid(design)) for name, part in parts_by_name(design).items()
    }
    parts["sensor"] = evaluator.mesh(sensor_body(design))
    exploded = _explode(parts)
    exploded += _mark_thin_walls(design, evaluator, exploded)
    half = width_px // 2
    mark = _mark_weakest(design, evaluator, exploded)
    work = Work(
        "", dict.fromkeys(("dorsal view", "palmar view", "sections", "on the hand"), 1.0), progress
    )
    work.begin("dorsal view")
    dorsal = _draw_panel("dorsal view", exploded, cameras.DORSAL, half, labels=_LABELS, mark=mark)
    work.begin("palmar view")
    palmar = _draw_panel("palmar view", exploded, cameras.PALMAR, width_px - half, labels=_LABELS)
    top = np.full((max(len(dorsal), len(palmar)), width_px, 3), 255, dtype=np.uint8)
    top[: len(dorsal), :half] = dorsal
    top[: len(palmar), half:] = palmar
    panels = [top]
    work.begin("sections")
    for section in list_sections(design):
        panels.append(draw_section(section, evaluator, width_px))

    if design.dimensions.joint:
        title = (
            f"finger on the hand: straight, and bent by {design.hand.travel_deg:g} degrees to "
            "its stop"
        )
        work.begin("on the hand")
        solids = {
            name: part.solid(design)
            for name, part in parts_by_name(design).items()
            if name in ("bone", "skin")
        }
        solids["sensor"] = sensor_body(design)
        placed = place_on_hand(design, design.dimensions.joint, evaluator, solids)
        meshes = [PlacedMesh(name, mesh, _COLOURS[name]) for name, mesh in placed]
        panels.append(
            _draw_panel(title, meshes, Camera.from_angles(0, 0), width_px, labels=(HAND,))
        )

    return to_png(Image.fromarray(np.concatenate(panels)))


def _mark_thin_walls(
    design: Design, evaluator: MeshEvaluator, exploded: list[PlacedMesh]
) -> list[PlacedMesh]:
    """Cover what is thinner than its minimum with red squares."""
    marks = []
    for item in exploded:
        if item.label not in _MEASURED:
            continue

        thin = find_thin_walls(design, evaluator, item.label)
        if thin.matters:
            squares = thin.patches()
            moved = Mesh(squares.vertices + np.array(item.offset_mm), squares.triangles)
            marks.append(PlacedMesh(_THIN, moved, _THIN_COLOUR, item.offset_mm))

    return marks


def _mark_weakest(design: Design, evaluator: MeshEvaluator, exploded: list[PlacedMesh]) -> Mark:
    """Return what to write about the place where the bone breaks first, and where it is drawn."""
    strength = assess_strength(design, evaluator)
    weakest = strength.weakest
    vertices = evaluator.mesh(PARTS["bone"].solid(design)).vertices
    dx, dy, dz = next(item.offset_mm for item in exploded if item.label == "bone")
    joint = design.dimensions.joint
    anchor = design.dimensions.anchor

    if anchor and "horn" in weakest.place:
        y = anchor.horn_y
    elif joint and weakest.place != "cross-section":
        y = joint.axis_y
    else:
        beside = np.abs(vertices[:, 2] - weakest.z_mm) < _MARK_REACH_MM
        y = float(vertices[beside, 1].max(initial=0.0))

    factor = f"z = {weakest.z_mm:.0f} mm, safety factor {strength.grip_safety_factor:.1f}"
    text = f"weakest: {weakest.place},\n{factor}\nat the grip force"
    return text, (dx, y + dy, weakest.z_mm + dz)


def _explode(parts: Mapping[str, Mesh]) -> list[PlacedMesh]:
    """Move the parts apart along the finger, and the halves of the mold above and below them."""
    size = {name: np.ptp(mesh.vertices, axis=0) for name, mesh in parts.items()}
    gap = 6.0
    behind = -0.55 * size["skin"][2]
    # So far that no half hides the bone, from above or from the palm
    spread = 1.25 * (size["bone"][1] + size["mold_palmar"][1] / 2) + 2 * gap
    shift = {
        "mold_dorsal": (0.0, spread, 0.0),
        "skin": (0.0, 0.0, gap - behind),
        "bone": (0.0, 2.0, behind),
        "sensor": (0.0, 2.0 - gap, behind),
        "mold_palmar": (0.0, -spread, 0.0),
        "plug": (0.0, 2.0 - 2 * gap, behind),
        **dict.fromkeys(("core", "holder"), (0.0, 2.0, behind - size["bone"][2] - 2 * gap)),
        **dict.fromkeys(("stand", "hand_stub"), (0.0, -1.2 * spread, behind)),
        "pin": (0.0, -spread / 2, 2 * behind),
    }

    return [
        PlacedMesh(
            name,
            Mesh(parts[name].vertices + np.array(offset), parts[name].triangles),
            _COLOURS[name],
            offset,
        )
        for name, offset in shift.items()
        if name in parts
    ]


def _draw_panel(
    title: str,
    placed: list[PlacedMesh],
    camera: Camera,
    width_px: int,
    *,
    labels: Collection[str],
    mark: Mark | None = None,
) -> NDArray[np.uint8]:
    centre, size = bounds([item.mesh for item in placed], camera)
    # A long and flat picture need not fill the width; others leave room for the names.
    scale = (width_px - 2 * _MARGIN_PX) / size[0] * (0.62 if HAND in labels else 0.9)
    height_px = int(size[1] * scale) + 2 * _MARGIN_PX + 2 * _CAPTION_PX
    canvas = Canvas(width_px, height_px, scale, camera)
    for item in placed:
        canvas.draw(item.mesh, item.colour, centre)

    image = canvas.image()
    picture = Image.fromarray(image)
    pen = ImageDraw.Draw(picture)
    font = ImageFont.load_default(size=_FONT_PX)
    covered: NDArray[np.bool_] = np.asarray((image < 255).any(axis=2))
    _claim(covered, pen.textbbox((16, 10), title, font=font))
    pen.text((16, 10), title, fill=_INK, font=font)
    draw_scale_bar(pen, (16.0, height_px - 16.0), scale)
    _claim(covered, (0, height_px - 34, 260, height_px))

    def to_pixel(point: Array) -> tuple[float, float]:
        u, v = ((point - centre) @ camera.axes.T * scale)[:2]
        return width_px / 2 + u, height_px / 2 - v

    if mark:
        text, point = mark
        _draw_mark(
            pen,
            font=font,
            text=text,
            tip=to_pixel(np.array(point)),
            covered=covered,
        )

    for item in placed:
        if item.label in labels:
            corners = (item.mesh.vertices - centre) @ camera.axes.T * scale
            left, low = corners.min(axis=0)[:2]
            right, high = corners.max(axis=0)[:2]
            box = (
                width_px / 2 + left,
                height_px / 2 - high,
                width_px / 2 + right,
                height_px / 2 - low,
            )
            text = item.label.replace("_", " ")
            place = find_free_place(covered, pen.textbbox((0, 0), text, font=font), box)
            pen.text(place, text, fill=_INK, font=font)
            _claim(covered, pen.textbbox(place, text, font=font))

    return np.asarray(picture)


def _draw_mark(
    pen: Pen,
    font: Any,
    text: str,
    tip: tuple[float, float],
    covered: NDArray[np.bool_],
) -> None:
    """Draw a text above the left end of the parts, with a line to the point that it marks."""
    box = pen.multiline_textbbox((0, 0), text, font=font)
    place = find_free_place(covered, box, (16.0, tip[1] - 40.0, tip[0], tip[1]))
    pen.multiline_text(place, text, fill=_MARK_INK, font=font)
    _claim(covered, pen.multiline_textbbox(place, text, font=font))
    start = (
        min(max(tip[0], place[0] + 20), place[0] + box[2] - 20),
        place[1] + (box[3] if place[1] < tip[1] else 0) + 4,
    )
    pen.line([start, tip], fill=_MARK_INK, width=2)
    pen.ellipse([tip[0] - 5, tip[1] - 5, tip[0] + 5, tip[1] + 5], outline=_MARK_INK, width=2)


def find_free_place(
    covered: NDArray[np.bool_],
    text: tuple[float, float, float, float],
    part: tuple[float, float, float, float],
) -> tuple[float, float]:
    """Find the place nearest to a part where a text covers nothing. Units: `text` [pixels]."""
    height, width = covered.shape
    wide = int(text[2] - text[0]) + 2 * _CLEAR_PX
    high = int(text[3] - text[1]) + 2 * _CLEAR_PX
    filled = np.zeros((height + 1, width + 1), dtype=np.int64)
    # The count of any rectangle follows from its corners.
    filled[1:, 1:] = covered.cumsum(axis=0).cumsum(axis=1)
    counts = (
        filled[high:, wide:]
        - filled[:-high, wide:]
        - filled[high:, :-wide]
        + filled[:-high, :-wide]
    )
    rows, columns = np.nonzero(counts == 0)
    if not len(rows):
        return part[0] - text[0], part[3] - text[1]

    # Distance between the two rectangles, and then to the middle of the part
    beside = np.maximum(0, np.maximum(part[0] - (columns + wide), columns - part[2]))
    beyond = np.maximum(0, np.maximum(part[1] - (rows + high), rows - part[3]))
    off = np.hypot(
        columns + wide / 2 - (part[0] + part[2]) / 2, rows + high / 2 - (part[1] + part[3]) / 2
    )
    best = int(np.argmin(np.hypot(beside, beyond) + 0.2 * off))

    return float(columns[best] + _CLEAR_PX - text[0]), float(rows[best] + _CLEAR_PX - text[1])


def _claim(covered: NDArray[np.bool_], box: tuple[float, float, float, float]) -> None:
    left, top, right, bottom = (max(0, int(side)) for side in box)
    covered[top : bottom + 1, left : right + 1] = True


def picture(design: Design, width_px: int = 1600) -> Picture:
    """Draw exploded views, a section through the mold and any joint on its hand.

    `width_px` is the width of the picture [pixels].
    """
    return Picture(draw(design, width_px))
