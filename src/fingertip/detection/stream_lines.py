"""Lines of a stream: the header, and the numbers and times in the lines of samples below it."""

from __future__ import annotations

import contextlib
import io
import itertools
import math
from collections import deque
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from fingertip.foundation.errors import Issue, TraceError, shorten
from fingertip.foundation.numerics import Array
from fingertip.slip.traces.cells import bare_line, bare_lines, parse_number, split_cells
from fingertip.slip.traces.csv_header import Header, find_header
from fingertip.slip.traces.number_blocks import parse_numbers
from fingertip.slip.traces.trace import NANOSEC, ColumnMap, arriving_blocks

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


class Block(NamedTuple):
    """Whole lines of a stream that arrived together."""

    number: int
    """Number of the first line, from 1."""
    text: str

    def read_lines(self) -> Iterator[NumberedLine]:
        """Yield the lines that are not empty, without the names of their values."""
        for number, line in enumerate(bare_lines(io.StringIO(self.text)), self.number):
            if line.strip():
                yield NumberedLine(number, line)


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


class LineStream:
    """Lines of a stream that are not empty, without the names of their values.

    They are taken one by one, or in the blocks in which they arrive.
    """

    def __init__(self, blocks: Iterable[str]) -> None:
        self._blocks = iter(blocks)
        self._lines = deque[str]()
        self._taken = 0
        """Number of lines that were taken."""

    def __iter__(self) -> Iterator[NumberedLine]:
        return self

    def __next__(self) -> NumberedLine:
        while True:
            line = NumberedLine(self._taken + 1, bare_line(self.take()))
            if line.text.strip():
                return line

    def take(self) -> str:
        """Take the next line, which may be empty."""
        if not self._lines:
            self._lines.extend(io.StringIO(next(self._blocks)))

        self._taken += 1
        return self._lines.popleft()

    def peek(self, count: int) -> list[NumberedLine]:
        """Return the next lines that are not empty, which are not taken."""
        before = self._taken
        taken = list[str]()
        found = list[NumberedLine]()
        with contextlib.suppress(StopIteration):
            while len(found) < count:
                taken.append(self.take())
                if taken[-1].strip():
                    found.append(NumberedLine(self._taken, bare_line(taken[-1])))

        self._lines.extendleft(reversed(taken))
        self._taken = before
        return found

    def take_blocks(self) -> Iterator[Block]:
        """Take all further lines in blocks."""
        number = self._taken + 1
        # The last line may have come without line break.
        rest = "".join(line if line.endswith("\n") else f"{line}\n" for line in self._lines)
        for text in itertools.chain([rest] if rest else [], self._blocks):
            yield Block(number, text)
            number += text.count("\n") + (not text.endswith("\n"))


def open_stream(
    lines: Iterable[str | bytes],
    columns: ColumnMap,
    *alternatives: ColumnMap,
    name: str = STREAM_NAME,
) -> tuple[Header, LineStream]:
    """Read the header and the line of units; return it and the lines below.

    Raises TraceError if the lines have no header with these columns.
    """
    stream = LineStream(arriving_blocks(lines, name))
    header = find_header(name, bare_lines(iter(stream.take, None)), columns, *alternatives)
    first = stream.peek(1)
    if first and header.is_unit_line(first[0].text):
        next(stream)

    return header, stream


def split_line(header: Header, line: NumberedLine) -> SampleLine:
    """Split a line into its cells, of which there may be too few or too many."""
    return SampleLine(line.number, line.text, split_cells(line.text, header.delimiter))


class SampleSplitter:
    """Splitter of lines into cells, with the number of cells that each line must have.

    Comments and repetitions of the header are left out: a controller sends its header, with its
    version, each second.
    """

    def __init__(self, header: Header, places: Collection[int]) -> None:
        """Begin; `places` are those of the columns that are read: later ones may be missing."""
        self._header = header
        self._places = sorted(places)
        self._width = 0

    def parse(self, block: Block) -> dict[int, Array] | None:
        """Return the columns that are read, by place; None if it may hold more than samples."""
        first_line = block.text.partition("\n")[0]
        width = self._width or len(split_cells(first_line, self._header.delimiter))
        if width != self._header.count_cells(width, self._places):
            return None

        columns = parse_numbers(block.text, self._header.delimiter, width, self._places)
        if columns is None:
            return None

        self._width = width
        return dict(zip(self._places, columns, strict=True))

    def split(self, block: Block) -> Iterator[SampleLine]:
        """Split the lines of samples. Raises TraceError at one whose number of cells is wrong."""
        header = self._header
        for line in block.read_lines():
            if header.is_repeated(line.text) or line.text.startswith("#"):
                continue

            sample_line = split_line(header, line)
            cell_count = len(sample_line.cells)
            self._width = self._width or header.count_cells(cell_count, self._places)

            if cell_count != self._width:
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


def sum_times(columns: Mapping[int, Array], time_columns: Sequence[TimeColumn]) -> Array:
    """Return the times of samples of which the columns are given, by place [s]."""
    first, *others = time_columns
    times_s: Array = first.unit_s * columns[first.place]
    for column in others:
        times_s = times_s + column.unit_s * columns[column.place]

    return times_s


def line_error(number: int, message: str) -> TraceError:
    """Return an error that names the line of the stream by its number."""
    return TraceError(Issue(f"{STREAM_NAME}, line {number}", message))


def _quote(text: str) -> str:
    """Quote a line as it came: it may be a message of the controller."""
    return f"The line reads {shorten(text.strip(), _MAX_QUOTED)!r}."
