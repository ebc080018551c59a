"""Traces as CSV files: a header line, then one sample per line."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fingertip.design.faults import nearest
from fingertip.design.sections import Detector
from fingertip.errors import Fault, TraceError
from fingertip.slip.trace import Trace, column_faults, length_faults, time_faults

COLUMNS = ("time_s", "voltage_v", "force_n", "slip")
NEEDED = ("time_s", "voltage_v")
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


def read_csv(path: Path, detector: Detector) -> Trace:
    """Read a trace and check it against the detector's rate and window. Further columns are ignored.

    Raises
    ------
    TraceError
        With one sentence for each fault: no such file, no CSV, a column missing, cells that are no numbers,
        and all that `fingertip.slip.trace.faults` finds.
    """
    name = str(path)
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise TraceError(Fault(name, "is no text; a trace is a CSV file with the columns time_s,voltage_v.")) from None
    except OSError as error:
        raise TraceError(Fault(name, f"cannot be read ({error.strerror}); give the path of a trace (CSV).")) from None
    lines = text.rstrip().splitlines()
    if not lines:
        raise TraceError(Fault(name, "is empty; a trace is a CSV file with the columns time_s,voltage_v."))
    header = [cell.strip().strip('"') for cell in lines[0].split(",")]
    if found := _header_faults(name, header):
        raise TraceError(found)

    rows = [line.split(",") for line in lines[1:]]
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
        if column in header:
            cells = [row[header.index(column)] for row in rows]
            columns[column], wrong = _numbers(cells)
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
    trace = Trace(
        columns["time_s"],
        columns["voltage_v"],
        columns.get("force_n"),
        None if truth is None else truth == 1.0,
    )
    found.extend(length_faults(trace, detector, name))
    found.extend(column_faults(trace, name, _FIRST_LINE))
    if not uneven and len(rows) > 1 and np.isfinite(trace.time_s).all():
        found.extend(time_faults(trace.time_s, detector, name, _FIRST_LINE))
    if found:
        raise TraceError(found)
    return trace


def _header_faults(name: str, header: Sequence[str]) -> list[Fault]:
    if not set(header) & set(COLUMNS):
        return [
            Fault(
                f"{name}, line 1",
                f"{','.join(header)[:60]!r} is no header of a trace; it must name time_s,voltage_v.",
            )
        ]
    found = [
        Fault(f"{name}, line 1", f"there is no column {column}; {nearest(column, header)}")
        for column in NEEDED
        if column not in header
    ]
    found.extend(
        Fault(f"{name}, line 1", f"column {column} stands there {header.count(column)} times; keep one.")
        for column in COLUMNS
        if header.count(column) > 1
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
