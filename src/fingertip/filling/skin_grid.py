"""Grid of the mold's cavity around the insert: the layer of silicone, unwrapped around and along the finger.

Rows lie across the finger, from the collar to the apex, which is the pole. Columns follow the outlines of the sections:
both sides (y = 0), the middle of the dorsal and the middle of the palmar side are columns. Points of cavity and insert
are paired by row and by the parameter of the outline's arc. The palmar flat cuts the insert's points off.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from fingertip.design import Design
from fingertip.design.geometry.conic import ConicBody, CrossSection
from fingertip.design.geometry.insert_body import insert_body
from fingertip.filling.network import Mask
from fingertip.filling.surface_links import Layer, NodeSums, link_layer, vector_areas
from fingertip.foundation.numerics import Array

ROWS, COLUMNS = 40, 48
"""Default numbers of rows, without the pole, and of columns."""
_SAMPLES = 65
"""Points of an arc or profile from which equal lengths are interpolated."""


@dataclass(frozen=True, eq=False)
class SkinGrid:
    """Layer of silicone around an insert, and the areas on which its pressure acts."""

    layer: Layer
    insert_area_mm2: Array
    """Area of the insert around each node, times its normal into the silicone, shape (nodes, 3).

    The first row's nodes include the collar's face at z = 0.
    """
    parting_area_mm2: Array
    """Area of the cavity's surface around each node, projected on the plane y = 0; the mean of both mold halves."""


def build_skin_grid(
    design: Design, rows: int = ROWS, columns: int = COLUMNS, is_closed: Callable[[Array], Mask] | None = None
) -> SkinGrid:
    """Build the grid of a design's cavity."""
    outer, shrinkage = design.dimensions.outer, design.dimensions.shrinkage
    body, flat, scale = insert_body(design.mold, design.bone, design.dimensions)
    straight, tip = _rows(outer, body, rows)
    side, height, is_dorsal = _outline(outer.section, body.section, columns)
    outer_z, outer_scale = _heights(outer, straight, tip)
    inner_z, inner_scale = _heights(body, straight, tip)
    outside = _points(outer.section, outer_z, outer_scale, side[0], height[0], is_dorsal)
    inside = _points(body.section, inner_z, inner_scale, side[1], height[1], is_dorsal)
    inside[..., 1] = np.maximum(inside[..., 1], -flat)
    inside, outside = scale * inside, shrinkage * outside
    layer = link_layer(inside, outside, has_pole=True, is_periodic=True, is_closed=is_closed)
    sums = NodeSums(is_periodic=True, has_pole=True)
    surfaces = [vector_areas(np.concatenate((surface, surface[:, :1]), axis=1)) for surface in (inside, outside)]
    insert = np.stack([sums(surfaces[0][..., k]) for k in range(3)], axis=1)
    face = np.concatenate((inside[:1], outside[:1]))
    on_collar = vector_areas(np.concatenate((face, face[:, :1]), axis=1))[0]
    insert[:columns] -= (on_collar + np.roll(on_collar, 1, axis=0))[::2]
    return SkinGrid(layer, insert, 0.5 * sums(np.abs(surfaces[1][..., 1])))


def _rows(outer: ConicBody, body: ConicBody, rows: int) -> tuple[Array, Array]:
    """Choose heights in the straight part and parameters of the tip, at twice the grid's resolution.

    The straight part keeps the insert's stations, the edges of the groove, as rows. Rows lie at equal distances along
    the mean of both profiles.
    """
    stations = [z for z, _ in body.stations if z >= 0.0]
    t = np.linspace(0.0, 1.0, _SAMPLES)
    (outer_z, outer_s), (inner_z, inner_s) = _tip_profile(outer, t), _tip_profile(body, t)
    radius = 0.25 * (_mean_radius(outer.section) * outer_s + _mean_radius(body.section) * inner_s) * 2.0
    length = np.concatenate(([0.0], np.cumsum(np.hypot(np.diff(0.5 * (outer_z + inner_z)), np.diff(radius)))))
    spacing = (stations[-1] + length[-1]) / rows
    straight = [np.array([0.0])]
    for low, high in pairwise(stations):
        count = 2 * max(1, round((high - low) / spacing))
        straight.append(low + (high - low) * np.arange(1, count + 1) / count)
    count = 2 * max(2, round(length[-1] / spacing))
    return np.concatenate(straight), np.interp(length[-1] * np.arange(1, count + 1) / count, length, t)


def _mean_radius(section: CrossSection) -> float:
    return 0.25 * (2.0 * section.half_width + section.palmar + section.dorsal)


def _heights(body: ConicBody, straight: Array, tip: Array) -> tuple[Array, Array]:
    """Compute height [mm] and scale of each row."""
    z, scale = (np.array(values) for values in zip(*body.stations, strict=True))
    tip_z, tip_scale = _tip_profile(body, tip)
    return np.concatenate((straight, tip_z)), np.concatenate((np.interp(straight, z, scale), tip_scale))


def _tip_profile(body: ConicBody, t: Array) -> tuple[Array, Array]:
    """Compute heights [mm] and scales on the tip; `ConicBody.tip_point` for arrays."""
    assert body.tip is not None
    z1, s1 = body.stations[-1]
    u, w = 1.0 - t, body.tip.weight
    side, middle, top = u * u, 2.0 * w * u * t, t * t
    d = side + middle + top
    return (side * z1 + (middle + top) * body.tip.z) / d, (side * s1 + middle * body.tip_control()) / d


def _arc(t: Array, w: float) -> tuple[Array, Array]:
    """Compute points of the unit arc; `conic.arc_point` for arrays."""
    u = 1.0 - t
    side, middle, top = u * u, 2.0 * w * u * t, t * t
    d = side + middle + top
    return (side + middle) / d, (top + middle) / d


def _outline(outer: CrossSection, inner: CrossSection, columns: int) -> tuple[Array, Array, Mask]:
    """Choose the points of the outline, at twice the grid's resolution, at equal distances along the mean outline."""
    count = columns // 2
    t = np.linspace(0.0, 1.0, _SAMPLES)
    quarters = []
    for dorsal in (True, False):
        arcs = [_arc(t, s.dorsal_weight if dorsal else s.palmar_weight) for s in (outer, inner)]
        heights = [s.dorsal if dorsal else s.palmar for s in (outer, inner)]
        x = 0.5 * (outer.half_width * arcs[0][0] + inner.half_width * arcs[1][0])
        y = 0.5 * (heights[0] * arcs[0][1] + heights[1] * arcs[1][1])
        length = np.concatenate(([0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))))
        chosen = np.interp(length[-1] * np.arange(count + 1) / count, length, t)
        quarters.append([_arc(chosen, s.dorsal_weight if dorsal else s.palmar_weight) for s in (outer, inner)])
    dorsal_arcs, palmar_arcs = quarters
    x = np.array([_around(d[0], p[0], -1.0, 1.0) for d, p in zip(dorsal_arcs, palmar_arcs, strict=True)])
    y = np.array([_around(d[1], p[1], 1.0, -1.0) for d, p in zip(dorsal_arcs, palmar_arcs, strict=True)])
    return x, y, np.arange(4 * count) <= 2 * count


def _around(dorsal: Array, palmar: Array, mirrored: float, below: float) -> Array:
    """Join quarter outlines to a closed one; `mirrored` is the sign at -x, `below` the sign on the palmar side."""
    return np.concatenate((
        dorsal[:-1], mirrored * dorsal[:0:-1], mirrored * below * palmar[:-1], below * palmar[:0:-1]
    ))  # fmt: skip


def _points(section: CrossSection, z: Array, scale: Array, x: Array, y: Array, is_dorsal: Mask) -> Array:
    """Compute the points of a surface [mm], shape (rows, columns, 3)."""
    around = section.half_width * x, np.where(is_dorsal, section.dorsal, section.palmar) * y
    across = [scale[:, None] * values for values in around]
    return np.stack((*across, np.broadcast_to(z[:, None], across[0].shape)), axis=2)
