"""The router's grid: who may go where, who is there, and what a trespass has cost so far."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

from fingertip.board.layout.names import Box
from fingertip.board.layout.placement import PlacedPad
from fingertip.board.layout.routing.paths import BACK, FRONT, GRID_MM, VIA, Node, Path, vias_of


@dataclass(frozen=True)
class Rules:
    """Widths and distances [mm]."""

    track: float
    clearance: float
    via: float
    edge: float
    """From copper to the board's edge."""


class Grid:
    """Claims of pads, and paths that are held."""

    def __init__(
        self, width: float, height: float, pads: list[PlacedPad], rules: Rules, no_vias: Iterable[Box] = ()
    ) -> None:
        self.columns, self.rows = round(width / GRID_MM) + 1, round(height / GRID_MM) + 1
        self.size = self.columns * self.rows
        self.rules = rules
        # Net that alone may pass (None: everybody, "": nobody), for tracks by layer and for vias.
        self.owner: list[list[str | None]] = [[None] * self.size for _ in range(3)]
        self.count = [[0.0] * self.size for _ in range(3)]
        self.past = [[0.0] * self.size for _ in range(3)]
        reach = {FRONT: rules.track / 2, BACK: rules.track / 2, VIA: rules.via / 2}
        for kind, half in reach.items():
            self._fence(kind, rules.edge + half)
            for pad in pads:
                # A via's hole may not lie in a pad of its own net either: solder would run off.
                if pad.pad.drill or kind != BACK:
                    self._claim(kind, pad, half + rules.clearance)
        for box in no_vias:
            self._keep_vias_out(box, rules.via / 2)
        self.track_reach = _disc(rules.track + rules.clearance)
        self.via_track_reach = _disc((rules.via + rules.track) / 2 + rules.clearance)
        self.via_reach = _disc(rules.via + rules.clearance)

    def may(self, kind: int, i: int, net: str) -> bool:
        """Whether a net may use a node."""
        return self.owner[kind][i] in (None, net)

    def entries(self, pad: PlacedPad) -> Path:
        """Nodes inside a pad, where a track may begin."""
        found: list[Node] = []
        for layer in (FRONT, BACK) if pad.pad.drill else (FRONT,):
            for row in range(self.rows):
                if abs(row * GRID_MM - pad.y) > pad.half_height * 0.6:
                    continue
                for column in range(self.columns):
                    if abs(column * GRID_MM - pad.x) <= pad.half_width * 0.6:
                        found.append((layer, column, row))
        return found

    def hold(self, paths: list[Path], by: float = 1.0) -> None:
        """Take the room of these paths; with -1 give it back."""
        for kind, nodes in enumerate(self._room(paths)):
            for i in nodes:
                self.count[kind][i] += by

    def trespasses(self, paths: list[Path]) -> list[tuple[int, int]]:
        """Kinds and nodes of these held paths that others hold too; the paths' own room counts once."""
        own = self._room(paths)
        return [(kind, i) for kind, i in self._used(paths) if self.count[kind][i] - (i in own[kind]) > 0.5]

    def remember(self, paths: list[Path]) -> None:
        """Make dearer for good where these paths trespass."""
        for kind, i in self.trespasses(paths):
            self.past[kind][i] += 0.5

    def _used(self, paths: list[Path]) -> set[tuple[int, int]]:
        used = {(layer, row * self.columns + column) for path in paths for layer, column, row in path}
        return used | {(VIA, row * self.columns + column) for path in paths for column, row in vias_of(path)}

    def _room(self, paths: list[Path]) -> list[set[int]]:
        """Nodes other nets may not use because of these paths, by kind."""
        covered: list[set[int]] = [set(), set(), set()]
        for path in paths:
            for layer, column, row in path:
                self._cover(covered[layer], column, row, self.track_reach)
                self._cover(covered[VIA], column, row, self.via_track_reach)
            for column, row in vias_of(path):
                for layer in (FRONT, BACK):
                    self._cover(covered[layer], column, row, self.via_track_reach)
                self._cover(covered[VIA], column, row, self.via_reach)
        return covered

    def _cover(self, covered: set[int], column: int, row: int, disc: list[tuple[int, int]]) -> None:
        for dx, dy in disc:
            x, y = column + dx, row + dy
            if 0 <= x < self.columns and 0 <= y < self.rows:
                covered.add(y * self.columns + x)

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
                    inside = kind == VIA and gap < self.rules.via / 2 + 0.05
                    mine = None if hole else pad.net
                    known = self.owner[kind][i]
                    if hole or inside or mine == "" or known not in (None, mine):
                        self.owner[kind][i] = ""
                    else:
                        self.owner[kind][i] = mine

    def _keep_vias_out(self, box: Box, margin: float) -> None:
        """What is printed there would be drilled away."""
        left, top, right, bottom = (v / GRID_MM for v in box)
        m = margin / GRID_MM
        for row in range(max(math.ceil(top - m), 0), min(math.floor(bottom + m), self.rows - 1) + 1):
            for column in range(max(math.ceil(left - m), 0), min(math.floor(right + m), self.columns - 1) + 1):
                self.owner[VIA][row * self.columns + column] = ""


def _disc(radius: float) -> list[tuple[int, int]]:
    n = math.ceil(radius / GRID_MM)
    return [
        (dx, dy) for dy in range(-n, n + 1) for dx in range(-n, n + 1) if math.hypot(dx, dy) * GRID_MM < radius - 1e-9
    ]
