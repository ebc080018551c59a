"""Cells and columns of a recording's lines: parsing, and LabVIEW's own names."""

from __future__ import annotations

import contextlib
import csv
import datetime
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Generic, TypeVar

from fingertip.foundation.errors import Issue, TraceError
from fingertip.slip.traces.trace import ColumnMap

T = TypeVar("T")

# Cells of a line of text: splitting, and parsing of numbers and of times as ISO 8601 writes them.

DELIMITERS = (",", ";", "\t")
SPACES = " "
"""Delimiter of columns that one or more spaces separate."""


def split_cells(line: str, delimiter: str) -> list[str]:
    """Split a line into its cells, with the spaces around them. A quoted cell may hold the delimiter."""
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


_PREFIXES = {"m": 1e-3, "u": 1e-6, "µ": 1e-6, "μ": 1e-6, "n": 1e-9, "k": 1e3}
_QUANTITY = re.compile(r"([-+]?[\d.,]+)([eE][-+]?\d+)?\s*(?:([munkµμ]?)(?:V|v|Volts?|s|N|Hz))?")
_THOUSANDS = re.compile(r"[-+]?\d{1,3}(?:[.,]\d{3})+")
_OVER_RANGE = re.compile(r"[*#]+|-{2,}|[-+]?(ol|ovl?d?|over\w*|clip\w*)", re.IGNORECASE)


def parse_number(cell: str) -> float | None:
    """Parse a number, quoted or not, with a decimal point or comma, marks of thousands, and a unit; else None.

    Of two kinds of marks, the last one is the decimal. A prefix of the unit is a factor: 12 mV is 0.012.
    """
    try:
        return float(cell)
    except ValueError:
        plain = unquote(cell)
    if plain != cell:
        return parse_number(plain)
    if not (found := _QUANTITY.fullmatch(plain)):
        return None
    digits, power, prefix = found.groups()
    whole, mark, decimals = re.fullmatch(r"(.*?)(?:([.,])([^.,]*))?", digits).groups("")  # type: ignore[union-attr]
    if mark in whole and mark:  # a mark that is repeated separates thousands
        whole, decimals = digits, ""
    if ("," in whole or "." in whole) and not _THOUSANDS.fullmatch(whole):
        return None
    try:
        return float(f"{re.sub('[.,]', '', whole)}.{decimals}{power or ''}") * _PREFIXES.get(prefix, 1.0)
    except ValueError:
        return None


def is_over_range(cell: str) -> bool:
    """Return whether a cell marks that the signal left an instrument's range."""
    return _OVER_RANGE.fullmatch(unquote(cell)) is not None


def is_value(cell: str) -> bool:
    """Return whether a cell contains a number, or a time in ISO 8601."""
    return parse_number(cell) is not None or parse_instant(cell) is not None


def parse_instant(cell: str) -> datetime.datetime | None:
    """Parse a date with time, or a time of day (then of an arbitrary date), as ISO 8601 writes them, else None."""
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


# LabVIEW's measurement files (LVM): the names of their columns, their times, and headers between their segments.
#
# Reference: National Instruments, "Specification for the LabVIEW Measurement File (.lvm)". A file has a header, and
# each segment another one; both end with `***End_of_Header***`. The names of the columns follow: `X_Value`, the
# channels, and `Comment`. Where the file has no column of times (`X_Columns No`), `Delta_X` is the step between
# samples.

LVM_HEADER_LINES = 200
TITLE = "LabVIEW Measurement"
_END = "***End_of_Header***"
_SEGMENT_KEYS = (
    "Channels", "Samples", "Date", "Time", "Y_Unit_Label", "X_Dimension", "X0", "Delta_X", "Notes", "Test_Name",
    "Test_Numbers", "Test_Series", "UUT_M/N", "UUT_Name", "UUT_S/N", "Y_Dimension", _END,
)  # fmt: skip
"""First cells of the lines in the header of a segment."""
_TIMES, _COMMENT = "X_Value", "Comment"


@dataclass
class NotedLines(Generic[T]):
    """Lines that are passed over or cannot be used, of which a file may hold millions: their number, first and last."""

    count: int = 0
    first: tuple[int, T] | None = None
    """Number of the first line, and what is noted of it."""
    last: tuple[int, T] | None = None

    def add(self, line: int, what: T) -> None:
        self.count += 1
        self.last = (line, what)
        self.first = self.first or self.last

    def drop_last(self, line: int) -> None:
        """Remove the last line if it has this number."""
        if self.last is not None and self.last[0] == line:
            self.count -= 1
            self.last = None  # the one before is not known, and nobody asks for it
            self.first = self.first if self.count else None


def adapt_columns(name: str, lines: Iterable[str], columns: ColumnMap) -> ColumnMap:
    """Fill in the names of an LVM file's columns that `columns` lacks; leave it for other files. Raises TraceError."""
    rows = iter(lines)
    if not next(rows, "").lstrip("\ufeff").startswith(TITLE):
        return columns
    settings: dict[str, list[str]] = {}
    names: list[str] = []
    for line in rows:
        cells = _split(line)
        if cells[0] == _TIMES:
            names = [cell for cell in cells if cell]
            break
        settings[cells[0]] = cells[1:]
    if not names:
        return columns  # a program has written columns of its own below the header
    added: dict[str, str] = {}
    if "voltage_v" not in columns.names and "voltage_v" not in names:
        channels = [each for each in names if each not in (_TIMES, _COMMENT)]
        if len(channels) != 1:
            listed = ", ".join(map(repr, channels[:4])) + ", ..." * (len(channels) > 4)
            message = f"holds {len(channels)} channels, {listed}; choose one with --column voltage_v=NAME."
            raise TraceError(Issue(name, message))
        added["voltage_v"] = channels[0]
    rate_hz = columns.rate_hz
    if "time_s" not in columns.names:
        added["time_s"] = _TIMES
        if settings.get("X_Columns", [""])[0] == "No":
            added["time_s"] = "no times"
            rate_hz = rate_hz or _read_rate(name, settings.get("Delta_X", []))
    return replace(columns, names={**columns.names, **added}, rate_hz=rate_hz)


def without_headers(rows: Iterable[tuple[int, str]], passed_over: NotedLines[str]) -> Iterator[tuple[int, str]]:
    """Yield numbered lines but those of the headers of segments, whose first line is added to `passed_over`."""
    within = False
    for number, line in rows:
        if line[:1].isalpha() or line.startswith(_END):
            first = _split(line)[0]
            if first in _SEGMENT_KEYS:
                if not within:
                    passed_over.add(number, line)
                within = first != _END
                continue
        yield number, line


def _read_rate(name: str, steps: Sequence[str]) -> float:
    step = steps[0].replace(",", ".") if steps else ""
    step_s = parse_number(step) or 0.0
    if not 0.0 < step_s < float("inf"):
        raise TraceError(Issue(name, f"has no times, and states the step {step!r} between samples; give --rate-hz."))
    return float(f"{1 / step_s:.9g}")


def _split(line: str) -> list[str]:
    """Split a line at its tabs, or at another delimiter if it has none."""
    delimiter = next((each for each in ("\t", *DELIMITERS) if each in line), "\t")
    return [cell.strip() for cell in line.split(delimiter)]
