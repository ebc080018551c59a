"""Network of conductances between the nodes of a structured grid.

Rows run along the finger, columns around it. A last node, the pole, closes the far end. Each node stands for the part
of the cavity nearest to it. For unit viscosity the flow through a link is its conductance times the difference of
pressure, so that a conductance has the unit mm3.

Its linear solver eliminates blocks row by row. A moving front needs the solution for one wet region after the other,
and most rows are as wet as they were before: rows before the first one that changed are not eliminated again.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from fingertip.foundation.numerics import Array

Mask = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class FlowNetwork:
    """Volumes of the nodes and conductances of the links between them.

    Vectors over all nodes hold the grid row by row, then the pole. A node without volume is closed: no link may reach
    it. Columns are periodic; a plane slot has zero conductances from its last column to its first.
    """

    volume_mm3: Array
    along_mm3: Array
    """Conductances (i, j) to (i + 1, j), shape (rows - 1, columns)."""
    around_mm3: Array
    """Conductances (i, j) to (i, j + 1), shape (rows, columns)."""
    rising_mm3: Array
    """Conductances (i, j) to (i + 1, j + 1), shape (rows - 1, columns)."""
    falling_mm3: Array
    """Conductances (i, j + 1) to (i + 1, j), shape (rows - 1, columns)."""
    pole_mm3: Array
    """Conductances of the last row's nodes to the pole, shape (columns,)."""

    @property
    def shape(self) -> tuple[int, int]:
        rows, columns = self.around_mm3.shape
        return rows, columns

    @property
    def total_mm3(self) -> float:
        return float(self.volume_mm3.sum())

    @cached_property
    def is_open(self) -> Mask:
        return self.volume_mm3 > 0.0

    @cached_property
    def links(self) -> tuple[NDArray[np.intp], NDArray[np.intp], Array]:
        """Ends of all links, and their conductances; links without conductance are left out."""
        rows, columns = self.shape
        number = np.arange(rows * columns).reshape(rows, columns)
        right = np.roll(number, -1, axis=1)
        low, high = number[:-1], number[1:]
        first = [low, number, low, right[:-1], number[-1]]
        second = [high, right, right[1:], high, np.full(columns, rows * columns)]
        values = [self.along_mm3, self.around_mm3, self.rising_mm3, self.falling_mm3, self.pole_mm3]
        a, b, k = (np.concatenate([part.ravel() for part in parts]) for parts in (first, second, values))
        linked = k != 0.0
        return a[linked], b[linked], k[linked]

    def inflow(self, potential: Array) -> Array:
        a, b, k = self.links
        flow = k * (potential[a] - potential[b])
        count = len(potential)
        return np.asarray(np.bincount(b, flow, count).astype(float) - np.bincount(a, flow, count))

    def reach(self, start: Mask) -> Mask:
        """Return the nodes linked to the start, directly or through others."""
        a, b, _ = self.links
        reached = start.copy()
        while True:
            new = np.concatenate((b[reached[a] & ~reached[b]], a[reached[b] & ~reached[a]]))
            if not len(new):
                return reached
            reached[new] = True

    @cached_property
    def blocks(self) -> tuple[Array, Array, float]:
        """Dense blocks of the matrix: each row with itself, each row with the next (negated), the pole's diagonal."""
        rows, columns = self.shape
        a, b, k = self.links
        count = rows * columns + 1
        diagonal = np.bincount(a, k, count) + np.bincount(b, k, count)
        own, next_row = np.zeros((rows, columns, columns)), np.zeros((rows - 1, columns, columns))
        j = np.arange(columns)
        right = (j + 1) % columns
        own[:, j, j] = diagonal[:-1].reshape(rows, columns)
        own[:, j, right] -= self.around_mm3
        own[:, right, j] -= self.around_mm3
        next_row[:, j, j] = self.along_mm3
        next_row[:, j, right] += self.rising_mm3
        next_row[:, right, j] += self.falling_mm3
        return own, next_row, float(diagonal[-1])


@dataclass(frozen=True, eq=False)
class _EliminatedRow:
    """Wet nodes of a row, after those of all rows before it have been eliminated."""

    columns: NDArray[np.intp]
    coupling: Array
    """Conductances to the wet nodes of the row before."""
    inverse: Array
    """Inverse of the row's block."""
    loads: Array


class RowElimination:
    """Solves sum_j K_ij (u_i - u_j) = load_i on the wet nodes of a network, with u = 0 on all others."""

    def __init__(self, network: FlowNetwork, loads: Array) -> None:
        self._network, self._loads = network, loads
        self._rows: list[_EliminatedRow] = []
        self._wet_rows = np.zeros(network.shape, dtype=bool)

    def solve(self, wet: Mask) -> Array:
        """Solve for the wet nodes, a vector. Each connected part of them must have a dry neighbour."""
        wet_rows = wet[:-1].reshape(self._network.shape).copy()
        unchanged = (wet_rows == self._wet_rows).all(axis=1)
        kept = len(unchanged) if unchanged.all() else int(unchanged.argmin())
        del self._rows[kept:]
        for number in range(len(self._rows), len(wet_rows)):
            self._rows.append(self._eliminate(number, np.flatnonzero(wet_rows[number])))
        self._wet_rows = wet_rows
        return self._substitute(is_pole_wet=bool(wet[-1]))

    def _eliminate(self, number: int, columns: NDArray[np.intp]) -> _EliminatedRow:
        own, next_row, _ = self._network.blocks
        block = own[number][columns][:, columns]
        loads = self._loads[:-1].reshape(*self._network.shape, -1)[number][columns]
        before = self._rows[-1] if number else None
        if before is None or not len(before.columns) or not len(columns):
            coupling = np.zeros((len(before.columns) if before else 0, len(columns)))
        else:
            coupling = next_row[number - 1][before.columns][:, columns]
            carried = coupling.T @ before.inverse
            block -= carried @ coupling
            loads = loads + carried @ before.loads
        return _EliminatedRow(columns, coupling, np.linalg.inv(block) if len(columns) else block, loads)

    def _substitute(self, is_pole_wet: bool) -> Array:
        """Compute the potential of the pole, and of all rows from the last to the first."""
        result = np.zeros_like(self._loads)
        potential = result[:-1].reshape(*self._network.shape, -1)
        last = self._rows[-1]
        loads = last.loads
        if is_pole_wet:
            link = self._network.pole_mm3[last.columns]
            carried = link @ last.inverse
            result[-1] = (self._loads[-1] + carried @ loads) / (self._network.blocks[2] - carried @ link)
            loads = loads + link[:, None] * result[-1]
        value = last.inverse @ loads
        potential[-1][last.columns] = value
        for number in range(len(self._rows) - 2, -1, -1):
            row = self._rows[number]
            value = row.inverse @ (row.loads + self._rows[number + 1].coupling @ value)
            potential[number][row.columns] = value
        return result
