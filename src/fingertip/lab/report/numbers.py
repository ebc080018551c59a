"""Numbers of a validation as text and as data for JSON."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from _typeshed import DataclassInstance


def format_ms(seconds: float, otherwise: str = "missed", form: str = ".1f") -> str:
    """Format a time in milliseconds; another text stands for one that is not finite."""
    return f"{1000 * seconds:{form}} ms" if math.isfinite(seconds) else otherwise


def to_number(value: float) -> float | None:
    """Round a number for JSON; None stands for one that is not finite."""
    return round(value, 7) if math.isfinite(value) else None


def to_data(row: DataclassInstance, decimals: Mapping[str, int] | None = None) -> dict[str, Any]:
    """Fields of a row by name, rounded, some of them to fewer decimals; None stands for what is not finite."""
    data = {field.name: getattr(row, field.name) for field in fields(row)}
    data |= {name: to_number(value) for name, value in data.items() if isinstance(value, float)}
    return data | {name: round(getattr(row, name), count) for name, count in (decimals or {}).items()}
