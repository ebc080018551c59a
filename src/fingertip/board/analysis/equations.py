"""The equations of a circuit (modified nodal analysis), written part by part. Needs numpy."""

from __future__ import annotations

import math

import numpy as np

from fingertip.arrays import Array
from fingertip.board.analysis.nodal import Source, System
from fingertip.board.circuit import RAILS, Circuit, Part, farads_or_ohms
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
from fingertip.board.values.built import OPEN_LOOP_GAIN


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
    board = _Stamps(circuit)
    for part in circuit.parts:
        kind = part.symbol.name
        if kind == "R":
            board.resistor(part)
        elif kind == "C":
            board.admit(board.C, board.at(part, "1"), board.at(part, "2"), farads_or_ohms(part.value))
        elif kind == "R_Potentiometer":  # at its middle
            for end in ("1", "3"):
                board.admit(board.G, board.at(part, end), board.at(part, "2"), 2.0 / farads_or_ohms(part.value))
        elif part.value == "FSR":
            board.admit(board.G, board.at(part, "1"), board.at(part, "2"), sensor_s)
        elif kind in AMPLIFIERS:
            for letter, pins in AMPLIFIERS[kind].units.items():
                board.amplifier(part, letter, pins, AMPLIFIERS[kind], gain_bandwidth_hz)
        elif kind == "AD623ARMZ":
            board.instrumentation(part, bridge_gain(circuit), driven=board.net[part.reference, "6"] == drive)
    if drive is None:
        start = {board.at(circuit.part("J1"), "1"): 1.0}
    else:
        k = board.branch(board.index[drive])
        board.G[k, board.index[drive]] += 1.0
        start = {k: 1.0}
    return board.system(start)


class _Stamps:
    """Matrices with one unknown for each net and each driven output; ground is the last of both, and dropped."""

    def __init__(self, circuit: Circuit) -> None:
        self.net = {node: net.name for net in circuit.nets for node in net.nodes}
        names = sorted(set(self.net.values()) - set(RAILS))
        self.index = {name: i for i, name in enumerate(names)}
        driven = sum(len(AMPLIFIERS[p.symbol.name].units) for p in circuit.parts if p.symbol.name in AMPLIFIERS)
        # A row for each amplifier, one for the instrumentation amplifier or for what drives the circuit, or both.
        self.used, self.ground = len(names), len(names) + driven + 2
        self.G = np.zeros((self.ground + 1, self.ground + 1))
        self.C = np.zeros_like(self.G)
        self.sources: list[tuple[str, dict[int, float], float, float]] = []
        self.gains = {self.net[p.reference, x] for p in circuit.parts for x in "18" if p.symbol.name == "AD623ARMZ"}

    def at(self, part: Part, pin: str) -> int:
        """The unknown of a pin's net."""
        return self.index.get(self.net[part.reference, pin], self.ground)

    def branch(self, output: int) -> int:
        """A new unknown, the current out of something that holds a net; its row says at which voltage."""
        k = self.used
        self.used += 1
        self.G[output, k] += 1.0
        return k

    def admit(self, matrix: Array, one: int, two: int, value: float) -> None:
        """An admittance between two nets."""
        matrix[one, one] += value
        matrix[two, two] += value
        matrix[one, two] -= value
        matrix[two, one] -= value

    def resistor(self, part: Part) -> None:
        """A resistor and its noise, but for that between gain pins, which enters with the amplifier's own."""
        one, two, ohm = self.at(part, "1"), self.at(part, "2"), farads_or_ohms(part.value)
        self.admit(self.G, one, two, 1.0 / ohm)
        if self.net[part.reference, "1"] not in self.gains:
            self.sources.append((part.reference, {one: 1.0, two: -1.0}, _thermal(1.0 / ohm), 0.0))

    def amplifier(
        self, part: Part, letter: str, pins: tuple[str, str, str], data: Amplifier, gain_bandwidth_hz: float
    ) -> None:
        """v_out / A = v_plus - v_minus + v_offset, 1 / A = 1 / A0 + s / (2 pi GBW)."""
        plus, minus, out = (self.at(part, pin) for pin in pins)
        k = self.branch(out)
        self.G[k, plus] += 1.0
        self.G[k, minus] -= 1.0
        self.G[k, out] -= 1.0 / OPEN_LOOP_GAIN
        self.C[k, out] -= 1.0 / (2.0 * math.pi * (data.bandwidth_hz or gain_bandwidth_hz))
        self.sources.append((f"{part.reference}{letter}", {k: -1.0}, data.noise_v, data.offset_v))

    def instrumentation(self, part: Part, gain: float, driven: bool) -> None:
        """v_out = gain (v_plus - v_minus) + v_ref with one pole; nothing where another source drives its output."""
        for pin in ("1", "8"):  # held by the amplifier's inside; here it does not matter by what
            self.G[self.at(part, pin), self.at(part, pin)] += 1.0
        if driven:
            return
        out = self.at(part, "6")
        k = self.branch(out)
        for pin, factor in (("3", gain), ("2", -gain), ("5", 1.0), ("6", -1.0)):
            self.G[k, self.at(part, pin)] += factor
        self.C[k, out] -= gain / (2.0 * math.pi * AD623_BANDWIDTH_HZ)
        noise = math.hypot(AD623_NOISE_V, AD623_OUTPUT_NOISE_V / gain)
        self.sources.append((part.reference, {k: -gain}, noise, AD623_OFFSET_V))
        # The voltage across the gain resistor is the input's, so its noise is amplified as one at the input is.
        self.sources.append((GAIN_RESISTOR, {k: 1.0 - gain}, _thermal(GAIN_CONSTANT_OHM / (gain - 1.0)), 0.0))

    def system(self, start: dict[int, float]) -> System:
        """What was written, without ground and rows that were not needed."""
        n = self.used
        sources = tuple(Source(name, self._row(row), noise, offset) for name, row, noise, offset in self.sources)
        return System(self.G[:n, :n], self.C[:n, :n], self.index, sources, self._row(start))

    def _row(self, entries: dict[int, float]) -> Array:
        row = np.zeros(self.ground + 1)
        for i, value in entries.items():
            row[i] += value
        return row[: self.used]


def _thermal(value: float) -> float:
    """sqrt(4 k T x): a resistor's noise current for its conductance [S], its noise voltage for its resistance [ohm]."""
    return math.sqrt(4.0 * BOLTZMANN_J_PER_K * TEMPERATURE_K * value)
