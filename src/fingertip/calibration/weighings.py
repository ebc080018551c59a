"""File of weighings: known forces on the finger, and what the sensor gave, with all faults reported at once.

A CSV file names one column of loads, `weight_g` or `force_n`, and one of readings, `voltage_v` (the tactile voltage),
`counts` (of a converter) or `resistance_ohm` (of the sensor alone). Each line is one weighing.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from fingertip.board.components.bridge import NEWTON_PER_GRAM
from fingertip.design.parameters.declaration import suggest_name
from fingertip.foundation.errors import InputFileError, Issue, TraceError, quote_value
from fingertip.foundation.input_files import RECORDING_LIMIT, read_input
from fingertip.slip.traces.columns import DELIMITERS, split_cells, unquote

LOADS = {"weight_g": NEWTON_PER_GRAM, "force_n": 1.0}
"""Columns of loads -> newtons per unit."""
READINGS = ("voltage_v", "counts", "resistance_ohm")
"""Columns of readings."""
MIN_WEIGHINGS = 4
"""Least number of weighings with a load: two figures are fitted, and two more show their scatter."""
MIN_LOADS = 3
"""Least number of different loads among them."""
MAX_BYTES = 2**20
"""Maximum size of a file of weighings [bytes]."""
MAX_FORCE_N = 1000.0
"""Largest force that a sensor survives, with a wide margin [N]."""


@dataclass(frozen=True)
class Weighing:
    """Known force, and the reading of the sensor under it."""

    force_n: float
    reading: float
    line: int
    """Line in the file."""


@dataclass(frozen=True)
class Weighings:
    """Content of a file of weighings."""

    source: str
    """Name of the file in messages."""
    kind: str
    """Column of the readings, from `READINGS`."""
    rows: tuple[Weighing, ...]
    """Weighings under load."""
    unloaded: tuple[Weighing, ...]
    """Readings without load, which show the offset of the board."""


def read_weighings(path: Path) -> Weighings:
    """Read a file of weighings. Raises TraceError."""
    try:
        content = read_input(path, RECORDING_LIMIT, "a file of weighings", MAX_BYTES + 1)
    except InputFileError as error:
        raise TraceError(error.issues) from None
    if len(content) > MAX_BYTES or b"\0" in content:
        message = f"is not a text file of less than {MAX_BYTES // 2**20} MB; write weighings as CSV."
        raise TraceError(Issue(str(path), message))
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = content.decode("latin-1")
    return parse_weighings(text, str(path))


def parse_weighings(text: str, source: str) -> Weighings:
    """Parse the text of a file of weighings, as `read_weighings` does; `source` names it in messages."""
    lines = [
        (number, line)
        for number, line in enumerate(text.splitlines(), 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if not lines:
        raise TraceError(Issue(source, "is empty; write a header such as weight_g,voltage_v, and a line per weighing."))
    number, first = lines[0]
    delimiter = max(DELIMITERS, key=first.count)
    header = [unquote(cell).lower() for cell in split_cells(first, delimiter)]
    places = []
    for names, noun in ((tuple(LOADS), "loads"), (READINGS, "readings")):
        found = [name for name in names if name in header]
        if len(found) != 1:
            problem = f"names {' and '.join(found)}" if found else f"names no column of {noun}"
            remedy = f"give one of {', '.join(names)}"
            if not found:
                remedy = f"one of {', '.join(names)}; {suggest_name(names[0], header)}"
            raise TraceError(Issue(f"{source}, line {number}", f"{problem}; {remedy.rstrip('.')}."))
        places.append(header.index(found[0]))
    load, kind = header[places[0]], header[places[1]]
    rows, issues = list[Weighing](), list[Issue]()
    for number, line in lines[1:]:
        cells = split_cells(line, delimiter)
        try:
            force, reading = (float(_plain(cells[place], delimiter)) for place in places)
        except (ValueError, IndexError):
            issues.append(
                Issue(f"{source}, line {number}", f"{quote_value(line.strip())} is not a weighing; write two numbers.")
            )
            continue
        rows.append(Weighing(force * LOADS[load], reading, number))
    issues += (Issue(f"{source}, line {row.line}", problem) for row in rows for problem in _find_problems(row, kind))
    if not issues:
        issues += _find_missing(source, [row for row in rows if row.force_n > 0.0])
    if issues:
        raise TraceError(issues)
    loaded, unloaded = ([row for row in rows if (row.force_n > 0.0) is under] for under in (True, False))
    return Weighings(source, kind, tuple(loaded), tuple(unloaded))


def _plain(cell: str, delimiter: str) -> str:
    return unquote(cell) if delimiter == "," else unquote(cell).replace(",", ".")


def _find_problems(row: Weighing, kind: str) -> Iterator[str]:
    """Find values that no weighing gives."""
    if not 0.0 <= row.force_n <= MAX_FORCE_N:
        yield f"{row.force_n:g} N is not a load; give 0 to {MAX_FORCE_N:g} N."
    if not math.isfinite(row.reading):
        yield f"{row.reading} is not a reading; weigh again, or delete the line."
    elif kind == "resistance_ohm" and row.reading <= 0.0:
        yield f"{row.reading:g} ohm is not a resistance; give a value above 0."


def _find_missing(source: str, loaded: Sequence[Weighing]) -> Iterator[Issue]:
    """Find too few weighings, or too few different loads."""
    loads = len({row.force_n for row in loaded})
    if len(loaded) < MIN_WEIGHINGS or loads < MIN_LOADS:
        yield Issue(
            source,
            f"holds {len(loaded)} weighings under {loads} different loads; at least {MIN_WEIGHINGS} under {MIN_LOADS} "
            "are needed for a curve and its interval.",
        )
