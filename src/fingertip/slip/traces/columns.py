"""Guesses which columns of a recording contain what a trace requires, and suggests them as options to type."""

from __future__ import annotations

import datetime
import re
import shlex
from collections.abc import Sequence

from fingertip.slip.traces.trace import ColumnMap, is_force

# Cells of a line of text: splitting, and parsing of numbers and of times as ISO 8601 writes them.


DELIMITERS = (",", ";", "\t")
SPACES = " "
"""Delimiter of columns that one or more spaces separate."""


def split_cells(line: str, delimiter: str) -> list[str]:
    """Split a line into its cells, with the spaces and quotes around them."""
    return line.split() if delimiter == SPACES else line.rstrip("\r\n").split(delimiter)


def unquote(cell: str) -> str:
    """Remove spaces and the quotes that some programs write around every cell."""
    return cell.strip().strip('"')


def is_number(cell: str) -> bool:
    """Return whether a cell contains a number, with a decimal point or a decimal comma."""
    try:
        float(cell.replace(",", "."))
    except ValueError:
        return False
    return True


def is_value(cell: str) -> bool:
    """Return whether a cell contains a number, or a time in ISO 8601."""
    return is_number(cell) or parse_instant(cell) is not None


def parse_instant(cell: str) -> datetime.datetime | None:
    """Parse a date with time, or a time of day, as ISO 8601 writes them; None for anything else.

    A time of day has an arbitrary date. Digits below a microsecond are cut off.
    """
    text = unquote(cell)
    if ":" not in text:  # a bare date, or a whole number, which would be read as one
        return None
    try:
        return datetime.datetime.fromisoformat(text)
    except ValueError:
        pass
    try:
        return datetime.datetime.combine(datetime.date(2000, 1, 1), datetime.time.fromisoformat(text))
    except ValueError:
        return None


def count_decimals(cell: str) -> int:
    """Count the digits behind the decimal point or comma of a number."""
    _, _, decimals = unquote(cell).replace(",", ".").partition(".")
    return len(decimals)


_TIME = re.compile(r"(time|zeit|timestamp|elapsed|seconds?|x_value|t)\b|.*([\[(]s[\])]|_s)$", re.IGNORECASE)
_VOLTAGE = re.compile(r".*(volt|[\[(]V[\])]|_v$)|(ai|ch|channel) ?\d", re.IGNORECASE)


def suggest_options(names: Sequence[str], columns: ColumnMap) -> str:
    """Suggest ``--column`` options for the required columns that a file's names do not contain."""
    candidates = [name for name in names if name and not is_number(name)]
    guesses: dict[str, str] = {}
    for column in columns.required:
        if columns.name_in_file(column) in candidates:
            candidates.remove(columns.name_in_file(column))
    for column, pattern in (("time_s", _TIME), ("voltage_v", _VOLTAGE)):
        if column in columns.required and columns.name_in_file(column) not in names and candidates:
            best = next((name for name in candidates if pattern.match(name)), None)
            if best is None and column == "time_s" and len(candidates) == 1:
                continue  # the only other column is the signal
            guess = best or candidates[0]
            candidates.remove(guess)
            if guess != column:  # a file that has this column needs no option
                guesses[column] = guess
    if not guesses:
        return ""
    options = [f"--column {column}={shlex.quote(name)}" for column, name in guesses.items()]
    if is_force(guesses.get("voltage_v", "")):
        options.append(
            "--calibrate 0:0.5 (a force has no threshold in volts: give the interval in which nothing happens)"
        )
    return f"name the file's column{'s' * (len(guesses) > 1)}: {' '.join(options)}"


def _lacks_only_times(columns: ColumnMap) -> bool:
    """Return whether all columns are given by number but that of the times, whose name is no number, such as none."""
    others = [column for column in columns.required if column != "time_s"]
    return (
        "time_s" in columns.required
        and "time_s" in columns.names
        and not columns.names["time_s"].isdecimal()
        and all(columns.name_in_file(column).isdecimal() for column in others)
    )


def suggest_numbers(count: int, columns: ColumnMap) -> str:
    """Suggest the options that read a file without a header, whose lines have `count` cells."""
    if _lacks_only_times(columns):
        return "the file has no header and its times are left out: give the sampling rate with --rate-hz, such as 2000"
    options = [f"--column {column}={number}" for number, column in enumerate(columns.required, 1)]
    if count < len(options):
        options = ["--rate-hz HZ", "--column voltage_v=1"]
    return f"the file has no header: give its columns by number, such as {' '.join(options)}"
