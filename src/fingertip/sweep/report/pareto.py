"""The best of many: who is first, and whom nobody beats in every respect."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Costs = NDArray[np.float64]
"""Shape (points, objectives): every objective to be as low as possible."""


def front(costs: Costs) -> NDArray[np.intp]:
    """Rows that no other row beats: none is as low in every objective and lower in one. Ascending; equal rows stay.

    Exact: compares ranks, never sums of costs.
    """
    rows, same = np.unique(costs, axis=0, return_inverse=True)
    same = same.reshape(-1)
    kept = _front_of_two(rows) if rows.shape[1] == 2 else _front_of_many(rows)
    return np.flatnonzero(kept[same])


def _front_of_two(rows: Costs) -> NDArray[np.bool_]:
    """`rows` are unique and sorted by the first column, then by the second."""
    least_before = np.minimum.accumulate(np.append(np.inf, rows[:-1, 1]))
    return np.asarray(rows[:, 1] < least_before)


def _front_of_many(rows: Costs) -> NDArray[np.bool_]:
    ranked = np.stack([np.unique(column, return_inverse=True)[1].reshape(-1) for column in rows.T], axis=1)
    # Whoever beats a row has a lower sum of ranks: the lowest of those left is beaten by nobody.
    left = np.argsort(ranked.sum(axis=1), kind="stable")
    kept = np.zeros(len(rows), dtype=bool)
    while len(left):
        first, left = left[0], left[1:]
        kept[first] = True
        left = left[np.any(ranked[left] < ranked[first], axis=1)]
    return kept


def first(costs: Costs) -> int:
    """The row whose first objective is lowest; the next objectives break ties, and at last the row's place."""
    places = np.arange(len(costs))
    return int(np.lexsort((places, *costs.T[::-1]))[0])


def compromise(costs: Costs, on_front: NDArray[np.intp]) -> int:
    """The row of the front nearest to the ideal, which has the lowest of every objective.

    Each objective counts in units of its range over the front (the utopia point of compromise programming, Zeleny
    1973); the first of equals.
    """
    rows = costs[on_front]
    span = np.ptp(rows, axis=0)
    away = (rows - rows.min(axis=0)) / np.where(span > 0, span, 1.0)
    return int(on_front[np.argmin(np.sum(away**2, axis=1))])
