"""Nodal analysis of the circuit: frequency response, noise and offsets at any net, without a simulator.

Modified nodal analysis, (G + s C) x = b (C.-W. Ho, A. Ruehli and P. Brennan, IEEE Trans. Circuits Syst. 22 (1975) 504),
of all resistors and capacitors. The sensor is a resistor, the rails are ground, amplifiers have one pole, and diodes do
not conduct. The analysis therefore applies to small signals ahead of the diode.
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
    """Noise or offset source: its magnitude, and where it enters the equations."""

    name: str
    row: Array
    """Contribution of 1 A or 1 V to the right-hand side."""
    noise: float
    """White noise density [A/sqrt(Hz) or V/sqrt(Hz)]."""
    offset: float
    """Offset [A or V]."""


@dataclass(frozen=True)
class System:
    """Equations of a circuit."""

    G: Array
    C: Array
    index: dict[str, int]
    """Net -> index of its unknown."""
    sources: tuple[Source, ...]
    drive: Array
    """Right-hand side for 1 V at the driven net, or for 1 A into the sensor's net."""

    def driven_response(self, f_hz: Array, net: str) -> Spectrum:
        """Compute the voltage at a net for the drive, at these frequencies [Hz]."""
        matrices = self.G[None] + 2j * math.pi * f_hz[:, None, None] * self.C[None]
        right = np.broadcast_to(self.drive[:, None], (len(f_hz), len(self.drive), 1)).astype(np.complex128)
        solution = np.linalg.solve(matrices.astype(np.complex128), right)
        return np.asarray(solution[:, self.index[net], 0], dtype=np.complex128)

    def source_transfers(self, f_hz: Array, net: str) -> Spectrum:
        """Compute the voltage at a net for 1 A or 1 V of each source: rows are frequencies, columns sources."""
        matrices = self.G[None] + 2j * math.pi * f_hz[:, None, None] * self.C[None]
        selector = np.zeros((len(f_hz), len(self.drive), 1))
        selector[:, self.index[net]] = 1.0
        # Adjoint method: one solution of the transposed equations serves all sources at once.
        adjoint = np.linalg.solve(matrices.transpose(0, 2, 1), selector)[:, :, 0]
        result: Spectrum = adjoint @ np.array([source.row for source in self.sources]).T
        return result
