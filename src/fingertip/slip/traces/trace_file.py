"""Traces as CSV files: a header line, then one sample per line; commas, semicolons or tabs between."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fingertip.design.faults import nearest
from fingertip.errors import Fault, TraceError
from fingertip.slip.traces.parsed import COLUMNS, Parsed, Wanted
from fingertip.slip.traces.trace import Trace

NEEDED = ("time_s", "voltage_v")
DELIMITERS = (",", ";", "\t")
_FIRST_LINE = 2


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
    """Read a CSV file.

    With another delimiter than the comma a number may have a decimal comma.

    Raises
    ------
    TraceError
        If the file cannot be read at all, or its header names no trace.
    """
    name = str(path)
    try:
        with path.open(encoding="utf-8-sig") as file:
            first = file.readline()
    except UnicodeDecodeError:
        raise TraceError(Fault(name, "is no text; a trace is a CSV file with the columns time_s,voltage_v.")) from None
    except OSError as error:
        raise TraceError(Fault(name, f"cannot be read ({error.strerror}); give the path of a trace.")) from None
    if not first.strip():
        raise TraceError(Fault(name, "is empty; a trace is a CSV file with the columns time_s,voltage_v."))
    header, delimiter = split_header(name, first, wanted)
    return _quickly(path, header, delimiter, wanted) or _carefully(path, header, delimiter, wanted)


def split_header(name: str, line: str, wanted: Wanted) -> tuple[list[str], str]:
    """The names in a header, and what stands between them.

    Raises
    ------
    TraceError
        If it does not name what a trace needs, or names it twice.
    """
    split = {d: [cell.strip().strip('"') for cell in line.strip("\r\n").split(d)] for d in DELIMITERS}
    known = {wanted.of(column) for column in COLUMNS}
    delimiter = max(DELIMITERS, key=lambda d: len(known & set(split[d])))
    header = split[delimiter]
    if found := _header_faults(name, header, line, wanted):
        raise TraceError(found)
    return header, delimiter


def _quickly(path: Path, header: list[str], delimiter: str, wanted: Wanted) -> Parsed | None:
    """A file without any fault, by numpy's reader; None if there is one, or if it is not sure."""
    present = [column for column in COLUMNS if wanted.of(column) in header]
    places = [header.index(wanted.of(column)) for column in present]
    try:
        with path.open(encoding="utf-8-sig") as file, warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # of no data; that is told in a sentence
            table = np.loadtxt(file, delimiter=delimiter, skiprows=1, comments=None, ndmin=2)
    except (ValueError, UnicodeDecodeError):
        return None
    if not len(table) or table.shape[1] != len(header) or not np.isfinite(table[:, places]).all():
        return None
    columns = {column: np.ascontiguousarray(table[:, place]) for column, place in zip(present, places, strict=True)}
    truth = columns.get("slip")
    if truth is not None and not np.isin(truth, (0.0, 1.0)).all():
        return None
    trace = wanted.trace(columns)
    if (np.diff(trace.time_s) <= 0.0).any():
        return None  # it will be told by its line, and numpy skips empty ones
    return Parsed(str(path), trace, first_line=_FIRST_LINE, in_volts=wanted.in_volts)


def _carefully(path: Path, header: list[str], delimiter: str, wanted: Wanted) -> Parsed:
    """Line by line, with all faults."""
    name, found = str(path), list[Fault]()
    try:
        lines = path.read_text(encoding="utf-8-sig").rstrip().splitlines()
    except UnicodeDecodeError:
        raise TraceError(Fault(name, "is no text; a trace is a CSV file with the columns time_s,voltage_v.")) from None
    rows = [line.split(delimiter) for line in lines[1:]]
    uneven = [i for i, row in enumerate(rows) if len(row) != len(header)]
    if uneven:
        first = uneven[0]
        where = f"{name}, line {_FIRST_LINE + first}"
        sentence = f"has {len(rows[first])} cells, the header {len(header)}{_more(uneven)}"
        found.append(Fault(where, f"{sentence}; each line must have one cell per column."))
        for i in uneven:
            rows[i] = ["0"] * len(header)  # a place holder: the other lines are judged with their own numbers
    columns: dict[str, NDArray[np.float64]] = {}
    for column in COLUMNS:
        if wanted.of(column) in header:
            cells = [row[header.index(wanted.of(column))] for row in rows]
            columns[column], wrong = _numbers(cells if delimiter == "," else [c.replace(",", ".") for c in cells])
            if wrong:
                where = f"{cells[wrong[0]].strip()!r} in line {_FIRST_LINE + wrong[0]}{_more(wrong)}"
                sentence = f"{where} is not a number; write it with a decimal point."
                found.append(Fault(f"{name}, {column}", sentence))
                uneven.extend(wrong if column == "time_s" else ())
    truth = columns.get("slip")
    if truth is not None:
        wrong = np.flatnonzero((truth != 0.0) & (truth != 1.0)).tolist()
        if wrong:
            where = f"{truth[wrong[0]]:g} in line {_FIRST_LINE + wrong[0]}{_more(wrong)}"
            found.append(Fault(f"{name}, slip", f"{where} is neither 0 nor 1; write one of those."))
    trace = wanted.trace(columns)
    return Parsed(name, trace, tuple(found), _FIRST_LINE, not uneven, wanted.in_volts)


def _header_faults(name: str, header: Sequence[str], line: str, wanted: Wanted) -> list[Fault]:
    field = f"{name}, line 1"
    if not set(header) & {wanted.of(column) for column in COLUMNS}:
        start = ",".join(header)[:60]
        needed = ",".join(wanted.of(column) for column in wanted.needed)
        if all(wanted.of(column) in line for column in wanted.needed):
            sentence = f"{start!r} has its names apart by neither comma, semicolon nor tab; use one of those."
        else:
            sentence = f"{start!r} is no header of a trace; it must name {needed}."
        return [Fault(field, sentence)]
    found = []
    for column in wanted.needed:
        if wanted.of(column) not in header:
            remedy = nearest(wanted.of(column), header)
            if column == "time_s":
                remedy += " Or give --rate-hz, if it has none."
            found.append(Fault(field, f"there is no column {wanted.of(column)}; {remedy}"))
    found.extend(
        Fault(field, f"column {known} stands there {header.count(known)} times; keep one.")
        for known in map(wanted.of, COLUMNS)
        if header.count(known) > 1
    )
    return found


def _numbers(cells: Sequence[str]) -> tuple[NDArray[np.float64], list[int]]:
    """Cells as numbers, and the places of those that are none; they stand as 0. NaN passes here."""
    values, wrong = [], []
    for i, cell in enumerate(cells):
        try:
            values.append(float(cell))
        except ValueError:
            values.append(0.0)
            wrong.append(i)
    return np.array(values, dtype=np.float64), wrong


def _more(places: Sequence[int]) -> str:
    return f", and {len(places) - 1} more after it," if len(places) > 1 else ""
