"""Bounds of what is read from a trace file, so that no file, damaged or made to harm, fills the memory.

`fingertip.foundation.input_files` states the limits and the environment variables that raise them.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from fingertip.foundation.errors import InputFileError, Issue, TraceError
from fingertip.foundation.input_files import RECORDING_LIMIT, SAMPLES_LIMIT, check_regular

MAX_LINE = 2**20
"""Maximum length of a line of text [characters]. Ten thousand columns need a third of it."""
_CELLS_PER_SAMPLE = 4
"""Ratio of the numbers in a table, columns that no trace takes included, to the largest number of samples."""
_REMEDY = "cut the recording into parts"


def max_samples() -> int:
    """Return the maximum number of samples: by default 70 minutes at 2 kHz, 7 minutes at 20 kHz."""
    return SAMPLES_LIMIT.value


def max_rows(columns: int) -> int:
    """Return the maximum number of lines of a table with this number of columns."""
    return max(1, min(max_samples(), _CELLS_PER_SAMPLE * max_samples() // max(1, columns)))


def max_table_bytes() -> int:
    """Return the maximum size of all numbers of a table [bytes]."""
    return 8 * _CELLS_PER_SAMPLE * max_samples()


def check_trace_file(path: Path) -> None:
    """Check that a trace is a regular file of at most the largest size. Raises TraceError."""
    try:
        check_regular(path, RECORDING_LIMIT, "a trace")
    except InputFileError as error:
        issues = [Issue(issue.field, _with_stream(issue.message)) for issue in error.issues]
        raise TraceError(issues) from None


def _with_stream(message: str) -> str:
    """Add to the refusal of a pipe how lines are read from one."""
    if message.startswith("is a pipe"):
        return message.removesuffix(".") + ", or - for lines from standard input."
    return message.replace("make it smaller", _REMEDY)


def max_lines() -> int:
    """Return the maximum number of lines of a file, those without a sample included."""
    return 2 * max_samples() + 10_000


def bounded_lines(lines: Iterable[str], name: str, most: int | None = None) -> Iterator[str]:
    """Yield lines of a text file or stream, none of which is longer than `MAX_LINE`. Raises TraceError."""
    readline = getattr(lines, "readline", None)
    pieces = iter(lambda: readline(MAX_LINE + 1), "") if readline else iter(lines)
    for number, line in enumerate(pieces, 1):
        if len(line) > MAX_LINE:
            message = f"is longer than {MAX_LINE} characters; a trace has one sample per line, so break the lines."
            raise TraceError(Issue(f"{name}, line {number}", message))
        if most is not None and number > most:
            message = f"has more than {most} lines; {_REMEDY}, or raise {SAMPLES_LIMIT.variable}."
            raise TraceError(Issue(name, message))
        yield line


def shape_message(shape: Sequence[int], item_bytes: int = 8) -> str | None:
    """Describe an array that is too large, by the shape that its file states; None for any other."""
    count, maximum = math.prod(shape), max_samples()
    fits = all(0 <= length <= maximum for length in shape) and 0 <= count <= _CELLS_PER_SAMPLE * maximum
    if fits and count * item_bytes <= RECORDING_LIMIT.value:
        return None
    held = f"{count:.3g}" if abs(count) < 10**300 else "too many"
    remedy = f"{_REMEDY}, record again, or raise {SAMPLES_LIMIT.variable}"
    return f"claims to hold {held} values; at most {maximum} samples are read; {remedy}."
