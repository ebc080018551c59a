"""Header of a CSV file: the line with the column names, or the first line of numbers.

The delimiter is a comma, a semicolon, a tab or spaces. Lines that a program wrote above the header
are skipped.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from fingertip.design.parameters.declaration import suggest_name
from fingertip.foundation.errors import Issue, TraceError, raise_issues
from fingertip.slip.traces.cells import DELIMITERS, SPACES, is_value, split_plain
from fingertip.slip.traces.column_survey import SURVEYED_LINES, UNIT_WORD, survey_lines
from fingertip.slip.traces.trace import COLUMNS, ColumnMap

MAX_CELLS = 10_000
"""Maximum number of columns by whose number one can be chosen."""
_MAX_SURVEYED = 2**21
"""Maximum size of these lines [characters]."""
NOT_TEXT = "is not a text file; a trace is a CSV file with the columns time_s,voltage_v."

_SEPARATOR = re.compile(r'"?sep=.?"?', re.IGNORECASE)
"""First line of a spreadsheet's export."""
_JSON = re.compile(r"\s*(\{.*\}|\[\s*[-\d.\"\[{].*\])\s*")


@dataclass(frozen=True)
class Header:
    names: tuple[str, ...]
    """Names of the columns, in the spelling of the `ColumnMap`, whatever their case in the file."""
    delimiter: str
    line: int
    """Line number in the file, from 1; 0 if the first line holds numbers already."""
    text: str = ""
    """The line itself, by which a header that is repeated among the samples is known."""
    has_samples_above: bool = False
    """True if samples stand above it, as of a controller that was running already."""

    def is_repeated(self, line: str) -> bool:
        """Return whether a line among the samples is this header again."""
        return bool(self.text) and _strip_comment(line) == self.text

    def is_unit_line(self, line: str) -> bool:
        """Return whether the line below the header holds units, not a first sample."""
        cells = split_plain(line, self.delimiter)
        first = [cell for cell in cells if cell][:2]
        return all(map(UNIT_WORD.fullmatch, [*cells[:2], *first]))

    def count_cells(self, first: int, places: Iterable[int]) -> int:
        """Return the cells that each line must have; last ones that are not read may be missing."""
        return first if max(places) < first < len(self.names) else len(self.names)

    def find_place(self, name: str) -> int:
        """Find the place of a column by its name, or its number from 1. Raises TraceError."""
        if name in self.names:
            return self.names.index(name)
        if name.isdecimal() and 0 < int(name) <= len(self.names):
            return int(name) - 1

        raise TraceError(
            Issue("--column", f"there is no column {name}; {suggest_name(name, self.names)}")
        )


def read_start(lines: Iterable[str]) -> Iterator[str]:
    """Yield the first lines of a file, in which its header must be."""
    size = 0
    for line in itertools.islice(lines, SURVEYED_LINES):
        yield line
        size = size + len(line)
        if size > _MAX_SURVEYED:
            return


def adapt_labview(lines: Sequence[str], columns: ColumnMap) -> ColumnMap:
    """Add what a LabVIEW file states: its times or their step, and the voltage if unique."""
    survey = survey_lines(lines)
    rate_hz = columns.rate_hz
    contents = survey.columns if survey else ()
    times = [content.key for content in contents if content.kind == "time"]
    signals = [content.key for content in contents if content.kind == "signal"]
    names = {"time_s": times[0]} if times else {}
    if len(signals) == 1:
        names["voltage_v"] = signals[0]

    names |= columns.names
    if survey and "time_s" not in names:
        rate_hz = rate_hz or survey.rate_hz

    return replace(columns, names=names, rate_hz=rate_hz)


def find_header(
    name: str, lines: Iterable[str], columns: ColumnMap, *alternatives: ColumnMap
) -> Header:
    """Find the first line that names the columns that a trace requires.

    Up to `SURVEYED_LINES` lines above are skipped: a controller repeats the header each second. It
    may be a comment. Where all required columns are given by number, the first line that has
    numbers there, or times, is the first sample. Raises TraceError.
    """
    lines_above: list[str] = []
    for number, text in enumerate(read_start(lines), start=1):
        if "\0" in text:  # UTF-16 without a byte order mark
            raise TraceError(Issue(name, NOT_TEXT))

        is_comment = text.lstrip().startswith("#")
        for candidate in (columns, *alternatives):
            match = None if is_comment else _match_numbers(text, candidate)
            if match:
                names, delimiter = match
                above = _strip_comment(lines_above[-1]) if lines_above else ""
                return Header(names, delimiter, number - 1, above)

            cells, delimiter = _split(text.lstrip().lstrip("#") if is_comment else text, candidate)
            if all(candidate.name_in_file(column) in cells for column in candidate.required):
                raise_issues(
                    TraceError, _duplicate_issues(f"{name}, line {number}", cells, candidate)
                )
                return Header(
                    names=tuple(cells),
                    delimiter=delimiter,
                    line=number,
                    text=_strip_comment(text),
                    has_samples_above=any(map(_is_sample, lines_above)),
                )

        lines_above.append("" if _SEPARATOR.fullmatch(text.strip()) else text)

    if not any(map(str.strip, lines_above)):
        required = ",".join(map(columns.name_in_file, columns.required))
        message = f"is empty; a trace is a CSV file with the columns {required}."
        raise TraceError(Issue(name, message))

    raise TraceError(_header_issues(name, lines_above, columns))


def _strip_comment(line: str) -> str:
    return line.strip().lstrip("#").strip()


def list_numbers(columns: ColumnMap) -> list[int]:
    """List the numbers of the required columns; none unless all are given by number."""
    names = [*map(columns.name_in_file, columns.required)]
    if all(name.isdecimal() and len(name) < 6 for name in names):
        return [int(name) for name in names]

    return []


def _number_names(count: int) -> tuple[str, ...]:
    return tuple(str(i) for i in range(1, count + 1))


def _match_numbers(line: str, columns: ColumnMap) -> tuple[tuple[str, ...], str] | None:
    """Match a line with values in the required columns.

    The comma comes late: it may be a decimal comma.
    """
    required = list_numbers(columns)
    if not required or not 1 <= min(required) <= max(required) <= MAX_CELLS:
        return None

    for delimiter in ("\t", ";", ",", SPACES):
        cells = split_plain(line, delimiter)
        if len(cells) >= max(required) and all(is_value(cells[number - 1]) for number in required):
            return _number_names(len(cells)), delimiter

    return None


def _split(line: str, columns: ColumnMap) -> tuple[list[str], str]:
    """Split a line at the delimiter that gives the most known names, by name or else by number."""
    names = set(map(columns.name_in_file, columns.looked_for))
    cells_by_delimiter = {
        delimiter: _normalise_case(split_plain(line, delimiter), columns)
        for delimiter in (*DELIMITERS, SPACES)
    }
    delimiter = max(
        cells_by_delimiter,
        key=lambda delimiter: len(names.intersection(cells_by_delimiter[delimiter])),
    )
    cells = cells_by_delimiter[delimiter]
    if len(cells) == 1:
        delimiter = "\t"  # a comma below is a decimal one

    if names & set(cells):
        for number in names - set(cells):
            if number.isdecimal() and 0 < int(number) <= len(cells):
                cells[int(number) - 1] = number

    return cells, delimiter


def _normalise_case(cells: list[str], columns: ColumnMap) -> list[str]:
    """Spell names as the known ones that differ in case only, if they are unique.

    Exact names win: a cell that is a known name as it stands, such as `force_N` after `--column
    voltage_v=force_N`, is that column and no other.
    """
    names = list(map(columns.name_in_file, columns.looked_for))
    for name in names:
        matches = [i for i, cell in enumerate(cells) if cell.casefold() == name.casefold()]
        if len(matches) == 1 and cells[matches[0]] not in names:
            cells[matches[0]] = name

    return cells


def _is_sample(line: str) -> bool:
    """Return whether a line contains numbers and times only."""
    return line.strip() != "" and any(
        all(map(is_value, split_plain(line, delimiter))) for delimiter in DELIMITERS
    )


def _header_issues(name: str, lines: Sequence[str], columns: ColumnMap) -> list[Issue]:
    if _JSON.fullmatch(lines[len(lines) // 2]):
        command = "jq --unbuffered -r '[.. | numbers] | @csv'"
        return [
            Issue(
                name,
                f"holds JSON lines; pass them through {command}, which leaves their numbers "
                "as CSV.",
            )
        ]

    survey = survey_lines(lines)
    required = list(map(columns.name_in_file, columns.required))
    if survey:
        number = survey.header or survey.first
    else:
        number = next(i for i, line in enumerate(lines, 1) if line.strip())

    line = _strip_comment(lines[number - 1])
    field = f"{name}, line {number}"
    cells = _split(line, columns)[0] if survey and survey.header else []
    missing = [column for column in columns.required if columns.name_in_file(column) not in cells]

    if survey and len(missing) < len(required):
        return [
            *survey.find_issues(field, "column", cells, columns, missing),
            *_duplicate_issues(field, cells, columns),
        ]

    if not survey and all(column in line for column in required):
        message = (
            f"{line[:60]!r} does not separate its names by comma, semicolon or tab; use one "
            "of these."
        )
        return [Issue(field, message)]

    text = lines[number - 1].strip()
    reason = f"it must name {','.join(required)}."
    proposal = ""

    if survey:
        text = ",".join(split_plain(line, survey.delimiter))
        proposal = survey.propose(columns, missing, "Or " if survey.header else "")
        if not survey.header:
            reason = "the file has no header."

    return [Issue(field, f"{text[:60]!r} is not the header of a trace; {reason}{proposal}")]


def find_numbered_header(lines: Sequence[str], columns: ColumnMap) -> Header | None:
    """Find the first sample of a file with columns given by number; None if they have names."""
    numbers = list_numbers(columns)
    survey = survey_lines(lines) if numbers else None
    names = (
        _number_names(len(split_plain(lines[survey.first - 1], survey.delimiter))) if survey else ()
    )
    if survey is None or not all(0 < number <= len(names) for number in numbers):
        return None

    header = _strip_comment(lines[survey.header - 1]) if survey.header else ""
    if set(map(str, numbers)) <= set(split_plain(header, survey.delimiter)):
        return None  # names win over numbers

    return Header(names, survey.delimiter, survey.first - 1, header)


def _duplicate_issues(field: str, cells: Sequence[str], columns: ColumnMap) -> list[Issue]:
    return [
        Issue(field, f"the column {name} appears {cells.count(name)} times; keep one.")
        for name in map(columns.name_in_file, COLUMNS)
        if cells.count(name) > 1
    ]
