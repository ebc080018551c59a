"""Axes of a sweep: one swept parameter each, with listed values, a stepped range, or an interval to
sample.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fingertip.foundation.errors import Issue

Value: TypeAlias = float | int | bool | str
Spacing: TypeAlias = Literal["linear", "logarithmic"]
_DIGITS = 9
"""Significant digits of a computed value.
The last bits of a logarithm differ between processors.
"""
_POWERS = np.array([float(f"1e{exponent}") for exponent in range(309)])
"""Powers of ten, each the float nearest to its decimal."""


@dataclass(frozen=True)
class Axis:
    """Swept parameter, and where its values come from.

    Numbers are in the unit of the parameter.
    """

    name: str
    """Dotted name of the parameter."""
    listed: tuple[Value, ...] = ()
    """Values of a list; empty for a range."""
    low: float = 0.0
    """Low end of a range, which belongs to it."""
    high: float = 0.0
    """High end of a range, which belongs to it."""
    steps: int = 0
    """Number of values of a range on a grid; 0 for an interval that a sampler draws from."""
    spacing: Spacing = "linear"
    """Spacing of the values of a range."""
    integer: bool = False
    """True for a whole number."""

    @property
    def count(self) -> int:
        """Number of values of a list or of a stepped range, without making them.

        0 for an interval.
        """
        return len(self.listed) or self.steps

    @cached_property
    def values(self) -> tuple[Value, ...]:
        """Every value of a list or of a stepped range; empty for an interval."""
        if self.listed:
            return self.listed

        fractions = np.arange(self.steps) / max(1, self.steps - 1)
        return tuple(self._interpolate(fractions).tolist())

    @cached_property
    def array(self) -> NDArray[Any]:
        """Every value as an array, of Python objects where texts and numbers are mixed."""
        are_texts = [isinstance(value, str) for value in self.values]
        is_mixed = any(are_texts) and not all(are_texts)

        return np.array(self.values, dtype=object if is_mixed else None)

    def restore_type(self, stored: Any) -> Value:
        """Return a value of the database with its type; flags are stored as whole numbers."""
        if self.listed and all(isinstance(value, bool) for value in self.listed):
            return bool(stored)

        value: Value = stored
        return value

    def sample(self, fractions: NDArray[np.float64]) -> NDArray[Any]:
        """Map fractions in [0, 1) to values.

        Each value of a list or of a stepped range takes an equal part of the fractions; an interval
        is interpolated.
        """
        if self.values:
            indices = (fractions * len(self.values)).astype(np.int64)
            return self.array[np.minimum(indices, len(self.values) - 1)]

        if self.integer and self.spacing == "linear":
            # Every integer, the ends too, has the same probability.
            offsets = np.floor(fractions * (self.high - self.low + 1.0))
            return (self.low + offsets).astype(np.int64)

        return self._interpolate(fractions)

    def _interpolate(self, fractions: NDArray[np.float64]) -> NDArray[Any]:
        """Interpolate between the ends of a range, from 0 at the low end to 1 at the high one."""
        if self.spacing == "logarithmic":
            exact = self.low * (self.high / self.low) ** fractions
        else:
            exact = self.low + (self.high - self.low) * fractions

        exact = np.clip(exact, self.low, self.high)
        if self.integer:
            return np.round(exact).astype(np.int64)

        return round_significant(exact)


def round_significant(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Round to `_DIGITS` significant digits; each result is the float nearest to its decimal."""
    with np.errstate(divide="ignore"):
        decimals = _DIGITS - 1 - np.floor(np.log10(np.abs(values)))

    # Zero has no first digit. The smallest floats have more decimals than there are powers of ten.
    decimals = np.where(np.isfinite(decimals), decimals, 0.0)
    max_power = len(_POWERS) - 1
    places = np.clip(decimals, -max_power, max_power).astype(np.int64)

    # One of the two powers is 1: a division by a power is exact where a product with 0.1 is not.
    multiplier = _POWERS[np.maximum(places, 0)]
    divisor = _POWERS[np.maximum(-places, 0)]
    rounded = np.round(values * multiplier / divisor)
    result: NDArray[np.float64] = rounded * divisor / multiplier

    return result


def find_repeats(axis: Axis) -> list[Issue]:
    """Find an axis of whole numbers whose range has fewer of them than steps. Makes its values."""
    if axis.listed or len(set(axis.values)) == len(axis.values):
        return []

    maximum = int(axis.high) - int(axis.low) + 1
    message = (
        f"{axis.steps} steps repeat a whole number; give at most {maximum}, or list the values."
    )
    return [Issue(f"axes.{axis.name}.steps", message)]
