"""Numbers of a validation as text and as data for JSON, and those that its text takes from a file."""

from __future__ import annotations

import json
import math
import tomllib
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

ONSETS: Mapping[str, Any] = tomllib.loads(Path(__file__).with_name("onsets.toml").read_text(encoding="utf-8"))
"""Times before gross slip in the article's trials [ms], which ``tools/onsets.py`` measures."""

BESIDE_ARTICLE: Mapping[str, Any] = json.loads(Path(__file__).with_name("beside_article.json").read_bytes())
"""Figures of the article's finger and board under all laws, which ``tools/beside_article.py`` measures."""


def format_ms(seconds: float, otherwise: str = "missed", form: str = ".1f", unit: str = " ms") -> str:
    """Format a time in milliseconds; another text stands for one that is not finite."""
    return f"{1000 * seconds:{form}}{unit}" if math.isfinite(seconds) else otherwise


def format_mn(newtons: float) -> str:
    return f"{1000 * newtons:.1f} mN" if math.isfinite(newtons) else "no slip"


def format_mv(volts: float) -> str:
    """Format a voltage in millivolts, without the unit."""
    return f"{1000 * volts:{'.0f' if volts >= 0.1 else '.2g'}}" if math.isfinite(volts) else "-"


def format_milli(value: float, signal: str) -> str:
    """Format a value of a signal in thousandths of its unit, which its name ends with."""
    return f"{1000 * value:.3f} m{signal.rpartition('_')[2].upper()}"


def to_number(value: float) -> float | None:
    """Round a number for JSON; None stands for one that is not finite."""
    return round(value, 7) if math.isfinite(value) else None


def to_data(row: DataclassInstance, decimals: Mapping[str, int] | None = None) -> dict[str, Any]:
    """Fields of a row by name, rounded, some of them to fewer decimals; None stands for what is not finite."""
    data = {field.name: getattr(row, field.name) for field in fields(row)}
    data |= {name: to_number(value) for name, value in data.items() if isinstance(value, float)}
    return data | {name: round(getattr(row, name), count) for name, count in (decimals or {}).items()}
