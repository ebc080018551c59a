"""Mesh of the skin: triangles over the plan of the pad, extruded to wedges between bone and
surface.

The plan is a Delaunay triangulation of points on the outline, on rings around the sensor and on a
hexagonal lattice elsewhere. Edges so follow the circle of the active area, over which the share is
integrated, and no mesh generator is needed. All elements are quadratic in plan and in height (18
nodes); the surface is curved like the form's.

Nodes have the axes x, z and palmar height, in this order [mm]. The skin ends at the parting plane.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.foundation.errors import GeometryError, Issue
from fingertip.foundation.numerics import Array, bisect_arrays
from fingertip.pad.pad_geometry import PadForm
from fingertip.pad.touch import X

RIM_MM = 0.6
"""Height of the surface above the parting plane at which the mesh ends [mm]: a feather edge carries
nothing.
"""
_THINNEST_MM = 0.1
"""Thickness of the skin over the bone below which it is not meshed [mm]."""
_WIDEST_MM = 200.0
"""Distance from the axis and the sensor within which the outline is looked for [mm]."""
_SMOOTHINGS = 10
"""Rounds in which free points move to the middle of their neighbours."""
_BYTES_PER_ENTRY = 20.0
_FIXED_GB = 0.2
"""Memory for an entry of the factorised stiffness, with all that is built for it, and beside it
[GB]: measured.
"""


@dataclass(frozen=True)
class MeshSize:
    """Length of the edges in plan, number of elements over the thickness, and the memory that they
    may take.
    """

    edge_mm: float = 0.8
    layers: int = 2
    memory_gb: float = 2.0


@dataclass(frozen=True, eq=False)
class WedgeMesh:
    """Wedges of 18 nodes between two heights.

    Nodes come in levels from the bottom up, all in the order of a plan.
    """

    nodes: Array
    triangles: NDArray[np.int64]
    """Triangles of a level: three corners, then the middles of the edges 0-1, 1-2 and 2-0."""
    wedges: NDArray[np.int64]
    """A triangle's nodes at the lower, the middle and the upper level of each wedge."""
    count: int
    """Number of nodes of a level."""


def quadratic_plan(
    corners: Array, triangles: NDArray[np.int64], centre_z: float = 0.0, radii: Sequence[float] = ()
) -> tuple[Array, NDArray[np.int64]]:
    """Add the middles of triangles' edges.

    Those of edges on a circle about (0, `centre_z`) move onto it.
    """
    turns_left = _doubled_areas(corners, triangles) > 0.0
    triangles = np.where(turns_left[:, None], triangles, triangles[:, [0, 2, 1]])
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]], axis=2).reshape(-1, 2)
    unique, index = np.unique(edges, axis=0, return_inverse=True)
    arms = corners[unique] - np.array([0.0, centre_z])
    middle = arms.mean(axis=1)

    for radius in radii:
        on = (np.abs(np.linalg.norm(arms, axis=2) - radius) < 1e-9).all(axis=1)
        middle[on] *= radius / np.linalg.norm(middle[on], axis=1, keepdims=True)

    points = np.concatenate([corners, middle + np.array([0.0, centre_z])])
    return points, np.hstack([triangles, len(corners) + index.reshape(-1, 3)])


def extrude(points: Array, triangles: NDArray[np.int64], faces: Array) -> WedgeMesh:
    """Fill the space between heights of a plan's points, from the bottom up, with a layer of wedges
    each.
    """
    layers = len(faces) - 1
    height = np.empty((2 * layers + 1, len(points)))
    height[::2] = faces
    height[1::2] = 0.5 * (faces[:-1] + faces[1:])
    nodes = np.dstack([np.broadcast_to(points, (*height.shape, 2)), height]).reshape(-1, 3)
    levels = [triangles + level * len(points) for level in range(2 * layers + 1)]
    wedges = np.concatenate([np.hstack(levels[i : i + 3]) for i in range(0, 2 * layers, 2)])

    return WedgeMesh(nodes, triangles, wedges, len(points))


def mesh_skin(form: PadForm, size: MeshSize, is_half: bool) -> tuple[WedgeMesh, NDArray[np.bool_]]:
    """Mesh the palmar skin, or its half x >= 0, and tell which triangles of its lower surface lie
    on the bone.
    """
    corners, triangles = _triangulate_half(form, size, 1.0 if is_half else 2.0)
    if not is_half:
        away = corners[:, X] > 0.0
        mirrored = np.where(away, len(corners) - 1 + np.cumsum(away), np.arange(len(corners)))
        corners = np.concatenate([corners, corners[away] * (-1.0, 1.0)])
        triangles = np.concatenate([triangles, mirrored[triangles]])

    points, t = quadratic_plan(corners, triangles, form.sensor_z_mm, _circles(form))
    x, z = points.T
    surface = form.skin_mm(x, z)
    bone = form.bone_mm(x, z)
    thin = int(np.argmin(surface - bone))

    if not surface[thin] - bone[thin] >= _THINNEST_MM:
        where = (
            f"at x = {x[thin]:.1f}, z = {z[thin]:.1f} mm the skin is "
            f"{surface[thin] - bone[thin]:.2g} mm thick"
        )
        raise GeometryError(
            Issue(
                "skin", f"{where}, below the {_THINNEST_MM:g} mm of a mesh; make it thicker there."
            )
        )

    bottom = np.maximum(bone, 0.0)
    # Where the bone has a kink within an element, a curved lower face would bulge: its middles lie
    # between its corners.
    bottom[t[:, 3:]] = 0.5 * (bottom[t[:, :3]] + bottom[t[:, [1, 2, 0]]])
    faces = bottom + np.linspace(0.0, 1.0, size.layers + 1)[:, None] * (surface - bottom)
    return extrude(points, t, faces), np.asarray(np.isfinite(bone[t]).all(axis=1))


def _circles(form: PadForm) -> list[float]:
    """Radii around the sensor on which edges lie: that of the active area, and that of a bump."""
    return sorted(
        {form.active_radius_mm} | ({form.bump_radius_mm} if form.bump_height_mm else set())
    )


def _outline(form: PadForm) -> Array:
    """Return a fine polyline along the half outline at which the mesh ends, from the base to the
    tip.
    """

    def reach(start: Array, x: float, z: float) -> Array:
        """Find how far from points on the axis, in a direction, the surface falls to the rim."""

        def is_inside(distance: Array) -> NDArray[np.bool_]:
            return np.asarray(form.skin_mm(x * distance, start + z * distance) >= RIM_MM)

        return bisect_arrays(
            is_inside, np.zeros(len(start)), np.full(len(start), _WIDEST_MM), halvings=50
        )[0]

    length = form.sensor_z_mm + float(reach(np.array([form.sensor_z_mm]), 0.0, 1.0)[0])
    z = length * np.sin(np.linspace(0.0, 0.5 * math.pi, 400))  # closer towards the tip
    return np.concatenate([np.column_stack([reach(z, 1.0, 0.0), z]), [[0.0, length]]])


def _resample(line: Array, spacing: float) -> Array:
    length = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
    at = np.linspace(0.0, length[-1], max(1, round(length[-1] / spacing)) + 1)
    return np.column_stack([np.interp(at, length, line[:, i]) for i in range(2)])


def _triangulate_half(
    form: PadForm, size: MeshSize, copies: float
) -> tuple[Array, NDArray[np.int64]]:
    """Triangulate the half x >= 0 of the plan.

    Its edges lie on the circle of the active area and on x = 0.
    """
    from scipy.spatial import Delaunay  # noqa: PLC0415

    edge = size.edge_mm
    centre = form.sensor_z_mm
    radius = _circles(form)[-1]
    outline = _outline(form)
    width = outline[0, 0]
    length = outline[-1, 1]
    _check_memory(size, copies * float(np.trapezoid(outline[:, 0], outline[:, 1])))
    straight = (
        [[0, 0], [width, 0]],
        [[0, 0], [0, centre - radius]],
        [[0, centre + radius], [0, length]],
    )
    lines = [outline, *(np.array(ends) for ends in straight)]
    circles = []
    last = 0.0

    for circle in _circles(form):
        parts = max(2 if not last else 1, round((circle - last) / edge))
        circles += [last + (circle - last) * part / parts for part in range(1, parts + 1)]
        last = circle

    nailed = [_resample(line, edge) for line in lines] + [np.array([[0.0, centre]])]
    for circle in circles:
        angle = np.linspace(-0.5 * math.pi, 0.5 * math.pi, round(math.pi * circle / circles[0]) + 1)
        arc = np.column_stack([np.cos(angle), np.sin(angle)])
        arc[[0, -1], 0] = 0.0
        nailed.append(circle * arc + np.array([0.0, centre]))

    fixed = np.concatenate(nailed)
    fixed = fixed[np.unique(np.round(fixed / (1e-6 * edge)), axis=0, return_index=True)[1]]
    row = 0.5 * math.sqrt(3.0) * edge
    i, j = np.meshgrid(
        np.arange(round(length / row)), np.arange(round(outline[:, 0].max() / edge) + 1)
    )
    x = edge * (j + 0.5 * (i % 2)).ravel()
    z = row * i.ravel()
    inside = (x < np.interp(z, outline[:, 1], outline[:, 0])) & (np.hypot(x, z - centre) > radius)
    lattice = np.column_stack([x, z])[inside]
    lattice = lattice[
        (np.hypot(*(lattice[:, None] - fixed).transpose(2, 0, 1)) > 0.6 * edge).all(axis=1)
    ]
    points = np.concatenate([fixed, lattice])

    for step in range(_SMOOTHINGS + 1):
        triangles = Delaunay(points).simplices.astype(np.int64)
        # Flat ones lie along straight borders.
        triangles = triangles[np.abs(_doubled_areas(points, triangles)) > 1e-3 * edge * edge]
        if step < _SMOOTHINGS:
            total = np.zeros_like(points)
            count = np.zeros((len(points), 1))
            np.add.at(
                total, triangles, points[triangles].sum(axis=1, keepdims=True) - points[triangles]
            )
            np.add.at(count, triangles, 2.0)
            points[len(fixed) :] = (total / count)[len(fixed) :]

    return points, triangles


def _doubled_areas(points: Array, triangles: NDArray[np.int64]) -> Array:
    (a, b), (c, d) = ((points[triangles[:, i]] - points[triangles[:, 0]]).T for i in (1, 2))
    return np.asarray(a * d - b * c)


def _check_memory(size: MeshSize, area_mm2: float) -> None:
    """Refuse a mesh whose factorised stiffness would not fit, by the fill of nested dissection in
    the plane.
    """
    if not (0.0 < size.edge_mm < math.inf and size.layers >= 1):
        raise GeometryError(
            Issue("mesh", f"{size.edge_mm:g} mm and {size.layers} layers: both must be above 0.")
        )

    points = 4.6 * area_mm2 / size.edge_mm**2 + 10.0
    entries = 4.5 * points * (6.0 * size.layers) ** 2 * math.log2(points)
    needed = _FIXED_GB + entries * _BYTES_PER_ENTRY * 1e-9
    limit_gb = size.memory_gb

    if needed > limit_gb:
        need = (
            f"edges of {size.edge_mm:g} mm in {size.layers} layers need about {needed:.1f} GB, "
            f"above {limit_gb:g} GB"
        )
        raise GeometryError(
            Issue("mesh.edge_mm", f"{need}; use longer edges, or raise mesh.memory_gb.")
        )
