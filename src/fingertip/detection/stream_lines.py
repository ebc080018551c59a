"""Lines of a stream: the header, and the numbers and times in the lines of samples below it."""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from fingertip.foundation.errors import Issue, TraceError, shorten
from fingertip.slip.traces.cells import bare_lines, parse_number, split_cells
from fingertip.slip.traces.csv_header import Header, find_header
from fingertip.slip.traces.trace import NANOSEC, ColumnMap, bounded_lines

STREAM_NAME = "standard input"
"""Name of a stream in messages, unless it has its own."""
_MAX_QUOTED = 100
"""Maximum length of a line in an error message [characters]."""
_NANOSECOND_S = 1e-9
"""Seconds per unit of a column of nanoseconds."""


class NumberedLine(NamedTuple):
    """Line of a stream."""

    number: int
    """Number of the line, from 1."""
    text: str


@dataclass(frozen=True)
class SampleLine:
    """Line that holds one sample."""

    number: int
    """Number of the line, from 1."""
    text: str
    cells: Sequence[str]
    """Cells of the line, one per column of the header."""

    def read_number(self, place: int) -> float:
        """Return the number in the cell at a place, from 0.

        Raises TraceError if the cell is empty, or holds text or a number that is not finite.
        """
        cell = self.cells[place]
        value = parse_number(cell)

        if value is None:
            message = f"{cell.strip()!r} is not a number; write it with a decimal point."
            if not cell.strip():
                message = "has an empty cell; give one number per column."

            raise line_error(self.number, f"{message} {_quote(self.text)}")

        if not math.isfinite(value):
            message = f"{value} is not a finite number; detection cannot continue across it."
            raise line_error(self.number, message)

        return value


@dataclass(frozen=True)
class TimeColumn:
    """Column whose numbers are a time, or one summand of it."""

    place: int
    """Place of the column in a line, from 0."""
    unit_s: float
    """Seconds per unit of its numbers."""


def open_stream(
    lines: Iterable[str | bytes],
    columns: ColumnMap,
    *alternatives: ColumnMap,
    name: str = STREAM_NAME,
) -> tuple[Header, Iterator[NumberedLine]]:
    """Read the header and the line of units; return it and all lines below that are not empty.

    Raises TraceError if the lines have no header with these columns.
    """
    remaining = bare_lines(bounded_lines(lines, name))
    header = find_header(name, remaining, columns, *alternatives)
    numbered = itertools.starmap(NumberedLine, enumerate(remaining, start=header.line + 1))
    below = (line for line in numbered if line.text.strip())

    first = next(below, None)
    if first is None or header.is_unit_line(first.text):
        return header, below

    return header, itertools.chain([first], below)


def split_line(header: Header, line: NumberedLine) -> SampleLine:
    """Split a line into its cells, of which there may be too few or too many."""
    return SampleLine(line.number, line.text, split_cells(line.text, header.delimiter))


def split_sample_lines(
    header: Header,
    lines: Iterable[NumberedLine],
    places: Collection[int],
) -> Iterator[SampleLine]:
    """Split each line that holds a sample, as soon as it arrives.

    Comments and repetitions of the header are left out: a controller sends its header, with its
    version, each second.

    Parameters
    ----------
    places
        Places of the columns that are read; columns after them may be missing.

    Raises
    ------
    TraceError
        At the first line whose number of cells is wrong.
    """
    width = 0

    for line in lines:
        if header.is_repeated(line.text) or line.text.startswith("#"):
            continue

        sample_line = split_line(header, line)
        cell_count = len(sample_line.cells)
        width = width or header.count_cells(cell_count, places)

        if cell_count != width:
            message = (
                f"has {cell_count} cells, but the header has {len(header.names)}; give one "
                "per column."
            )
            raise line_error(line.number, f"{message} {_quote(line.text)}")

        yield sample_line


def find_time_columns(header: Header, columns: ColumnMap) -> list[TimeColumn]:
    """Find the columns whose sum is the time of a sample; an empty list if there are no times."""
    units_s = {
        columns.name_in_file("time_s"): columns.time_scale,
        columns.names.get(NANOSEC, ""): _NANOSECOND_S,
    }
    return [
        TimeColumn(header.names.index(name), unit_s)
        for name, unit_s in units_s.items()
        if name in header.names
    ]


def read_time(line: SampleLine, time_columns: Iterable[TimeColumn]) -> float:
    """Return the time of a sample [s]. Raises TraceError if a cell of it holds no number."""
    return sum(column.unit_s * line.read_number(column.place) for column in time_columns)


def line_error(number: int, message: str) -> TraceError:
    """Return an error that names the line of the stream by its number."""
    return TraceError(Issue(f"{STREAM_NAME}, line {number}", message))


def _quote(text: str) -> str:
    """Quote a line as it came: it may be a message of the controller."""
    return f"The line reads {shorten(text.strip(), _MAX_QUOTED)!r}."
