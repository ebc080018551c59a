"""Ways on the router's grid, and the tracks and vias they become."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

GRID_MM = 0.2
FRONT, BACK, VIA = 0, 1, 2
"""Both layers; and vias, which need room on both."""

Node = tuple[int, int, int]
"""Layer, column, row."""
Path = list[Node]
Segment = tuple[int, tuple[float, float], tuple[float, float]]
"""Layer and both ends [mm]."""


@dataclass(frozen=True)
class Tracks:
    """One net's copper."""

    segments: tuple[Segment, ...]
    vias: tuple[tuple[float, float], ...]


def net_of(job: str) -> str:
    """The net of a job, whose name begins with it."""
    return job.split(" ")[0]


def vias_of(path: Path) -> list[tuple[int, int]]:
    """Column and row wherever a path changes layers."""
    return [(a[1], a[2]) for a, b in pairwise(path) if a[0] != b[0]]


def gathered(held: dict[str, list[Path]]) -> dict[str, Tracks]:
    """Paths by net, straight runs joined."""
    segments: dict[str, list[Segment]] = {}
    vias: dict[str, list[tuple[float, float]]] = {}
    for job, paths in sorted(held.items()):
        net = net_of(job)
        for path in paths:
            segments.setdefault(net, []).extend(_runs(path))
            vias.setdefault(net, []).extend((_mm(x), _mm(y)) for x, y in vias_of(path))
    return {
        net: Tracks(tuple(cut(dict.fromkeys(segments[net]))), tuple(dict.fromkeys(vias[net])))
        for net in sorted(segments)
    }


def cut(segments: Iterable[Segment]) -> list[Segment]:
    """The segments of one net, cut wherever another of the same layer ends on them: KiCad wants ends to meet there."""
    pieces = list(segments)
    found: list[Segment] = []
    for layer, a, b in pieces:
        ends = {end for other, *both in pieces for end in both if other == layer and _inside(a, end, b)}
        chain = [a, *sorted(ends, key=lambda end: math.dist(a, end)), b]
        found += [(layer, start, end) for start, end in pairwise(chain)]
    return list(dict.fromkeys(found))


def _inside(a: tuple[float, float], c: tuple[float, float], b: tuple[float, float]) -> bool:
    """Whether c lies on the straight piece between a and b, and is neither; all on the grid."""
    return c not in (a, b) and math.dist(a, c) + math.dist(c, b) - math.dist(a, b) < 1e-6


def _runs(path: Path) -> list[Segment]:
    runs: list[Segment] = []
    start = 0
    for i in range(1, len(path)):
        last = i == len(path) - 1
        a, b = path[i - 1], path[i]
        turns = last or tuple(q - p for p, q in zip(a, b, strict=True)) != tuple(
            q - p for p, q in zip(b, path[i + 1], strict=True)
        )
        if turns:
            if a[0] == b[0] and path[start] != b:
                runs.append((b[0], (_mm(path[start][1]), _mm(path[start][2])), (_mm(b[1]), _mm(b[2]))))
            start = i
    return runs


def _mm(cells: int) -> float:
    return round(cells * GRID_MM, 3)
