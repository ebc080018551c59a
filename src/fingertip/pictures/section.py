"""Longitudinal sections of the closed cup with its core and of the bone, with named features.

The cut is drawn as polygons: meshes that touch in the plane would fight for each pixel in a depth
buffer. A notch that lies in another plane is drawn there as a dashed outline. Names stand above and
below the parts, where no edge runs, with a line to what they name.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageChops, ImageDraw, ImageFont

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.design import Design
from fingertip.design.interfaces import interface_of
from fingertip.foundation.numerics import Array
from fingertip.models import mold
from fingertip.models.making import making_of
from fingertip.models.mold_layout import GAP_MM, PLATE_MM
from fingertip.models.parts import PARTS, parts_by_name
from fingertip.models.sensor_pocket import sensor_body
from fingertip.models.solids import Solid
from fingertip.pictures import colours
from fingertip.pictures.raster import Font, Pen

Point = tuple[float, float]
"""Point of the plane: along the finger (z) and dorsal (y) [mm]."""
Feature = tuple[str, Point]
"""Name of a feature of a part, and the point where its line ends."""
_FINE = 3
"""Factor by which the picture is drawn finer than it is returned."""
_PLANE_MM = 1e-3
"""Distance of the cut from the plane of symmetry, in which edges of parts lie [mm]."""
_CUT_SHADE = 0.88
"""Brightness of a cut, over that of the part's surface."""
_INK = (40, 40, 40)
_NAME_INK = (25, 45, 90)
_FONT_PX = 17
_ROW_PX = 26
_GAP_PX = 14
_LINE_PX = 16
_NEAR_MM = 1.3
"""Distance from an outline within which a feature counts as shown [mm]."""


@dataclass(frozen=True)
class Section:
    """Longitudinal section of some parts, with the features to name."""

    title: str
    parts: Mapping[str, Solid]
    dashed: Sequence[tuple[Solid, float]]
    """Solids that are drawn dashed, each with the x of the plane in which it is cut."""
    features: Sequence[Feature]


def list_sections(design: Design) -> list[Section]:
    """List the sections of a design: of its closed mold and of its bone."""
    solids = {name: part.solid(design) for name, part in parts_by_name(design).items()}
    finger = {"bone": solids["bone"], "sensor": sensor_body(design)}
    making = making_of(design)
    names = ("mold_dorsal", "mold_palmar", "skin", *making.lowered)
    cast = {name: solids[name] for name in names}
    notch = mold.notches(design)[1].intersect(mold.block(design))
    title = (
        f"longitudinal section of the closed cup and its {making.lowered[0]}; it stands on its "
        "right end; dashed: an overflow notch"
    )

    return [
        Section(
            title, cast, [(notch, design.mold_layout.notch_x)], list(_list_mold_features(design))
        ),
        Section(
            "longitudinal section of the bone with its sensor",
            finger,
            [],
            list(_list_bone_features(design)),
        ),
    ]


def draw_section(section: Section, evaluator: MeshEvaluator, width_px: int) -> NDArray[np.uint8]:
    """Draw a section with the names of its features; returns the picture (height, width, 3)."""
    font = ImageFont.load_default(size=_FONT_PX * _FINE)
    assert isinstance(font, Font)
    cuts = {name: slice_solid(evaluator, solid, _PLANE_MM) for name, solid in section.parts.items()}
    dashed = [slice_solid(evaluator, solid, x) for solid, x in section.dashed]
    outlines = [*itertools.chain(*cuts.values(), *dashed)]
    corners = np.concatenate(outlines)
    low = corners.min(axis=0)
    high = corners.max(axis=0)
    scale = 0.8 * width_px / (high[0] - low[0])
    size = (high - low) * scale
    features = [
        feature for feature in dict.fromkeys(section.features) if is_near(feature[1], outlines)
    ]
    above, below = (
        _place_names(
            [feature for feature in features if (feature[1][1] < 0) == is_low],
            font=font,
            low_z=low[0],
            scale=scale,
            width_px=width_px,
            length_px=size[0],
        )
        for is_low in (False, True)
    )
    head = _ROW_PX + 14
    top = head + _ROW_PX * _count_rows(above) + _LINE_PX
    height_px = int(top + size[1] + _LINE_PX + _ROW_PX * _count_rows(below) + 44)
    picture = Image.new("RGB", (width_px * _FINE, height_px * _FINE), "white")
    pen = ImageDraw.Draw(picture)
    left = (width_px - size[0]) / 2

    def to_pixel(point: Iterable[float]) -> Point:
        z, y = point
        return _FINE * (left + (z - low[0]) * scale), _FINE * (top + (high[1] - y) * scale)

    for name, rings in cuts.items():
        base = PARTS[name].colour if name in PARTS else colours.SENSOR
        red, green, blue = (round(255 * _CUT_SHADE * part) for part in base)
        _fill(picture, [[*map(to_pixel, ring)] for ring in rings], (red, green, blue))

    for ring in itertools.chain(*dashed):
        _dash(pen, [*map(to_pixel, (*ring, ring[0]))])

    sides = ((above, top - _LINE_PX, -1), (below, top + size[1] + _LINE_PX, 1))
    for names, line_y, way in sides:
        for (name, at), x, row in names:
            _draw_name(
                pen,
                font=font,
                name=name,
                at=(x, line_y + way * (_ROW_PX * row + 2)),
                target=to_pixel(at),
                way=way,
            )

    pen.text((16 * _FINE, 10 * _FINE), section.title, fill=_INK, font=font)
    picture = picture.resize((width_px, height_px), Image.Resampling.BOX)
    draw_scale_bar(ImageDraw.Draw(picture), (16.0, height_px - 16.0), scale)
    return np.asarray(picture)


def is_near(point: Point, outlines: Sequence[Array]) -> bool:
    """Return whether a point lies within an outline or close to it."""
    at = np.array(point)
    is_inside = False

    for ring in outlines:
        a = ring
        b = np.roll(ring, -1, axis=0)
        along = b - a
        squares = np.maximum((along * along).sum(axis=1), 1e-12)
        share = np.clip(((at - a) * along).sum(axis=1) / squares, 0.0, 1.0)
        if np.hypot(*(a + share[:, None] * along - at).T).min() <= _NEAR_MM:
            return True

        crosses = (a[:, 1] > at[1]) != (b[:, 1] > at[1])
        x = a[:, 0] + (at[1] - a[:, 1]) / np.where(crosses, along[:, 1], 1.0) * along[:, 0]
        is_inside |= bool(np.count_nonzero(crosses & (x > at[0])) % 2)

    return is_inside


def slice_solid(evaluator: MeshEvaluator, solid: Solid, x: float) -> list[Array]:
    """Cut a solid at a plane `x` [mm]; returns its outlines as points (z, y)."""
    # x becomes the height, and z runs against the first axis.
    turned = evaluator.manifold(solid).rotate((0.0, -90.0, 0.0))
    return [np.asarray(ring) * np.array([-1.0, 1.0]) for ring in turned.slice(x).to_polygons()]


def draw_scale_bar(pen: Pen, corner: Point, pixels_per_mm: float) -> None:
    """Draw a bar of a round length, its lower left corner at a point of the picture."""
    longest = 130 / pixels_per_mm
    decade = 10.0 ** math.floor(math.log10(longest))
    length = max(step * decade for step in (1.0, 2.0, 5.0) if step * decade <= longest)
    x, y = corner
    end = x + length * pixels_per_mm
    pen.line([(x, y), (end, y)], fill=_INK, width=2)
    for tick in (x, end):
        pen.line([(tick, y - 5), (tick, y + 5)], fill=_INK, width=2)

    font = ImageFont.load_default(size=_FONT_PX - 2)
    pen.text((end + 8, y), f"{length:g} mm", fill=_INK, font=font, anchor="lm")


def _list_mold_features(design: Design) -> Iterable[Feature]:
    dims = design.dimensions
    layout = design.mold_layout
    bone = design.bone
    making = making_of(design)
    yield f"plate of the {making.hanger}", (-PLATE_MM / 2, layout.dorsal_height / 2)
    yield "ridge in its groove", (1.0, layout.dorsal_height - 2.0)
    yield "dorsal half", (0.5 * design.skin.length_mm, 0.75 * layout.dorsal_height)
    yield "seat of a rubber band", (layout.belts_z[1], layout.dorsal_height - 0.5)

    if bone.groove_depth_mm:
        z = bone.groove_distance_mm + bone.groove_depth_mm + bone.groove_width_mm / 2
        yield "rib of the skin", (z, dims.bone_outline.section.dorsal - bone.groove_depth_mm / 2)

    yield making.lowered[0], (0.4 * design.skin.length_mm, 0.5)
    yield "skin", (design.skin.length_mm - design.skin.thickness_tip_mm / 2, 0.5)
    if making.is_bonded:
        yield "plug over the tail", (PLATE_MM / -2, -dims.flat_depth - 0.8)
    else:
        yield "bump over the sensor", (dims.sensor_z, -dims.platform_depth - 0.3)

    yield (
        "palmar half",
        (0.85 * design.skin.length_mm, -(dims.outer.section.palmar + layout.palmar_height) / 2),
    )
    yield (
        "gap, where silicone overflows",
        (GAP_MM / 2, -(dims.base_palmar_height + layout.palmar_height) / 2),
    )


def _list_bone_features(design: Design) -> Iterable[Feature]:
    dims = design.dimensions
    bone = design.bone
    section = dims.bone_outline.section
    collar = dims.collar
    dorsal = (section.dorsal + collar.section.dorsal) / 2
    yield "collar", (-bone.collar_length_mm / 2, dorsal)

    if bone.groove_depth_mm > 0 and bone.groove_width_mm > 0:
        groove_z = bone.groove_distance_mm + bone.groove_width_mm / 2
        yield "groove", (groove_z, section.dorsal - bone.groove_depth_mm / 2)

    yield (
        "sensor",
        (dims.sensor_z, -dims.platform_depth + dims.pocket_depth - dims.sensor.thickness_mm / 2),
    )
    yield "solder joints", (dims.tail_end_z, -dims.flat_depth + dims.pocket_depth + 0.6)
    yield "cable channel", (dims.channel_exit_z, section.dorsal - bone.channel_diameter_mm / 2)
    yield from interface_of(design).features(design)


_PlacedName = tuple[Feature, float, int]
"""Feature, the middle of its name [pixels], and the row of the name, counted from the parts."""


def _place_names(
    features: Sequence[Feature],
    font: Font,
    low_z: float,
    scale: float,
    width_px: int,
    length_px: float,
) -> list[_PlacedName]:
    """Place names in few rows, each as near as possible to what it names."""
    left = (width_px - length_px) / 2
    ordered = sorted(features, key=lambda feature: feature[1][0])
    widths = [font.getlength(name) / _FINE + _GAP_PX for name, _ in ordered]
    rows = max(1, math.ceil(sum(widths) / (width_px - 40)))
    placed: list[_PlacedName] = []

    for row in range(rows):
        chosen = list(itertools.islice(zip(ordered, widths, strict=True), row, None, rows))
        wishes = [left + (point[0] - low_z) * scale for (_, point), _ in chosen]
        middles = spread([width for _, width in chosen], wishes, width_px)
        placed += [(feature, x, row) for (feature, _), x in zip(chosen, middles, strict=True)]

    return placed


def spread(widths: Sequence[float], wishes: Sequence[float], total: float) -> list[float]:
    """Shift intervals, in blocks within `total`, until none overlaps; returns their middles."""
    blocks: list[tuple[float, float, list[int]]] = []  # middle, width, members
    for i, (width, wish) in enumerate(zip(widths, wishes, strict=True)):
        middle = wish
        size = width
        members = [i]

        while True:
            middle = min(max(middle, size / 2), total - size / 2)
            if not blocks or blocks[-1][0] + blocks[-1][1] / 2 <= middle - size / 2 + 1e-9:
                break

            _, before, merged = blocks.pop()
            members = [*merged, *members]
            size += before
            middle = sum(wishes[k] for k in members) / len(members)

        blocks.append((middle, size, members))

    middles = [0.0] * len(widths)
    for middle, size, members in blocks:
        start = middle - size / 2
        for k in members:
            middles[k] = start + widths[k] / 2
            start += widths[k]

    return middles


def _count_rows(names: Sequence[_PlacedName]) -> int:
    return 1 + max((row for _, _, row in names), default=-1)


def _draw_name(
    pen: Pen,
    font: Font,
    name: str,
    at: Point,
    target: Point,
    way: int,
) -> None:
    x = at[0] * _FINE
    y = at[1] * _FINE
    pen.line([(x, y), target], fill=_NAME_INK, width=_FINE)
    radius = 3.5 * _FINE
    u, v = target
    pen.ellipse(
        [u - radius, v - radius, u + radius, v + radius],
        fill="white",
        outline=_NAME_INK,
        width=2 * _FINE,
    )
    base = y - 5 * _FINE if way < 0 else y + 15 * _FINE
    left, top, right, bottom = pen.textbbox((x, base), name, font=font, anchor="ms")
    pen.rectangle([left - 4 * _FINE, top - _FINE, right + 4 * _FINE, bottom + _FINE], fill="white")
    pen.text((x, base), name, fill=_NAME_INK, font=font, anchor="ms")


def _fill(picture: Any, rings: Sequence[Sequence[Point]], colour: tuple[int, int, int]) -> None:
    """Fill outlines by the even-odd rule, so that holes stay open, and draw their edges."""
    mask = Image.new("1", picture.size)
    for ring in rings:
        filled = Image.new("1", picture.size)
        ImageDraw.Draw(filled).polygon(list(ring), fill=1)
        mask = ImageChops.logical_xor(mask, filled)

    picture.paste(colour, mask=mask)
    pen = ImageDraw.Draw(picture)
    for ring in rings:
        pen.line([*ring, ring[0]], fill=_INK, width=_FINE)


def _dash(pen: Pen, line: Sequence[Point]) -> None:
    on = 7.0 * _FINE
    off = 4.0 * _FINE
    done = 0.0

    for (ax, ay), (bx, by) in itertools.pairwise(line):
        length = math.hypot(bx - ax, by - ay)
        way = 0.0
        while way < length:
            phase = (done + way) % (on + off)
            end = on if phase < on else on + off
            step = min(end - phase, length - way)
            if phase < on:
                ends = [
                    (ax + (bx - ax) * t / length, ay + (by - ay) * t / length)
                    for t in (way, way + step)
                ]
                pen.line(ends, fill=_INK, width=round(1.3 * _FINE))

            way += max(step, 1e-6)

        done += length
