"""Linear circuits: equations of a circuit of resistors, capacitors and amplifiers, and exact steps of their solution.

The equations come from modified nodal analysis, solved once (C. W. Ho, A. E. Ruehli, P. A. Brennan, IEEE Trans.
Circuits and Systems 22(6), 1975, doi:10.1109/TCS.1975.1084079). Each capacitor's voltage is a state and stands as a
source in the analysis; its current then is the state's derivative. An amplifier without limits makes its inputs equal,
a saturated one is a source, and one with a finite gain-bandwidth product has its output as a state:
d out/dt = 2 pi GBW (v+ - v-). Every value may be an array over many circuits.

The steps are exact for x' = A x + b u + k with an input u that is linear in time over the step. The state is carried as
z = (x, u, slope of u, 1), so one matrix exponential of that larger system holds everything (C. Van Loan, IEEE Trans.
Automatic Control 23(3), 1978, doi:10.1109/TAC.1978.1101743). The shortest step's exponential is a Taylor series; each
longer one is the square of the one before (scaling and squaring).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fingertip.arrays import Array

GROUND = "0"
_TERMS = 10  # of the Taylor series, for a norm of at most 1/16: the next term is below 1e-20


@dataclass(frozen=True)
class PassiveComponent:
    """Resistor [ohm] or capacitor [F] between two nodes."""

    name: str
    first: str
    second: str
    value: float | Array


@dataclass(frozen=True)
class Amplifier:
    """Operational amplifier."""

    plus: str
    minus: str
    out: str
    gain_bandwidth_hz: float | None = None
    saturated_v: float | None = None
    """Output voltage of a saturated amplifier [V]; None: it is not saturated."""


@dataclass(frozen=True, eq=False)
class StateSpace:
    """State equations x' = A x + b u + k, batched, and every node's voltage as a row over (x, u, slope of u, 1)."""

    A: Array
    b: Array
    k: Array
    nodes: Mapping[str, Array]


def assemble(
    resistors: Sequence[PassiveComponent],
    capacitors: Sequence[PassiveComponent],
    amplifiers: Sequence[Amplifier],
    source: str,
    batch: int,
) -> StateSpace:
    """Solve the circuit that a voltage source drives at a node.

    Parameters
    ----------
    resistors, capacitors, amplifiers
        Components. The states are the capacitors' voltages, in order, then the outputs of amplifiers with a finite
        gain-bandwidth product.
    source
        Driven node; its voltage is u.
    batch
        Number of circuits in the values' arrays.
    """
    names = {n for component in (*resistors, *capacitors) for n in (component.first, component.second)} | {source}
    names |= {n for a in amplifiers for n in (a.plus, a.minus, a.out)}
    index = {name: i for i, name in enumerate(sorted(names - {GROUND}))}
    slow = [a for a in amplifiers if a.gain_bandwidth_hz is not None]
    states = len(capacitors) + len(slow)
    size = len(index) + len(capacitors) + len(amplifiers) + 1
    M, right = np.zeros((batch, size, size)), np.zeros((batch, size, states + 3))

    def add_voltage(row: int, node: str, factor: float) -> None:
        if node != GROUND:
            M[:, row, index[node]] += factor

    def add_current(node: str, column: int, factor: float) -> None:
        if node != GROUND:
            M[:, index[node], column] += factor

    # Kirchhoff's current law at every node but ground.
    for component in resistors:
        conductance = 1 / np.broadcast_to(np.asarray(component.value, dtype=np.float64), (batch,))
        ends = (component.first, component.second)
        for node, other in (ends, ends[::-1]):
            if node != GROUND:
                M[:, index[node], index[node]] += conductance
                if other != GROUND:
                    M[:, index[node], index[other]] -= conductance
    # A capacitor is a source of its state's voltage, and its current is an unknown.
    for i, component in enumerate(capacitors):
        row = len(index) + i
        add_voltage(row, component.first, 1.0)
        add_voltage(row, component.second, -1.0)
        right[:, row, i] = 1.0
        add_current(component.first, row, 1.0)
        add_current(component.second, row, -1.0)
    # An amplifier's output current is an unknown; its equation depends on how it is modelled.
    for i, amplifier in enumerate(amplifiers):
        row = len(index) + len(capacitors) + i
        add_current(amplifier.out, row, 1.0)
        if amplifier.saturated_v is not None:
            add_voltage(row, amplifier.out, 1.0)
            right[:, row, states + 2] = amplifier.saturated_v
        elif amplifier in slow:
            add_voltage(row, amplifier.out, 1.0)
            right[:, row, len(capacitors) + slow.index(amplifier)] = 1.0
        else:
            add_voltage(row, amplifier.plus, 1.0)
            add_voltage(row, amplifier.minus, -1.0)
    add_voltage(size - 1, source, 1.0)
    add_current(source, size - 1, 1.0)
    right[:, size - 1, states] = 1.0

    solution = np.linalg.solve(M, right).astype(np.float64, copy=False)
    nodes = {name: solution[:, i] for name, i in index.items()}
    nodes[GROUND] = np.zeros_like(solution[:, 0])
    rates = [
        solution[:, len(index) + i] / np.reshape(component.value, (-1, 1)) for i, component in enumerate(capacitors)
    ]
    rates += [2 * math.pi * (a.gain_bandwidth_hz or 0.0) * (nodes[a.plus] - nodes[a.minus]) for a in slow]
    rows = np.stack(rates, axis=1)
    return StateSpace(rows[:, :, :states], rows[:, :, states], rows[:, :, states + 2], nodes)


def augment(A: Array, b: Array, k: Array) -> Array:
    """Matrix of z' = M z; leading dimensions are a batch. A: (..., n, n), b and k: (..., n)."""
    n = A.shape[-1]
    M = np.zeros((*A.shape[:-2], n + 3, n + 3))
    M[..., :n, :n] = A
    M[..., :n, n] = b
    M[..., :n, n + 2] = k
    M[..., n, n + 1] = 1.0
    return M


def exponentials(M: Array, step_s: float, levels: int) -> Array:
    """Matrix exponentials exp(M step / 2^l) for l = 0 .. levels - 1, in a new axis before the last two."""
    shortest = M * (step_s * 2.0 ** (1 - levels))
    norm = float(np.abs(shortest).sum(axis=-1).max())
    squarings = max(0, math.ceil(math.log2(norm * 16.0))) if norm > 0.0 else 0
    X = shortest * 2.0**-squarings
    # D = exp - 1 is squared as 2 D + D^2: so many squarings of exp itself would lose eight digits to the 1 in it.
    D = term = X
    for i in range(2, _TERMS + 1):
        term = term @ X / i
        D = D + term
    for _ in range(squarings):
        D = 2 * D + D @ D
    found = [D]
    for _ in range(levels - 1):
        D = 2 * D + D @ D
        found.append(D)
    return np.stack(found[::-1], axis=-3) + np.eye(M.shape[-1])
