"""Network of a thin layer between two surfaces: exact volumes, and conductances by linear finite elements.

Both surfaces are given at twice the grid's resolution: even rows and columns hold the nodes. The volume between the
surfaces is cut into hexahedra, four to a quad, and each belongs to the node at its corner. A quad's thickness is its
volume divided by its area halfway between the surfaces. Its conductance per width and length is h^3 / 12. Each quad is
cut along its Delaunay diagonal, which keeps the conductances positive, and linear triangles (cotangent weights) remain
consistent where rows and columns are not perpendicular. Conductances along grid lines alone would not.

The grid of the mold's cavity unwraps the layer of silicone around the insert. Rows lie across the finger, from the
collar to the apex, which is the pole. Columns follow the outlines of the sections: both sides (y = 0), the middle of
the dorsal and the middle of the palmar side are columns. Points of cavity and insert are paired by row and by the
parameter of the outline's arc. The palmar flat cuts the insert's points off.

References: J. Grandy, Conservative remapping, J. Comput. Phys. 148 (1999) 433, eq. 6 (volume of a hexahedron);
U. Pinkall and K. Polthier, Exp. Math. 2 (1993) 15 (cotangent weights).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from fingertip.design import Design
from fingertip.design.geometry.conic import ConicBody, CrossSection, arc_point
from fingertip.filling.network import FlowNetwork, Mask
from fingertip.foundation.numerics import Array

TOUCHING_MM = 0.05
"""Thickness below which both surfaces are taken to touch [mm]. Silicone does not flow there."""


@dataclass(frozen=True, eq=False)
class Layer:
    """Network of a layer with the geometry of its nodes. Vectors hold the grid row by row, then the pole."""

    network: FlowNetwork
    points_mm: Array
    """Nodes halfway between both surfaces, shape (nodes, 3)."""
    thickness_mm: Array
    """Thickness of the layer at each node; 0 at closed ones."""


def link_layer(
    inner: Array,
    outer: Array,
    *,
    has_pole: bool,
    is_periodic: bool,
    is_closed: Callable[[Array], Mask] | None = None,
    without_steps: Array | None = None,
) -> Layer:
    """Link the nodes of a layer; lengths and areas are those halfway from `without_steps`, if given, not from `inner`.

    A quad over a step of the inner surface stands the steeper the finer the grid. Its large area would make the layer
    thin there, and block it.
    """
    middle = 0.5 * (inner + outer)
    middle_wrapped = middle if without_steps is None else 0.5 * (without_steps + outer)
    if is_periodic:
        inner, outer, middle_wrapped = (np.concatenate((a, a[:, :1]), axis=1) for a in (inner, outer, middle_wrapped))
    small_volume = hexahedron_volumes(inner, outer)
    small_area = np.linalg.norm(vector_areas(middle_wrapped), axis=2)
    volume, area = _sum_of_four(small_volume), _sum_of_four(small_area)
    thickness = np.divide(volume, area, out=np.zeros_like(volume), where=area > 0.0)
    closed = thickness < TOUCHING_MM
    if is_closed is not None:
        closed |= is_closed(middle_wrapped[1::2, 1::2])
    thickness = np.where(closed, 0.0, thickness)
    small_closed = np.repeat(np.repeat(closed, 2, axis=0), 2, axis=1)
    small_volume, small_area = (np.where(small_closed, 0.0, small) for small in (small_volume, small_area))

    node_volume = _sum_at_nodes(small_volume, is_periodic, has_pole)
    nodes = middle[::2, ::2]
    rest = (nodes[:-1].reshape(-1, 3), nodes[-1, :1]) if has_pole else (nodes.reshape(-1, 3), np.full((1, 3), np.nan))
    points = np.concatenate(rest)
    node_area = _sum_at_nodes(small_area, is_periodic, has_pole)
    node_thickness = np.divide(node_volume, node_area, out=np.zeros_like(node_volume), where=node_area > 0.0)
    network = _link(middle_wrapped[::2, ::2], thickness**3 / 12.0, node_volume, has_pole, is_periodic)
    return Layer(network, points, node_thickness)


def _sum_at_nodes(small: Array, is_periodic: bool = True, has_pole: bool = True) -> Array:
    """Sum values of the small quads, shape (2 rows, 2 columns), around each node, as a vector over the nodes."""
    rows, columns = small.shape[0] // 2 + 1, small.shape[1] // 2
    by_row = np.zeros((rows, small.shape[1]))
    by_row[:-1] += small[::2]
    by_row[1:] += small[1::2]
    by_node = np.zeros((rows, columns + 1))
    by_node[:, :-1] += by_row[:, ::2]
    by_node[:, 1:] += by_row[:, 1::2]
    if is_periodic:
        by_node[:, 0] += by_node[:, -1]
        by_node = by_node[:, :-1]
    if has_pole:
        return np.append(by_node[:-1].ravel(), by_node[-1].sum())
    return np.append(by_node.ravel(), 0.0)


def _link(nodes: Array, mobility: Array, volume: Array, has_pole: bool, is_periodic: bool) -> FlowNetwork:
    """Assemble conductances from the triangles of all quads. Units: `mobility` [mm3]."""
    a, b, c, d = nodes[:-1, :-1], nodes[1:, :-1], nodes[1:, 1:], nodes[:-1, 1:]
    # Quad a (i, j), b (i + 1, j), c (i + 1, j + 1), d (i, j + 1). Diagonal a-c faces the angles at b and d.
    at_b, at_d = _cotangent(b, a, c), _cotangent(d, c, a)
    rises = at_b + at_d >= 0.0
    if has_pole:
        rises[-1] = True  # b and c are the same point: the triangle a, c, d is the whole quad
    half = 0.5 * mobility
    # Diagonal a-c: triangles a, b, c and a, c, d. Diagonal b-d: triangles a, b, d and b, c, d.
    c_abc, a_abc = _cotangent(c, a, b), _cotangent(a, b, c)
    c_acd, a_acd = _cotangent(c, d, a), _cotangent(a, c, d)
    d_abd, b_abd = _cotangent(d, a, b), _cotangent(b, d, a)
    d_bcd, b_bcd = _cotangent(d, b, c), _cotangent(b, c, d)
    along_left = half * np.where(rises, c_abc, d_abd)  # link a-b
    along_right = half * np.where(rises, a_acd, b_bcd)  # link d-c
    lower = half * np.where(rises, c_acd, b_abd)  # link a-d
    upper = half * np.where(rises, a_abc, d_bcd)  # link b-c
    rising = half * np.where(rises, at_b + at_d, 0.0)
    falling = half * np.where(rises, 0.0, _cotangent(a, d, b) + _cotangent(c, b, d))
    rows, columns = half.shape
    around = np.zeros((rows + 1, columns))
    around[:-1] += lower
    if has_pole:
        # The last row of quads is a fan of triangles a, pole, d.
        pole, half_fan = nodes[-1, :1], half[-1]
        first, second = nodes[-2, :-1], nodes[-2, 1:]
        around[-2] += half_fan * _cotangent(np.broadcast_to(pole, first.shape), first, second) - lower[-1]
        to_first = half_fan * _cotangent(second, first, pole)
        to_second = half_fan * _cotangent(first, second, pole)
        pole_links = to_first + np.roll(to_second, 1)
        along_left, along_right, upper, rising, falling, around = (
            part[:-1] for part in (along_left, along_right, upper, rising, falling, around)
        )
    else:
        pole_links = np.zeros(columns if is_periodic else columns + 1)
    around[1:] += upper
    if is_periodic:
        along = along_left + np.roll(along_right, 1, axis=1)
    else:
        along = np.pad(along_left, ((0, 0), (0, 1))) + np.pad(along_right, ((0, 0), (1, 0)))
        around, rising, falling = (np.pad(part, ((0, 0), (0, 1))) for part in (around, rising, falling))
    return FlowNetwork(volume, along, around, rising, falling, pole_links)


def hexahedron_volumes(inner: Array, outer: Array) -> Array:
    """Compute the volumes [mm3] between two surfaces, exact for bilinear faces; positive for a left-handed system."""
    x0, x1, x2, x3 = inner[:-1, :-1], inner[1:, :-1], inner[:-1, 1:], inner[1:, 1:]
    x4, x5, x6, x7 = outer[:-1, :-1], outer[1:, :-1], outer[:-1, 1:], outer[1:, 1:]
    along, around, outwards = x7 - x2, x7 - x1, x7 - x4
    sides = x6 - x0, x5 - x0, x3 - x0
    total = (
        _determinant(around + sides[0], along, sides[2])
        + _determinant(sides[0], along + sides[1], outwards)
        + _determinant(around, sides[1], outwards + sides[2])
    )
    return -total / 12.0


def _determinant(a: Array, b: Array, c: Array) -> Array:
    return np.asarray(
        a[..., 0] * (b[..., 1] * c[..., 2] - b[..., 2] * c[..., 1])
        + a[..., 1] * (b[..., 2] * c[..., 0] - b[..., 0] * c[..., 2])
        + a[..., 2] * (b[..., 0] * c[..., 1] - b[..., 1] * c[..., 0])
    )


def vector_areas(surface: Array) -> Array:
    """Compute the vector areas of the quads of a surface, rows x columns."""
    first, second = surface[1:, 1:] - surface[:-1, :-1], surface[:-1, 1:] - surface[1:, :-1]
    return np.asarray(0.5 * np.cross(second, first))


def _sum_of_four(small: Array) -> Array:
    return small[::2, ::2] + small[1::2, ::2] + small[::2, 1::2] + small[1::2, 1::2]


def _cotangent(corner: Array, a: Array, b: Array) -> Array:
    """Compute the cotangent of the angle at a corner between the directions to a and b; 0 without area."""
    u, v = a - corner, b - corner
    sine = np.linalg.norm(np.cross(u, v), axis=-1)
    cosine = np.einsum("...k,...k->...", u, v)
    return np.asarray(np.divide(cosine, sine, out=np.zeros_like(cosine), where=sine > 1e-12))


ROWS, COLUMNS = 40, 48
"""Default numbers of rows, without the pole, and of columns."""
_SAMPLES = 65
"""Points of an arc or profile from which equal lengths are interpolated."""


@dataclass(frozen=True, eq=False)
class SkinGrid:
    """Layer of silicone around an insert, and the areas on which its pressure acts."""

    layer: Layer
    insert_area_mm2: Array
    """Area of the insert around each node, times its normal into the silicone, shape (nodes, 3). The first row's nodes
    include the collar's face at z = 0."""
    parting_area_mm2: Array
    """Area of the cavity's surface around each node, projected on the plane y = 0; the mean of both mold halves."""


def build_skin_grid(
    design: Design, rows: int = ROWS, columns: int = COLUMNS, is_closed: Callable[[Array], Mask] | None = None
) -> SkinGrid:
    outer, shrinkage = design.dimensions.outer, design.dimensions.shrinkage
    body, flat, scale = design.dimensions.insert_body()
    straight, tip = _rows(outer, body, rows)
    side, height, is_dorsal = _outline(outer.section, body.section, columns)
    outer_z, outer_scale = _heights(outer, straight, tip)
    inner_z, inner_scale = _heights(body, straight, tip)
    palmar_scale = np.array([outer.palmar_scale_at(float(z)) for z in outer_z]) if outer.crown else outer_scale
    outside = _points(outer.section, outer_z, outer_scale, palmar_scale, side[0], height[0], is_dorsal)
    inside = _points(body.section, inner_z, inner_scale, inner_scale, side[1], height[1], is_dorsal)
    inside[..., 1] = np.maximum(inside[..., 1], -flat)
    without_platform = scale * inside
    if design.bone.platform_mm:
        dims = design.dimensions
        half, deep = (
            np.array([at(float(z)) for z in inner_z])[:, None]
            for at in (dims.platform_half_width_at, dims.flat_depth_at)
        )
        inset = dims.flat_depth - flat
        raised = (inside[..., 1] <= -flat) & (np.abs(inside[..., 0]) <= half - inset)
        inside[..., 1] = np.where(raised, inset - deep, inside[..., 1])
    inside, outside = scale * inside, shrinkage * outside
    layer = link_layer(
        inside, outside, has_pole=True, is_periodic=True, is_closed=is_closed, without_steps=without_platform
    )
    surfaces = [vector_areas(np.concatenate((surface, surface[:, :1]), axis=1)) for surface in (inside, outside)]
    insert = np.stack([_sum_at_nodes(surfaces[0][..., k]) for k in range(3)], axis=1)
    face = np.concatenate((inside[:1], outside[:1]))
    on_collar = vector_areas(np.concatenate((face, face[:, :1]), axis=1))[0]
    insert[:columns] -= (on_collar + np.roll(on_collar, 1, axis=0))[::2]
    return SkinGrid(layer, insert, 0.5 * _sum_at_nodes(np.abs(surfaces[1][..., 1])))


def _rows(outer: ConicBody, body: ConicBody, rows: int) -> tuple[Array, Array]:
    """Choose heights in the straight part and parameters of the tip, at twice the grid's resolution.

    The straight part keeps the insert's stations, the edges of the groove, as rows. Rows lie at equal distances along
    the mean of both profiles.
    """
    stations = [z for z, _ in body.stations if z >= 0.0]
    t = np.linspace(0.0, 1.0, _SAMPLES)
    (outer_z, outer_s), (inner_z, inner_s) = outer.tip_point(t), body.tip_point(t)
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
    tip_z, tip_scale = body.tip_point(tip)
    return np.concatenate((straight, tip_z)), np.concatenate((np.interp(straight, z, scale), tip_scale))


def _outline(outer: CrossSection, inner: CrossSection, columns: int) -> tuple[Array, Array, Mask]:
    """Choose the points of the outline, at twice the grid's resolution, at equal distances along the mean outline."""
    count = columns // 2
    t = np.linspace(0.0, 1.0, _SAMPLES)
    quarters = []
    for dorsal in (True, False):
        arcs = [arc_point(t, s.dorsal_weight if dorsal else s.palmar_weight) for s in (outer, inner)]
        heights = [s.dorsal if dorsal else s.palmar for s in (outer, inner)]
        x = 0.5 * (outer.half_width * arcs[0][0] + inner.half_width * arcs[1][0])
        y = 0.5 * (heights[0] * arcs[0][1] + heights[1] * arcs[1][1])
        length = np.concatenate(([0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))))
        chosen = np.interp(length[-1] * np.arange(count + 1) / count, length, t)
        quarters.append([arc_point(chosen, s.dorsal_weight if dorsal else s.palmar_weight) for s in (outer, inner)])
    dorsal_arcs, palmar_arcs = quarters
    x = np.array([_around(d[0], p[0], -1.0, 1.0) for d, p in zip(dorsal_arcs, palmar_arcs, strict=True)])
    y = np.array([_around(d[1], p[1], 1.0, -1.0) for d, p in zip(dorsal_arcs, palmar_arcs, strict=True)])
    return x, y, np.arange(4 * count) <= 2 * count


def _around(dorsal: Array, palmar: Array, mirrored: float, below: float) -> Array:
    """Join quarter outlines to a closed one; `mirrored` is the sign at -x, `below` the sign on the palmar side."""
    return np.concatenate((
        dorsal[:-1], mirrored * dorsal[:0:-1], mirrored * below * palmar[:-1], below * palmar[:0:-1]
    ))  # fmt: skip


def _points(section: CrossSection, z: Array, scale: Array, palmar: Array, x: Array, y: Array, is_dorsal: Mask) -> Array:
    """Compute the points of a surface [mm], shape (rows, columns, 3), with a scale of its own for the palmar height."""
    wide = scale[:, None] * (section.half_width * x)
    high = np.where(is_dorsal, scale[:, None] * section.dorsal, palmar[:, None] * section.palmar) * y
    return np.stack((wide, high, np.broadcast_to(z[:, None], wide.shape)), axis=2)
