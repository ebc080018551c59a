"""Nodal analysis of a netlist file: an oracle that shares nothing with the package but the file.

Reads the file with an independent parser, knows parts by their library symbol, and solves Kirchhoff's current law
(modified nodal analysis). Ideal amplifiers give the transfer function. They cannot tell which input or output is which,
because only negative feedback makes an amplifier hold its inputs equal; so amplifiers of finite bandwidth give the
poles, whose place says whether the feedback is negative.
"""

from __future__ import annotations

import copy
import functools
import warnings
from pathlib import Path
from typing import Any

import kinparse
import numpy as np
import scipy.linalg

PREFIXES = {"M": 1e6, "k": 1e3, "m": 1e-3, "u": 1e-6, "n": 1e-9, "p": 1e-12}
# Output, inverting and non-inverting input of each amplifier in the package, from the data sheets.
DUAL = (("1", "2", "3"), ("7", "6", "5"))
AMPLIFIERS = {"TL082": DUAL, "TLV2372": DUAL, "TLV2371DBV": (("1", "4", "3"),)}
GAIN_BANDWIDTH_HZ = 3e6


def number(text: str) -> float:
    """A schematic's value: "4.7k" -> 4700."""
    return float(text[:-1]) * PREFIXES[text[-1]] if text[-1] in PREFIXES else float(text)


def parse(path: Path) -> Any:
    """The file as the independent parser sees it; it takes seconds, so each text is read once."""
    return _parsed(path.read_text(encoding="utf-8"))


@functools.cache
def _parsed(text: str) -> Any:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # of the parser's own making
        return kinparse.parse_netlist(text)


class NetlistCircuit:
    """Parts and connections as they stand in a netlist file."""

    def __init__(self, path: Path) -> None:
        parsed = parse(path)
        self.parts: dict[str, tuple[str, str]] = {p.ref: (p.name, p.value) for p in parsed.parts}
        # The bridge and its amplifier are not solved here: their output is where the tests' source is.
        self.net: dict[tuple[str, str], str] = {(pin.ref, pin.num): n.name for n in parsed.nets for pin in n.pins}
        self._number_nets()

    def swapped(self, one: tuple[str, str], two: tuple[str, str]) -> NetlistCircuit:
        """The circuit with two pins exchanged."""
        other = copy.copy(self)
        other.net = self.net | {one: self.net[two], two: self.net[one]}
        other._number_nets()
        return other

    def _number_nets(self) -> None:
        # Supplies do not move, so for signals they are ground; so is the resistor between U2's gain pins, which
        # would otherwise float.
        supply = {net for (reference, _), net in self.net.items() if reference == "J2"}
        grounds = {"GND", *supply, *self.nodes("U2", "1", "8")}
        self.index = {net: i for i, net in enumerate(sorted(set(self.net.values()) - grounds))}

    def nodes(self, reference: str, *pins: str) -> tuple[str, ...]:
        return tuple(self.net[reference, pin] for pin in pins)

    def gain(self, f_hz: float, source: str, output: str, bandwidth_hz: float | None = None) -> complex:
        """Voltage at net `output` for 1 V at net `source`, nan if nothing determines it.

        Amplifiers are ideal unless they have a bandwidth; behind open diodes only such have an output.
        """
        G, C = self._equations(source, bandwidth_hz)
        b = np.zeros(len(G), dtype=complex)
        b[-1] = 1.0
        try:
            return complex(np.linalg.solve(G + 2j * np.pi * f_hz * C, b)[self.index[output]])
        except np.linalg.LinAlgError:
            return complex("nan")

    def poles(self, source: str) -> Any:
        """Natural frequencies [rad/s] with the source at 0 V and amplifiers of finite bandwidth."""
        G, C = self._equations(source, bandwidth_hz=GAIN_BANDWIDTH_HZ)
        found = scipy.linalg.eigvals(G, -C)
        return found[np.isfinite(found) & (np.abs(found) < 1e12)]

    def _equations(self, source: str, bandwidth_hz: float | None) -> tuple[Any, Any]:
        """G and C of (G + s C) x = b; x is the nets' voltages, the amplifiers' and the source's currents.

        Diodes carry no current: behind D1 R6 and C4 are held up, and the clamps are open.
        """
        amplifiers = [
            (ref, pins) for ref, (part, _) in self.parts.items() if part in AMPLIFIERS for pins in AMPLIFIERS[part]
        ]
        n = len(self.index)
        size = n + len(amplifiers) + 1
        G, C = np.zeros((size, size)), np.zeros((size, size))

        def put(matrix: Any, row: int | None, column: int | None, value: float) -> None:
            if row is not None and column is not None:
                matrix[row, column] += value

        for reference, (part, value) in self.parts.items():
            if part not in ("R", "C"):
                continue
            one, two = (self.index.get(net) for net in self.nodes(reference, "1", "2"))
            matrix, admittance = (G, 1 / number(value)) if part == "R" else (C, number(value))
            for here, there in ((one, two), (two, one)):
                put(matrix, here, here, admittance)
                put(matrix, here, there, -admittance)
        for k, (reference, pins) in enumerate(amplifiers, start=n):
            out, minus, plus = (self.index.get(net) for net in self.nodes(reference, *pins))
            put(G, out, k, 1.0)
            put(G, k, plus, 1.0)
            put(G, k, minus, -1.0)
            if bandwidth_hz is not None:  # v_out s / omega_t = v_plus - v_minus
                put(C, k, out, -1.0 / (2 * np.pi * bandwidth_hz))
        put(G, self.index[source], size - 1, 1.0)
        put(G, size - 1, self.index[source], 1.0)
        return G, C
