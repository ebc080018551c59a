"""Traces as CSV files: a header line, then one sample per line; commas, semicolons or tabs between."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fingertip.errors import Issue, TraceError
from fingertip.slip.traces.header import Header, encoding_of, find_header, unquoted
from fingertip.slip.traces.parsed import COLUMNS, Parsed, Wanted
from fingertip.slip.traces.trace import Trace

NEEDED = ("time_s", "voltage_v")


def to_csv(trace: Trace) -> bytes:
    """A trace as CSV: fixed decimals, so that the same numbers give the same bytes.

    Time to 0.1 us, voltage to 1 uV (a step of the 16-bit converter is 305 uV), force to 1 uN.
    """
    columns = [
        [f"{value:.7f}" for value in trace.time_s.tolist()],
        [f"{value:.6f}" for value in trace.voltage_v.tolist()],
    ]
    names = list(NEEDED)
    if trace.force_n is not None:
        columns.append([f"{value:.6f}" for value in trace.force_n.tolist()])
        names.append("force_n")
    if trace.slip is not None:
        columns.append(["1" if value else "0" for value in trace.slip.tolist()])
        names.append("slip")
    lines = [",".join(names), *map(",".join, zip(*columns, strict=True))]
    return ("\n".join(lines) + "\n").encode("ascii")


def parse_csv(path: Path, wanted: Wanted) -> Parsed:
    """Read a CSV file, UTF-8 or marked as UTF-16.

    With another delimiter than the comma a number may have a decimal comma. Lines above the header are passed over, and
    units below it.

    Raises
    ------
    TraceError
        If the file cannot be read at all, or its header names no trace.
    """
    name = str(path)
    try:
        encoding = encoding_of(path)
        with path.open(encoding=encoding) as file:
            header = find_header(name, file, wanted)
            below = file.readline()
    except UnicodeError:
        raise TraceError(Issue(name, "is no text; a trace is a CSV file with the columns time_s,voltage_v.")) from None
    except OSError as error:
        raise TraceError(Issue(name, f"cannot be read ({error.strerror}); give the path of a trace.")) from None
    first_line = header.line + (2 if header.has_units(below) else 1)
    return _quickly(path, encoding, header, first_line, wanted) or _carefully(
        path, encoding, header, first_line, wanted
    )


def _quickly(path: Path, encoding: str, header: Header, first_line: int, wanted: Wanted) -> Parsed | None:
    """A file without any issue, by numpy's reader; None if there is one, or if it is not sure."""
    present = [column for column in COLUMNS if wanted.of(column) in header.names]
    places = [header.names.index(wanted.of(column)) for column in present]
    try:
        with path.open(encoding=encoding) as file, warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # of no data; that is told in a sentence
            table = np.loadtxt(file, delimiter=header.delimiter, skiprows=first_line - 1, comments=None, ndmin=2)
    except ValueError:
        return None
    if not len(table) or table.shape[1] != header.width(table.shape[1], wanted):
        return None
    if not np.isfinite(table[:, places]).all():
        return None
    columns = {column: np.ascontiguousarray(table[:, place]) for column, place in zip(present, places, strict=True)}
    truth = columns.get("slip")
    if truth is not None and not np.isin(truth, (0.0, 1.0)).all():
        return None
    trace = wanted.trace(columns)
    if (np.diff(trace.time_s) <= 0.0).any():
        return None  # it will be told by its line, and numpy skips empty ones
    return Parsed(str(path), trace, first_line=first_line, in_volts=wanted.in_volts)


def _carefully(path: Path, encoding: str, header: Header, first_line: int, wanted: Wanted) -> Parsed:
    """Line by line, with all issues."""
    name, found = str(path), list[Issue]()
    try:
        lines = path.read_text(encoding=encoding).rstrip().splitlines()
    except UnicodeError:
        raise TraceError(Issue(name, "is no text; a trace is a CSV file with the columns time_s,voltage_v.")) from None
    rows = [line.split(header.delimiter) for line in lines[first_line - 1 :]]
    width = header.width(len(rows[0]), wanted) if rows else 0
    uneven = [i for i, row in enumerate(rows) if len(row) != width]
    if uneven:
        first = uneven[0]
        where = f"{name}, line {first_line + first}"
        sentence = f"has {len(rows[first])} cells, the header {len(header.names)}{_more(uneven)}"
        found.append(Issue(where, f"{sentence}; each line must have one cell per column."))
        for i in uneven:
            rows[i] = ["0"] * width  # a place holder: the other lines are judged with their own numbers
    columns: dict[str, NDArray[np.float64]] = {}
    for column in COLUMNS:
        if wanted.of(column) in header.names:
            cells = [row[header.names.index(wanted.of(column))] for row in rows]
            points = header.delimiter == ","
            columns[column], wrong = _numbers(cells if points else [c.replace(",", ".") for c in cells])
            if wrong:
                where = f"{cells[wrong[0]].strip()!r} in line {first_line + wrong[0]}{_more(wrong)}"
                sentence = f"{where} is not a number; write it with a decimal point."
                found.append(Issue(f"{name}, {column}", sentence))
                uneven.extend(wrong if column == "time_s" else ())
    truth = columns.get("slip")
    if truth is not None:
        wrong = np.flatnonzero((truth != 0.0) & (truth != 1.0)).tolist()
        if wrong:
            where = f"{truth[wrong[0]]:g} in line {first_line + wrong[0]}{_more(wrong)}"
            found.append(Issue(f"{name}, slip", f"{where} is neither 0 nor 1; write one of those."))
    trace = wanted.trace(columns)
    return Parsed(name, trace, tuple(found), first_line, not uneven, wanted.in_volts)


def _numbers(cells: Sequence[str]) -> tuple[NDArray[np.float64], list[int]]:
    """Cells as numbers, quoted or not, and the places of those that are none; they stand as 0. NaN passes here."""
    values, wrong = [], []
    for i, cell in enumerate(cells):
        try:
            values.append(float(unquoted(cell)))
        except ValueError:
            values.append(0.0)
            wrong.append(i)
    return np.array(values, dtype=np.float64), wrong


def _more(places: Sequence[int]) -> str:
    return f", and {len(places) - 1} more after it," if len(places) > 1 else ""
