"""Oracle: nodal analysis of a netlist file that shares nothing with the package but the file.

It identifies components by their library symbol and solves Kirchhoff's current law (modified nodal analysis). Ideal
amplifiers give the transfer function. They do not distinguish the inputs and outputs of an amplifier, because only
negative feedback makes an amplifier keep its inputs equal. Amplifiers of finite bandwidth therefore give the poles,
whose positions show whether the feedback is negative.
"""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import numpy as np

from tests.oracles.sexpressions import children, descendants, parse, word

PREFIXES = {"M": 1e6, "k": 1e3, "m": 1e-3, "u": 1e-6, "n": 1e-9, "p": 1e-12}
# Output, inverting and non-inverting input of each amplifier in a package, from the data sheets.
DUAL = (("1", "2", "3"), ("7", "6", "5"))
AMPLIFIERS = {"TL082": DUAL, "TLV2372": DUAL, "LM2904": DUAL, "OPA2376xxD": DUAL, "MCP6022": DUAL}
GAIN_BANDWIDTH_HZ = 3e6


def number(text: str) -> float:
    """Parse a value of a schematic: "4.7k" -> 4700."""
    return float(text[:-1]) * PREFIXES[text[-1]] if text[-1] in PREFIXES else float(text)


class NetlistCircuit:
    """Components and connections of a netlist file."""

    def __init__(self, path: Path) -> None:
        tree = parse(path.read_text("utf-8"))
        self.components: dict[str, tuple[str, str]] = {
            word(component, "ref"): (word(source, "part"), word(component, "value"))
            for component in descendants(tree, "comp")
            for source in children(component, "libsource")
        }
        # The bridge and its amplifier are not analysed: the source of the tests replaces their output.
        self.net: dict[tuple[str, str], str] = {
            (word(node, "ref"), word(node, "pin")): word(net, "name")
            for net in descendants(tree, "net")
            for node in children(net, "node")
        }
        self._number_nets()

    def swapped(self, one: tuple[str, str], two: tuple[str, str]) -> NetlistCircuit:
        """Return the circuit with two pins exchanged."""
        other = copy.copy(self)
        other.net = self.net | {one: self.net[two], two: self.net[one]}
        other._number_nets()
        return other

    def _number_nets(self) -> None:
        # For signals the supplies are ground. So are the gain pins of an AD623, whose resistor would otherwise float.
        supply = {net for (reference, _), net in self.net.items() if reference == "J2"}
        gain_pins = self.nodes("U2", "1", "8") if self.components["U2"][0] == "AD623ARMZ" else ()
        grounds = {"GND", *supply, *gain_pins}
        self.index = {net: i for i, net in enumerate(sorted(set(self.net.values()) - grounds))}

    def nodes(self, reference: str, *pins: str) -> tuple[str, ...]:
        return tuple(self.net[reference, pin] for pin in pins)

    def gain(self, f_hz: float, source: str, output: str, bandwidth_hz: float | None = None) -> complex:
        """Compute the voltage at net `output` for 1 V at net `source`; nan if the equations do not determine it.

        Amplifiers are ideal unless a bandwidth is given. After open diodes only those with a bandwidth have an output.
        """
        G, C = self._equations(source, bandwidth_hz)
        b = np.zeros(len(G), dtype=complex)
        b[-1] = 1.0
        try:
            return complex(np.linalg.solve(G + 2j * np.pi * f_hz * C, b)[self.index[output]])
        except np.linalg.LinAlgError:
            return complex("nan")

    def poles(self, source: str) -> Any:
        """Compute the natural frequencies [rad/s] with the source at 0 V and amplifiers of finite bandwidth."""
        from scipy.linalg import eigvals

        G, C = self._equations(source, bandwidth_hz=GAIN_BANDWIDTH_HZ)
        found = eigvals(G, -C)
        return found[np.isfinite(found) & (np.abs(found) < 1e12)]

    def _equations(self, source: str, bandwidth_hz: float | None) -> tuple[Any, Any]:
        """G and C of (G + s C) x = b, where x holds the voltages of the nets and the currents of amplifiers and source.

        Diodes do not conduct: after D1 nothing drives R6 and C4, and the clamps are open.
        """
        amplifiers = [
            (ref, pins)
            for ref, (symbol, _) in self.components.items()
            if symbol in AMPLIFIERS
            for pins in AMPLIFIERS[symbol]
            if self.net[ref, pins[0]] != source
        ]
        n = len(self.index)
        size = n + len(amplifiers) + 1
        G, C = np.zeros((size, size)), np.zeros((size, size))

        def add(matrix: Any, row: int | None, column: int | None, value: float) -> None:
            if row is not None and column is not None:
                matrix[row, column] += value

        for reference, (symbol, value) in self.components.items():
            if symbol not in ("R", "C"):
                continue
            one, two = (self.index.get(net) for net in self.nodes(reference, "1", "2"))
            matrix, admittance = (G, 1 / number(value)) if symbol == "R" else (C, number(value))
            for here, there in ((one, two), (two, one)):
                add(matrix, here, here, admittance)
                add(matrix, here, there, -admittance)
        for k, (reference, pins) in enumerate(amplifiers, start=n):
            out, minus, plus = (self.index.get(net) for net in self.nodes(reference, *pins))
            add(G, out, k, 1.0)
            add(G, k, plus, 1.0)
            add(G, k, minus, -1.0)
            if bandwidth_hz is not None:  # v_out s / omega_t = v_plus - v_minus
                add(C, k, out, -1.0 / (2 * np.pi * bandwidth_hz))
        add(G, self.index[source], size - 1, 1.0)
        add(G, size - 1, self.index[source], 1.0)
        return G, C
