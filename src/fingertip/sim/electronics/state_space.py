"""A circuit of resistors, capacitors and amplifiers as a linear system: modified nodal analysis, solved once.

C. W. Ho, A. E. Ruehli, P. A. Brennan, IEEE Trans. Circuits and Systems 22(6), 1975, doi:10.1109/TCS.1975.1084079. Each
capacitor's voltage is a state and stands as a source in the analysis; its current then is the state's derivative. An
amplifier without bound makes its inputs equal, at a rail it is a source, and with a finite gain-bandwidth product its
output is a state: d out/dt = 2 pi GBW (v+ - v-). Every value may be an array over many circuits.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fingertip.arrays import Array

GROUND = "0"


@dataclass(frozen=True)
class Part:
    """A resistor [ohm] or a capacitor [F] between two nodes."""

    name: str
    first: str
    second: str
    value: float | Array


@dataclass(frozen=True)
class Amplifier:
    """An operational amplifier."""

    plus: str
    minus: str
    out: str
    gain_bandwidth_hz: float | None = None
    rail_v: float | None = None
    """Where it is held at a rail: that rail's voltage; None: it is not."""


@dataclass(frozen=True, eq=False)
class StateSpace:
    """x' = A x + b u + k, and every node's voltage as a row over (x, u, slope of u, 1); all batched."""

    A: Array
    b: Array
    k: Array
    nodes: Mapping[str, Array]


def assemble(
    resistors: Sequence[Part], capacitors: Sequence[Part], amplifiers: Sequence[Amplifier], source: str, batch: int
) -> StateSpace:
    """Solve the circuit that a voltage source drives at a node.

    Parameters
    ----------
    resistors, capacitors, amplifiers
        The circuit; the capacitors' voltages are the first states, in order, then amplifiers' outputs.
    source
        The driven node; its voltage is u.
    batch
        How many circuits the values' arrays are of.
    """
    names = {n for part in (*resistors, *capacitors) for n in (part.first, part.second)} | {source}
    names |= {n for a in amplifiers for n in (a.plus, a.minus, a.out)}
    at = {name: i for i, name in enumerate(sorted(names - {GROUND}))}
    slow = [a for a in amplifiers if a.gain_bandwidth_hz is not None]
    states = len(capacitors) + len(slow)
    size = len(at) + len(capacitors) + len(amplifiers) + 1
    M, right = np.zeros((batch, size, size)), np.zeros((batch, size, states + 3))

    def voltage(row: int, node: str, share: float) -> None:
        if node != GROUND:
            M[:, row, at[node]] += share

    def current(node: str, column: int, share: float) -> None:
        if node != GROUND:
            M[:, at[node], column] += share

    for part in resistors:
        conductance = 1 / np.broadcast_to(np.asarray(part.value, dtype=np.float64), (batch,))
        for node, other in ((part.first, part.second), (part.second, part.first)):
            if node != GROUND:
                M[:, at[node], at[node]] += conductance
                if other != GROUND:
                    M[:, at[node], at[other]] -= conductance
    for i, part in enumerate(capacitors):
        row = len(at) + i
        voltage(row, part.first, 1.0)
        voltage(row, part.second, -1.0)
        right[:, row, i] = 1.0
        current(part.first, row, 1.0)
        current(part.second, row, -1.0)
    for i, amplifier in enumerate(amplifiers):
        row = len(at) + len(capacitors) + i
        current(amplifier.out, row, 1.0)
        if amplifier.rail_v is not None:
            voltage(row, amplifier.out, 1.0)
            right[:, row, states + 2] = amplifier.rail_v
        elif amplifier in slow:
            voltage(row, amplifier.out, 1.0)
            right[:, row, len(capacitors) + slow.index(amplifier)] = 1.0
        else:
            voltage(row, amplifier.plus, 1.0)
            voltage(row, amplifier.minus, -1.0)
    voltage(size - 1, source, 1.0)
    current(source, size - 1, 1.0)
    right[:, size - 1, states] = 1.0

    found = np.linalg.solve(M, right).astype(np.float64, copy=False)
    nodes = {name: found[:, i] for name, i in at.items()}
    nodes[GROUND] = np.zeros_like(found[:, 0])
    rates = [found[:, len(at) + i] / np.reshape(part.value, (-1, 1)) for i, part in enumerate(capacitors)]
    rates += [2 * math.pi * (a.gain_bandwidth_hz or 0.0) * (nodes[a.plus] - nodes[a.minus]) for a in slow]
    rows = np.stack(rates, axis=1)
    return StateSpace(rows[:, :, :states], rows[:, :, states], rows[:, :, states + 2], nodes)
