"""A grid router for two layers: finds the tracks of a board that is then kept as a template.

Nets are routed one by one, cheapest way first, through what other nets hold at a price that rises from round to round
until nobody trespasses (negotiated congestion). It takes about a minute and runs when a placement changes, never when
a board is written: tracks depend on places and nets alone, not on values.

Ground is not routed as a net: each of its pads in front gets a way to a via of its own, into the pour behind.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import pairwise

from fingertip.board.placement import PlacedPad

GRID_MM = 0.2
FRONT, BACK = 0, 1
POUR = "GND"

_VIA_COST = 12.0
_BACK_COST = 2.5
"""Tracks behind cut the ground pour."""
_TURN = math.sqrt(2.0)


@dataclass(frozen=True)
class Rules:
    """Widths and distances [mm]."""

    track: float
    clearance: float
    via: float
    edge: float
    """From copper to the board's edge."""


Node = tuple[int, int, int]
"""Layer, column, row."""
Segment = tuple[int, tuple[float, float], tuple[float, float]]
"""Layer and both ends [mm]."""


@dataclass(frozen=True)
class Tracks:
    """One net's copper."""

    segments: tuple[Segment, ...]
    vias: tuple[tuple[float, float], ...]


def route(
    width: float, height: float, pads: list[PlacedPad], rules: Rules, rounds: int = 60,
    tell: Callable[[str], None] = lambda _words: None,
) -> dict[str, Tracks]:  # fmt: skip
    """Net -> tracks that join all its pads; RuntimeError if nets still trespass after all rounds."""
    grid = _Grid(width, height, pads, rules)
    jobs = _jobs(pads)
    held: dict[str, list[list[Node]]] = {}
    price = 0.6
    for turn in range(rounds):
        for name, groups in jobs:
            if name in held and not grid.trespasses(name, held[name]):
                continue
            if name in held:
                grid.release(name, held.pop(name))
            held[name] = grid.connect(name, groups, price)
            grid.hold(name, held[name])
        bad = [name for name in held if grid.trespasses(name, held[name])]
        tell(f"round {turn + 1}: {len(bad)} nets trespass")
        if not bad:
            return _gathered(held)
        for name in bad:
            grid.remember(name, held[name])
        price *= 1.5
    raise RuntimeError(f"nets still trespass after {rounds} rounds: {', '.join(bad)}; move parts apart")


def _jobs(pads: list[PlacedPad]) -> list[tuple[str, list[PlacedPad]]]:
    """What is to be joined: each net's pads, and each of the pour's pads in front alone; short ones first."""
    nets: dict[str, list[PlacedPad]] = {}
    for pad in pads:
        if pad.net == POUR and not pad.pad.drill:
            nets[f"{POUR} {pad.reference}.{pad.pad.number}"] = [pad]
        elif pad.net and pad.net != POUR:
            nets.setdefault(pad.net, []).append(pad)

    def span(group: list[PlacedPad]) -> float:
        return max(p.x for p in group) - min(p.x for p in group) + max(p.y for p in group) - min(p.y for p in group)

    return sorted(nets.items(), key=lambda item: (span(item[1]), item[0]))


def _net(job: str) -> str:
    return job.split(" ")[0]


class _Grid:
    """Who may go where, and who is there."""

    def __init__(self, width: float, height: float, pads: list[PlacedPad], rules: Rules) -> None:
        self.columns, self.rows = round(width / GRID_MM) + 1, round(height / GRID_MM) + 1
        self.size = self.columns * self.rows
        self.rules = rules
        # Net that alone may pass (None: everybody, "": nobody), for tracks by layer and for vias.
        self.owner: list[list[str | None]] = [[None] * self.size for _ in range(3)]
        self.count = [[0.0] * self.size for _ in range(3)]
        self.past = [[0.0] * self.size for _ in range(3)]
        reach = {FRONT: rules.track / 2, BACK: rules.track / 2, 2: rules.via / 2}
        for kind, half in reach.items():
            self._fence(kind, rules.edge + half)
            for pad in pads:
                # A via's hole may not lie in a pad of its own net either: solder would run off.
                if pad.pad.drill or kind != BACK:
                    self._claim(kind, pad, half + rules.clearance)
        self.track_reach = self._disc(rules.track + rules.clearance)
        self.via_track_reach = self._disc((rules.via + rules.track) / 2 + rules.clearance)
        self.via_reach = self._disc(rules.via + rules.clearance)

    def _fence(self, kind: int, margin: float) -> None:
        for row in range(self.rows):
            for column in range(self.columns):
                x, y = column * GRID_MM, row * GRID_MM
                gap = min(x, y, (self.columns - 1) * GRID_MM - x, (self.rows - 1) * GRID_MM - y)
                if gap < margin - 1e-9:
                    self.owner[kind][row * self.columns + column] = ""

    def _claim(self, kind: int, pad: PlacedPad, margin: float) -> None:
        hole = not pad.pad.plated
        for row in range(self.rows):
            dy = max(abs(row * GRID_MM - pad.y) - pad.half_height, 0.0)
            if dy >= margin:
                continue
            for column in range(self.columns):
                dx = max(abs(column * GRID_MM - pad.x) - pad.half_width, 0.0)
                if pad.pad.shape == "circle":
                    gap = math.hypot(column * GRID_MM - pad.x, row * GRID_MM - pad.y) - pad.half_width
                else:
                    gap = math.hypot(dx, dy)
                if gap < margin - 1e-9 + (0.1 if hole else 0.0):
                    i = row * self.columns + column
                    inside = kind == 2 and gap < self.rules.via / 2 + 0.05
                    mine = None if hole else pad.net
                    known = self.owner[kind][i]
                    if hole or inside or mine == "" or known not in (None, mine):
                        self.owner[kind][i] = ""
                    else:
                        self.owner[kind][i] = mine

    def _disc(self, radius: float) -> list[tuple[int, int]]:
        n = math.ceil(radius / GRID_MM)
        return [
            (dx, dy)
            for dy in range(-n, n + 1)
            for dx in range(-n, n + 1)
            if math.hypot(dx, dy) * GRID_MM < radius - 1e-9
        ]

    def entries(self, pad: PlacedPad) -> list[Node]:
        """Nodes inside a pad, where a track may begin."""
        found = []
        for layer in (FRONT, BACK) if pad.pad.drill else (FRONT,):
            for row in range(self.rows):
                if abs(row * GRID_MM - pad.y) > pad.half_height * 0.6:
                    continue
                for column in range(self.columns):
                    if abs(column * GRID_MM - pad.x) <= pad.half_width * 0.6:
                        found.append((layer, column, row))
        return found

    def connect(self, job: str, pads: list[PlacedPad], price: float) -> list[list[Node]]:
        """Paths that join the pads, or one pad with a via."""
        if len(pads) == 1:
            return [self._search(job, self.entries(pads[0]), None, price)]
        reached = set(self.entries(pads[0]))
        left = [set(self.entries(pad)) for pad in pads[1:]]
        paths = []
        while left:
            targets = set().union(*left)
            path = self._search(job, sorted(reached), targets, price)
            paths.append(path)
            reached.update(path)
            for group in [group for group in left if path[-1] in group]:
                reached |= group
                left.remove(group)
        return paths

    def _search(self, job: str, sources: Iterable[Node], targets: set[Node] | None, price: float) -> list[Node]:
        """Cheapest way from any source to any target; without targets, to any node behind."""
        net = _net(job)
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
                if not (0 <= x < self.columns and 0 <= y < self.rows):
                    continue
                i = y * self.columns + x
                if self.owner[layer][i] not in (None, net):
                    continue
                weight = length * (_BACK_COST if layer == BACK else 1.0)
                total = cost + weight * (1.0 + self.past[layer][i]) + price * self.count[layer][i] * length
                if total < best.get((layer, x, y), math.inf):
                    best[layer, x, y] = total
                    before[layer, x, y] = node
                    heapq.heappush(queue, (total, (layer, x, y)))
            i = row * self.columns + column
            other = 1 - layer
            if self.owner[2][i] in (None, net) and self.owner[other][i] in (None, net):
                total = cost + _VIA_COST * (1.0 + self.past[2][i]) + price * 3.0 * self.count[2][i]
                if total < best.get((other, column, row), math.inf):
                    best[other, column, row] = total
                    before[other, column, row] = node
                    heapq.heappush(queue, (total, (other, column, row)))
        raise RuntimeError(f"{job} has no way at all")

    def _footprint(self, paths: list[list[Node]]) -> list[set[int]]:
        """Nodes other nets may not use because of these paths, by kind."""
        covered: list[set[int]] = [set(), set(), set()]
        for path in paths:
            for layer, column, row in path:
                self._cover(covered[layer], column, row, self.track_reach)
                self._cover(covered[2], column, row, self.via_track_reach)
            for column, row in _vias(path):
                for layer in (FRONT, BACK):
                    self._cover(covered[layer], column, row, self.via_track_reach)
                self._cover(covered[2], column, row, self.via_reach)
        return covered

    def _cover(self, covered: set[int], column: int, row: int, disc: list[tuple[int, int]]) -> None:
        for dx, dy in disc:
            x, y = column + dx, row + dy
            if 0 <= x < self.columns and 0 <= y < self.rows:
                covered.add(y * self.columns + x)

    def hold(self, job: str, paths: list[list[Node]]) -> None:
        self._change(paths, 1.0)

    def release(self, job: str, paths: list[list[Node]]) -> None:
        self._change(paths, -1.0)

    def _change(self, paths: list[list[Node]], by: float) -> None:
        for kind, nodes in enumerate(self._footprint(paths)):
            for i in nodes:
                self.count[kind][i] += by

    def _used(self, paths: list[list[Node]]) -> set[tuple[int, int]]:
        used = {(layer, row * self.columns + column) for path in paths for layer, column, row in path}
        return used | {(2, row * self.columns + column) for path in paths for column, row in _vias(path)}

    def trespasses(self, job: str, paths: list[list[Node]]) -> bool:
        """Whether another net keeps one of these nodes for itself; this net's own claim counts once."""
        own = self._footprint(paths)
        return any(self.count[kind][i] - (i in own[kind]) > 0.5 for kind, i in self._used(paths))

    def remember(self, job: str, paths: list[list[Node]]) -> None:
        own = self._footprint(paths)
        for kind, i in self._used(paths):
            if self.count[kind][i] - (i in own[kind]) > 0.5:
                self.past[kind][i] += 0.5


_STEPS = [(dx, dy, _TURN if dx and dy else 1.0) for dx in (-1, 0, 1) for dy in (-1, 0, 1) if dx or dy]


def _vias(path: list[Node]) -> list[tuple[int, int]]:
    return [(a[1], a[2]) for a, b in pairwise(path) if a[0] != b[0]]


def _gathered(held: dict[str, list[list[Node]]]) -> dict[str, Tracks]:
    """Paths by net, straight runs joined."""
    segments: dict[str, list[Segment]] = {}
    vias: dict[str, list[tuple[float, float]]] = {}
    for job, paths in sorted(held.items()):
        net = _net(job)
        for path in paths:
            segments.setdefault(net, []).extend(_runs(path))
            vias.setdefault(net, []).extend((_mm(x), _mm(y)) for x, y in _vias(path))
    return {
        net: Tracks(tuple(dict.fromkeys(segments[net])), tuple(dict.fromkeys(vias[net]))) for net in sorted(segments)
    }


def _runs(path: list[Node]) -> list[Segment]:
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
