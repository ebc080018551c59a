"""Grid router for two layers, by negotiated congestion.

It routes the connections one by one along their cheapest paths. A path may cross what other connections occupy, at a
cost that rises from round to round, until no conflicts are left (L. McMurchie and C. Ebeling, "PathFinder: a
negotiation-based performance-driven router for FPGAs", FPGA 1995). This takes a minute or two. It runs only after a
change of placement and never when a board is written, because tracks depend on placement and nets but not on values.

Ground is not routed as a net: each of its pads on the front gets a via of its own into the pour on the back.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from fingertip.board.kicad.footprints import Box
from fingertip.board.kicad.placement import PlacedPad, Tracks
from fingertip.foundation.jit import compile_for_process
from tools.routing.grid import ANY_NET, DesignRules, Grid
from tools.routing.paths import BACK, VIA, Node, Path, merge_paths, net_name

POURED_NET = "GND"

_VIA_COST = 12.0
_BACK_COST = 2.5
"""Cost of a track on the back relative to the front; it is higher because such tracks cut the ground pour."""
_FIRST_CONFLICT_COST = 0.6
_CONFLICT_COST_GROWTH = 1.5
"""Growth of the conflict cost from round to round."""


def route(
    width: float, height: float, pads: list[PlacedPad], rules: DesignRules, no_vias: Iterable[Box] = (),
    rounds: int = 60, progress: Callable[[str], None] = lambda message: None,
) -> dict[str, Tracks]:  # fmt: skip
    """Route all nets: tracks by net that connect all its pads, with no via within the boxes `no_vias`.

    Raises
    ------
    RuntimeError
        If conflicts are left after all rounds, or there is no path at all.
    """
    grid = Grid(width, height, pads, rules, no_vias)
    connections = _find_connections(pads)
    routed: dict[str, list[Path]] = {}
    conflict_cost = _FIRST_CONFLICT_COST
    conflicting: list[str] = []
    for i in range(rounds):
        # Route what is not routed yet, and reroute what conflicts with others.
        for connection, group in connections:
            if connection in routed and not grid.conflicts(routed[connection]):
                continue
            if connection in routed:
                grid.occupy(routed.pop(connection), -1.0)
            routed[connection] = connect(grid, connection, group, conflict_cost)
            grid.occupy(routed[connection])
        conflicting = [connection for connection, paths in routed.items() if grid.conflicts(paths)]
        progress(f"round {i + 1}: {len(conflicting)} connections conflict")
        if not conflicting:
            return merge_paths(routed)
        for connection in conflicting:
            grid.add_history_cost(routed[connection])
        conflict_cost *= _CONFLICT_COST_GROWTH
    raise RuntimeError(
        f"conflicts are left after {rounds} rounds: {', '.join(conflicting)}; move the components further apart"
    )


def _find_connections(pads: list[PlacedPad]) -> list[tuple[str, list[PlacedPad]]]:
    """Name and pads of each connection, shortest first: all pads of a net, or a single pad of the poured net."""
    connections: dict[str, list[PlacedPad]] = {}
    for pad in pads:
        if pad.net == POURED_NET and not pad.pad.drill:
            # Several pads may have the same number, as the mounting tabs of a connector do.
            connections[f"{POURED_NET} {pad.reference}.{pad.pad.number} at {pad.x:g} {pad.y:g}"] = [pad]
        elif pad.net and pad.net != POURED_NET:
            connections.setdefault(pad.net, []).append(pad)

    def span(group: list[PlacedPad]) -> float:
        return max(p.x for p in group) - min(p.x for p in group) + max(p.y for p in group) - min(p.y for p in group)

    return sorted(connections.items(), key=lambda item: (span(item[1]), item[0]))


def connect(grid: Grid, connection: str, pads: list[PlacedPad], conflict_cost: float) -> list[Path]:
    """Find paths that connect the pads, or a single pad with the pour on the back."""
    if len(pads) == 1:
        return [_find_path(grid, connection, grid.pad_nodes(pads[0]), None, conflict_cost)]
    connected = set(grid.pad_nodes(pads[0]))
    unconnected = [set(grid.pad_nodes(pad)) for pad in pads[1:]]
    paths = []
    while unconnected:
        targets = set().union(*unconnected)
        path = _find_path(grid, connection, sorted(connected), targets, conflict_cost)
        paths.append(path)
        connected.update(path)
        for nodes in [nodes for nodes in unconnected if path[-1] in nodes]:
            connected |= nodes
            unconnected.remove(nodes)
    return paths


def _find_path(
    grid: Grid, connection: str, sources: Iterable[Node], targets: set[Node] | None, conflict_cost: float
) -> Path:
    """Find the cheapest path from any source to any target (Dijkstra); without targets, to any node on the back."""
    is_target = np.zeros(2 * grid.size, dtype=np.bool_)
    if targets is None:
        is_target[grid.size :] = True
    else:
        is_target[[_number(grid, node) for node in targets]] = True
    best = np.full(2 * grid.size, math.inf)
    previous = np.full(2 * grid.size, -1, dtype=np.int64)
    end = _search(
        np.array([_number(grid, node) for node in sources]), is_target, grid.owner, grid.occupancy, grid.history_cost,
        grid.columns, grid.rows, grid.nets[net_name(connection)], conflict_cost, best, previous,
    )  # fmt: skip
    if end < 0:
        raise RuntimeError(f"there is no path for {connection}; move the components further apart")
    path: Path = []
    while end >= 0:
        layer, i = divmod(int(end), grid.size)
        path.append((layer, i % grid.columns, i // grid.columns))
        end = previous[end]
    return path[::-1]


def _number(grid: Grid, node: Node) -> int:
    """Number of a node among those of both layers."""
    layer, column, row = node
    return layer * grid.size + row * grid.columns + column


def _search_plain(
    sources: Any, is_target: Any, owner: Any, occupancy: Any, history: Any, columns: int, rows: int, net: int,
    conflict_cost: float, best: Any, previous: Any,
) -> int:  # fmt: skip
    """Search the cheapest path and note the way back in `previous`; returns the node at its end, -1 if none."""
    size = columns * rows
    queue = [(0.0, int(sources[0]))]
    for node in sources:
        best[node] = 0.0
        heapq.heappush(queue, (0.0, int(node)))
    while queue:
        cost, node = heapq.heappop(queue)
        if cost > best[node]:
            continue
        if is_target[node]:
            return node
        layer, i = node // size, node % size
        column, row = i % columns, i // columns
        # Steps to the eight neighbours on the same layer.
        for dy in range(-1, 2):
            for dx in range(-1, 2):
                x, y = column + dx, row + dy
                if (dx == 0 and dy == 0) or x < 0 or y < 0 or x >= columns or y >= rows:
                    continue
                k = y * columns + x
                if owner[layer, k] not in (ANY_NET, net):
                    continue
                length = math.sqrt(dx * dx + dy * dy)
                weight = length * (_BACK_COST if layer == BACK else 1.0)
                total = cost + weight * (1.0 + history[layer, k]) + conflict_cost * occupancy[layer, k] * length
                if total < best[layer * size + k]:
                    best[layer * size + k] = total
                    previous[layer * size + k] = node
                    heapq.heappush(queue, (total, layer * size + k))
        # A via to the other layer.
        other = 1 - layer
        if owner[VIA, i] in (ANY_NET, net) and owner[other, i] in (ANY_NET, net):
            total = cost + _VIA_COST * (1.0 + history[VIA, i]) + conflict_cost * 3.0 * occupancy[VIA, i]
            if total < best[other * size + i]:
                best[other * size + i] = total
                previous[other * size + i] = node
                heapq.heappush(queue, (total, other * size + i))
    return -1


_search = compile_for_process(_search_plain)
