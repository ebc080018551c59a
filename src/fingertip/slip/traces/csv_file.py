"""CSV files of traces: one line that names the columns, then one sample per line.

The delimiter is a comma, a semicolon, a tab or spaces. `csv_header` finds the header, or the first
sample of a file without one. Lines that hold no sample are passed over, and named: a header that is
repeated, comments, and a last line that was cut off.
"""

from __future__ import annotations

import array
import codecs
import datetime
import io
import itertools
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from fingertip.foundation.errors import Issue, TraceError, quote_value
from fingertip.foundation.input_files import SAMPLES_LIMIT
from fingertip.foundation.numerics import Array
from fingertip.slip.traces import cells as text
from fingertip.slip.traces.csv_header import (
    Header,
    adapt_labview,
    find_header,
    find_numbered_header,
    read_start,
)
from fingertip.slip.traces.number_blocks import parse_numbers
from fingertip.slip.traces.sampling import count_others
from fingertip.slip.traces.trace import (
    ColumnMap,
    RawTrace,
    bounded_blocks,
    bounded_lines,
    max_lines,
    shape_message,
)

_PROBE_BYTES = 2**20
"""Length of the pieces in which the encoding of a file is tested [bytes]."""

_BLOCK_LINES = 20_000
"""Lines of a block where each line is changed."""

Change = Callable[[Iterable[str]], Iterator[str]]
_FLAGS = {"true": 1.0, "false": 0.0}
"""Words for slip, as data frames write it, in small letters -> number."""


def read_csv(path: Path, columns: ColumnMap) -> RawTrace:
    """Read a CSV file in UTF-8, UTF-16 with a byte order mark, or Latin-1.

    LabVIEW's measurement files (LVM) are read by their own names of the columns. Raises TraceError
    or OSError.
    """
    name = str(path)
    encoding = _detect_encoding(path)
    start = [*read_start(_read_lines(path, encoding))]
    change: Change = iter
    last = [*filter(str.strip, start)][-20:]

    if start and start[0].startswith(text.LABVIEW):
        change = text.plain_labview
    elif 2 * sum(map(text.is_named, last)) > len(last):
        change = text.bare_lines

    start = [*change(start)]
    columns = adapt_labview(start, columns) if change is text.plain_labview else columns
    try:
        header = find_numbered_header(start, columns) or find_header(name, start, columns)
    except TraceError as error:
        if change is not text.bare_lines:
            raise

        note = "the file holds labels or time stamps, whose values are taken in their order: "
        raise TraceError(
            replace(issue, message=note + issue.message) for issue in error.issues
        ) from None

    below = "".join(start[header.line : header.line + 1])
    first_line = header.line + (2 if below.strip() and header.is_unit_line(below) else 1)
    source = _Source(
        path=path,
        encoding=encoding,
        change=change,
        header=header,
        first_line=first_line,
        columns=columns.with_simulated_names(header.names),
    )
    return _read_samples(source)


def _read_lines(path: Path, encoding: str) -> Iterator[str]:
    with path.open(encoding=encoding, errors="replace") as file:
        yield from bounded_lines(file, str(path))


def _detect_encoding(path: Path) -> str:
    """Return UTF-16 if the byte order mark says so, UTF-8 if it decodes, otherwise Latin-1."""
    with path.open("rb") as file:
        if file.read(2) in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE):
            return "utf-16"

        file.seek(0)
        decoder = codecs.getincrementaldecoder("utf-8")()
        try:
            for piece in iter(lambda: file.read(_PROBE_BYTES), b""):
                decoder.decode(piece)
        except UnicodeDecodeError:
            return "latin-1"

    return "utf-8-sig"  # an incomplete character at the very end belongs to a line that was cut off


@dataclass(frozen=True)
class _Source:
    path: Path
    encoding: str
    change: Change
    """Change of the lines that leaves their values."""
    header: Header
    first_line: int
    """Line number of the first sample."""
    columns: ColumnMap
    cut_off: list[str] = field(default_factory=list)

    def read_blocks(self) -> Iterator[tuple[int, str]]:
        """Yield blocks of the lines of samples, each with the line number of its first line."""
        number = 1
        for block in self._keep_whole_lines(self._read_blocks()):
            above = max(0, self.first_line - number)
            parts = block.split("\n", above)
            if len(parts) > above and parts[above]:
                yield number + above, parts[above]

            number += block.count("\n")

    def _read_blocks(self) -> Iterator[str]:
        name = str(self.path)
        with self.path.open(encoding=self.encoding, errors="replace") as file:
            if self.change is iter:
                yield from bounded_blocks(file, name, max_lines())
                return

            lines = self.change(bounded_lines(file, name, max_lines()))
            while block := "".join(itertools.islice(lines, _BLOCK_LINES)):
                yield block

    def _keep_whole_lines(self, blocks: Iterable[str]) -> Iterator[str]:
        """Leave out a line that is cut off: without line break, and shorter than the last."""
        before = ""
        for block in blocks:
            end = block.rfind("\n") + 1
            before = block[block.rfind("\n", 0, end - 1) + 1 : end] if end else before
            if end < len(block) and len(block) - end < len(before.rstrip()):
                self.cut_off.append(block[end:])
                block = block[:end]

            yield block

    @property
    def places(self) -> dict[str, int]:
        """Index of each column of the trace that the file has."""
        names = {column: self.columns.name_in_file(column) for column in self.columns.looked_for}
        return {
            column: self.header.names.index(name)
            for column, name in names.items()
            if name in self.header.names
        }

    def list_notes(self, last: int) -> Iterator[str]:
        """Yield notes on samples above the header, and on a line that is cut off."""
        if self.header.has_samples_above:
            yield (
                f"{self.path}, lines 1 to {self.header.line - 1}: stand above the header, and "
                "are passed over"
            )
        if self.cut_off:
            yield f"{self.path}, line {last + 1}: is cut off, and passed over"


@dataclass
class _Samples:
    """Samples of a file as they are read line by line, with what is wrong."""

    values: dict[str, array.array[float]]
    lines: array.array[int] = field(default_factory=lambda: array.array("I"))
    uneven: text.NotedLines = field(default_factory=text.NotedLines)
    """Line number and number of cells of lines with another number of cells than the others."""
    wrong: dict[str, text.NotedLines] = field(default_factory=dict)
    """Line number and text of the cells of each column that cannot be read."""
    passed_over: text.NotedLines = field(default_factory=text.NotedLines)
    """Lines of headers and comments among the samples."""
    after_header: bool = False
    """True if the last line was one of these: a line of units may follow."""
    width: int = 0
    """Number of cells that each line must have."""
    start: datetime.datetime | None = None
    """Time of the first sample, in a file of dates."""


def _read_samples(source: _Source) -> RawTrace:
    name = str(source.path)
    columns = source.columns
    samples = _collect(source)
    notes = list(source.list_notes(samples.lines[-1] if samples.lines else 0))

    if samples.passed_over.first:
        line = samples.passed_over.first[0]
        more = count_others(samples.passed_over.count)
        notes.append(
            f"{name}, line {line}: is a header or a comment among the samples{more}, and passed "
            "over"
        )

    if samples.start is not None:
        notes.append(f"{name}, time_s: dates are read as seconds since {samples.start.isoformat()}")

    issues = list(_find_issues(name, source, samples))
    if (
        source.change is text.plain_labview
        and samples.passed_over.count
        and "time_s" not in samples.values
    ):
        message = (
            "holds several segments, and no times that join them; keep the lines of one, or "
            "export X_Columns One."
        )
        issues.append(Issue(name, message))

    values: dict[str, Array] = {
        column: np.asarray(cells) for column, cells in samples.values.items()
    }
    has_all_times = (
        not samples.uneven.count and not samples.wrong.get("time_s", text.NotedLines()).count
    )
    # Dates are in seconds: their scale is an issue, and would make others.
    if samples.start is not None:
        columns = replace(columns, time_scale=1.0)

    trace = columns.make_trace(values)
    return RawTrace(
        name=name,
        trace=trace,
        issues=tuple(issues),
        lines=samples.lines,
        has_all_times=has_all_times,
        in_volts=columns.in_volts,
        notes=tuple(notes),
    )


def _collect(source: _Source) -> _Samples:
    """Collect the samples: blocks of plain numbers at once, and any other block line by line."""
    places = source.places
    samples = _Samples(
        {column: array.array("d") for column in places},
        wrong={column: text.NotedLines() for column in places},
    )

    for number, block in source.read_blocks():
        if not _add_numbers(source, samples, number, block):
            _add_lines(source, samples, number, block)

    return samples


def _add_numbers(source: _Source, samples: _Samples, number: int, block: str) -> bool:
    """Add a block of one sample a line; False, and nothing, if it may be anything else."""
    header = source.header
    places = source.places
    width = samples.width or len(text.split_cells(block.partition("\n")[0], header.delimiter))
    if width != header.count_cells(width, places.values()):
        return False

    columns = parse_numbers(block, header.delimiter, width, [*places.values()])
    if columns is None or len(samples.lines) + len(columns[0]) > SAMPLES_LIMIT.value:
        return False

    for values, column in zip(samples.values.values(), columns, strict=True):
        values.frombytes(column.tobytes())

    lines = np.arange(number, number + len(columns[0]), dtype=np.uintc)
    samples.lines.frombytes(lines.tobytes())
    samples.width = width
    samples.after_header = False
    return True


def _add_lines(source: _Source, samples: _Samples, first: int, block: str) -> None:
    """Add the samples of a block line by line.

    Cells that cannot be read become 0, so that the others are validated.
    """
    header = source.header
    places = source.places
    most = SAMPLES_LIMIT.value
    filled = (entry for entry in enumerate(io.StringIO(block), first) if entry[1].strip())

    for number, line in filled:
        if (
            header.is_repeated(line)
            or line.lstrip().startswith("#")
            or (samples.after_header and header.is_unit_line(line))
        ):
            samples.passed_over.add(number, line)
            samples.after_header = True
            continue

        samples.after_header = False
        cells = text.split_cells(line, header.delimiter)
        samples.width = width = samples.width or header.count_cells(len(cells), places.values())
        samples.lines.append(number)
        if len(samples.lines) > most:
            raise TraceError(Issue(str(source.path), shape_message([len(samples.lines)]) or ""))
        if len(cells) != width:
            samples.uneven.add(number, str(len(cells)))

        for column, place in places.items():
            value = 0.0
            if len(cells) == width:
                parsed = _parse(cells[place], column, samples)
                if parsed is None:
                    samples.wrong[column].add(number, cells[place])
                else:
                    value = parsed

            samples.values[column].append(value)


def _parse(cell: str, column: str, samples: _Samples) -> float | None:
    """Parse a cell as a number, NaN too, or as seconds since the first date; else None."""
    plain = text.unquote(cell)
    instant = text.parse_instant(plain) if column == "time_s" and ":" in plain else None
    if instant is not None:
        if samples.start is None and len(samples.lines) == 1:
            samples.start = instant

        try:
            return None if samples.start is None else (instant - samples.start).total_seconds()
        except TypeError:  # one with a time zone, and one without
            return None

    if column == "slip" and plain.lower() in _FLAGS:
        return _FLAGS[plain.lower()]

    return text.parse_number(plain)


def _find_issues(name: str, source: _Source, samples: _Samples) -> Iterator[Issue]:
    if samples.uneven.first:
        number, count = samples.uneven.first
        message = (
            f"has {count} cells, but the header has "
            f"{len(source.header.names)}{count_others(samples.uneven.count)}"
        )
        yield Issue(f"{name}, line {number}", f"{message}; each line must have one per column.")

    for column, wrong in samples.wrong.items():
        if not wrong.first:
            continue

        number, cell = wrong.first
        if not text.unquote(cell):
            message = f"is missing in line {number}{count_others(wrong.count)}"
            yield Issue(
                f"{name}, {column}", f"{message}; fill it in, such as with the value before it."
            )
        elif text.is_over_range(cell):
            value = f"{quote_value(text.unquote(cell))} in line {number}{count_others(wrong.count)}"
            message = (
                f"{value} marks that the signal left the instrument's range; record again "
                "with a wider one"
            )
            yield Issue(f"{name}, {column}", f"{message}, or cut the recording there.")
        else:
            value = f"{quote_value(cell.strip())} in line {number}"
            form = ", or a date as 2024-05-31T12:00:00.0005" if column == "time_s" else ""
            message = (
                f"{value} is not a number{count_others(wrong.count)}; write it with a "
                f"decimal point{form}."
            )
            yield Issue(f"{name}, {column}", message)

    if samples.start is not None and source.columns.time_scale != 1.0:
        yield Issue("--time-scale", f"does not apply to the dates in {name}; leave it out.")

    slip = np.array(samples.values.get("slip", ()))
    neither = np.flatnonzero((slip != 0) & (slip != 1))
    if neither.size:
        value = f"{slip[neither[0]]:g} in line {samples.lines[neither[0]]}"
        yield Issue(
            f"{name}, slip",
            f"{value} is neither 0 nor 1{count_others(neither.size)}; write 0 or 1.",
        )
