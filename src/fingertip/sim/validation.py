"""What every integrator refuses before it starts: values out of bounds, and input that is not finite."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from fingertip.arrays import Array
from fingertip.errors import Issue, TraceError


def positive(field: str, value: float, unit: str, example: str) -> list[Issue]:
    """A issue unless `value` [unit] is finite and above 0; `example` is a value that passes."""
    if math.isfinite(value) and value > 0.0:
        return []
    return [Issue(field, f"{_said(value, unit)} is refused; give a finite number above 0, such as {example} {unit}.")]


def not_negative(field: str, value: float, unit: str) -> list[Issue]:
    """A issue unless `value` [unit] is finite and at least 0."""
    if math.isfinite(value) and value >= 0.0:
        return []
    return [Issue(field, f"{_said(value, unit)} is refused; give a finite number of at least 0.")]


def columns(**arrays: Array) -> Iterable[Issue]:
    """Columns that are not finite, with the first such sample, and columns of unequal length."""
    length = len(next(iter(arrays.values())))
    for name, values in arrays.items():
        if values.shape != (length,) or length < 1:
            yield Issue(name, f"has shape {values.shape}, needed is ({max(length, 1)},); give one value per sample.")
        elif (bad := np.flatnonzero(~np.isfinite(values))).size:
            more = f", and {bad.size - 1} more after it," if bad.size > 1 else ""
            sentence = f"{values[bad[0]]} at sample {bad[0]}{more} is not a finite number; give the true value."
            yield Issue(name, sentence)


def refuse(issues: Iterable[Issue]) -> None:
    """Raise all issues at once, if there are any."""
    if found := list(issues):
        raise TraceError(found)


def _said(value: float, unit: str) -> str:
    return f"{value:g} {unit}".rstrip()
