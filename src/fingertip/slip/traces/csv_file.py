"""CSV files of traces: one line that names the columns, then one sample per line.

The delimiter is a comma, a semicolon or a tab. Lines that a program wrote above the header are skipped.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fingertip.arrays import Array
from fingertip.design.issues import suggest_name
from fingertip.errors import Issue, TraceError
from fingertip.slip.traces.guess_columns import is_number, suggest_options
from fingertip.slip.traces.trace import COLUMNS, ColumnMap, RawTrace, Trace

DELIMITERS = (",", ";", "\t")
MAX_PREAMBLE = 200
"""Maximum number of lines above the header (LabVIEW writes some 25)."""

_SEPARATOR = re.compile(r'"?sep=.?"?', re.IGNORECASE)
"""First line of a spreadsheet's export."""
_UNIT = re.compile(r'"?[\[(]?(s|ms|us|µs|sec|seconds?|v|mv|volts?|n|newtons?|hz|counts?|-|)[\])]?"?', re.IGNORECASE)
_NOT_TEXT = "is not a text file; a trace is a CSV file with the columns time_s,voltage_v."


@dataclass(frozen=True)
class Header:
    """Line that names the columns."""

    names: tuple[str, ...]
    """Names of the columns. Those in the `ColumnMap` are spelt as there, whatever their case in the file."""
    delimiter: str
    line: int
    """Line number in the file, from 1."""

    def is_unit_line(self, line: str) -> bool:
        """Return whether the line below the header contains the columns' units instead of a first sample."""
        cells = [cell.strip() for cell in line.strip("\r\n").split(self.delimiter)]
        return len(cells) == len(self.names) and any(cells) and all(map(_UNIT.fullmatch, cells))

    def count_cells(self, first: int, columns: ColumnMap) -> int:
        """Return how many cells each line must have, given the number in the first line.

        It is the number of names, or fewer where a program omits the last cells (LabVIEW's comments) and none of those
        belongs to the trace.
        """
        minimum = 1 + max(self.names.index(name) for name in map(columns.name_in_file, COLUMNS) if name in self.names)
        return first if minimum <= first < len(self.names) else len(self.names)


def to_csv(trace: Trace) -> bytes:
    """Write a trace as CSV with fixed decimals, so that the same numbers give the same bytes.

    Time has a resolution of 0.1 us, voltage of 1 uV (one step of the 16-bit ADC is 305 uV), force of 1 uN.
    """
    columns = [
        [f"{value:.7f}" for value in trace.time_s.tolist()],
        [f"{value:.6f}" for value in trace.voltage_v.tolist()],
    ]
    names = ["time_s", "voltage_v"]
    if trace.force_n is not None:
        columns.append([f"{value:.6f}" for value in trace.force_n.tolist()])
        names.append("force_n")
    if trace.slip is not None:
        columns.append(["1" if value else "0" for value in trace.slip.tolist()])
        names.append("slip")
    lines = [",".join(names), *map(",".join, zip(*columns, strict=True))]
    return ("\n".join(lines) + "\n").encode("ascii")


def read_csv(path: Path, columns: ColumnMap) -> RawTrace:
    """Read a CSV file in UTF-8, or in UTF-16 with a byte order mark.

    With another delimiter than the comma, numbers may have a decimal comma.

    Raises
    ------
    TraceError
        If the file cannot be read, or has no header with the required columns.
    """
    name = str(path)
    try:
        encoding = _detect_encoding(path)
        with path.open(encoding=encoding) as file:
            header = find_header(name, file, columns)
            below = file.readline()
    except UnicodeError:
        raise TraceError(Issue(name, _NOT_TEXT)) from None
    except OSError as error:
        raise TraceError(Issue(name, f"cannot be read ({error.strerror}); give the path of a trace.")) from None
    first_line = header.line + (2 if header.is_unit_line(below) else 1)
    fast = _read_valid(path, encoding, header, first_line, columns)
    return fast or _read_by_line(path, encoding, header, first_line, columns)


def _detect_encoding(path: Path) -> str:
    """Return UTF-16 for a file that begins with its byte order mark, otherwise UTF-8. Raises OSError."""
    with path.open("rb") as file:
        return "utf-16" if file.read(2) in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig"


def _read_valid(path: Path, encoding: str, header: Header, first_line: int, columns: ColumnMap) -> RawTrace | None:
    """Read a file without any issue by numpy's reader; None if there may be one."""
    present = [column for column in COLUMNS if columns.name_in_file(column) in header.names]
    places = [header.names.index(columns.name_in_file(column)) for column in present]
    try:
        with path.open(encoding=encoding) as file, warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # of no data, which is reported as an issue
            table = np.loadtxt(file, delimiter=header.delimiter, skiprows=first_line - 1, comments=None, ndmin=2)
    except ValueError:
        return None
    if not len(table) or table.shape[1] != header.count_cells(table.shape[1], columns):
        return None
    if not np.isfinite(table[:, places]).all():
        return None
    values = {column: np.ascontiguousarray(table[:, place]) for column, place in zip(present, places, strict=True)}
    slip = values.get("slip")
    if slip is not None and not np.isin(slip, (0.0, 1.0)).all():
        return None
    trace = columns.make_trace(values)
    if (np.diff(trace.time_s) <= 0.0).any():
        return None  # the message names the line, and numpy skips empty lines
    return RawTrace(str(path), trace, first_line=first_line, in_volts=columns.in_volts)


def _read_by_line(path: Path, encoding: str, header: Header, first_line: int, columns: ColumnMap) -> RawTrace:
    """Read a file line by line and collect all issues."""
    name, issues = str(path), list[Issue]()
    try:
        lines = path.read_text(encoding=encoding).rstrip().splitlines()
    except UnicodeError:
        raise TraceError(Issue(name, _NOT_TEXT)) from None
    rows = [line.split(header.delimiter) for line in lines[first_line - 1 :]]

    # Lines with a wrong number of cells are replaced by placeholders, so that the others are still validated.
    width = header.count_cells(len(rows[0]), columns) if rows else 0
    uneven = [i for i, row in enumerate(rows) if len(row) != width]
    if uneven:
        first = uneven[0]
        others = f" (and {len(uneven) - 1} more such lines)" if len(uneven) > 1 else ""
        message = f"has {len(rows[first])} cells, but the header has {len(header.names)}{others}"
        issues.append(Issue(f"{name}, line {first_line + first}", f"{message}; each line must have one per column."))
        for i in uneven:
            rows[i] = ["0"] * width

    has_all_times = not uneven
    values: dict[str, Array] = {}
    for column in COLUMNS:
        if columns.name_in_file(column) in header.names:
            cells = [row[header.names.index(columns.name_in_file(column))] for row in rows]
            if header.delimiter != ",":
                values[column], wrong = _parse_numbers([cell.replace(",", ".") for cell in cells])
            else:
                values[column], wrong = _parse_numbers(cells)
            if wrong and not unquote(cells[wrong[0]]):
                message = f"is missing in line {first_line + wrong[0]}{_count_others(wrong)}"
                issues.append(Issue(f"{name}, {column}", f"{message}; fill it in, such as with the value before it."))
            elif wrong:
                value = f"{cells[wrong[0]].strip()!r} in line {first_line + wrong[0]}"
                message = f"{value} is not a number{_count_others(wrong)}; write it with a decimal point."
                issues.append(Issue(f"{name}, {column}", message))
            if wrong and column == "time_s":
                has_all_times = False

    slip = values.get("slip")
    if slip is not None:
        wrong = np.flatnonzero((slip != 0.0) & (slip != 1.0)).tolist()
        if wrong:
            value = f"{slip[wrong[0]]:g} in line {first_line + wrong[0]}"
            issues.append(Issue(f"{name}, slip", f"{value} is neither 0 nor 1{_count_others(wrong)}; write 0 or 1."))
    return RawTrace(name, columns.make_trace(values), tuple(issues), first_line, has_all_times, columns.in_volts)


def _parse_numbers(cells: Sequence[str]) -> tuple[Array, list[int]]:
    """Parse cells, quoted or not; return 0 for those that are not numbers, with their indices. NaN is accepted here."""
    values, wrong = [], []
    for i, cell in enumerate(cells):
        try:
            values.append(float(unquote(cell)))
        except ValueError:
            values.append(0.0)
            wrong.append(i)
    return np.array(values, dtype=np.float64), wrong


def _count_others(places: Sequence[int]) -> str:
    return f" (and {len(places) - 1} more)" if len(places) > 1 else ""


def unquote(cell: str) -> str:
    """Remove spaces and the quotes that some programs write around every cell."""
    return cell.strip().strip('"')


def find_header(name: str, lines: Iterable[str], columns: ColumnMap, *alternatives: ColumnMap) -> Header:
    """Find the first line that names the columns that a trace requires.

    Empty lines, a spreadsheet's `sep=;` and any other lines above are skipped, up to the first line of numbers. The
    header may be a comment.

    Parameters
    ----------
    name
        Name of the trace in the messages.
    lines
        Lines of the file from its beginning; none beyond the header is taken.
    columns, alternatives
        Columns to look for; the header must match one of these maps.

    Raises
    ------
    TraceError
        If no line names the required columns, or one names them twice.
    """
    skipped: list[tuple[int, str]] = []
    for number, line in enumerate(lines, start=1):
        text = line.lstrip("\ufeff") if number == 1 else line
        if "\0" in text:  # UTF-16 without a byte order mark
            raise TraceError(Issue(name, _NOT_TEXT))
        is_comment = text.lstrip().startswith("#")
        text = text.lstrip().lstrip("#") if is_comment else text
        for candidate in (columns, *alternatives):
            cells, delimiter = _split(text, candidate)
            if all(candidate.name_in_file(column) in cells for column in candidate.required):
                if duplicates := _duplicate_issues(f"{name}, line {number}", cells, candidate):
                    raise TraceError(duplicates)
                return Header(tuple(cells), delimiter, number)
        if not is_comment and text.strip() and not _SEPARATOR.fullmatch(text.strip()):
            skipped.append((number, text))
            if _count_numbers(text) or len(skipped) == MAX_PREAMBLE:
                break
    if not skipped:
        message = f"is empty; a trace is a CSV file with the columns {_join_required(columns)}."
        raise TraceError(Issue(name, message))
    raise TraceError(_header_issues(name, *_find_likely_header(skipped), columns))


def _join_required(columns: ColumnMap) -> str:
    return ",".join(map(columns.name_in_file, columns.required))


def _split(line: str, columns: ColumnMap) -> tuple[list[str], str]:
    """Split a line at the delimiter that gives the most known names; return the cells and the delimiter."""
    split = {d: _normalise_case(_split_at(line, d), columns) for d in DELIMITERS}
    known = set(map(columns.name_in_file, COLUMNS))
    delimiter = max(DELIMITERS, key=lambda d: len(known & set(split[d])))
    return split[delimiter], delimiter


def _split_at(line: str, delimiter: str) -> list[str]:
    return [unquote(cell) for cell in line.strip("\r\n").split(delimiter)]


def _split_at_each(line: str) -> list[list[str]]:
    return [_split_at(line, delimiter) for delimiter in DELIMITERS]


def _split_most(line: str) -> list[str]:
    """Split a line at the delimiter that gives the most cells."""
    return max(_split_at_each(line), key=lambda cells: len(cells))


def _normalise_case(cells: list[str], columns: ColumnMap) -> list[str]:
    """Replace a name that differs from a known one in its case only, if there is no other such name."""
    for known in map(columns.name_in_file, COLUMNS):
        matches = [i for i, cell in enumerate(cells) if cell.casefold() == known.casefold()]
        if len(matches) == 1:
            cells[matches[0]] = known
    return cells


def _count_numbers(line: str) -> int:
    """Count the numbers in a line that contains nothing else; 0 for any other line."""
    return max(len(cells) if all(map(is_number, cells)) else 0 for cells in _split_at_each(line))


def _find_likely_header(skipped: Sequence[tuple[int, str]]) -> tuple[int, str]:
    """Find the line most likely intended as header: above the first numbers, with as many cells."""
    count = _count_numbers(skipped[-1][1])
    if not count or len(skipped) == 1:
        return skipped[0]
    above = [entry for entry in skipped[:-1] if not all(map(_UNIT.fullmatch, _split_most(entry[1])))]
    same_count = [entry for entry in above if count in map(len, _split_at_each(entry[1]))]
    return (same_count or above or skipped)[-1]


def _header_issues(name: str, number: int, line: str, columns: ColumnMap) -> list[Issue]:
    """Say why a line is not a header, with the remedy."""
    cells, _ = _split(line, columns)
    field = f"{name}, line {number}"
    if not set(cells) & set(map(columns.name_in_file, COLUMNS)):
        cells = _split_most(line)
        start = ",".join(cells)[:60]
        if all(columns.name_in_file(column) in line for column in columns.required):
            message = f"{start!r} does not separate its names by comma, semicolon or tab; use one of these."
        else:
            options = suggest_options(cells, columns)
            message = f"{start!r} is not the header of a trace; it must name {_join_required(columns)}"
            message += f"; or {options}." if options else "."
        return [Issue(field, message)]
    missing = [column for column in columns.required if columns.name_in_file(column) not in cells]
    issues = []
    for column in missing:
        remedy = suggest_name(columns.name_in_file(column), cells)
        if column == "time_s":
            remedy += " Or give --rate-hz if the file has no times."
        if column == missing[-1] and (options := suggest_options(cells, columns)):
            remedy += f" Or {options}."
        issues.append(Issue(field, f"there is no column {columns.name_in_file(column)}; {remedy}"))
    return [*issues, *_duplicate_issues(field, cells, columns)]


def _duplicate_issues(field: str, cells: Sequence[str], columns: ColumnMap) -> list[Issue]:
    return [
        Issue(field, f"the column {known} appears {cells.count(known)} times; keep one.")
        for known in map(columns.name_in_file, COLUMNS)
        if cells.count(known) > 1
    ]
