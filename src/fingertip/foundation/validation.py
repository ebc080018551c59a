"""Checks of values: bounds and finite input of every integrator, and a value compared with its limit."""

from __future__ import annotations

import math
import operator
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from fingertip.foundation.errors import Issue
from fingertip.foundation.numerics import Array


def find_not_positive(field: str, values: Array | float, unit: str, example: str) -> list[Issue]:
    """Report the first of one or many values that is not a finite number above 0."""
    row = np.ravel(np.asarray(values, dtype=np.float64))
    return _refuse_first(field, row, row > 0.0, unit, f"give a finite number above 0, such as {example} {unit}")


def find_negative(field: str, values: Array | float, unit: str) -> list[Issue]:
    """Report the first of one or many values that is not a finite number of at least 0."""
    row = np.ravel(np.asarray(values, dtype=np.float64))
    return _refuse_first(field, row, row >= 0.0, unit, "give a finite number of at least 0")


def _refuse_first(field: str, row: Array, valid: NDArray[np.bool_], unit: str, remedy: str) -> list[Issue]:
    return [
        Issue(field, f"{f'{row[i]:g} {unit}'.rstrip()}{f' at index {i}' if row.size > 1 else ''} is refused; {remedy}.")
        for i in np.flatnonzero(~(valid & np.isfinite(row))).tolist()[:1]
    ]


def find_not_finite(field: str, values: Array) -> Iterator[Issue]:
    """Report the first sample that is not finite."""
    if (bad := np.flatnonzero(~np.isfinite(values))).size:
        more = f" (and {bad.size - 1} more after it)" if bad.size > 1 else ""
        yield Issue(field, f"{values[bad[0]]} at sample {bad[0]}{more} is not a finite number; give the true value.")


def find_column_issues(**arrays: Array) -> Iterator[Issue]:
    """Report columns that are not finite, with the first such sample, and columns of unequal length."""
    length = len(next(iter(arrays.values())))
    for name, values in arrays.items():
        if values.shape != (length,) or length < 1:
            yield Issue(name, f"shape is {values.shape}; must be ({max(length, 1)},); give one value per sample.")
        else:
            yield from find_not_finite(name, values)


def round_down(value: float) -> float:
    """Round a positive number down to three digits, so that the remedy of an error passes when it is typed back in."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 2)
    return float(f"{math.floor(value / unit * (1 + 1e-12)) * unit:.3g}")


def round_up(value: float) -> float:
    """Round a positive number up to three digits, so that the remedy of an error passes when it is typed back in."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 2)
    return float(f"{math.ceil(value / unit * (1 - 1e-12)) * unit:.3g}")


Relation = Literal["at most", "below", "at least", "exactly"]


@dataclass(frozen=True)
class Comparison:
    """A value that must be `relation` its limit."""

    name: str
    value: float
    limit: float
    unit: str = ""
    relation: Relation = "at most"

    @property
    def sign(self) -> str:
        """Relation as a sign, for tables."""
        return {"at most": "<=", "below": "<", "at least": ">=", "exactly": "="}[self.relation]

    @property
    def passed(self) -> bool:
        compare = {"at most": operator.le, "below": operator.lt, "at least": operator.ge, "exactly": operator.eq}
        return bool(compare[self.relation](self.value, self.limit))

    @property
    def margin_percent(self) -> float:
        """Distance of the value from its limit, in percent of the limit; infinite where that has no meaning."""
        above = self.value - self.limit if self.relation == "at least" else self.limit - self.value
        return math.inf if self.relation == "exactly" or not self.limit else 100.0 * above / abs(self.limit)
