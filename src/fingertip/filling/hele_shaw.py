"""Moving front of a viscous liquid in a thin gap (Hele-Shaw flow), on a network of conductances.

With pressure 0 at the front, let u be the integral of p / (mu Q) over the injected volume. It solves an obstacle
problem: for an injected volume V find u >= 0 and filled fractions 0 <= f <= 1 with

    sum_j K_ij (u_j - u_i) + V w_i = v_i f_i,   f_i = 1 where u_i > 0.

K are the conductances, v the volumes of the nodes, and w says how the gate's inflow is shared between nodes. The
solution depends on V alone, not on the steps towards it, so that a few volumes suffice and no step limits the others.
The derivative du/dV is the pressure of unit flow and unit viscosity, and w.u is the integral of the cavity's resistance
over volume. At full volume, u is the solution of one linear Neumann problem, and its minimum the last point to fill.

Each volume is solved with a primal-dual active set, warm-started from the next larger volume. Where all conductances
are positive (M-matrix), the iteration ends after a few linear solves; the few slightly negative ones of skewed quads
near the apex do not disturb it. Air is assumed to escape freely.

The unfilled region shrinks as silicone enters, and may split. A part that splits off without an open vent is trapped
air. So is what is left of a part when the front has covered its last vent. Parts follow from the arrival field alone:
each local maximum is a last point, and two parts split at the saddle between their maxima. The pressure of trapped air
is not computed: the front moves on as if it escaped.

References: C. M. Elliott and V. Janovsky, Proc. R. Soc. Edinburgh A 88 (1981) 93 (the transform); M. Hintermueller, K.
Ito and K. Kunisch, SIAM J. Optim. 13 (2002) 865 (the active set).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.filling.network import FlowNetwork, Mask, RowElimination
from fingertip.foundation.numerics import Array

LEVELS = 12
"""Number of injected volumes at which the front is computed, the full cavity included."""
_MAX_ITERATIONS = 40
"""Limit of the active set's iterations; two to five are common."""
_ROUNDING = 1e-9
"""Filled fraction above 1, and u relative to its maximum, that count as rounding."""


@dataclass(frozen=True, eq=False)
class Front:
    """Wet region at one injected volume. All arrays are vectors over the nodes."""

    injected_mm3: float
    potential: Array
    """u, the integral of p / (mu Q) over the injected volume [1]."""
    pressure_per_mm3: Array
    """p / (mu Q) [1/mm3]."""
    filled: Array
    """Filled fraction f."""


@dataclass(frozen=True, eq=False)
class Filling:
    """Filling of a network through one gate."""

    network: FlowNetwork
    gate: Array
    """Share of the inflow that enters each node, a vector with the sum 1."""
    fronts: tuple[Front, ...]
    """Fronts from the smallest volume to the full cavity."""
    arrival_mm3: Array
    """Injected volume at which the front passes each node; NaN for closed nodes."""


def fill(network: FlowNetwork, gate: Array, levels: int = LEVELS) -> Filling:
    solver = RowElimination(network, np.stack((gate, network.volume_mm3), axis=1))
    fronts = [_full_front(network, solver)]
    # The front is a small circle at first, and closes around a small spot at last. Its area is quadratic in its radius,
    # and so are these volumes at both ends.
    angle = np.pi * np.arange(1, levels) / levels
    volumes_mm3 = network.total_mm3 * 0.5 * (1.0 - np.cos(angle))
    for injected in volumes_mm3[::-1]:
        guess = _guess(network, fronts[-1], float(injected))
        fronts.append(_solve_front(network, solver, gate, float(injected), guess))
    return Filling(network, gate, tuple(fronts[::-1]), _conserve(network, _arrival(network, fronts[::-1]), levels))


def _guess(network: FlowNetwork, front: Front, injected_mm3: float) -> Mask:
    """Guess the wet region at a smaller volume.

    From the full cavity, the nodes of least u become dry: they fill last. From others, the arrival volumes are about
    V - 2 u / (du/dV), as in `_arrival`.
    """
    u, removed_mm3 = front.potential, front.injected_mm3 - injected_mm3
    if front.injected_mm3 < network.total_mm3:
        return np.asarray((u > 0.0) & (2.0 * u > removed_mm3 * front.pressure_per_mm3))
    wet = network.is_open.copy()
    order = np.argsort(np.where(wet, u, np.inf))
    wet[order[np.cumsum(network.volume_mm3[order]) <= removed_mm3]] = False
    wet[order[0]] = False  # however coarse the grid: without a dry node the equations are singular
    return wet


def _full_front(network: FlowNetwork, solver: RowElimination) -> Front:
    """Solve the full cavity as the last node fills: a Neumann problem, shifted to the minimum zero."""
    total = network.total_mm3
    wet = network.is_open.copy()
    last = int(np.flatnonzero(wet)[0])
    for _ in range(2):  # the node held at zero is any open one first, then the last to fill
        wet[last] = False
        solved = solver.solve(wet)
        potential = total * solved[:, 0] - solved[:, 1]
        potential[~network.is_open] = np.inf
        wet[last] = True
        last = int(np.argmin(potential))
    potential -= potential[last]
    potential[~network.is_open] = 0.0
    return Front(total, potential, solved[:, 0], network.is_open.astype(float))


def _solve_front(network: FlowNetwork, solver: RowElimination, gate: Array, injected_mm3: float, guess: Mask) -> Front:
    """Solve one injected volume with the active set, from a guess of the wet region."""
    volume, wet = network.volume_mm3, guess
    per_volume = np.divide(1.0, volume, out=np.zeros_like(volume), where=network.is_open)
    for _ in range(_MAX_ITERATIONS):
        solved = solver.solve(wet)
        potential = injected_mm3 * solved[:, 0] - solved[:, 1]
        filled = (network.inflow(potential) + injected_mm3 * gate) * per_volume
        stays = potential > -_ROUNDING * potential.max()
        next_wet = np.where(wet, stays, filled > 1.0 + _ROUNDING)
        if np.array_equal(next_wet, wet):
            break
        wet = next_wet
    return Front(injected_mm3, np.maximum(potential, 0.0), solved[:, 0], filled)


def _arrival(network: FlowNetwork, fronts: list[Front]) -> Array:
    """Interpolate the injected volume at which the front passes each node.

    Behind a moving front u = c (V - A)^m for a node with arrival volume A: m is 2 where the front passes, since u is
    quadratic in the distance from it, and 1 where it closes. With r = u / (du/dV) = (V - A) / m at the first two
    volumes after the arrival, m and A follow.
    """
    total = network.total_mm3
    arrival = np.full(len(network.volume_mm3), np.nan)
    passed, at_end = np.zeros((2, len(arrival)), dtype=bool)
    below = np.zeros(len(arrival))
    columns = network.shape[1]
    at_end[:columns] = True
    at_end[-1 - columns : -1] = not network.is_open[-1]
    done = ~network.is_open
    for k, front in enumerate(fronts[:-1]):
        here = ~done & (front.potential > 0.0)
        if here.any():
            r = front.potential[here] / front.pressure_per_mm3[here]
            after = fronts[k + 1]
            is_last = k + 2 == len(fronts)
            r_after = after.potential[here] / np.maximum(after.pressure_per_mm3[here], 1e-300)
            step = after.injected_mm3 - front.injected_mm3
            m = np.clip(step / np.maximum(r_after - r, 1e-300), 1.0, 2.0) if not is_last else np.full(r.shape, 2.0)
            low = np.where(passed[here], 0.0, below[here])
            high = np.where(passed[here], below[here], front.injected_mm3)
            arrival[here] = np.clip(front.injected_mm3 - m * r, low, high)
            done = done | here
        # The front passes a node when its part of the cavity is half full; one at an end, when it is full.
        passed, below = (front.filled >= 0.5) & ~at_end, np.full(len(arrival), front.injected_mm3)
    rest = ~done
    if rest.any():
        # What is left shrinks to the minimum of u, and its volume is proportional to u.
        u = fronts[-1].potential[rest]
        largest = max(float(u.max()), _ROUNDING * float(fronts[-1].potential.max()))
        arrival[rest] = total - (total - below[0]) * u / largest
    return arrival


def _conserve(network: FlowNetwork, arrival: Array, levels: int) -> Array:
    """Correct arrival volumes so that the nodes passed at any volume hold that volume.

    Interpolation errors shift all nodes that the front passes at the same time alike. Counted in the volume of all
    nodes passed before, their arrival is exact. The count is smoothed over half the distance of two fronts, since nodes
    come in lumps.
    """
    total, volume = network.total_mm3, network.volume_mm3[network.is_open]
    found = arrival[network.is_open]
    knots = total * np.linspace(0.0, 1.0, 2 * levels + 1)[1:-1]
    width = np.minimum(total / levels, 2.0 * np.minimum(knots, total - knots))
    passed = np.clip((knots[:, None] - found) / width[:, None] + 0.5, 0.0, 1.0) @ volume
    corrected = np.full(len(arrival), np.nan)
    corrected[network.is_open] = np.interp(
        found, np.concatenate(([0.0], knots, [total])), np.concatenate(([0.0], passed, [total]))
    )
    return corrected


SMALLEST_POCKET_MM3 = 0.5
"""Volume below which a split or a rest of air is not reported [mm3]: a bubble of 1 mm. An assumption."""


@dataclass(frozen=True)
class TrappedAir:
    """Part of the unfilled region that no vent can empty any more."""

    node: int
    """Node at which it would have filled last."""
    injected_mm3: float
    """Injected volume at which it was trapped."""
    volume_mm3: float
    """Volume at that moment."""


@dataclass(frozen=True)
class _Part:
    """Connected part of the unfilled region, from the injected volume at which it split off."""

    basins: frozenset[int]
    peak: int
    children: tuple[_Part, ...] = ()
    splits_mm3: float = np.inf
    """Injected volume at which it splits into its children."""


@dataclass(frozen=True, eq=False)
class _Field:
    """Arrival field with its basins: the nodes from which the way uphill leads to the same maximum."""

    arrival: Array
    volume: Array
    basin: NDArray[np.intp]

    def unfilled_mm3(self, part: _Part, injected_mm3: float) -> float:
        left = float(self.volume.sum()) - injected_mm3
        unfilled: Mask = self.arrival > injected_mm3
        all_mm3 = float(self.volume[unfilled].sum())
        if all_mm3 == 0.0:  # all that is left is part of the last node
            return left if self.arrival[part.peak] >= self.arrival.max() else 0.0
        mine = unfilled & np.isin(self.basin, list(part.basins))
        return left * float(self.volume[mine].sum()) / all_mm3


def find_air(
    network: FlowNetwork, arrival_mm3: Array, vents: Mapping[int, float]
) -> tuple[list[int], tuple[TrappedAir, ...]]:
    """Find the nodes that fill last, the last one first, and the trapped air, the largest first.

    `vents` holds the nodes of vents, with the injected volume at which the front has covered each [mm3].
    """
    arrival = np.where(network.is_open, arrival_mm3, -np.inf)
    a, b, _ = network.links
    field = _Field(arrival, network.volume_mm3, _climb(arrival, a, b))
    root = _build_tree(field, a, b)
    points = sorted(_leaves(root), key=lambda node: -arrival[node])
    pockets = tuple(sorted(_trap(field, root, 0.0, vents), key=lambda air: -air.volume_mm3))
    return points, tuple(air for air in pockets if air.volume_mm3 >= SMALLEST_POCKET_MM3)


def _climb(arrival: Array, a: NDArray[np.intp], b: NDArray[np.intp]) -> NDArray[np.intp]:
    """Find the local maximum to which each node's steepest way leads; equal nodes are ranked by number."""
    count = len(arrival)
    rank = np.empty(count, dtype=np.intp)
    rank[np.argsort(arrival, kind="stable")] = np.arange(count)
    low, high = np.where(rank[a] < rank[b], a, b), np.where(rank[a] < rank[b], b, a)
    order = np.argsort(rank[high], kind="stable")
    target = np.arange(count)
    target[low[order]] = high[order]  # of several assignments the last, the highest, remains
    while not np.array_equal(further := target[target], target):
        target = further
    return target


def _build_tree(field: _Field, a: NDArray[np.intp], b: NDArray[np.intp]) -> _Part:
    """Join basins from the highest saddle down; parts too small to count are joined without a split."""
    arrival, basin = field.arrival, field.basin
    is_open = np.isfinite(arrival)
    part_of = {int(k): _Part(frozenset((int(k),)), int(k)) for k in sorted(set(basin[is_open].tolist()))}
    across = np.flatnonzero((basin[a] != basin[b]) & is_open[a] & is_open[b])
    saddle = np.minimum(arrival[a[across]], arrival[b[across]])
    for link in np.argsort(-saddle, kind="stable"):
        first, second = part_of[int(basin[a[across[link]]])], part_of[int(basin[b[across[link]]])]
        if first is second:
            continue
        if arrival[first.peak] < arrival[second.peak]:
            first, second = second, first
        height = float(saddle[link])
        basins = first.basins | second.basins
        if min(field.unfilled_mm3(part, height) for part in (first, second)) < SMALLEST_POCKET_MM3:
            joined = _Part(basins, first.peak, first.children, first.splits_mm3)
        else:
            joined = _Part(basins, first.peak, (first, second), height)
        part_of.update(dict.fromkeys(basins, joined))
    parts = list({id(part): part for part in part_of.values()}.values())
    highest = max(parts, key=lambda part: float(arrival[part.peak]))
    if len(parts) == 1:
        return highest
    return _Part(frozenset().union(*(part.basins for part in parts)), highest.peak, tuple(parts), 0.0)


def _leaves(part: _Part) -> list[int]:
    """List the maxima of the parts that do not split again."""
    return [peak for child in part.children for peak in _leaves(child)] or [part.peak]


def _trap(field: _Field, part: _Part, since_mm3: float, vents: Mapping[int, float]) -> list[TrappedAir]:
    """Find the air trapped in a part that split off at an injected volume."""
    own = {node: mm3 for node, mm3 in vents.items() if mm3 > since_mm3 and int(field.basin[node]) in part.basins}
    closed_mm3 = max(own.values(), default=since_mm3)
    if closed_mm3 < part.splits_mm3:
        if closed_mm3 >= field.arrival[part.peak]:
            return []
        return [TrappedAir(part.peak, closed_mm3, field.unfilled_mm3(part, closed_mm3))]
    return [air for child in part.children for air in _trap(field, child, part.splits_mm3, own)]
