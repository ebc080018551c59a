"""Last points to fill, and air that is trapped there.

The unfilled region shrinks as silicone enters, and may split. A part that splits off without an open vent is trapped
air. So is what is left of a part when the front has covered its last vent. Parts follow from the arrival field alone:
each local maximum is a last point, and two parts split at the saddle between their maxima.

Trapped air is found, but its pressure is not computed: the front moves on as if it escaped.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.filling.network import FlowNetwork, Mask
from fingertip.foundation.numerics import Array

SMALLEST_POCKET_MM3 = 0.5
"""Volume below which a split or a rest of air is not reported [mm3]: a bubble of 1 mm. An assumption."""


@dataclass(frozen=True)
class ClosingVent:
    """Vent, and the injected volume at which the front has covered it."""

    node: int
    covered_mm3: float


@dataclass(frozen=True)
class LastPoint:
    """Local maximum of the arrival volume."""

    node: int
    arrival_mm3: float
    split_mm3: float
    """Injected volume at which its part of the unfilled region split off; 0 if it never did."""


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
        """Compute the volume of a part at an injected volume."""
        left = float(self.volume.sum()) - injected_mm3
        unfilled: Mask = self.arrival > injected_mm3
        all_mm3 = float(self.volume[unfilled].sum())
        if all_mm3 == 0.0:  # all that is left is part of the last node
            return left if self.arrival[part.peak] >= self.arrival.max() else 0.0
        mine = unfilled & np.isin(self.basin, list(part.basins))
        return left * float(self.volume[mine].sum()) / all_mm3


def find_air(
    network: FlowNetwork, arrival_mm3: Array, vents: tuple[ClosingVent, ...]
) -> tuple[tuple[LastPoint, ...], tuple[TrappedAir, ...]]:
    """Find last points, the last first, and trapped air, the largest first."""
    arrival = np.where(network.is_open, arrival_mm3, -np.inf)
    a, b, _ = network.links
    basin = _climb(arrival, a, b)
    field = _Field(arrival, network.volume_mm3, basin)
    root = _build_tree(field, a, b)
    points = tuple(sorted(_leaves(root, 0.0, arrival), key=lambda point: -point.arrival_mm3))
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


def _leaves(part: _Part, split_mm3: float, arrival: Array) -> list[LastPoint]:
    if not part.children:
        return [LastPoint(part.peak, float(arrival[part.peak]), split_mm3)]
    return [point for child in part.children for point in _leaves(child, part.splits_mm3, arrival)]


def _trap(field: _Field, part: _Part, since_mm3: float, vents: tuple[ClosingVent, ...]) -> list[TrappedAir]:
    """Find the air trapped in a part that split off at an injected volume."""
    own = tuple(v for v in vents if v.covered_mm3 > since_mm3 and int(field.basin[v.node]) in part.basins)
    closed_mm3 = max((v.covered_mm3 for v in own), default=since_mm3)
    if closed_mm3 < part.splits_mm3:
        if closed_mm3 >= field.arrival[part.peak]:
            return []
        return [TrappedAir(part.peak, closed_mm3, field.unfilled_mm3(part, closed_mm3))]
    return [air for child in part.children for air in _trap(field, child, part.splits_mm3, own)]
