"""Poses of parts on the printer's bed, and their overhangs: what is printed over air, and holds on
to nothing.

A part is turned by quarter turns, its lowest point on z = 0, its lowest corner at the origin. A
facet overhangs if it faces down and is steeper than 45 degrees from the vertical. Connected facets
form a ceiling. Its edge is held where the surface beside it goes down, and free where it rises:
there the part ends. The threads of a ceiling run in one direction, as a slicer lays them: a thread
that is held at both ends is a bridge, one that is held at one end a ledge. Short ones of both print
over air. The rest of the ceiling is unsupported.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.cad.kernel.mesh import Mesh
from fingertip.cad.kernel.tessellate import Triangles
from fingertip.foundation.numerics import Array


@dataclass(frozen=True)
class Pose:
    """Rigid motion of a part from its file to the bed: v -> rotation v + shift."""

    rotation: Array
    """Rotation, shape (3, 3).
    Its entries are 0, 1 and -1, so that vertices keep their exact values.
    """
    shift: tuple[float, float, float]
    """Translation after the rotation [mm]."""

    def apply(self, mesh: Mesh) -> Mesh:
        return Mesh(mesh.vertices @ self.rotation.T + np.array(self.shift) + 0.0, mesh.triangles)

    def size(self, mesh: Mesh) -> tuple[float, float, float]:
        moved = mesh.vertices @ self.rotation.T
        x, y, z = (moved.max(axis=0) - moved.min(axis=0)).tolist()
        return x, y, z

    def turned(self) -> Pose:
        """Turn the pose by a quarter turn about the vertical.

        It lies at the corner again once `on_bed` places it.
        """
        return Pose(
            np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]) @ self.rotation,
            self.shift,
        )

    def on_bed(self, mesh: Mesh, x: float = 0.0, y: float = 0.0) -> Pose:
        """Move the lowest corner of a part to (`x`, `y`, 0) [mm]."""
        low = (mesh.vertices @ self.rotation.T).min(axis=0).tolist()
        return Pose(self.rotation, (x - low[0], y - low[1], -low[2]))


def bed_pose(mesh: Mesh, rotate_x_deg: float) -> Pose:
    """Find the pose of a part that is turned about x, with its lowest corner at the origin.

    Raises ValueError.
    """
    quarters = rotate_x_deg / 90.0
    if quarters != round(quarters):
        raise ValueError(f"{rotate_x_deg:g} degrees are no quarter turns")

    angle = math.radians(rotate_x_deg)
    c = float(round(math.cos(angle)))
    s = float(round(math.sin(angle)))
    return Pose(np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]]), (0.0, 0.0, 0.0)).on_bed(
        mesh
    )


OVERHANG_DEG = 45.0
"""Angle from the vertical above which a surface overhangs."""
MAX_BRIDGE_MM = 10.0
"""Longest bridge that prints over air [mm].
Design guides of print services state 5 to 15 mm. An assumption.
"""
MAX_LEDGE_MM = 1.0
"""Longest ledge that prints over air [mm], as design guides for resin state. An assumption."""
MAX_UNSUPPORTED_MM2 = MAX_LEDGE_MM**2
"""Largest unsupported part of a ceiling [mm2]: a corner of the longest ledge, as where a bore ends
in a round side.
"""
_STEEP = math.sin(math.radians(OVERHANG_DEG)) + 1e-4
"""Component of the normal downwards above which a facet overhangs.
Facets at the angle itself do not.
"""
_ON_BED_MM = 0.005
"""Height up to which a facet lies on the bed [mm]."""
_THREAD_MM = 0.1
"""Distance of the threads at which a ceiling is measured [mm]."""
_DIRECTIONS = 36  # steps of 5 degrees, in which PrusaSlicer turns bridges


@dataclass(frozen=True)
class Ceiling:
    facets: NDArray[np.int64]
    """Numbers of the facets in the mesh."""
    edges: Array
    """Edges of its boundary seen from above, shape (n, 2, 2): x and y of both ends [mm]."""
    is_held: NDArray[np.bool_]
    """True for edges beside which the surface goes down, shape (n,)."""

    def unsupported_mm2(self) -> float:
        """Area seen from above that no short bridge and no short ledge covers [mm2], in the best
        direction.
        """
        return min(
            _unsupported_along(self.edges, self.is_held, math.pi * i / _DIRECTIONS)
            for i in range(_DIRECTIONS)
        )


def find_ceilings(mesh: Mesh) -> list[Ceiling]:
    """Find the ceilings of a mesh whose bed is the plane z = 0, from its first facet on."""
    corners = mesh.vertices[mesh.triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    on_bed = corners[:, :, 2].max(axis=1) <= _ON_BED_MM
    steep = (normal[:, 2] < -_STEEP * np.linalg.norm(normal, axis=1)) & ~on_bed
    numbers = np.flatnonzero(steep)
    if not len(numbers):
        return []

    beside = _neighbours(mesh.triangles, numbers)
    group = _connected(numbers, beside)
    row, side = np.nonzero(~steep[beside])
    facet = numbers[row]
    third = beside[row, side]
    edges = np.stack([corners[facet, side], corners[facet, (side + 1) % 3]], axis=1)
    # Of the facet beside, only the corner off the common edge leaves the plane of the ceiling's
    # facet.
    away = (corners[third] - edges[:, :1]) @ normal[facet, :, None]
    is_held = away[:, :, 0].sum(axis=1) > 0.0
    members = _split(group)
    sides = _split(group[row])

    return [
        Ceiling(numbers[facets], edges[selected][:, :, :2], is_held[selected])
        for facets, selected in zip(members, sides, strict=True)
    ]


def _split(group: NDArray[np.int64]) -> list[NDArray[np.int64]]:
    """List for each group the positions at which its number stands."""
    order = np.argsort(group, kind="stable")
    return np.split(order, np.flatnonzero(np.diff(group[order])) + 1)


def _neighbours(triangles: Triangles, numbers: NDArray[np.int64]) -> NDArray[np.int64]:
    """Find the three facets beside each of some facets of a closed mesh, in the order of their
    sides, shape (n, 3).
    """
    size = int(triangles.max()) + 1
    keys = (triangles * size + np.roll(triangles, -1, axis=1)).ravel()
    order = np.argsort(keys)
    edge_triangles = triangles[numbers]
    opposite = np.roll(edge_triangles, -1, axis=1) * size + edge_triangles

    return np.asarray(order[np.searchsorted(keys[order], opposite)] // 3)


def _connected(numbers: NDArray[np.int64], beside: NDArray[np.int64]) -> NDArray[np.int64]:
    """Find the group of each facet: those that overhang and share an edge have the place of the
    first of them.
    """
    row_of = {number: row for row, number in enumerate(numbers.tolist())}
    links = [
        [row_of[neighbour] for neighbour in neighbours if neighbour in row_of]
        for neighbours in beside.tolist()
    ]
    group = [-1] * len(links)

    for first in range(len(links)):
        if group[first] >= 0:
            continue

        waiting = [first]
        group[first] = first
        while waiting:
            for neighbour in links[waiting.pop()]:
                if group[neighbour] < 0:
                    group[neighbour] = first
                    waiting.append(neighbour)

    return np.array(group)


def _unsupported_along(edges: Array, is_held: NDArray[np.bool_], angle: float) -> float:
    """Area [mm2] of a ceiling that is not covered if its threads run in one direction."""
    along = edges @ np.array([math.cos(angle), math.sin(angle)])
    across = edges @ np.array([-math.sin(angle), math.cos(angle)])
    low = float(across.min())
    high = float(across.max())
    count = max(1, math.ceil((high - low) / _THREAD_MM))
    spacing = (high - low) / count
    threads = low + spacing * (np.arange(count) + 0.5)
    begin = across[:, :1]
    end = across[:, 1:]
    thread, edge = np.nonzero(((begin <= threads) != (end <= threads)).T)
    share = (threads[thread] - begin[edge, 0]) / (end - begin)[edge, 0]
    at = along[edge, 0] + share * (along[edge, 1] - along[edge, 0])
    order = np.lexsort((at, thread))
    at = at[order]
    is_supported = is_held[edge[order]]
    # Each thread crosses the boundary an even number of times: it enters and leaves in turn.
    length = at[1::2] - at[::2]
    ends = is_supported[1::2].astype(int) + is_supported[::2]
    longest = np.array([0.0, MAX_LEDGE_MM, MAX_BRIDGE_MM])[ends]

    return float(length[length > longest + 1e-6].sum() * spacing)
