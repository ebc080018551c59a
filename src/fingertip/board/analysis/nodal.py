"""Nodal analysis of the circuit itself: Bode of any net, noise and offsets at any net, without a simulator.

Modified nodal analysis, (G + s C) x = b, of all resistors and capacitors; the sensor is a resistor, rails are ground,
amplifiers have one pole, diodes carry no current. So it holds for small signals ahead of the diode.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.arrays import Array

Spectrum = NDArray[np.complex128]


@dataclass(frozen=True)
class Source:
    """A disturbance: where it enters the equations, and how large it is."""

    name: str
    row: Array
    """What 1 A or 1 V of it adds to the right-hand side."""
    noise: float
    """Density [A/sqrt(Hz) or V/sqrt(Hz)], white."""
    offset: float
    """Constant part [A or V]."""


@dataclass(frozen=True)
class System:
    """The equations of a circuit."""

    G: Array
    C: Array
    index: dict[str, int]
    """Net -> unknown."""
    sources: tuple[Source, ...]
    drive: Array
    """Right-hand side of 1 V at the driven net, or of 1 A into the sensor."""

    def response(self, f_hz: Array, net: str) -> Spectrum:
        """Voltage at a net for the drive, at these frequencies [Hz]."""
        matrices = self.G[None] + 2j * math.pi * f_hz[:, None, None] * self.C[None]
        right = np.broadcast_to(self.drive[:, None], (len(f_hz), len(self.drive), 1)).astype(np.complex128)
        solution = np.linalg.solve(matrices.astype(np.complex128), right)
        return np.asarray(solution[:, self.index[net], 0], dtype=np.complex128)

    def transfers(self, f_hz: Array, net: str) -> Spectrum:
        """Voltage at a net for 1 A or 1 V of each source: rows are frequencies, columns sources."""
        matrices = self.G[None] + 2j * math.pi * f_hz[:, None, None] * self.C[None]
        pick = np.zeros((len(f_hz), len(self.drive), 1))
        pick[:, self.index[net]] = 1.0
        # One solution of the transposed equations serves all sources at once.
        adjoint = np.linalg.solve(matrices.transpose(0, 2, 1), pick)[:, :, 0]
        result: Spectrum = adjoint @ np.array([source.row for source in self.sources]).T
        return result
