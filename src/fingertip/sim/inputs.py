"""What every integrator refuses before it starts: values out of bounds, and input that is not finite."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from fingertip.errors import Fault, TraceError

Array = NDArray[np.float64]


def positive(field: str, value: float, unit: str, example: str) -> list[Fault]:
    """A fault unless `value` [unit] is finite and above 0; `example` is a value that passes."""
    if math.isfinite(value) and value > 0.0:
        return []
    return [Fault(field, f"{_said(value, unit)} is refused; give a finite number above 0, such as {example} {unit}.")]


def not_negative(field: str, value: float, unit: str) -> list[Fault]:
    """A fault unless `value` [unit] is finite and at least 0."""
    if math.isfinite(value) and value >= 0.0:
        return []
    return [Fault(field, f"{_said(value, unit)} is refused; give a finite number of at least 0.")]


def columns(**arrays: Array) -> Iterable[Fault]:
    """Columns that are not finite, with the first such sample, and columns of unequal length."""
    length = len(next(iter(arrays.values())))
    for name, values in arrays.items():
        if values.shape != (length,) or length < 1:
            yield Fault(name, f"has shape {values.shape}, needed is ({max(length, 1)},); give one value per sample.")
        elif (bad := np.flatnonzero(~np.isfinite(values))).size:
            more = f", and {bad.size - 1} more after it," if bad.size > 1 else ""
            sentence = f"{values[bad[0]]} at sample {bad[0]}{more} is not a finite number; give the true value."
            yield Fault(name, sentence)


def refuse(faults: Iterable[Fault]) -> None:
    """Raise all faults at once, if there are any."""
    if found := list(faults):
        raise TraceError(found)


def _said(value: float, unit: str) -> str:
    return f"{value:g} {unit}".rstrip()
