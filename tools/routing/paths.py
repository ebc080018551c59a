"""Paths on the router's grid, and the tracks and vias made from them."""

from __future__ import annotations

import math
from collections.abc import Iterable
from itertools import pairwise

from fingertip.board.kicad.footprints import Point
from fingertip.board.kicad.placement import Segment, Tracks
from fingertip.board.kicad.project import TRACK_MM

GRID_MM = 0.2
FRONT, BACK, VIA = 0, 1, 2
"""Kinds of copper: tracks on the front, tracks on the back, and vias, which need space on both layers."""

Node = tuple[int, int, int]
"""Layer, column and row."""
Path = list[Node]


def net_name(connection: str) -> str:
    """Net of a connection, whose name begins with it."""
    return connection.split(" ")[0]


def find_vias(path: Path) -> list[tuple[int, int]]:
    """Find the columns and rows where a path changes layers."""
    return [(a[1], a[2]) for a, b in pairwise(path) if a[0] != b[0]]


def merge_paths(paths_by_connection: dict[str, list[Path]]) -> dict[str, Tracks]:
    """Convert paths to tracks by net, with straight runs joined to one segment."""
    segments: dict[str, list[Segment]] = {}
    vias: dict[str, list[Point]] = {}
    for connection, paths in sorted(paths_by_connection.items()):
        net = net_name(connection)
        for path in paths:
            segments.setdefault(net, []).extend(_straight_runs(path))
            vias.setdefault(net, []).extend((_to_mm(x), _to_mm(y)) for x, y in find_vias(path))
    return {
        net: Tracks(tuple(split_at_junctions(dict.fromkeys(segments[net]))), tuple(dict.fromkeys(vias[net])))
        for net in sorted(segments)
    }


def split_at_junctions(segments: Iterable[Segment]) -> list[Segment]:
    """Split the segments of one net wherever another segment of the same layer ends on them.

    KiCad reports an end in the middle of another segment as dangling.
    """
    unsplit = list(segments)
    split: list[Segment] = []
    for layer, a, b, width in unsplit:
        junctions = {end for s in unsplit for end in s[1:3] if s[0] == layer and _lies_between(a, end, b)}
        chain = [a, *sorted(junctions, key=lambda end: math.dist(a, end)), b]
        split += [(layer, start, end, width) for start, end in pairwise(chain)]
    return list(dict.fromkeys(split))


def _lies_between(a: Point, c: Point, b: Point) -> bool:
    """Return whether c lies on the straight line between a and b, excluding both ends. All points lie on the grid."""
    return c not in (a, b) and math.dist(a, c) + math.dist(c, b) - math.dist(a, b) < 1e-6


def _straight_runs(path: Path) -> list[Segment]:
    """Segments of a path, each as long as the path keeps its direction."""
    runs: list[Segment] = []
    start = 0
    for i in range(1, len(path)):
        a, b = path[i - 1], path[i]
        is_last = i == len(path) - 1
        run_ends = is_last or tuple(q - p for p, q in zip(a, b, strict=True)) != tuple(
            q - p for p, q in zip(b, path[i + 1], strict=True)
        )
        if run_ends:
            # A change of layers is a via and not a segment.
            if a[0] == b[0] and path[start] != b:
                ends = ((_to_mm(path[start][1]), _to_mm(path[start][2])), (_to_mm(b[1]), _to_mm(b[2])))
                runs.append((b[0], *ends, TRACK_MM))
            start = i
    return runs


def _to_mm(cells: int) -> float:
    return round(cells * GRID_MM, 3)
