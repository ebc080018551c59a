"""Outlines of two versions of a finger, at one scale: from the side and from above."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.design import Design
from fingertip.foundation.numerics import Array
from fingertip.models.parts import parts_by_name
from fingertip.models.sensor_pocket import sensor_body
from fingertip.models.solids import Solid
from fingertip.pictures.raster import Pen, to_png
from fingertip.pictures.section import draw_scale_bar, slice_solid

_TOLERANCE_MM = 0.02
_PLANE_MM = 1e-3
"""Distance of a cut from the plane in which edges of parts lie [mm]."""
_MARGIN_PX = 30
_CAPTION_PX = 40
_FONT_PX = 18
_INK = (40, 40, 40)
_COLOURS = ((200, 40, 30), (20, 70, 190))
"""Colours of the version before and of that after."""
_LINE_PX = 2


@dataclass(frozen=True)
class _View:
    """One view: title, and each version's outlines along the finger and across it [mm]."""

    title: str
    outlines: tuple[Sequence[Array], ...]


def draw_before_and_after(
    before: Design, after: Design, captions: tuple[str, str], width_px: int = 1200
) -> bytes:
    """Draw both designs as a PNG of this width [pixels]: before in red, after in blue.

    It is cut along the middle and seen from the side, and below that cut at the parting plane and
    seen from above. Both designs are drawn at one scale, with the base of the skin at the same
    place.
    """
    evaluator = MeshEvaluator(_TOLERANCE_MM)
    solids = [_list_solids(design) for design in (before, after)]
    views = [
        _View(
            "cut along the middle, seen from the side",
            tuple(_cut_side(evaluator, version) for version in solids),
        ),
        _View(
            "cut at the parting plane, seen from above",
            tuple(_cut_plan(evaluator, version) for version in solids),
        ),
    ]

    versions = itertools.chain.from_iterable(view.outlines for view in views)
    corners = np.concatenate([*itertools.chain.from_iterable(versions)])
    left = float(corners[:, 0].min())
    right = float(corners[:, 0].max())
    pixels_per_mm = (width_px - 2 * _MARGIN_PX) / (right - left)

    panels = [_draw_legend(captions, width_px)]
    panels += [_draw_view(view, left, pixels_per_mm, width_px) for view in views]

    return to_png(_stack(panels))


def _list_solids(design: Design) -> Mapping[str, Solid]:
    parts = parts_by_name(design)
    finger = {name: part.solid(design) for name, part in parts.items() if part.is_in_finger}
    return {**finger, "sensor": sensor_body(design)}


def _cut_side(evaluator: MeshEvaluator, solids: Mapping[str, Solid]) -> list[Array]:
    """Cut solids in the plane x = 0; returns outlines along z and y [mm]."""
    outlines = []
    for solid in solids.values():
        outlines += slice_solid(evaluator, solid, _PLANE_MM)

    return outlines


def _cut_plan(evaluator: MeshEvaluator, solids: Mapping[str, Solid]) -> list[Array]:
    """Cut solids in the plane y = 0; returns outlines along z and x [mm]."""
    outlines = []
    for solid in solids.values():
        section = evaluator.manifold(solid).rotate((90.0, 0.0, 0.0)).slice(_PLANE_MM)
        outlines += [
            np.column_stack([-ring[:, 1], ring[:, 0]])
            for ring in map(np.asarray, section.to_polygons())
        ]

    return outlines


def _draw_view(view: _View, left_mm: float, pixels_per_mm: float, width_px: int) -> Image.Image:
    outlines = itertools.chain.from_iterable(view.outlines)
    across = np.concatenate([outline[:, 1] for outline in outlines])
    low = float(across.min())
    high = float(across.max())
    height_px = int((high - low) * pixels_per_mm) + 2 * _CAPTION_PX + _MARGIN_PX

    picture = Image.new("RGB", (width_px, height_px), "white")
    pen = ImageDraw.Draw(picture)
    pen.text((_MARGIN_PX, 10), view.title, _INK, ImageFont.load_default(size=_FONT_PX))

    for version, colour in zip(view.outlines, _COLOURS, strict=True):
        for outline in version:
            x = _MARGIN_PX + (outline[:, 0] - left_mm) * pixels_per_mm
            y = _CAPTION_PX + (high - outline[:, 1]) * pixels_per_mm
            _draw_ring(pen, np.column_stack([x, y]), colour)

    draw_scale_bar(pen, (float(_MARGIN_PX), height_px - 20.0), pixels_per_mm)
    return picture


def _draw_ring(pen: Pen, ring: Array, colour: tuple[int, int, int]) -> None:
    closed = [(float(x), float(y)) for x, y in [*ring, ring[0]]]
    pen.line(closed, fill=colour, width=_LINE_PX)


def _draw_legend(captions: tuple[str, str], width_px: int) -> Image.Image:
    picture = Image.new("RGB", (width_px, 2 * _CAPTION_PX), "white")
    pen = ImageDraw.Draw(picture)
    font = ImageFont.load_default(size=_FONT_PX)

    for row, (caption, colour) in enumerate(zip(captions, _COLOURS, strict=True)):
        y = 18 + row * 28
        pen.line([(_MARGIN_PX, y), (_MARGIN_PX + 40, y)], fill=colour, width=2 * _LINE_PX)
        word = ("before", "after")[row]
        pen.text((_MARGIN_PX + 52, y), f"{word}: {caption}", _INK, font, anchor="lm")

    return picture


def _stack(panels: Sequence[Image.Image]) -> Image.Image:
    whole = Image.new("RGB", (panels[0].width, sum(panel.height for panel in panels)), "white")
    top = 0
    for panel in panels:
        whole.paste(panel, (0, top))
        top += panel.height

    return whole
