"""Cells of a recording's lines: splitting, parsing, and lines that name their values."""

from __future__ import annotations

import contextlib
import csv
import datetime
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

# Cells of a line of text: splitting, and parsing of numbers and of times as ISO 8601 writes them.

DELIMITERS = (",", ";", "\t")
SPACES = " "
"""Delimiter of columns that one or more spaces separate."""


def split_cells(line: str, delimiter: str) -> list[str]:
    """Split a line into its cells, with the spaces around them.

    A quoted cell may hold the delimiter.
    """
    if delimiter == SPACES:
        return line.split()

    line = line.rstrip("\r\n")
    if '"' in line and delimiter in line:
        with contextlib.suppress(csv.Error, StopIteration):  # of a cell that is too long
            return next(csv.reader([line], delimiter=delimiter, skipinitialspace=True))

    return line.split(delimiter)


def split_plain(line: str, delimiter: str) -> list[str]:
    """Split a line into its cells, without the spaces and quotes around them."""
    return [unquote(cell) for cell in split_cells(line, delimiter)]


def unquote(cell: str) -> str:
    """Remove spaces and the quotes that some programs write around every cell."""
    return cell.strip().strip('"')


_PREFIXES = {
    "m": 1e-3,
    "u": 1e-6,
    "µ": 1e-6,
    "μ": 1e-6,
    "n": 1e-9,
    "k": 1e3,
}
_QUANTITY = re.compile(r"([-+]?[\d.,]+)([eE][-+]?\d+)?\s*(?:([munkµμ]?)(?:V|v|Volts?|s|N|Hz))?")
_THOUSANDS = re.compile(r"[-+]?\d{1,3}(?:[.,]\d{3})+")
_OVER_RANGE = re.compile(r"[*#]+|-{2,}|[-+]?(ol|ovl?d?|over\w*|clip\w*)", re.IGNORECASE)


def parse_number(cell: str) -> float | None:
    """Parse a number with a decimal point or comma, marks of thousands, and a unit; else None.

    Of two kinds of marks, the last one is the decimal. A prefix of the unit is a factor: 12 mV is
    0.012.
    """
    try:
        return float(cell)
    except ValueError:
        plain = unquote(cell)

    if plain != cell:
        return parse_number(plain)

    match = _QUANTITY.fullmatch(plain)
    if not match:
        return None

    digits, power, prefix = match.groups()
    whole, mark, decimals = re.fullmatch(r"(.*?)(?:([.,])([^.,]*))?", digits).groups("")  # type: ignore[union-attr]
    if mark in whole and mark:  # a mark that is repeated separates thousands
        whole = digits
        decimals = ""

    if ("," in whole or "." in whole) and not _THOUSANDS.fullmatch(whole):
        return None

    try:
        value = float(f"{re.sub('[.,]', '', whole)}.{decimals}{power or ''}")
        return value * _PREFIXES.get(prefix, 1.0)
    except ValueError:
        return None


def is_over_range(cell: str) -> bool:
    """Return whether a cell marks that the signal left an instrument's range."""
    return _OVER_RANGE.fullmatch(unquote(cell)) is not None


def is_value(cell: str) -> bool:
    """Return whether a cell contains a number, or a time in ISO 8601."""
    return parse_number(cell) is not None or parse_instant(cell) is not None


def parse_instant(cell: str) -> datetime.datetime | None:
    """Parse a date with time, or a time of day (on an arbitrary date), in ISO 8601; else None."""
    text = unquote(cell)
    if ":" not in text:  # a bare date, or a whole number, which would be read as one
        return None

    try:
        return datetime.datetime.fromisoformat(text)
    except ValueError:
        pass

    try:
        return datetime.datetime.combine(
            datetime.date(2000, 1, 1), datetime.time.fromisoformat(text)
        )
    except ValueError:
        return None


# Lines that name each value, as plotters and serial monitors write them.

_NAMED = re.compile(r"\s*(.* -?> .*|[A-Za-z_][^,;\t:=]*[:=]\s*[-+.\d].*)\s*")
"""Line that names each value, or that begins with a monitor's time stamp."""
_NAME = re.compile(r"(^.* -?> )|[A-Za-z_][A-Za-z_0-9 .]*[:=] *")


# LabVIEW's measurement files (LVM): a header, and one more above each segment; both end with the
# same line.
#
# Reference: National Instruments, "Specification for the LabVIEW Measurement File (.lvm)".

LABVIEW = "LabVIEW Measurement"
_SEGMENT = "Channels"
_END = "***End_of_Header***"


def plain_labview(lines: Iterable[str]) -> Iterator[str]:
    """Yield the names and samples of a LabVIEW file, without segment headers and comments."""
    width = 0
    is_header = True

    for line in lines:
        is_header = is_header or line.startswith(_SEGMENT)
        if is_header or not line.strip():
            is_header = is_header and not line.startswith(_END)
            yield "\n" if width else line
            continue

        delimiter = "\t" if "\t" in line else ","
        cells = line.rstrip("\r\n").split(delimiter)
        width = width or (cells.index("Comment") if "Comment" in cells else len(cells))
        yield delimiter.join(cells[:width]) + line[len(line.rstrip("\r\n")) :]


def is_named(line: str) -> bool:
    """Return whether a line names its values, or begins with a monitor's time stamp."""
    return _NAMED.fullmatch(line) is not None


def bare_line(line: str) -> str:
    """Return a line without the names of its values."""
    return _NAME.sub("", line) if is_named(line) else line


def bare_lines(lines: Iterable[str]) -> Iterator[str]:
    """Yield lines without the names of their values."""
    return map(bare_line, lines)


@dataclass
class NotedLines:
    """Count of lines that are passed over or wrong, perhaps millions; and the first one."""

    count: int = 0
    first: tuple[int, str] | None = None
    """Number of the first line, and what is noted of it."""

    def add(self, line: int, what: str) -> None:
        self.count += 1
        self.first = self.first or (line, what)
