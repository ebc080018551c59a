"""Comparison of a value with its limit: what checks of parts, conditions of a board and requirements have in common."""

from __future__ import annotations

import operator
from dataclasses import dataclass
from typing import Literal

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
