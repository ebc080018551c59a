"""Network of conductances between the nodes of a structured grid.

Rows run along the finger, columns around it. A last node, the pole, closes the far end. Each node stands for the part
of the cavity nearest to it. For unit viscosity the flow through a link is its conductance times the difference of
pressure, so that a conductance has the unit mm3.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from fingertip.arrays import Array

Mask = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class FlowNetwork:
    """Volumes of the nodes and conductances of the links between them.

    Vectors over all nodes hold the grid row by row, then the pole. A node without volume is closed: no link may reach
    it. Columns are periodic; a plane slot has zero conductances from its last column to its first.
    """

    volume_mm3: Array
    """Volume of each node, a vector."""
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
        """Numbers of rows and columns."""
        rows, columns = self.around_mm3.shape
        return rows, columns

    @property
    def total_mm3(self) -> float:
        """Volume of all nodes."""
        return float(self.volume_mm3.sum())

    @cached_property
    def is_open(self) -> Mask:
        """Nodes that hold silicone, a vector."""
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
        """Compute the flow into each node, sum_j K_ij (u_j - u_i)."""
        a, b, k = self.links
        flow = k * (potential[a] - potential[b])
        count = len(potential)
        inflow: Array = np.bincount(b, flow, count).astype(float) - np.bincount(a, flow, count)
        return inflow

    def reach(self, start: Mask) -> Mask:
        """Return the nodes linked to the start, directly or through others."""
        a, b, _ = self.links
        reached = start.copy()
        while True:
            new = np.concatenate((b[reached[a] & ~reached[b]], a[reached[b] & ~reached[a]]))
            if not len(new):
                return reached
            reached[new] = True

    def keep(self, kept: Mask) -> FlowNetwork:
        """Close all nodes but some, which no link joins to the others."""
        return replace(self, volume_mm3=np.where(kept, self.volume_mm3, 0.0))

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
