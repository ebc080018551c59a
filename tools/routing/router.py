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

from fingertip.board.kicad.footprints import Box
from fingertip.board.layout.placement import PlacedPad
from fingertip.board.layout.template import Tracks
from tools.routing.grid import DesignRules, Grid
from tools.routing.paths import BACK, VIA, Node, Path, merge_paths, net_name

POURED_NET = "GND"

_VIA_COST = 12.0
_BACK_COST = 2.5
"""Cost of a track on the back relative to the front; it is higher because such tracks cut the ground pour."""
_FIRST_CONFLICT_COST = 0.6
_CONFLICT_COST_GROWTH = 1.5
"""Growth of the conflict cost from round to round."""
_STEPS = [(dx, dy, math.hypot(dx, dy)) for dx in (-1, 0, 1) for dy in (-1, 0, 1) if dx or dy]


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
    net = net_name(connection)
    columns, rows, history, occupancy = grid.columns, grid.rows, grid.history_cost, grid.occupancy
    best: dict[Node, float] = dict.fromkeys(sources, 0.0)
    previous: dict[Node, Node] = {}
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
            while path[-1] in previous:
                path.append(previous[path[-1]])
            return path[::-1]
        # Steps to the eight neighbours on the same layer.
        for dx, dy, length in _STEPS:
            x, y = column + dx, row + dy
            if not (0 <= x < columns and 0 <= y < rows):
                continue
            i = y * columns + x
            if not grid.is_allowed(layer, i, net):
                continue
            weight = length * (_BACK_COST if layer == BACK else 1.0)
            total = cost + weight * (1.0 + history[layer][i]) + conflict_cost * occupancy[layer][i] * length
            if total < best.get((layer, x, y), math.inf):
                best[layer, x, y] = total
                previous[layer, x, y] = node
                heapq.heappush(queue, (total, (layer, x, y)))
        # A via to the other layer.
        i, other = row * columns + column, 1 - layer
        if grid.is_allowed(VIA, i, net) and grid.is_allowed(other, i, net):
            total = cost + _VIA_COST * (1.0 + history[VIA][i]) + conflict_cost * 3.0 * occupancy[VIA][i]
            if total < best.get((other, column, row), math.inf):
                best[other, column, row] = total
                previous[other, column, row] = node
                heapq.heappush(queue, (total, (other, column, row)))
    raise RuntimeError(f"there is no path for {connection}; move the components further apart")
