"""Mesh of the palmar skin: triangles in the plan of the pad, extruded to wedges up to the surface.

The plan is a Delaunay triangulation of points on the outline, on circles around the sensor, and on
a hexagonal lattice elsewhere. So edges follow the circle of the active area, over which the share
is integrated, and no mesh generator is needed. All elements are quadratic in plan and in height (18
nodes); the surface is curved as that of the form.

Coordinates of a node are x, z and palmar height, in this order [mm]. The skin ends at the parting
plane.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.foundation.errors import GeometryError, Issue
from fingertip.foundation.numerics import Array, bisect_arrays
from fingertip.pad.pad_geometry import PadForm
from fingertip.pad.touch import X

RIM_MM = 0.6
"""Height of the surface above the parting plane at which the mesh ends [mm]. Beyond it the skin is
too thin to carry a load.
"""
_THINNEST_MM = 0.1
"""Thickness of the skin over the bone below which it is not meshed [mm]."""
_WIDEST_MM = 200.0
"""Distance from the axis and from the sensor up to which the outline is sought [mm]."""
_OUTLINE_POINTS = 400
_MIN_DISTANCE = 0.6
"""Least distance of a lattice point from a fixed one, in lengths of an edge."""
_SMOOTHINGS = 10
"""Rounds in which free points move to the middle of their neighbours."""
_BYTES_PER_ENTRY = 20.0
"""Memory for an entry of the factorised stiffness, with what is built for it [byte]: measured."""
_FIXED_GB = 0.2
"""Memory that does not grow with the mesh [GB]: measured."""

Triangles = NDArray[np.int64]
"""Indices of points, a row for each triangle."""


@dataclass(frozen=True)
class MeshSize:
    """Size of the elements, and the memory that they may take."""

    edge_mm: float = 0.8
    """Length of the edges in plan."""
    layers: int = 2
    """Number of elements over the thickness."""
    memory_gb: float = 2.0


@dataclass(frozen=True, eq=False)
class WedgeMesh:
    """Wedges of 18 nodes between two heights.

    Nodes come in levels from the bottom up. Every level has the order of the plan's points.
    """

    nodes: Array
    triangles: Triangles
    """Triangles of a level: three corners, then the middles of the edges 0-1, 1-2 and 2-0."""
    wedges: NDArray[np.int64]
    """Nodes of each wedge: those of its triangle at the lower, the middle and the upper level."""
    count: int
    """Number of nodes of a level."""


def quadratic_plan(
    corners: Array, triangles: Triangles, centre_z: float = 0.0, radii: Sequence[float] = ()
) -> tuple[Array, Triangles]:
    """Add the middles of the edges to a plan, and turn all triangles to the left.

    The middle of an edge whose ends lie on a circle about (0, `centre_z`) moves onto that circle.
    Returns the points, and for each triangle its corners and middles as in `WedgeMesh.triangles`.
    """
    turns_left = _double_areas(corners, triangles) > 0.0
    triangles = np.where(turns_left[:, None], triangles, triangles[:, [0, 2, 1]])
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]], axis=2).reshape(-1, 2)
    unique, index = np.unique(edges, axis=0, return_inverse=True)

    centre = np.array([0.0, centre_z])
    ends = corners[unique] - centre
    middles = ends.mean(axis=1)

    for radius in radii:
        is_on_circle = (np.abs(np.linalg.norm(ends, axis=2) - radius) < 1e-9).all(axis=1)
        chords = middles[is_on_circle]
        middles[is_on_circle] *= radius / np.linalg.norm(chords, axis=1, keepdims=True)

    points = np.concatenate([corners, middles + centre])
    return points, np.hstack([triangles, len(corners) + index.reshape(-1, 3)])


def extrude(points: Array, triangles: Triangles, faces: Array) -> WedgeMesh:
    """Extrude a plan to layers of wedges between faces.

    `faces` holds the heights of the plan's points, a row for each face from the bottom up.
    """
    layers = len(faces) - 1
    heights = np.empty((2 * layers + 1, len(points)))
    heights[::2] = faces
    heights[1::2] = 0.5 * (faces[:-1] + faces[1:])

    plans = np.broadcast_to(points, (*heights.shape, 2))
    nodes = np.dstack([plans, heights]).reshape(-1, 3)
    levels = [triangles + level * len(points) for level in range(2 * layers + 1)]
    wedges = np.concatenate([np.hstack(levels[i : i + 3]) for i in range(0, 2 * layers, 2)])

    return WedgeMesh(nodes, triangles, wedges, len(points))


def mesh_skin(form: PadForm, size: MeshSize, is_half: bool) -> tuple[WedgeMesh, NDArray[np.bool_]]:
    """Mesh the palmar skin, or its half x >= 0.

    Also returns which triangles of its lower surface lie on the bone. Raises GeometryError.
    """
    corners, triangles = _triangulate_half(form, size, is_half)
    if not is_half:
        corners, triangles = _add_mirror_image(corners, triangles)

    points, triangles = quadratic_plan(corners, triangles, form.sensor_z_mm, _circles_mm(form))
    x, z = points.T
    surface = form.skin_mm(x, z)
    bone = form.bone_mm(x, z)
    _check_thickness(points, surface - bone)

    # Where the bone has a kink within an element, a curved lower face would bulge. So its middles
    # lie between its corners.
    bottom = np.maximum(bone, 0.0)
    begins = bottom[triangles[:, [0, 1, 2]]]
    ends = bottom[triangles[:, [1, 2, 0]]]
    bottom[triangles[:, 3:]] = 0.5 * (begins + ends)

    fractions = np.linspace(0.0, 1.0, size.layers + 1)[:, None]
    faces = bottom + fractions * (surface - bottom)
    lies_on_bone = np.isfinite(bone[triangles]).all(axis=1)
    return extrude(points, triangles, faces), np.asarray(lies_on_bone)


def _add_mirror_image(corners: Array, triangles: Triangles) -> tuple[Array, Triangles]:
    """Add the half x <= 0 to a plan of the half x >= 0; points on x = 0 belong to both."""
    is_beside = corners[:, X] > 0.0
    new_index = len(corners) - 1 + np.cumsum(is_beside)
    mirrored = np.where(is_beside, new_index, np.arange(len(corners)))

    return (
        np.concatenate([corners, corners[is_beside] * (-1.0, 1.0)]),
        np.concatenate([triangles, mirrored[triangles]]),
    )


def _check_thickness(points: Array, thickness: Array) -> None:
    """Refuse a skin that is too thin for a mesh at one of the points. Raises GeometryError."""
    thinnest = int(np.argmin(thickness))
    if thickness[thinnest] >= _THINNEST_MM:
        return

    x, z = points[thinnest]
    place = f"at x = {x:.1f}, z = {z:.1f} mm the skin is {thickness[thinnest]:.2g} mm thick"
    remedy = f"below the {_THINNEST_MM:g} mm of a mesh; make it thicker there."
    raise GeometryError(Issue("skin", f"{place}, {remedy}"))


def _circles_mm(form: PadForm) -> list[float]:
    """List the radii around the sensor on which edges lie: of the active area, and of a bump."""
    radii = {form.active_radius_mm}
    if form.bump_height_mm:
        radii.add(form.bump_radius_mm)

    return sorted(radii)


# Plan of the half x >= 0.


def _triangulate_half(form: PadForm, size: MeshSize, is_half: bool) -> tuple[Array, Triangles]:
    """Triangulate the half x >= 0 of the plan, with edges on the circles and on x = 0.

    Raises GeometryError if the mesh of the half, or of the whole, takes too much memory.
    """
    outline = _trace_outline(form)
    area_mm2 = float(np.trapezoid(outline[:, 0], outline[:, 1]))
    _check_memory(size, area_mm2 if is_half else 2.0 * area_mm2)

    fixed = _place_fixed_points(form, outline, size.edge_mm)
    lattice = _place_lattice(form, outline, size.edge_mm)
    differences = lattice[:, None] - fixed
    distances = np.hypot(differences[..., 0], differences[..., 1])
    is_apart = (distances > _MIN_DISTANCE * size.edge_mm).all(axis=1)

    points = np.concatenate([fixed, lattice[is_apart]])
    return _triangulate_smoothly(points, len(fixed), size.edge_mm)


def _trace_outline(form: PadForm) -> Array:
    """Trace the half outline at which the mesh ends, from the base to the tip, as a fine line."""
    tip_z = form.sensor_z_mm + float(_find_rim(form, np.array([form.sensor_z_mm]), 0.0, 1.0)[0])
    # Points lie closer together towards the tip.
    z = tip_z * np.sin(np.linspace(0.0, 0.5 * math.pi, _OUTLINE_POINTS))
    sides = np.column_stack([_find_rim(form, z, 1.0, 0.0), z])

    return np.concatenate([sides, [[0.0, tip_z]]])


def _find_rim(form: PadForm, begin_z: Array, x: float, z: float) -> Array:
    """Find how far from points of the axis, in direction (x, z), the surface falls to the rim."""

    def is_inside(distance: Array) -> NDArray[np.bool_]:
        return np.asarray(form.skin_mm(x * distance, begin_z + z * distance) >= RIM_MM)

    low = np.zeros(len(begin_z))
    high = np.full(len(begin_z), _WIDEST_MM)
    rim, _ = bisect_arrays(is_inside, low, high, halvings=50)
    return rim


def _place_fixed_points(form: PadForm, outline: Array, edge: float) -> Array:
    """Place points on the outline, on the straight borders, and on circles around the sensor."""
    centre_z = form.sensor_z_mm
    radius = _circles_mm(form)[-1]
    width = outline[0, 0]
    tip_z = outline[-1, 1]
    centre = np.array([0.0, centre_z])
    base = np.array([[0, 0], [width, 0]])
    axis_below = np.array([[0, 0], [0, centre_z - radius]])
    axis_above = np.array([[0, centre_z + radius], [0, tip_z]])

    lines = [_resample(line, edge) for line in (outline, base, axis_below, axis_above)]
    arcs = [centre + arc for arc in _place_arcs(_circles_mm(form), edge)]
    points = np.concatenate([*lines, centre[None], *arcs])

    # Ends of lines and arcs coincide.
    _, first = np.unique(np.round(points / (1e-6 * edge)), axis=0, return_index=True)
    return points[first]


def _place_arcs(circles: Sequence[float], edge: float) -> Iterator[Array]:
    """Yield points of half circles around the origin, up to each of the circles in equal steps."""
    radii = []
    inner = 0.0
    for circle in circles:
        steps = max(1 if inner else 2, round((circle - inner) / edge))
        radii += [inner + (circle - inner) * step / steps for step in range(1, steps + 1)]
        inner = circle

    for radius in radii:
        intervals = round(math.pi * radius / radii[0])
        angle = np.linspace(-0.5 * math.pi, 0.5 * math.pi, intervals + 1)
        arc = np.column_stack([np.cos(angle), np.sin(angle)])
        arc[[0, -1], 0] = 0.0
        yield radius * arc


def _resample(line: Array, spacing: float) -> Array:
    """Place points at about equal distances along a line."""
    steps = np.diff(line, axis=0)
    length = np.concatenate([[0.0], np.cumsum(np.hypot(steps[:, 0], steps[:, 1]))])
    intervals = max(1, round(length[-1] / spacing))
    place = np.linspace(0.0, length[-1], intervals + 1)
    return np.column_stack([np.interp(place, length, line[:, i]) for i in range(2)])


def _place_lattice(form: PadForm, outline: Array, edge: float) -> Array:
    """Place a hexagonal lattice inside the outline and outside the circles."""
    row = 0.5 * math.sqrt(3.0) * edge
    rows = round(outline[-1, 1] / row)
    columns = round(outline[:, 0].max() / edge) + 1
    i, j = np.meshgrid(np.arange(rows), np.arange(columns))
    x = edge * (j + 0.5 * (i % 2)).ravel()
    z = row * i.ravel()

    is_inside = x < np.interp(z, outline[:, 1], outline[:, 0])
    is_outside_circles = np.hypot(x, z - form.sensor_z_mm) > _circles_mm(form)[-1]
    return np.column_stack([x, z])[is_inside & is_outside_circles]


def _triangulate_smoothly(points: Array, fixed: int, edge: float) -> tuple[Array, Triangles]:
    """Triangulate points, of which all but the first `fixed` may move; return both."""
    triangles = _triangulate(points, edge)
    for _ in range(_SMOOTHINGS):
        neighbours = points[triangles].sum(axis=1, keepdims=True) - points[triangles]
        total = np.zeros_like(points)
        count = np.zeros((len(points), 1))
        np.add.at(total, triangles, neighbours)
        np.add.at(count, triangles, 2.0)

        points[fixed:] = (total / count)[fixed:]
        triangles = _triangulate(points, edge)

    return points, triangles


def _triangulate(points: Array, edge: float) -> Triangles:
    """Triangulate points, without the flat triangles along straight borders."""
    from scipy.spatial import Delaunay  # noqa: PLC0415

    triangles: Triangles = Delaunay(points).simplices.astype(np.int64)
    has_area = np.abs(_double_areas(points, triangles)) > 1e-3 * edge * edge
    return triangles[has_area]


def _double_areas(points: Array, triangles: Triangles) -> Array:
    """Compute twice the area of each triangle, negative where it turns to the right."""
    first = points[triangles[:, 1]] - points[triangles[:, 0]]
    second = points[triangles[:, 2]] - points[triangles[:, 0]]
    return np.asarray(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])


def _check_memory(size: MeshSize, area_mm2: float) -> None:
    """Refuse a mesh whose factorised stiffness would not fit. Raises GeometryError.

    Entries are estimated by the fill of nested dissection in the plane.
    """
    if not (0.0 < size.edge_mm < math.inf and size.layers >= 1):
        message = f"{size.edge_mm:g} mm and {size.layers} layers: both must be above 0."
        raise GeometryError(Issue("mesh", message))

    points = 4.6 * area_mm2 / size.edge_mm**2 + 10.0
    entries = 4.5 * points * (6.0 * size.layers) ** 2 * math.log2(points)
    needed_gb = _FIXED_GB + entries * _BYTES_PER_ENTRY * 1e-9
    if needed_gb <= size.memory_gb:
        return

    problem = (
        f"edges of {size.edge_mm:g} mm in {size.layers} layers need about {needed_gb:.1f} GB, "
        f"above {size.memory_gb:g} GB"
    )
    remedy = "use longer edges, or raise mesh.memory_gb."
    raise GeometryError(Issue("mesh.edge_mm", f"{problem}; {remedy}"))
