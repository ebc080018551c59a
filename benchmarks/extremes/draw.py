"""Draws of one case, and what a family of cases is. A case depends on its family's name and its number alone."""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TypeVar

Option = TypeVar("Option")
Range = tuple[float, float]


@dataclass
class Draw:
    """Values of one case. Cases with even numbers stay inside the documented bounds, odd ones go beyond."""

    family: str
    number: int
    values: dict[str, object] = field(default_factory=dict)
    ranges: dict[str, tuple[Range, Range]] = field(default_factory=dict)
    """Name -> range of cases inside the bounds, and of those beyond."""

    def __post_init__(self) -> None:
        self.rng = random.Random(f"extremes:{self.family}:{self.number}")

    @property
    def is_inside(self) -> bool:
        return self.number % 2 == 0

    def log(self, name: str, inside: Range, beyond: Range | None = None) -> float:
        """Draw a value whose logarithm is uniform."""
        self.ranges[name] = inside, beyond or inside
        low, high = map(math.log, self.ranges[name][not self.is_inside])
        value = math.exp(self.rng.uniform(low, high))
        self.values[name] = value
        return value

    def choose(self, name: str, options: Sequence[Option]) -> Option:
        value = self.rng.choice(options)
        self.values[name] = value
        return value

    def describe(self) -> str:
        """Return the values as text, so that the case is known without a run."""
        return ", ".join(f"{k} {v:.3g}" if isinstance(v, float) else f"{k} {v}" for k, v in self.values.items())


@dataclass(frozen=True)
class Family:
    """Cases of one kernel. Work refuses a case by a FingertipError; any other exception is wrong."""

    name: str
    against: str
    """Reference of a case, and the bound of its deviation."""
    weight: float
    """Share of all cases, chosen by their cost."""
    deviate: Callable[[Draw], float]
    """Compute a case and return its largest deviation, in relation to the bound: up to 1 it is held."""
