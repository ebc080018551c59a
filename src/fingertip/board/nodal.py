"""Nodal analysis of the circuit itself: Bode of any net, noise and offsets at any net, without a simulator.

Modified nodal analysis, (G + s C) x = b, of all resistors and capacitors; the sensor is a resistor, rails are ground,
amplifiers have one pole, diodes carry no current. So it holds for small signals ahead of the diode.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.board.amplifiers import (
    AD623_BANDWIDTH_HZ,
    AD623_NOISE_V,
    AD623_OFFSET_V,
    AD623_OUTPUT_NOISE_V,
    AMPLIFIERS,
    BOLTZMANN_J_PER_K,
    GAIN_RESISTOR,
    TEMPERATURE_K,
    bridge_gain,
)
from fingertip.board.bridge import GAIN_CONSTANT_OHM
from fingertip.board.built import OPEN_LOOP_GAIN
from fingertip.board.circuit import RAILS, Circuit, farads_or_ohms

Array = NDArray[np.float64]
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


def equations(circuit: Circuit, gain_bandwidth_hz: float, sensor_s: float, drive: str | None = None) -> System:
    """The equations of a circuit.

    Parameters
    ----------
    circuit
        The board.
    gain_bandwidth_hz
        Of the filter's amplifier.
    sensor_s
        The sensor's conductance [S].
    drive
        Net held by a source of 1 V, instead of whatever drives it; None: 1 A flows into the sensor's net.
    """
    net = {node: n.name for n in circuit.nets for node in n.nodes}
    names = sorted({n.name for n in circuit.nets} - set(RAILS))
    index = {name: i for i, name in enumerate(names)}
    units = [
        (part, f"{part.reference}{letter}", AMPLIFIERS[part.symbol.name], pins)
        for part in circuit.parts
        if part.symbol.name in AMPLIFIERS
        for letter, pins in AMPLIFIERS[part.symbol.name].units.items()
    ]
    bridges = [p for p in circuit.parts if p.symbol.name == "AD623ARMZ" and net[p.reference, "6"] != drive]
    size = len(names) + len(units) + len(bridges) + (drive is not None)
    G, C = np.zeros((size, size)), np.zeros((size, size))
    sources: list[Source] = []

    def at(reference: str, pin: str) -> int | None:
        return index.get(net[reference, pin])

    def unit(entries: dict[int | None, float]) -> Array:
        row = np.zeros(size)
        for i, value in entries.items():
            if i is not None:
                row[i] += value
        return row

    def admit(matrix: Array, one: int | None, two: int | None, value: float) -> None:
        for a, b in ((one, two), (two, one)):
            if a is not None:
                matrix[a, a] += value
                if b is not None:
                    matrix[a, b] -= value

    gains = {net[p.reference, pin] for p in bridges for pin in ("1", "8")}
    for part in circuit.parts:
        kind = part.symbol.name
        if kind == "R_Potentiometer":  # at its middle
            for end in ("1", "3"):
                admit(G, at(part.reference, end), at(part.reference, "2"), 2.0 / farads_or_ohms(part.value))
        if kind not in ("R", "C"):
            continue
        one, two = at(part.reference, "1"), at(part.reference, "2")
        value = farads_or_ohms(part.value)
        if kind == "C":
            admit(C, one, two, value)
            continue
        admit(G, one, two, 1.0 / value)
        if net[part.reference, "1"] not in gains:  # its noise enters with the amplifier's own
            density = math.sqrt(4.0 * BOLTZMANN_J_PER_K * TEMPERATURE_K / value)
            sources.append(Source(part.reference, unit({one: 1.0, two: -1.0}), density, 0.0))
    sensors = [p for p in circuit.parts if p.value == "FSR"]
    for part in sensors:
        admit(G, at(part.reference, "1"), at(part.reference, "2"), sensor_s)
    k = len(names)
    for part, name, data, (plus, minus, out) in units:
        o = at(part.reference, out)
        if o is not None:
            G[o, k] += 1.0
        # v_out / A = v_plus - v_minus + v_offset, 1 / A = 1 / A0 + s / (2 pi GBW)
        for pin, sign in ((plus, 1.0), (minus, -1.0)):
            if (i := at(part.reference, pin)) is not None:
                G[k, i] += sign
        if o is not None:
            G[k, o] -= 1.0 / OPEN_LOOP_GAIN
            C[k, o] -= 1.0 / (2.0 * math.pi * (data.bandwidth_hz or gain_bandwidth_hz))
        sources.append(Source(name, unit({k: -1.0}), data.noise_v, data.offset_v))
        k += 1
    for part in bridges:
        gain = bridge_gain(circuit)
        for pin in ("1", "8"):  # held by the amplifier's inside; here it does not matter by what
            if (i := at(part.reference, pin)) is not None:
                G[i, i] += 1.0
        o = at(part.reference, "6")
        for pin, sign in (("3", gain), ("2", -gain), ("5", 1.0)):
            if (i := at(part.reference, pin)) is not None:
                G[k, i] += sign
        if o is not None:
            G[o, k] += 1.0
            G[k, o] -= 1.0
            C[k, o] -= gain / (2.0 * math.pi * AD623_BANDWIDTH_HZ)
        noise = math.hypot(AD623_NOISE_V, AD623_OUTPUT_NOISE_V / gain)
        sources.append(Source(part.reference, unit({k: -gain}), noise, AD623_OFFSET_V))
        # The voltage across the gain resistor is the input's, so its noise is amplified as one at the input is.
        gain_ohm = GAIN_CONSTANT_OHM / (gain - 1.0)
        density = math.sqrt(4.0 * BOLTZMANN_J_PER_K * TEMPERATURE_K * gain_ohm)
        sources.append(Source(GAIN_RESISTOR, unit({k: 1.0 - gain}), density, 0.0))
        k += 1
    if drive is None:
        start = unit({at(part.reference, "1"): 1.0 for part in sensors})
    else:
        for p in circuit.parts:  # gain pins of an amplifier that is replaced by the source
            if p.symbol.name == "AD623ARMZ" and net[p.reference, "6"] == drive:
                for pin in ("1", "8"):
                    if (i := at(p.reference, pin)) is not None:
                        G[i, i] += 1.0
        G[index[drive], k] += 1.0
        G[k, index[drive]] += 1.0
        start = unit({k: 1.0})
    return System(G, C, index, tuple(sources), start)
