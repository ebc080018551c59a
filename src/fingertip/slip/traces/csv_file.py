"""CSV files of traces: one line that names the columns, then one sample per line.

The delimiter is a comma, a semicolon, a tab or spaces. `csv_header` finds the header, or the first
sample of a file without one. Lines that hold no sample are passed over, and named: a header that is
repeated, comments, and a last line that was cut off.
"""

from __future__ import annotations

import array
import codecs
import datetime
import itertools
import warnings
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
from fingertip.slip.traces.sampling import count_others
from fingertip.slip.traces.trace import (
    ColumnMap,
    RawTrace,
    bounded_lines,
    max_lines,
    max_rows,
    shape_message,
)

_PROBE_BYTES = 2**20
"""Length of the pieces in which the encoding of a file is tested [bytes]."""

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
    return _read_valid(source) or _read_by_line(source)


def _read_lines(
    path: Path, encoding: str, change: Change = iter, most: int | None = None
) -> Iterator[str]:
    with path.open(encoding=encoding, errors="replace") as file:
        yield from change(bounded_lines(file, str(path), most))


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

    def read_lines(self) -> Iterator[str]:
        """Yield the lines, but not a cut-off one: without line break, and shorter than the last."""
        before = ""
        for line in _read_lines(self.path, self.encoding, self.change, max_lines()):
            if line.endswith("\n") or len(line) >= len(before.rstrip()):
                yield line
            else:
                self.cut_off.append(line)

            before = line

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


def _read_valid(source: _Source) -> RawTrace | None:
    """Read a file by numpy's reader; None if it may have any issue."""
    header = source.header
    columns = source.columns
    places = source.places
    has_spaces = header.delimiter.isspace() and header.delimiter != "\t"

    try:
        with warnings.catch_warnings():
            # An empty file is reported as an issue.
            warnings.simplefilter("ignore", UserWarning)
            rows = itertools.islice(source.read_lines(), source.first_line - 1, None)
            most = max_rows(len(header.names))
            table = np.loadtxt(
                rows,
                delimiter=None if has_spaces else header.delimiter,
                comments=None,
                ndmin=2,
                max_rows=most,
            )
    except ValueError:
        return None

    if not len(table) or table.shape[1] != header.count_cells(table.shape[1], places.values()):
        return None
    if len(table) == most or not np.isfinite(table[:, list(places.values())]).all():
        return None

    values = {column: np.ascontiguousarray(table[:, place]) for column, place in places.items()}
    slip = values.get("slip")
    if slip is not None and not np.isin(slip, (0.0, 1.0)).all():
        return None

    trace = columns.make_trace(values)
    if (np.diff(trace.time_s) <= 0.0).any():
        return None  # the message names the line, and numpy skips empty lines

    lines = range(source.first_line, source.first_line + len(table))
    return RawTrace(
        str(source.path),
        trace,
        lines=lines,
        in_volts=columns.in_volts,
        notes=tuple(source.list_notes(lines[-1])),
    )


@dataclass
class _Samples:
    """Samples of a file as they are read line by line, with what is wrong."""

    values: dict[str, array.array[float]]
    lines: array.array[int] = field(default_factory=lambda: array.array("q"))
    uneven: text.NotedLines = field(default_factory=text.NotedLines)
    """Line number and number of cells of lines with another number of cells than the others."""
    wrong: dict[str, text.NotedLines] = field(default_factory=dict)
    """Line number and text of the cells of each column that cannot be read."""
    passed_over: text.NotedLines = field(default_factory=text.NotedLines)
    """Lines of headers and comments among the samples."""
    width: int = 0
    """Number of cells that each line must have."""
    start: datetime.datetime | None = None
    """Time of the first sample, in a file of dates."""


def _read_by_line(source: _Source) -> RawTrace:
    name = str(source.path)
    columns = source.columns
    samples = _collect(source, enumerate(source.read_lines(), 1))
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

    values: dict[str, Array] = {column: np.array(cells) for column, cells in samples.values.items()}
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


def _collect(source: _Source, lines: Iterable[tuple[int, str]]) -> _Samples:
    """Collect the samples of numbered lines.

    Cells that cannot be read become 0, so that the others are validated.
    """
    header = source.header
    places = source.places
    samples = _Samples(
        {column: array.array("d") for column in places},
        wrong={column: text.NotedLines() for column in places},
    )
    after_header = False
    most = SAMPLES_LIMIT.value
    below = (entry for entry in lines if entry[0] >= source.first_line and entry[1].strip())

    for number, line in below:
        if (
            header.is_repeated(line)
            or line.lstrip().startswith("#")
            or (after_header and header.is_unit_line(line))
        ):
            samples.passed_over.add(number, line)
            after_header = True
            continue

        after_header = False
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

    return samples


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
