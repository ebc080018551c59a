"""Network of a thin layer between two surfaces: exact volumes, and conductances by linear finite elements.

Both surfaces are given at twice the grid's resolution: even rows and columns hold the nodes. The volume between the
surfaces is cut into hexahedra, four to a quad, and each belongs to the node at its corner. A quad's thickness is its
volume divided by its area halfway between the surfaces. Its conductance per width and length is h^3 / 12. Each quad is
cut along its Delaunay diagonal, which keeps the conductances positive, and linear triangles (cotangent weights) remain
consistent where rows and columns are not perpendicular. Conductances along grid lines alone would not.

References: J. Grandy, Conservative remapping, J. Comput. Phys. 148 (1999) 433, eq. 6 (volume of a hexahedron);
U. Pinkall and K. Polthier, Exp. Math. 2 (1993) 15 (cotangent weights).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

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
    inner: Array, outer: Array, *, has_pole: bool, is_periodic: bool, is_closed: Callable[[Array], Mask] | None = None
) -> Layer:
    """Link the layer between two surfaces."""
    middle = 0.5 * (inner + outer)
    if is_periodic:
        inner, outer, middle_wrapped = (np.concatenate((a, a[:, :1]), axis=1) for a in (inner, outer, middle))
    else:
        middle_wrapped = middle
    small_volume = hexahedron_volumes(inner, outer)
    small_area = np.linalg.norm(vector_areas(middle_wrapped), axis=2)
    volume, area = _sum_of_four(small_volume), _sum_of_four(small_area)
    thickness = np.divide(volume, area, out=np.zeros_like(volume), where=area > 0.0)
    closed = thickness < TOUCHING_MM
    if is_closed is not None:
        closed |= is_closed(middle_wrapped[1::2, 1::2])
    thickness = np.where(closed, 0.0, thickness)
    small_volume = np.where(np.repeat(np.repeat(closed, 2, axis=0), 2, axis=1), 0.0, small_volume)

    collect = NodeSums(is_periodic, has_pole)
    node_volume = collect(small_volume)
    nodes = middle[::2, ::2]
    rest = (nodes[:-1].reshape(-1, 3), nodes[-1, :1]) if has_pole else (nodes.reshape(-1, 3), np.full((1, 3), np.nan))
    points = np.concatenate(rest)
    node_area = collect(np.where(np.repeat(np.repeat(closed, 2, axis=0), 2, axis=1), 0.0, small_area))
    node_thickness = np.divide(node_volume, node_area, out=np.zeros_like(node_volume), where=node_area > 0.0)
    network = _link(middle_wrapped[::2, ::2], thickness**3 / 12.0, node_volume, has_pole, is_periodic)
    return Layer(network, points, node_thickness)


@dataclass(frozen=True)
class NodeSums:
    """Sums over the small quads around each node, as a vector over the nodes."""

    is_periodic: bool
    has_pole: bool

    def __call__(self, small: Array) -> Array:
        """Sum the values of all small quads, shape (2 rows, 2 columns)."""
        rows, columns = small.shape[0] // 2 + 1, small.shape[1] // 2
        by_row = np.zeros((rows, small.shape[1]))
        by_row[:-1] += small[::2]
        by_row[1:] += small[1::2]
        by_node = np.zeros((rows, columns + 1))
        by_node[:, :-1] += by_row[:, ::2]
        by_node[:, 1:] += by_row[:, 1::2]
        if self.is_periodic:
            by_node[:, 0] += by_node[:, -1]
            by_node = by_node[:, :-1]
        if self.has_pole:
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
    along_left, along_right = np.zeros_like(half), np.zeros_like(half)
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
    """Compute the volumes [mm3] of the hexahedra between two surfaces, exact for bilinear faces.

    Positive where rows, columns and the direction from the inner to the outer surface form a left-handed system.
    """
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
    """Compute a . (b x c) in the last axis."""
    result: Array = (
        a[..., 0] * (b[..., 1] * c[..., 2] - b[..., 2] * c[..., 1])
        + a[..., 1] * (b[..., 2] * c[..., 0] - b[..., 0] * c[..., 2])
        + a[..., 2] * (b[..., 0] * c[..., 1] - b[..., 1] * c[..., 0])
    )
    return result


def vector_areas(surface: Array) -> Array:
    """Compute the vector areas of the quads of a surface, rows x columns."""
    first, second = surface[1:, 1:] - surface[:-1, :-1], surface[:-1, 1:] - surface[1:, :-1]
    areas: Array = 0.5 * np.cross(second, first)
    return areas


def _sum_of_four(small: Array) -> Array:
    """Sum the four small quads of each quad."""
    return small[::2, ::2] + small[1::2, ::2] + small[::2, 1::2] + small[1::2, 1::2]


def _cotangent(corner: Array, a: Array, b: Array) -> Array:
    """Compute the cotangent of the angle at a corner between the directions to a and b; 0 without area."""
    u, v = a - corner, b - corner
    sine = np.linalg.norm(np.cross(u, v), axis=-1)
    cosine = np.einsum("...k,...k->...", u, v)
    cotangent: Array = np.divide(cosine, sine, out=np.zeros_like(cosine), where=sine > 1e-12)
    return cotangent
