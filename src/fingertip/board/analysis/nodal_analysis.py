"""Nodal analysis of a circuit: frequency response, noise and offsets at any net, without a simulator. Needs numpy.

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
from fingertip.board.circuit import RAILS, Circuit, Component, parse_component_value
from fingertip.board.values.amplifiers import (
    AD623_BANDWIDTH_HZ,
    AD623_NOISE_V,
    AD623_OFFSET_V,
    AD623_OUTPUT_NOISE_V,
    AMPLIFIERS,
    BOLTZMANN_J_PER_K,
    GAIN_RESISTOR,
    TEMPERATURE_K,
    Amplifier,
    bridge_gain,
)
from fingertip.board.values.bridge import GAIN_CONSTANT_OHM
from fingertip.board.values.nonideal_response import OPEN_LOOP_GAIN

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


def build_equations(circuit: Circuit, gain_bandwidth_hz: float, sensor_s: float, drive: str | None = None) -> System:
    """Build the equations of a circuit.

    Parameters
    ----------
    circuit
        Circuit of the board.
    gain_bandwidth_hz
        Gain-bandwidth product of the filter's amplifier [Hz].
    sensor_s
        Conductance of the sensor [S].
    drive
        Net that a source of 1 V drives, in place of its actual driver; None: 1 A flows into the sensor's net.
    """
    assembly = _Assembly(circuit)
    for component in circuit.components:
        symbol = component.symbol.name
        if symbol == "R":
            assembly.add_resistor(component)
        elif symbol == "C":
            assembly.add_admittance(assembly.C, component, ("1", "2"), parse_component_value(component.value))
        elif symbol == "R_Potentiometer":  # wiper at the midpoint
            half_s = 2.0 / parse_component_value(component.value)
            assembly.add_admittance(assembly.G, component, ("1", "2"), half_s)
            assembly.add_admittance(assembly.G, component, ("3", "2"), half_s)
        elif component.value == "FSR":
            assembly.add_admittance(assembly.G, component, ("1", "2"), sensor_s)
        elif symbol in AMPLIFIERS:
            for letter, pins in AMPLIFIERS[symbol].units.items():
                assembly.add_amplifier(component, letter, pins, AMPLIFIERS[symbol], gain_bandwidth_hz)
        elif symbol == "AD623ARMZ":
            is_driven = assembly.net[component.reference, "6"] == drive
            assembly.add_instrumentation_amplifier(component, bridge_gain(circuit), is_driven)
    if drive is None:
        excitation = {assembly.node(circuit.component("J1"), "1"): 1.0}
    else:
        branch = assembly.add_branch(assembly.index[drive])
        assembly.G[branch, assembly.index[drive]] += 1.0
        excitation = {branch: 1.0}
    return assembly.system(excitation)


class _Assembly:
    """Matrices with one unknown for each net and each driven output. The last one is ground, which is removed."""

    def __init__(self, circuit: Circuit) -> None:
        self.net = {node: net.name for net in circuit.nets for node in net.nodes}
        names = sorted(set(self.net.values()) - set(RAILS))
        self.index = {name: i for i, name in enumerate(names)}
        symbols = [(component.reference, component.symbol.name) for component in circuit.components]
        outputs = sum(len(AMPLIFIERS[symbol].units) for _, symbol in symbols if symbol in AMPLIFIERS)
        # One row for each amplifier, and up to two for the instrumentation amplifier and the source that drives a net.
        self.count, self.ground = len(names), len(names) + outputs + 2
        self.G = np.zeros((self.ground + 1, self.ground + 1))
        self.C = np.zeros_like(self.G)
        self.sources: list[tuple[str, dict[int, float], float, float]] = []
        self.gain_nets = {
            self.net[reference, pin] for reference, symbol in symbols for pin in "18" if symbol == "AD623ARMZ"
        }

    def node(self, component: Component, pin: str) -> int:
        """Index of the unknown of a pin's net."""
        return self.index.get(self.net[component.reference, pin], self.ground)

    def add_branch(self, output: int) -> int:
        """Add an unknown: the current of a source that drives a net. Its row determines the voltage."""
        branch = self.count
        self.count += 1
        self.G[output, branch] += 1.0
        return branch

    def add_admittance(self, matrix: Array, component: Component, pins: tuple[str, str], value: float) -> None:
        """Add a conductance [S] to G or a capacitance [F] to C, between two pins."""
        one, two = (self.node(component, pin) for pin in pins)
        matrix[one, one] += value
        matrix[two, two] += value
        matrix[one, two] -= value
        matrix[two, one] -= value

    def add_resistor(self, component: Component) -> None:
        """Add a resistor and its noise. The noise of a gain resistor is added with that of its amplifier."""
        conductance_s = 1.0 / parse_component_value(component.value)
        self.add_admittance(self.G, component, ("1", "2"), conductance_s)
        if self.net[component.reference, "1"] not in self.gain_nets:
            row = {self.node(component, "1"): 1.0, self.node(component, "2"): -1.0}
            self.sources.append((component.reference, row, _thermal_noise(conductance_s), 0.0))

    def add_amplifier(
        self, component: Component, letter: str, pins: tuple[str, str, str], data: Amplifier, gain_bandwidth_hz: float
    ) -> None:
        """Add an amplifier: v_out / A = v_plus - v_minus + v_offset, 1 / A = 1 / A0 + s / (2 pi GBW)."""
        plus, minus, out = (self.node(component, pin) for pin in pins)
        branch = self.add_branch(out)
        self.G[branch, plus] += 1.0
        self.G[branch, minus] -= 1.0
        self.G[branch, out] -= 1.0 / OPEN_LOOP_GAIN
        self.C[branch, out] -= 1.0 / (2.0 * math.pi * (data.bandwidth_hz or gain_bandwidth_hz))
        self.sources.append((f"{component.reference}{letter}", {branch: -1.0}, data.noise_v, data.offset_v))

    def add_instrumentation_amplifier(self, component: Component, gain: float, is_driven: bool) -> None:
        """Add an instrumentation amplifier: v_out = gain (v_plus - v_minus) + v_ref with one pole.

        The amplifier does not drive its output if another source does (`is_driven`).
        """
        for pin in ("1", "8"):  # the amplifier drives its gain pins, whose voltage influences nothing else
            self.G[self.node(component, pin), self.node(component, pin)] += 1.0
        if is_driven:
            return
        out = self.node(component, "6")
        branch = self.add_branch(out)
        for pin, factor in (("3", gain), ("2", -gain), ("5", 1.0), ("6", -1.0)):
            self.G[branch, self.node(component, pin)] += factor
        self.C[branch, out] -= gain / (2.0 * math.pi * AD623_BANDWIDTH_HZ)
        noise = math.hypot(AD623_NOISE_V, AD623_OUTPUT_NOISE_V / gain)
        self.sources.append((component.reference, {branch: -gain}, noise, AD623_OFFSET_V))
        # The gain resistor carries the input voltage, so its noise is amplified as noise at the input is.
        gain_resistor_noise = _thermal_noise(GAIN_CONSTANT_OHM / (gain - 1.0))
        self.sources.append((GAIN_RESISTOR, {branch: 1.0 - gain}, gain_resistor_noise, 0.0))

    def system(self, excitation: dict[int, float]) -> System:
        """Return the equations without ground and without unused rows."""
        n = self.count
        sources = tuple(Source(name, self._row(row), noise, offset) for name, row, noise, offset in self.sources)
        return System(self.G[:n, :n], self.C[:n, :n], self.index, sources, self._row(excitation))

    def _row(self, entries: dict[int, float]) -> Array:
        row = np.zeros(self.ground + 1)
        for i, value in entries.items():
            row[i] += value
        return row[: self.count]


def _thermal_noise(value: float) -> float:
    """Johnson-Nyquist noise density sqrt(4 k T x).

    It is a current density for a conductance [S] and a voltage density for a resistance [ohm].
    """
    return math.sqrt(4.0 * BOLTZMANN_J_PER_K * TEMPERATURE_K * value)
