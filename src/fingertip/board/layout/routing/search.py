"""The cheapest way on the router's grid (Dijkstra): to other pads of a net, or to the pour behind."""

from __future__ import annotations

import heapq
import math
from collections.abc import Iterable

from fingertip.board.layout.placement import PlacedPad
from fingertip.board.layout.routing.grid import Grid
from fingertip.board.layout.routing.paths import BACK, VIA, Node, Path, net_of

_VIA_COST = 12.0
_BACK_COST = 2.5
"""Tracks behind cut the ground pour."""
_STEPS = [(dx, dy, math.hypot(dx, dy)) for dx in (-1, 0, 1) for dy in (-1, 0, 1) if dx or dy]


def connect(grid: Grid, job: str, pads: list[PlacedPad], price: float) -> list[Path]:
    """Paths that join the pads, or one pad with a via, through what others hold at a price."""
    if len(pads) == 1:
        return [_search(grid, job, grid.entries(pads[0]), None, price)]
    reached = set(grid.entries(pads[0]))
    left = [set(grid.entries(pad)) for pad in pads[1:]]
    paths = []
    while left:
        targets = set().union(*left)
        path = _search(grid, job, sorted(reached), targets, price)
        paths.append(path)
        reached.update(path)
        for group in [group for group in left if path[-1] in group]:
            reached |= group
            left.remove(group)
    return paths


def _search(grid: Grid, job: str, sources: Iterable[Node], targets: set[Node] | None, price: float) -> Path:
    """Cheapest way from any source to any target; without targets, to any node behind."""
    net = net_of(job)
    columns, rows, past, count = grid.columns, grid.rows, grid.past, grid.count
    best: dict[Node, float] = dict.fromkeys(sources, 0.0)
    before: dict[Node, Node] = {}
    queue = [(0.0, node) for node in best]
    heapq.heapify(queue)
    done: set[Node] = set()
    while queue:
        cost, node = heapq.heappop(queue)
        if node in done:
            continue
        done.add(node)
        layer, column, row = node
        if node in targets if targets is not None else layer == BACK:
            path = [node]
            while path[-1] in before:
                path.append(before[path[-1]])
            return path[::-1]
        for dx, dy, length in _STEPS:
            x, y = column + dx, row + dy
            if not (0 <= x < columns and 0 <= y < rows):
                continue
            i = y * columns + x
            if not grid.may(layer, i, net):
                continue
            weight = length * (_BACK_COST if layer == BACK else 1.0)
            total = cost + weight * (1.0 + past[layer][i]) + price * count[layer][i] * length
            if total < best.get((layer, x, y), math.inf):
                best[layer, x, y] = total
                before[layer, x, y] = node
                heapq.heappush(queue, (total, (layer, x, y)))
        i, other = row * columns + column, 1 - layer
        if grid.may(VIA, i, net) and grid.may(other, i, net):
            total = cost + _VIA_COST * (1.0 + past[VIA][i]) + price * 3.0 * count[VIA][i]
            if total < best.get((other, column, row), math.inf):
                best[other, column, row] = total
                before[other, column, row] = node
                heapq.heappush(queue, (total, (other, column, row)))
    raise RuntimeError(f"{job} has no way at all; move parts apart")
