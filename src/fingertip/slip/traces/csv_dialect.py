"""Header of a CSV file: the line that names the columns, or the first line of numbers if they are given by number.

The delimiter is a comma, a semicolon, a tab or spaces. Lines that a program wrote above the header are skipped.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from fingertip.design.parameters.declaration import suggest_name
from fingertip.foundation.errors import Issue, TraceError, raise_issues
from fingertip.slip.traces.columns import (
    DELIMITERS,
    SPACES,
    is_value,
    split_cells,
    suggest_numbers,
    suggest_options,
    unquote,
)
from fingertip.slip.traces.trace import COLUMNS, ColumnMap

MAX_PREAMBLE = 200
"""Maximum number of lines above the header (LabVIEW writes some 25)."""
MAX_CELLS = 10_000
"""Maximum number of columns by whose number one can be chosen."""
MAX_SAMPLES_ABOVE = 5000
"""Maximum number of samples above the header, which a controller repeats each second."""
NOT_TEXT = "is not a text file; a trace is a CSV file with the columns time_s,voltage_v."

_SEPARATOR = re.compile(r'"?sep=.?"?', re.IGNORECASE)
"""First line of a spreadsheet's export."""
_UNIT = re.compile(r'"?[\[(]?(s|ms|[uµμ]s|ns|sec|seconds?|v|mv|volts?|n|newtons?|hz|counts?|-|)[\])]?"?', re.IGNORECASE)


@dataclass(frozen=True)
class Header:
    names: tuple[str, ...]
    """Names of the columns. Those in the `ColumnMap` are spelt as there, whatever their case in the file."""
    delimiter: str
    line: int
    """Line number in the file, from 1; 0 if the columns are numbers and the first line holds them already."""
    text: str = ""
    """The line itself, by which a header that is repeated among the samples is known."""
    is_loose: bool = False
    """True if lines may have other numbers of cells, as in LabVIEW's files, whose comments are the last cell."""
    has_samples_above: bool = False
    """True if samples stand above it, as where a recording of a controller begins while it runs already."""

    def is_repeated(self, line: str) -> bool:
        """Return whether a line among the samples is this header again."""
        return bool(self.text) and _strip_comment(line) == self.text

    def is_unit_line(self, line: str) -> bool:
        """Return whether the line below the header contains the columns' units instead of a first sample."""
        cells = [cell.strip() for cell in split_cells(line, self.delimiter)]
        return len(cells) == len(self.names) and any(cells) and all(map(_UNIT.fullmatch, cells))

    def count_cells(self, first: int, columns: ColumnMap) -> int:
        """Return how many cells each line must have: a program may omit last ones that no column of a trace takes."""
        minimum = 1 + max(self.names.index(name) for name in map(columns.name_in_file, COLUMNS) if name in self.names)
        return first if minimum <= first < len(self.names) else len(self.names)


def find_header(name: str, lines: Iterable[str], columns: ColumnMap, *alternatives: ColumnMap) -> Header:
    """Find the first line that names the columns that a trace requires.

    Empty lines, a spreadsheet's `sep=;` and any other lines above are skipped, and up to `MAX_SAMPLES_ABOVE` lines from
    the first line of numbers on. The header may be a comment. Where all required columns are given by number, the
    first line that has numbers there, or times, is the first sample. Raises TraceError.
    """
    skipped: list[tuple[int, str]] = []
    above = 0
    for number, line in enumerate(lines, start=1):
        text = line.lstrip("\ufeff") if number == 1 else line
        if "\0" in text:  # UTF-16 without a byte order mark
            raise TraceError(Issue(name, NOT_TEXT))
        is_comment = text.lstrip().startswith("#")
        text = text.lstrip().lstrip("#") if is_comment else text
        for candidate in (columns, *alternatives):
            if not is_comment and (found := _match_numbers(text, candidate)):
                before = skipped[-1][1] if skipped else ""
                return Header(*found, number - 1, _strip_comment(before))
            cells, delimiter = _split(text, candidate)
            if all(candidate.name_in_file(column) in cells for column in candidate.required):
                raise_issues(TraceError, _duplicate_issues(f"{name}, line {number}", cells, candidate))
                return Header(tuple(cells), delimiter, number, _strip_comment(text), has_samples_above=above > 0)
        if not is_comment and text.strip() and not _SEPARATOR.fullmatch(text.strip()):
            if not above:  # the lines from the first sample on say nothing of a header above it
                skipped.append((number, text))
            above += above > 0 or _count_numbers(text) > 0
            if above == MAX_SAMPLES_ABOVE or (not above and len(skipped) == MAX_PREAMBLE):
                break
    if not skipped:
        message = f"is empty; a trace is a CSV file with the columns {_join_required(columns)}."
        raise TraceError(Issue(name, message))
    raise TraceError(_header_issues(name, *_find_likely_header(skipped), columns))


def _strip_comment(line: str) -> str:
    return line.lstrip("\ufeff").strip().lstrip("#").strip()


def _match_numbers(line: str, columns: ColumnMap) -> tuple[tuple[str, ...], str] | None:
    """Match a line with values in the required columns. The comma comes late: it may be a decimal comma."""
    names = [columns.name_in_file(column) for column in columns.required]
    if not all(map(str.isdecimal, names)):
        return None
    required = [int(name) for name in names]
    if not 1 <= min(required) <= max(required) <= MAX_CELLS:
        return None
    for delimiter in ("\t", ";", ",", SPACES):
        cells = _split_at(line, delimiter)
        if len(cells) >= max(required) and all(is_value(cells[number - 1]) for number in required):
            return tuple(str(i) for i in range(1, len(cells) + 1)), delimiter
    return None


def _join_required(columns: ColumnMap) -> str:
    return ",".join(map(columns.name_in_file, columns.required))


def _split(line: str, columns: ColumnMap) -> tuple[list[str], str]:
    """Split a line at the delimiter that gives the most known names, by name or else by number."""
    split = {d: _normalise_case(_split_at(line, d), columns) for d in (*DELIMITERS, SPACES)}
    known = set(map(columns.name_in_file, COLUMNS))
    delimiter = max(split, key=lambda d: len(known & set(split[d])))
    cells = split[delimiter]
    if known & set(cells):
        for number in known - set(cells):
            if number.isdecimal() and 0 < int(number) <= len(cells):
                cells[int(number) - 1] = number
    return cells, delimiter


def _split_at(line: str, delimiter: str) -> list[str]:
    return [unquote(cell) for cell in split_cells(line, delimiter)]


def _split_at_each(line: str) -> list[list[str]]:
    return [_split_at(line, delimiter) for delimiter in DELIMITERS]


def _split_most(line: str) -> list[str]:
    return max(_split_at_each(line), key=lambda cells: len(cells))


def _normalise_case(cells: list[str], columns: ColumnMap) -> list[str]:
    """Replace a name that differs from a known one in its case only, if there is no other such name.

    Exact names win: a cell that is a known name as it stands, such as `force_N` after `--column voltage_v=force_N`, is
    that column and no other.
    """
    names = list(map(columns.name_in_file, COLUMNS))
    for known in names:
        matches = [i for i, cell in enumerate(cells) if cell.casefold() == known.casefold()]
        if len(matches) == 1 and cells[matches[0]] not in names:
            cells[matches[0]] = known
    return cells


def _count_numbers(line: str) -> int:
    """Count the numbers and times in a line that contains nothing else; 0 for any other line."""
    return max(len(cells) if all(map(is_value, cells)) else 0 for cells in _split_at_each(line))


def _find_likely_header(skipped: Sequence[tuple[int, str]]) -> tuple[int, str]:
    """Find the line most likely intended as header: above the first numbers, with as many cells."""
    count = _count_numbers(skipped[-1][1])
    if not count or len(skipped) == 1:
        return skipped[0]
    above = [entry for entry in skipped[:-1] if not all(map(_UNIT.fullmatch, _split_most(entry[1])))]
    same_count = [entry for entry in above if count in map(len, _split_at_each(entry[1]))]
    return (same_count or above or skipped)[-1]


_LABELLED = re.compile(r"\s*[A-Za-z_]\w*:\s*[-+.\d]")


def _find_bare_remedy(line: str) -> str | None:
    """Say how to strip what a controller's monitor or plotter writes before each number; None for other lines."""
    if " -> " in line:
        return "it has the monitor's time stamp; remove that with: sed 's/^.* -> //' FILE > bare.csv"
    if all(_LABELLED.match(cell) for cell in re.split(r"[,;\t]", line)):
        return "it has a label before each number; remove them with: sed 's/[A-Za-z_]*: *//g' FILE > bare.csv"
    return None


def _header_issues(name: str, number: int, line: str, columns: ColumnMap) -> list[Issue]:
    cells, _ = _split(line, columns)
    field = f"{name}, line {number}"
    if not set(cells) & set(map(columns.name_in_file, COLUMNS)):
        cells = _split_most(line)
        start = ",".join(cells)[:60]
        if bare := _find_bare_remedy(line):
            message = f"{start!r} is not the header of a trace; {bare}."
        elif count := _count_numbers(line) or _count_numbers(SPACES.join(line.split()).replace(SPACES, DELIMITERS[0])):
            message = f"{start!r} is not the header of a trace; {suggest_numbers(count, columns)}."
        elif all(columns.name_in_file(column) in line for column in columns.required):
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
