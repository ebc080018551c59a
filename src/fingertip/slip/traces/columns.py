"""Cells and columns of a recording's lines: parsing, guesses of what a trace requires, and LabVIEW's own names."""

from __future__ import annotations

import datetime
import re
import shlex
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Generic, TypeVar

from fingertip.foundation.errors import Issue, TraceError
from fingertip.slip.traces.trace import ColumnMap, is_force

T = TypeVar("T")

# Cells of a line of text: splitting, and parsing of numbers and of times as ISO 8601 writes them.

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


_TIME = re.compile(r"(time|zeit|timestamp|elapsed|seconds?|x_value|t)\b|.*([\[(]s[\])]|_s)$", re.IGNORECASE)
_VOLTAGE = re.compile(r".*(volt|[\[(]V[\])]|_v$)|(ai|ch|channel) ?\d", re.IGNORECASE)


def suggest_options(names: Sequence[str], columns: ColumnMap) -> str:
    """Suggest ``--column`` options for the required columns that a file's names do not contain."""
    candidates = [name for name in names if name and not is_number(name)]
    guesses: dict[str, str] = {}
    for column in columns.required:
        if columns.name_in_file(column) in candidates:
            candidates.remove(columns.name_in_file(column))
    for column, pattern in (("time_s", _TIME), ("voltage_v", _VOLTAGE)):
        if column in columns.required and columns.name_in_file(column) not in names and candidates:
            best = next((name for name in candidates if pattern.match(name)), None)
            if best is None and column == "time_s" and len(candidates) == 1:
                continue  # the only other column is the signal
            guess = best or candidates[0]
            candidates.remove(guess)
            if guess != column:  # a file that has this column needs no option
                guesses[column] = guess
    if not guesses:
        return ""
    options = [f"--column {column}={shlex.quote(name)}" for column, name in guesses.items()]
    if is_force(guesses.get("voltage_v", "")):
        reason = "a force has no threshold in volts: give the interval in which nothing happens"
        options.append(f"--calibrate 0:0.5 ({reason})")
    return f"name the file's column{'s' * (len(guesses) > 1)}: {' '.join(options)}"


def suggest_numbers(count: int, columns: ColumnMap) -> str:
    """Suggest the options that read a file without a header, whose lines have `count` cells."""
    by_name = [column for column in columns.required if not columns.name_in_file(column).isdecimal()]
    if by_name == ["time_s"] and "time_s" in columns.names:  # such as none
        return "the file has no header and its times are left out: give the sampling rate with --rate-hz, such as 2000"
    options = [f"--column {column}={number}" for number, column in enumerate(columns.required, 1)]
    if count < len(options):
        options = ["--rate-hz HZ", "--column voltage_v=1"]
    return f"the file has no header: give its columns by number, such as {' '.join(options)}"


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
            options = " or ".join(f"--column voltage_v={each!r}" for each in channels[:4])
            raise TraceError(Issue(name, f"holds {len(channels)} channels; choose one with {options}."))
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
    step_s = float(step) if is_number(step) else 0.0
    if not 0.0 < step_s < float("inf"):
        raise TraceError(Issue(name, f"has no times, and states the step {step!r} between samples; give --rate-hz."))
    return float(f"{1 / step_s:.9g}")


def _split(line: str) -> list[str]:
    """Split a line at its tabs, or at another delimiter if it has none."""
    delimiter = next((each for each in ("\t", *DELIMITERS) if each in line), "\t")
    return [cell.strip() for cell in line.split(delimiter)]
