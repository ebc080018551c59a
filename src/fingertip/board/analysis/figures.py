"""Figures for tables and texts: a few significant digits, without an exponent."""

from __future__ import annotations

import math


def format_figure(value: float, digits: int = 4) -> str:
    """Format a number with this many significant digits; zeros fill the places before the decimal point."""
    if not value or not math.isfinite(value):
        return f"{value + 0.0:g}"  # 0 has no sign
    decimals = digits - 1 - math.floor(math.log10(abs(float(f"{value:.{digits - 1}e}"))))
    return f"{round(value, decimals):.{max(decimals, 0)}f}"
