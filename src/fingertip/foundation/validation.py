"""Checks of values: bounds that pass when they are typed back, and comparison with a limit."""

from __future__ import annotations

import math
import operator
from dataclasses import dataclass
from typing import Literal

from fingertip.foundation.errors import Issue


def find_not_positive(field: str, value: float, unit: str, example: str) -> list[Issue]:
    """Report a value that is not a finite number above 0."""
    if math.isfinite(value) and value > 0.0:
        return []

    remedy = f"give a finite number above 0, such as {example} {unit}"
    return [Issue(field, f"{value:g} {unit} is refused; {remedy}.")]


def round_down(value: float) -> float:
    """Round a positive number down to three digits, so that the remedy of an error passes when it
    is typed back in.
    """
    unit = 10.0 ** (math.floor(math.log10(value)) - 2)
    return float(f"{math.floor(value / unit * (1 + 1e-12)) * unit:.3g}")


def round_up(value: float) -> float:
    """Round a positive number up to three digits, so that the remedy of an error passes when it is
    typed back in.
    """
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
        return {
            "at most": "<=",
            "below": "<",
            "at least": ">=",
            "exactly": "=",
        }[self.relation]

    @property
    def passed(self) -> bool:
        compare = {
            "at most": operator.le,
            "below": operator.lt,
            "at least": operator.ge,
            "exactly": operator.eq,
        }
        return bool(compare[self.relation](self.value, self.limit))

    @property
    def margin_percent(self) -> float:
        """Distance of the value from its limit, in percent of the limit.

        It is infinite where that has no meaning.
        """
        above = self.value - self.limit if self.relation == "at least" else self.limit - self.value
        return (
            math.inf
            if self.relation == "exactly" or not self.limit
            else 100.0 * above / abs(self.limit)
        )
