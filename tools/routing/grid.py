"""Grid of the router: which net may use each node, how many paths occupy it, and its history cost."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from fingertip.board.kicad.footprints import Box
from fingertip.board.kicad.placement import PlacedPad
from fingertip.foundation.numerics import Array
from tools.routing.paths import BACK, FRONT, GRID_MM, VIA, Node, Path, find_vias

_HISTORY_COST = 0.5
ANY_NET, NO_NET = -1, -2
"""Owners of a node that every net may use, or none."""


@dataclass(frozen=True)
class DesignRules:
    """Widths and clearances [mm]."""

    track: float
    clearance: float
    via: float
    edge: float
    """Clearance of copper from the edge of the board."""


class Grid:
    """Nodes claimed by pads and occupied by paths, for each kind: tracks on the front, tracks on the back and vias.

    Attributes
    ----------
    nets
        Number of each net.
    owner
        Number of the only net that may use a node; `ANY_NET` if every net may, `NO_NET` if no net may.
    occupancy
        Number of connections that use a node or its clearance.
    history_cost
        Cost of a node from the conflicts there so far.
    """

    def __init__(
        self, width: float, height: float, pads: list[PlacedPad], rules: DesignRules, no_vias: Iterable[Box] = ()
    ) -> None:
        self.columns, self.rows = round(width / GRID_MM) + 1, round(height / GRID_MM) + 1
        self.size = self.columns * self.rows
        self.rules = rules
        self.nets = {net: i for i, net in enumerate(dict.fromkeys(pad.net for pad in pads if pad.net))}
        self.owner = np.full((3, self.size), ANY_NET, dtype=np.int64)
        self.occupancy: Array = np.zeros((3, self.size))
        self.history_cost: Array = np.zeros((3, self.size))
        half_widths = {FRONT: rules.track / 2, BACK: rules.track / 2, VIA: rules.via / 2}
        for kind, half_width in half_widths.items():
            self._block_edge(kind, rules.edge + half_width)
            for pad in pads:
                # A via may not lie in a pad of its own net either: its hole would draw the solder off.
                if pad.pad.drill or kind != BACK:
                    self._claim_pad(kind, pad, half_width + rules.clearance)
        for box in no_vias:
            self._block_vias(box, rules.via / 2)
        self.track_to_track = _disc(rules.track + rules.clearance)
        self.via_to_track = _disc((rules.via + rules.track) / 2 + rules.clearance)
        self.via_to_via = _disc(rules.via + rules.clearance)

    def pad_nodes(self, pad: PlacedPad) -> Path:
        """Nodes inside a pad, where a track may begin."""
        nodes: list[Node] = []
        for layer in (FRONT, BACK) if pad.pad.drill else (FRONT,):
            for column, row in self._near(pad, 0.0):
                dx, dy = abs(column * GRID_MM - pad.x), abs(row * GRID_MM - pad.y)
                if dx <= pad.half_width * 0.6 and dy <= pad.half_height * 0.6:
                    nodes.append((layer, column, row))
        return nodes

    def occupy(self, paths: list[Path], change: float = 1.0) -> None:
        """Occupy the space of these paths; a change of -1 releases it."""
        for kind, nodes in enumerate(self._occupied(paths)):
            self.occupancy[kind, list(nodes)] += change

    def conflicts(self, paths: list[Path]) -> list[tuple[int, int]]:
        """Kinds and nodes where these paths, which occupy the grid, conflict with others."""
        own = self._occupied(paths)
        return [(kind, i) for kind, i in self._used(paths) if self.occupancy[kind, i] - (i in own[kind]) > 0.5]

    def add_history_cost(self, paths: list[Path]) -> None:
        """Raise the cost of the nodes where these paths conflict with others, for all later rounds."""
        for kind, i in self.conflicts(paths):
            self.history_cost[kind, i] += _HISTORY_COST

    def _used(self, paths: list[Path]) -> set[tuple[int, int]]:
        """Kinds and nodes on the centre lines of these paths."""
        used = {(layer, row * self.columns + column) for path in paths for layer, column, row in path}
        return used | {(VIA, row * self.columns + column) for path in paths for column, row in find_vias(path)}

    def _occupied(self, paths: list[Path]) -> list[set[int]]:
        """Nodes by kind that these paths take from other nets."""
        occupied: list[set[int]] = [set(), set(), set()]
        for path in paths:
            for layer, column, row in path:
                self._add_disc(occupied[layer], column, row, self.track_to_track)
                self._add_disc(occupied[VIA], column, row, self.via_to_track)
            for column, row in find_vias(path):
                for layer in (FRONT, BACK):
                    self._add_disc(occupied[layer], column, row, self.via_to_track)
                self._add_disc(occupied[VIA], column, row, self.via_to_via)
        return occupied

    def _add_disc(self, nodes: set[int], column: int, row: int, disc: list[tuple[int, int]]) -> None:
        for dx, dy in disc:
            x, y = column + dx, row + dy
            if 0 <= x < self.columns and 0 <= y < self.rows:
                nodes.add(y * self.columns + x)

    def _block_edge(self, kind: int, margin: float) -> None:
        """Block the nodes within a margin [mm] of the board's edge."""
        for row in range(self.rows):
            for column in range(self.columns):
                x, y = column * GRID_MM, row * GRID_MM
                gap = min(x, y, (self.columns - 1) * GRID_MM - x, (self.rows - 1) * GRID_MM - y)
                if gap < margin - 1e-9:
                    self.owner[kind, row * self.columns + column] = NO_NET

    def _claim_pad(self, kind: int, pad: PlacedPad, margin: float) -> None:
        """Reserve the nodes within a margin [mm] of a pad for its net."""
        is_hole = not pad.pad.is_plated
        # Between two nodes a diagonal track comes nearer to a sharp corner than at the nodes.
        reach = margin - 1e-9 + (0.1 if is_hole else 0.045 if pad.pad.shape == "rect" else 0.0)
        net = self.nets.get(pad.net, NO_NET)
        for column, row in self._near(pad, reach):
            x, y = column * GRID_MM - pad.x, row * GRID_MM - pad.y
            if pad.pad.shape == "circle":
                gap = math.hypot(x, y) - pad.half_width
            else:
                gap = math.hypot(max(abs(x) - pad.half_width, 0.0), max(abs(y) - pad.half_height, 0.0))
            if gap < reach:
                i = row * self.columns + column
                is_via_in_pad = kind == VIA and gap < self.rules.via / 2 + 0.05
                # A node within the margin of pads of two nets is of use to neither.
                is_shared = self.owner[kind, i] not in (ANY_NET, net)
                self.owner[kind, i] = NO_NET if is_hole or is_via_in_pad or is_shared else net

    def _near(self, pad: PlacedPad, margin: float) -> Iterator[tuple[int, int]]:
        """Yield the columns and rows of the nodes in the box around a pad, with a margin [mm]."""
        x, y = pad.half_width + margin, pad.half_height + margin
        for row in range(max(math.ceil((pad.y - y) / GRID_MM), 0), min(int((pad.y + y) / GRID_MM) + 1, self.rows)):
            for column in range(
                max(math.ceil((pad.x - x) / GRID_MM), 0), min(int((pad.x + x) / GRID_MM) + 1, self.columns)
            ):
                yield column, row

    def _block_vias(self, box: Box, margin: float) -> None:
        """Block vias in a box with silkscreen: they would make the print illegible."""
        left, top, right, bottom = (v / GRID_MM for v in box)
        m = margin / GRID_MM
        for row in range(max(math.ceil(top - m), 0), min(math.floor(bottom + m), self.rows - 1) + 1):
            for column in range(max(math.ceil(left - m), 0), min(math.floor(right + m), self.columns - 1) + 1):
                self.owner[VIA, row * self.columns + column] = NO_NET


@functools.cache
def _disc(radius: float) -> list[tuple[int, int]]:
    """Offsets in columns and rows of all nodes within a radius [mm]."""
    n = math.ceil(radius / GRID_MM)
    return [
        (dx, dy) for dy in range(-n, n + 1) for dx in range(-n, n + 1) if math.hypot(dx, dy) * GRID_MM < radius - 1e-9
    ]
