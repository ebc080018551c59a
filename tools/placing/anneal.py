"""Simulated annealing of a placement, as a loop over arrays that numba compiles where it is installed.

The cost is the half-perimeter wire length of all nets [mm] and the overlaps of courtyards and labels (C. Sechen and A.
Sangiovanni-Vincentelli, "The TimberWolf placement and routing package", IEEE J. Solid-State Circuits 20(2), 1985).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fingertip.foundation.jit import compile_for_process

GRID_MM = 0.05
"""Grid of the positions."""
EDGE_MM = 0.1
"""Distance of courtyards from the edge of the board. The pads are a quarter of a millimetre farther inside."""
_STRANGER_MM = 0.15
"""Distance by which a label keeps farther from the components of others than from its own."""
_LABEL_GAP_MM = 0.25


def anneal(
    state: Any, movable: Any, courtyards: Any, areas: Any, labels: Any, states: Any, width: float, height: float,
    gap: float, pins: Any, first_pin: Any, net_pins: Any, first_net_pin: Any, weights: Any, own_nets: Any,
    first_own_net: Any, moves: int, hot: float, cold: float,
    first_penalty: float, last_penalty: float, seed: int,
) -> Any:  # fmt: skip
    """Anneal a placement in place; returns wire length and overlap [mm].

    Parameters
    ----------
    state
        Row per component: x, y, quarter turns, number of the label's place.
    movable
        True for each component that may move; labels always may.
    courtyards, areas
        Boxes per component and quarter turn: courtyard, and area that labels avoid.
    labels, states
        Boxes per component, quarter turn and place of its label, and the number of places; 0 without label.
    width, height, gap
        Outline of the board, and clearance between courtyards.
    pins, first_pin
        Offset of each pin per quarter turn, and the first pin of each component.
    net_pins, first_net_pin, weights
        Component and pin of each net's pins, the first entry of each net, and its weight.
    own_nets, first_own_net
        Nets of each component.
    moves, hot, cold, first_penalty, last_penalty, seed
        Number of moves; temperature, and cost of overlaps, at the beginning and at the end; seed of the random numbers.
    """
    np.random.seed(seed)
    n = len(state)

    def excess(a: Any, ax: float, ay: float, am: float, b: Any, bx: float, by: float) -> float:
        dx = min(a[2] + ax, b[2] + bx) - max(a[0] + ax, b[0] + bx) + am
        dy = min(a[3] + ay, b[3] + by) - max(a[1] + ay, b[1] + by) + am
        if dx <= 1e-6 or dy <= 1e-6:
            return 0.0
        return float(dx * dy + 0.5 * min(dx, dy))

    def overlap(i: int) -> float:
        x, y, r, s = state[i, 0], state[i, 1], int(state[i, 2]), int(state[i, 3])
        total = 0.0
        c = courtyards[i, r]
        if movable[i]:
            total += (max(0.0, EDGE_MM - x - c[0]) + max(0.0, EDGE_MM + x + c[2] - width)) * (1.0 + c[3] - c[1])
            total += (max(0.0, EDGE_MM - y - c[1]) + max(0.0, EDGE_MM + y + c[3] - height)) * (1.0 + c[2] - c[0])
            total *= 4.0
        if states[i] > 1:
            b = labels[i, r, s]
            outside = max(0.0, 0.3 - x - b[0]) + max(0.0, 0.3 - y - b[1])
            outside += max(0.0, x + b[2] - width + 0.3) + max(0.0, y + b[3] - height + 0.3)
            total += 5.0 * outside
        for j in range(n):
            if j == i:
                continue
            u, v, q, t = state[j, 0], state[j, 1], int(state[j, 2]), int(state[j, 3])
            if abs(u - x) > 18.0 or abs(v - y) > 18.0:
                continue
            total += 2.0 * excess(c, x, y, gap, courtyards[j, q], u, v)
            if states[i]:
                total += excess(labels[i, r, s], x, y, _STRANGER_MM, areas[j, q], u, v)
                if states[j]:
                    total += excess(labels[i, r, s], x, y, _LABEL_GAP_MM, labels[j, q, t], u, v)
            if states[j]:
                total += excess(labels[j, q, t], u, v, _STRANGER_MM, areas[i, r], x, y)
        return total

    def length(net: int) -> float:
        left, right, top, bottom = 1e9, -1e9, 1e9, -1e9
        for k in range(first_net_pin[net], first_net_pin[net + 1]):
            i, p = net_pins[k, 0], net_pins[k, 1]
            r = int(state[i, 2])
            x, y = state[i, 0] + pins[p, r, 0], state[i, 1] + pins[p, r, 1]
            left, right, top, bottom = min(left, x), max(right, x), min(top, y), max(bottom, y)
        return float(weights[net]) * (right - left + bottom - top)

    def lengths(i: int) -> float:
        total = 0.0
        for k in range(first_own_net[i], first_own_net[i + 1]):
            total += length(own_nets[k])
        return total

    ratio = (cold / hot) ** (1.0 / max(moves, 1))
    temperature = hot
    for move in range(moves):
        temperature *= ratio
        done = move / moves
        penalty = first_penalty + (last_penalty - first_penalty) * done * done
        i = np.random.randint(n)
        kind = np.random.random()
        x, y, r, s = state[i, 0], state[i, 1], state[i, 2], state[i, 3]
        if not movable[i] or (kind < 0.15 and states[i] > 1):
            if states[i] < 2:
                continue
            before = penalty * overlap(i)
            state[i, 3] = np.random.randint(states[i])
            after = penalty * overlap(i)
            if after > before and np.random.random() >= math.exp((before - after) / temperature):
                state[i, 3] = s
            continue
        if kind < 0.3:
            j = np.random.randint(n)
            if j == i or not movable[j]:
                continue
            u, v = state[j, 0], state[j, 1]
            before = penalty * overlap(i) + lengths(i)
            state[i, 0], state[i, 1] = u, v
            change = penalty * overlap(i) + lengths(i) - before
            before = penalty * overlap(j) + lengths(j)
            state[j, 0], state[j, 1] = x, y
            change += penalty * overlap(j) + lengths(j) - before
            if change > 0 and np.random.random() >= math.exp(-change / temperature):
                state[i, 0], state[i, 1], state[j, 0], state[j, 1] = x, y, u, v
            continue
        before = penalty * overlap(i) + lengths(i)
        if kind < 0.45:
            state[i, 2] = np.random.randint(4)
        else:
            reach = 0.1 + 8.0 * (1.0 - done) ** 3
            state[i, 0] = round((x + np.random.normal(0.0, reach)) / GRID_MM) * GRID_MM
            state[i, 1] = round((y + np.random.normal(0.0, reach)) / GRID_MM) * GRID_MM
        if states[i] > 1 and np.random.random() < 0.3:
            state[i, 3] = np.random.randint(states[i])
        after = penalty * overlap(i) + lengths(i)
        if after > before and np.random.random() >= math.exp((before - after) / temperature):
            state[i, 0], state[i, 1], state[i, 2], state[i, 3] = x, y, r, s
    wire, rest = 0.0, 0.0
    for net in range(len(weights)):
        wire += length(net)
    for i in range(n):
        rest += overlap(i)
    return wire, rest


compiled_anneal = compile_for_process(anneal)
