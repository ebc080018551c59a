"""Where a recording's samples begin: the line that names its columns, below whatever a program wrote above it."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from fingertip.design.issues import nearest
from fingertip.errors import Issue, TraceError
from fingertip.slip.traces.own_names import is_number, own_names
from fingertip.slip.traces.parsed import COLUMNS, Wanted

DELIMITERS = (",", ";", "\t")
MAX_ABOVE = 200
"""So many lines a program may write above the one that names the columns (LabVIEW: some 25)."""

_SEPARATOR = re.compile(r'"?sep=.?"?', re.IGNORECASE)
"""A spreadsheet's first line."""
_UNIT = re.compile(r'"?[\[(]?(s|ms|us|µs|sec|seconds?|v|mv|volts?|n|newtons?|hz|counts?|-|)[\])]?"?', re.IGNORECASE)


@dataclass(frozen=True)
class Header:
    """The line that names the columns."""

    names: tuple[str, ...]
    """Those that are wanted as `Wanted` has them, whatever their case in the file."""
    delimiter: str
    line: int
    """Its number in the file, from 1."""

    def has_units(self, below: str) -> bool:
        """Whether the line below it holds the columns' units instead of a first sample."""
        cells = [cell.strip() for cell in below.strip("\r\n").split(self.delimiter)]
        return len(cells) == len(self.names) and any(cells) and all(map(_UNIT.fullmatch, cells))

    def width(self, cells: int, wanted: Wanted) -> int:
        """How many cells each line must have, if the first has so many: as many as there are names, or fewer where the
        last are left out (LabVIEW's comments) and none of those is wanted."""
        needed = 1 + max(self.names.index(name) for name in map(wanted.of, COLUMNS) if name in self.names)
        return cells if needed <= cells < len(self.names) else len(self.names)


def encoding_of(path: Path) -> str:
    """UTF-8, or UTF-16 where the file begins with its mark. Raises OSError."""
    with path.open("rb") as file:
        return "utf-16" if file.read(2) in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig"


def unquoted(cell: str) -> str:
    """A cell without the quotes that some programs put around everything."""
    return cell.strip().strip('"')


def find_header(name: str, lines: Iterable[str], wanted: Wanted, *others: Wanted) -> Header:
    """Take lines up to the first that names what a trace needs.

    Empty lines, a spreadsheet's `sep=;`, and whatever else stands above are passed over, up to the first line of
    numbers; a header may be a comment itself.

    Parameters
    ----------
    name
        What the sentences call the trace.
    lines
        Of the file, from its beginning; none is taken beyond the header.
    wanted, others
        What to look for; any of them will do.

    Raises
    ------
    TraceError
        If no line names what is needed, or names it twice.
    """
    passed: list[tuple[int, str]] = []
    for number, line in enumerate(lines, start=1):
        text = line.lstrip("\ufeff") if number == 1 else line
        if "\0" in text:  # UTF-16 that nobody said was that
            raise TraceError(Issue(name, "is no text; a trace is a CSV file with the columns time_s,voltage_v."))
        is_comment = text.lstrip().startswith("#")
        text = text.lstrip().lstrip("#") if is_comment else text
        for one in (wanted, *others):
            cells, delimiter = _split(text, one)
            if all(one.of(column) in cells for column in one.needed):
                if doubled := _doubled(f"{name}, line {number}", cells, one):
                    raise TraceError(doubled)
                return Header(tuple(cells), delimiter, number)
        if not is_comment and text.strip() and not _SEPARATOR.fullmatch(text.strip()):
            passed.append((number, text))
            if _numbers_in(text) or len(passed) == MAX_ABOVE:
                break
    if not passed:
        needed = ",".join(wanted.of(column) for column in wanted.needed)
        raise TraceError(Issue(name, f"is empty; a trace is a CSV file with the columns {needed}."))
    raise TraceError(_issues(name, *_likeliest(passed), wanted))


def _split(line: str, wanted: Wanted) -> tuple[list[str], str]:
    """The cells of a line, wanted names as they are wanted, and what stands between them."""
    split = {d: _as_wanted(_cells(line, d), wanted) for d in DELIMITERS}
    known = {wanted.of(column) for column in COLUMNS}
    delimiter = max(DELIMITERS, key=lambda d: len(known & set(split[d])))
    return split[delimiter], delimiter


def _all_cells(line: str) -> list[list[str]]:
    return [_cells(line, delimiter) for delimiter in DELIMITERS]


def _max_cells(line: str) -> list[str]:
    return max(_all_cells(line), key=lambda cells: len(cells))


def _cells(line: str, delimiter: str) -> list[str]:
    return [unquoted(cell) for cell in line.strip("\r\n").split(delimiter)]


def _as_wanted(cells: list[str], wanted: Wanted) -> list[str]:
    """A name that differs in its case only is the wanted one, if there is no other such."""
    for known in map(wanted.of, COLUMNS):
        alike = [i for i, cell in enumerate(cells) if cell.casefold() == known.casefold()]
        if len(alike) == 1:
            cells[alike[0]] = known
    return cells


def _numbers_in(line: str) -> int:
    """How many numbers a line holds, if it holds nothing else."""
    return max(len(cells) if all(map(is_number, cells)) else 0 for cells in _all_cells(line))


def _likeliest(passed: Sequence[tuple[int, str]]) -> tuple[int, str]:
    """Of lines without a header, the one that was meant to be it: above the first numbers, with as many cells."""
    count = _numbers_in(passed[-1][1])
    if not count or len(passed) == 1:
        return passed[0]
    above = [one for one in passed[:-1] if not all(map(_UNIT.fullmatch, _max_cells(one[1])))]
    alike = [one for one in above if count in map(len, _all_cells(one[1]))]
    return (alike or above or passed)[-1]


def _issues(name: str, number: int, line: str, wanted: Wanted) -> list[Issue]:
    """Why a line is no header."""
    header, _ = _split(line, wanted)
    field = f"{name}, line {number}"
    if not set(header) & {wanted.of(column) for column in COLUMNS}:
        header = _max_cells(line)
        start = ",".join(header)[:60]
        needed = ",".join(wanted.of(column) for column in wanted.needed)
        if all(wanted.of(column) in line for column in wanted.needed):
            sentence = f"{start!r} has its names apart by neither comma, semicolon nor tab; use one of those."
        else:
            sentence = f"{start!r} is no header of a trace; it must name {needed}{own_names(header, wanted)}."
        return [Issue(field, sentence)]
    missing = [column for column in wanted.needed if wanted.of(column) not in header]
    found = []
    for column in missing:
        remedy = nearest(wanted.of(column), header)
        if column == "time_s":
            remedy += " Or give --rate-hz, if it has none."
        if column == missing[-1] and (own := own_names(header, wanted)):
            remedy += f" O{own.removeprefix('; o')}."
        found.append(Issue(field, f"there is no column {wanted.of(column)}; {remedy}"))
    return [*found, *_doubled(field, header, wanted)]


def _doubled(field: str, header: Sequence[str], wanted: Wanted) -> list[Issue]:
    return [
        Issue(field, f"column {known} stands there {header.count(known)} times; keep one.")
        for known in map(wanted.of, COLUMNS)
        if header.count(known) > 1
    ]
