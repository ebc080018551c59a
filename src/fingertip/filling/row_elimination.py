"""Linear solver of a flow network: block elimination, row by row.

A moving front needs the solution for one wet region after the other, and most rows are as wet as they were before. Rows
before the first one that changed are not eliminated again.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.arrays import Array
from fingertip.filling.network import FlowNetwork, Mask


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
    """Solves sum_j K_ij (u_i - u_j) = load_i on the wet nodes of a network, with u = 0 on all others.

    Parameters
    ----------
    network
        The network.
    loads
        Right-hand sides, shape (nodes, count).
    """

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
        """Eliminate the row before from a row."""
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
