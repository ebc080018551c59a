"""The best of many: whom nobody beats in every respect, and who of those comes nearest to the best of each."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Costs = NDArray[np.float64]
"""Shape (points, objectives): every objective to be as low as possible, and finite."""


def front(costs: Costs) -> NDArray[np.intp]:
    """Rows that no other row beats: none is as low in every objective and lower in one. Ascending; equal rows stay.

    Exact: costs are compared, never added.
    """
    rows, same = np.unique(costs, axis=0, return_inverse=True)
    kept = _front_of_two(rows) if rows.shape[1] == 2 else _front_of_many(rows)
    return np.flatnonzero(kept[same.reshape(-1)])


def _front_of_two(rows: Costs) -> NDArray[np.bool_]:
    """`rows` differ and are sorted by the first column, then by the second."""
    min_before = np.minimum.accumulate(np.append(np.inf, rows[:-1, 1]))
    return np.asarray(rows[:, 1] < min_before)


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


def nearest_to_ideal(costs: Costs, on_front: NDArray[np.intp]) -> int:
    """The row of the front nearest to the ideal, which has the lowest of every objective; the first of equals.

    Each objective counts in units of its range over the front (compromise programming, Zeleny 1973). Of a single
    objective this is its lowest row.
    """
    rows = costs[on_front]
    span = np.ptp(rows, axis=0)
    away = (rows - rows.min(axis=0)) / np.where(span > 0, span, 1.0)
    return int(on_front[np.argmin(np.sum(away**2, axis=1))])
