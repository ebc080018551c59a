"""A column of a sweep in bins: what the tables and pictures of many points are counted over."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Column = NDArray[Any]
"""Values of one axis or output over all points, shape (points,): numbers, or words."""


@dataclass(frozen=True)
class Bins:
    """A column cut into bins that hold at least one point each, in ascending order."""

    code: NDArray[np.intp]
    """Bin of each point, shape (points,)."""
    low: Column
    """Least value found in each bin, shape (bins,)."""
    high: Column
    """Greatest value found in each bin, shape (bins,)."""

    @property
    def count(self) -> int:
        """Number of bins."""
        return len(self.low)

    @property
    def each_value(self) -> bool:
        """Whether every bin holds a single value."""
        return bool(np.all(self.low == self.high))


def is_words(column: Column) -> bool:
    """Whether a column holds words (a choice) and no numbers: it has no order and no distances."""
    return column.dtype.kind in "OUS"


def plain(column: Column) -> Column:
    """A column that can be sorted: words next to numbers become words."""
    return column.astype(str) if column.dtype == object else column


def by_count(column: Column, maximum: int) -> Bins:
    """Each value its bin, or at most `most` bins of about as many points each; equal values share one."""
    return _merged(column, maximum, lambda values, counts: maximum * (np.cumsum(counts) - counts / 2) / counts.sum())


def by_value(column: Column, maximum: int) -> Bins:
    """Each value its bin, or at most `most` bins of equal width; of equal ratio where the values are spread so."""

    def place(values: Column, counts: NDArray[np.intp]) -> NDArray[np.float64]:
        scale = np.log(values) if is_spread_by_ratio(values) else values.astype(float)
        return np.asarray(maximum * (scale - scale[0]) / (scale[-1] - scale[0]))

    return _merged(column, maximum, place)


def is_spread_by_ratio(column: Column) -> bool:
    """Whether a logarithmic scale suits a column: positive, the greatest at least five times the
    least, and the median nearer to the geometric than to the arithmetic mean of both."""
    if is_words(column) or not len(column) or not np.min(column) > 0:
        return False
    minimum, maximum, middle = float(np.min(column)), float(np.max(column)), float(np.median(column))
    return maximum >= 5 * minimum and abs(np.log(middle**2 / (minimum * maximum))) < abs(
        np.log(2 * middle / (minimum + maximum))
    )


def ranks(column: Column) -> NDArray[np.float64]:
    """Rank of each value from 1; equal values share the mean of theirs."""
    _, code, counts = np.unique(column, return_inverse=True, return_counts=True)
    return np.asarray((np.cumsum(counts) - (counts - 1) / 2)[code])


def _merged(column: Column, maximum: int, place: Any) -> Bins:
    values, code, counts = np.unique(plain(column), return_inverse=True, return_counts=True)
    if len(values) <= maximum or is_words(column):
        return Bins(code, values, values)
    wanted = np.clip(np.floor(place(values, counts)).astype(int), 0, maximum - 1)
    first = np.flatnonzero(np.diff(wanted, prepend=-1))  # bins that would be empty are left out
    last = np.append(first[1:], len(values)) - 1
    bin_of_value = np.repeat(np.arange(len(first)), last - first + 1)
    return Bins(bin_of_value[code], values[first], values[last])
