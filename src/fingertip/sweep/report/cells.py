"""An output over two axes: the best and the mean of each cell."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.sweep.report.statistics import Bins, Column


@dataclass(frozen=True)
class Cells:
    """What two axes' bins hold of an output; arrays of shape (bins of y, bins of x)."""

    asked: NDArray[np.intp]
    """Points, feasible or not."""
    count: NDArray[np.intp]
    """Feasible points of which the output is finite."""
    best: NDArray[np.float64]
    """NaN where there is none."""
    mean: NDArray[np.float64]
    """NaN where there is none."""


def cells(x: Bins, y: Bins, values: Column, ok: NDArray[np.bool_], lower_is_better: bool) -> Cells:
    """Cells of an output.

    Parameters
    ----------
    x, y
        Bins of the two axes.
    values
        The output, shape (points,).
    ok
        Feasible points, shape (points,).
    lower_is_better
        Which end of the output is best.
    """
    shape = (y.count, x.count)
    size = y.count * x.count
    of_point = y.code * x.count + x.code
    known = ok & np.isfinite(values)
    code, kept = of_point[known], values[known]
    count = np.bincount(code, minlength=size)
    mean = np.bincount(code, kept, minlength=size) / np.where(count > 0, count, np.nan)
    best = np.full(size, np.inf if lower_is_better else -np.inf)
    (np.minimum if lower_is_better else np.maximum).at(best, code, kept)
    best[count == 0] = np.nan
    asked = np.bincount(of_point, minlength=size)
    return Cells(asked.reshape(shape), count.reshape(shape), best.reshape(shape), mean.reshape(shape))
