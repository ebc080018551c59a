"""Numbers of a validation as text and as data for JSON, and those that its text takes from a file."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

ONSETS: Mapping[str, Any] = tomllib.loads(Path(__file__).with_name("onsets.toml").read_text(encoding="utf-8"))
"""Times before gross slip in the article's trials [ms], which ``tools/onsets.py`` measures."""


def format_ms(seconds: float, otherwise: str = "missed", form: str = ".1f", unit: str = " ms") -> str:
    """Format a time in milliseconds; another text stands for one that is not finite."""
    return f"{1000 * seconds:{form}}{unit}" if math.isfinite(seconds) else otherwise


def to_number(value: float) -> float | None:
    """Round a number for JSON; None stands for one that is not finite."""
    return round(value, 7) if math.isfinite(value) else None
