"""Overhangs of a part that lies on the printer's bed: what is printed over air, and holds on to nothing.

A facet overhangs if it faces down and is steeper than 45 degrees from the vertical. Connected facets form a ceiling.
Its edge is held where the surface beside it goes down, and free where it rises: there the part ends. The threads of a
ceiling run in one direction, as a slicer lays them: a thread that is held at both ends is a bridge, one that is held at
one end a ledge. Short ones of both print over air. The rest of the ceiling is unsupported.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.arrays import Array
from fingertip.cad.kernel.mesh import Mesh
from fingertip.cad.kernel.tessellate import Triangles

OVERHANG_DEG = 45.0
"""Angle from the vertical above which a surface overhangs."""
MAX_BRIDGE_MM = 10.0
"""Longest bridge that prints over air [mm]. Design guides of print services state 5 to 15 mm. An assumption."""
MAX_LEDGE_MM = 1.0
"""Longest ledge that prints over air [mm], as design guides for resin state. An assumption."""
MAX_UNSUPPORTED_MM2 = MAX_LEDGE_MM**2
"""Largest unsupported part of a ceiling [mm2]: a corner of the longest ledge, as where a bore ends in a round side."""
_STEEP = math.sin(math.radians(OVERHANG_DEG)) + 1e-4
"""Component of the normal downwards above which a facet overhangs; facets at the angle itself do not."""
_ON_BED_MM = 0.005
"""Height up to which a facet lies on the bed [mm]."""
_THREAD_MM = 0.1
"""Distance of the threads at which a ceiling is measured [mm]."""
_DIRECTIONS = 12
"""Number of directions of threads that are tried."""


@dataclass(frozen=True)
class Ceiling:
    """Connected facets that overhang."""

    facets: NDArray[np.int64]
    """Numbers of the facets in the mesh."""
    edges: Array
    """Edges of its boundary seen from above, shape (n, 2, 2): x and y of both ends [mm]."""
    is_held: NDArray[np.bool_]
    """True for edges beside which the surface goes down, shape (n,)."""

    def unsupported_mm2(self) -> float:
        """Area seen from above that no short bridge and no short ledge covers [mm2], in the best direction."""
        least = math.inf
        for i in range(_DIRECTIONS):
            least = min(least, _unsupported_along(self.edges, self.is_held, math.pi * i / _DIRECTIONS))
            if least == 0.0:
                break
        return least


def find_ceilings(mesh: Mesh) -> list[Ceiling]:
    """Find the ceilings of a mesh whose bed is the plane z = 0, from its first facet on."""
    corners = mesh.vertices[mesh.triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    on_bed = corners[:, :, 2].max(axis=1) <= _ON_BED_MM
    steep = (normal[:, 2] < -_STEEP * np.linalg.norm(normal, axis=1)) & ~on_bed
    numbers = np.flatnonzero(steep)
    if not len(numbers):
        return []
    neighbours = _neighbours(mesh.triangles, numbers)
    return [_ceiling(mesh, steep, group, neighbours) for group in _connected(numbers, steep, neighbours)]


def _ceiling(mesh: Mesh, steep: NDArray[np.bool_], facets: list[int], neighbours: dict[int, list[int]]) -> Ceiling:
    """Collect the boundary of connected facets. A concave edge is held: what is beside it lies in the air."""
    sides = [
        (facet, side, beside) for facet in facets for side, beside in enumerate(neighbours[facet]) if not steep[beside]
    ]
    facet, side, beside = np.array(sides).T
    corners = mesh.vertices[mesh.triangles[facet]]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    rows = np.arange(len(sides))
    edges = np.stack([corners[rows, side], corners[rows, (side + 1) % 3]], axis=1)
    # Of the facet beside, only the corner off the common edge leaves the plane of the ceiling's facet.
    away = (mesh.vertices[mesh.triangles[beside]] - edges[:, :1]) @ normal[:, :, None]
    return Ceiling(np.array(facets), edges[:, :, :2], away[:, :, 0].sum(axis=1) > 0.0)


def _neighbours(triangles: Triangles, numbers: NDArray[np.int64]) -> dict[int, list[int]]:
    """Find the three facets beside each of some facets of a closed mesh, in the order of their sides."""
    size = int(triangles.max()) + 1
    first, second = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    keys = first * size + second
    order = np.argsort(keys)
    wanted = triangles[numbers]
    opposite = np.roll(wanted, -1, axis=1) * size + wanted
    beside = order[np.searchsorted(keys[order], opposite)] // 3
    return dict(zip(numbers.tolist(), beside.tolist(), strict=True))


def _connected(
    numbers: NDArray[np.int64], steep: NDArray[np.bool_], neighbours: dict[int, list[int]]
) -> Iterator[list[int]]:
    """Group facets that overhang and share an edge."""
    left = dict.fromkeys(numbers.tolist())
    while left:
        group, waiting = [], [next(iter(left))]
        del left[waiting[0]]
        while waiting:
            facet = waiting.pop()
            group.append(facet)
            for beside in neighbours[facet]:
                if steep[beside] and beside in left:
                    del left[beside]
                    waiting.append(beside)
        yield sorted(group)


def _unsupported_along(edges: Array, is_held: NDArray[np.bool_], angle: float) -> float:
    """Area [mm2] of a ceiling that is not covered if its threads run in one direction."""
    along = edges @ np.array([math.cos(angle), math.sin(angle)])
    across = edges @ np.array([-math.sin(angle), math.cos(angle)])
    low, high = float(across.min()), float(across.max())
    count = max(1, math.ceil((high - low) / _THREAD_MM))
    spacing = (high - low) / count
    threads = low + spacing * (np.arange(count) + 0.5)
    begin, end = across[:, :1], across[:, 1:]
    thread, edge = np.nonzero(((begin <= threads) != (end <= threads)).T)
    share = (threads[thread] - begin[edge, 0]) / (end - begin)[edge, 0]
    at = along[edge, 0] + share * (along[edge, 1] - along[edge, 0])
    order = np.lexsort((at, thread))
    at, held = at[order], is_held[edge[order]]
    # Each thread crosses the boundary an even number of times: it enters and leaves in turn.
    length = at[1::2] - at[::2]
    ends = held[1::2].astype(int) + held[::2]
    longest = np.array([0.0, MAX_LEDGE_MM, MAX_BRIDGE_MM])[ends]
    return float(length[length > longest + 1e-6].sum() * spacing)
