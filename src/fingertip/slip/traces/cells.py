"""Cells of a line of text: splitting, and parsing of numbers and of times as ISO 8601 writes them."""

from __future__ import annotations

import datetime

DELIMITERS = (",", ";", "\t")
SPACES = " "
"""Delimiter of columns that one or more spaces separate."""


def split_cells(line: str, delimiter: str) -> list[str]:
    """Split a line into its cells, with the spaces and quotes around them."""
    return line.split() if delimiter == SPACES else line.rstrip("\r\n").split(delimiter)


def unquote(cell: str) -> str:
    """Remove spaces and the quotes that some programs write around every cell."""
    return cell.strip().strip('"')


def is_number(cell: str) -> bool:
    """Return whether a cell contains a number, with a decimal point or a decimal comma."""
    try:
        float(cell.replace(",", "."))
    except ValueError:
        return False
    return True


def is_value(cell: str) -> bool:
    """Return whether a cell contains a number, or a time in ISO 8601."""
    return is_number(cell) or parse_instant(cell) is not None


def parse_instant(cell: str) -> datetime.datetime | None:
    """Parse a date with time, or a time of day, as ISO 8601 writes them; None for anything else.

    A time of day has an arbitrary date. Digits below a microsecond are cut off.
    """
    text = unquote(cell)
    if ":" not in text:  # a bare date, or a whole number, which would be read as one
        return None
    try:
        return datetime.datetime.fromisoformat(text)
    except ValueError:
        pass
    try:
        return datetime.datetime.combine(datetime.date(2000, 1, 1), datetime.time.fromisoformat(text))
    except ValueError:
        return None


def count_decimals(cell: str) -> int:
    """Count the digits behind the decimal point or comma of a number."""
    _, _, decimals = unquote(cell).replace(",", ".").partition(".")
    return len(decimals)
