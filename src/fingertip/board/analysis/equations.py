"""Assembly of a circuit's equations (modified nodal analysis), component by component. Needs numpy."""

from __future__ import annotations

import math

import numpy as np

from fingertip.arrays import Array
from fingertip.board.analysis.nodal import Source, System
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
    board = _Assembly(circuit)
    for component in circuit.components:
        symbol = component.symbol.name
        if symbol == "R":
            board.resistor(component)
        elif symbol == "C":
            board.admit(
                board.C, board.at(component, "1"), board.at(component, "2"), parse_component_value(component.value)
            )
        elif symbol == "R_Potentiometer":  # wiper at the midpoint
            for end in ("1", "3"):
                board.admit(
                    board.G,
                    board.at(component, end),
                    board.at(component, "2"),
                    2.0 / parse_component_value(component.value),
                )
        elif component.value == "FSR":
            board.admit(board.G, board.at(component, "1"), board.at(component, "2"), sensor_s)
        elif symbol in AMPLIFIERS:
            for letter, pins in AMPLIFIERS[symbol].units.items():
                board.amplifier(component, letter, pins, AMPLIFIERS[symbol], gain_bandwidth_hz)
        elif symbol == "AD623ARMZ":
            board.instrumentation(component, bridge_gain(circuit), driven=board.net[component.reference, "6"] == drive)
    if drive is None:
        start = {board.at(circuit.component("J1"), "1"): 1.0}
    else:
        k = board.branch(board.index[drive])
        board.G[k, board.index[drive]] += 1.0
        start = {k: 1.0}
    return board.system(start)


class _Assembly:
    """Matrices with one unknown for each net and each driven output. The last one is ground, which is removed."""

    def __init__(self, circuit: Circuit) -> None:
        self.net = {node: net.name for net in circuit.nets for node in net.nodes}
        names = sorted(set(self.net.values()) - set(RAILS))
        self.index = {name: i for i, name in enumerate(names)}
        driven = sum(len(AMPLIFIERS[p.symbol.name].units) for p in circuit.components if p.symbol.name in AMPLIFIERS)
        # One row for each amplifier, and up to two for the instrumentation amplifier and the source that drives a net.
        self.used, self.ground = len(names), len(names) + driven + 2
        self.G = np.zeros((self.ground + 1, self.ground + 1))
        self.C = np.zeros_like(self.G)
        self.sources: list[tuple[str, dict[int, float], float, float]] = []
        self.gains = {
            self.net[p.reference, x] for p in circuit.components for x in "18" if p.symbol.name == "AD623ARMZ"
        }

    def at(self, component: Component, pin: str) -> int:
        """Index of the unknown of a pin's net."""
        return self.index.get(self.net[component.reference, pin], self.ground)

    def branch(self, output: int) -> int:
        """Add an unknown: the current of a source that drives a net. Its row determines the voltage."""
        k = self.used
        self.used += 1
        self.G[output, k] += 1.0
        return k

    def admit(self, matrix: Array, one: int, two: int, value: float) -> None:
        """Add an admittance between two nets."""
        matrix[one, one] += value
        matrix[two, two] += value
        matrix[one, two] -= value
        matrix[two, one] -= value

    def resistor(self, component: Component) -> None:
        """Add a resistor and its noise. The noise of a gain resistor is added with that of its amplifier."""
        one, two, ohm = self.at(component, "1"), self.at(component, "2"), parse_component_value(component.value)
        self.admit(self.G, one, two, 1.0 / ohm)
        if self.net[component.reference, "1"] not in self.gains:
            self.sources.append((component.reference, {one: 1.0, two: -1.0}, _thermal(1.0 / ohm), 0.0))

    def amplifier(
        self, component: Component, letter: str, pins: tuple[str, str, str], data: Amplifier, gain_bandwidth_hz: float
    ) -> None:
        """Add an amplifier: v_out / A = v_plus - v_minus + v_offset, 1 / A = 1 / A0 + s / (2 pi GBW)."""
        plus, minus, out = (self.at(component, pin) for pin in pins)
        k = self.branch(out)
        self.G[k, plus] += 1.0
        self.G[k, minus] -= 1.0
        self.G[k, out] -= 1.0 / OPEN_LOOP_GAIN
        self.C[k, out] -= 1.0 / (2.0 * math.pi * (data.bandwidth_hz or gain_bandwidth_hz))
        self.sources.append((f"{component.reference}{letter}", {k: -1.0}, data.noise_v, data.offset_v))

    def instrumentation(self, component: Component, gain: float, driven: bool) -> None:
        """Add an instrumentation amplifier: v_out = gain (v_plus - v_minus) + v_ref with one pole.

        Nothing drives the output where another source does (`driven`).
        """
        for pin in ("1", "8"):  # the amplifier drives its gain pins; their voltage has no influence here
            self.G[self.at(component, pin), self.at(component, pin)] += 1.0
        if driven:
            return
        out = self.at(component, "6")
        k = self.branch(out)
        for pin, factor in (("3", gain), ("2", -gain), ("5", 1.0), ("6", -1.0)):
            self.G[k, self.at(component, pin)] += factor
        self.C[k, out] -= gain / (2.0 * math.pi * AD623_BANDWIDTH_HZ)
        noise = math.hypot(AD623_NOISE_V, AD623_OUTPUT_NOISE_V / gain)
        self.sources.append((component.reference, {k: -gain}, noise, AD623_OFFSET_V))
        # The gain resistor carries the input voltage, so its noise is amplified as noise at the input is.
        self.sources.append((GAIN_RESISTOR, {k: 1.0 - gain}, _thermal(GAIN_CONSTANT_OHM / (gain - 1.0)), 0.0))

    def system(self, start: dict[int, float]) -> System:
        """Return the equations without ground and without unused rows."""
        n = self.used
        sources = tuple(Source(name, self._row(row), noise, offset) for name, row, noise, offset in self.sources)
        return System(self.G[:n, :n], self.C[:n, :n], self.index, sources, self._row(start))

    def _row(self, entries: dict[int, float]) -> Array:
        row = np.zeros(self.ground + 1)
        for i, value in entries.items():
            row[i] += value
        return row[: self.used]


def _thermal(value: float) -> float:
    """Johnson-Nyquist noise sqrt(4 k T x).

    Current density for a conductance [S], voltage density for a resistance [ohm].
    """
    return math.sqrt(4.0 * BOLTZMANN_J_PER_K * TEMPERATURE_K * value)
