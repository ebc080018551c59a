"""A recording's own names for what a trace needs, as far as they can be guessed: the remedy, ready to be typed."""

from __future__ import annotations

import re
import shlex
from collections.abc import Sequence

from fingertip.slip.traces.parsed import Wanted, is_force

_TIME = re.compile(r"(time|zeit|timestamp|elapsed|seconds?|x_value|t)\b|.*([\[(]s[\])]|_s)$", re.IGNORECASE)
_VOLTAGE = re.compile(r".*(volt|[\[(]V[\])]|_v$)|(ai|ch|channel) ?\d", re.IGNORECASE)


def own_names(names: Sequence[str], wanted: Wanted) -> str:
    """`; or name the file's columns: --column ...` for what is needed and not there; "" if there is nothing to name."""
    left = [name for name in names if name and not is_number(name)]
    guessed: dict[str, str] = {}
    for column in wanted.needed:
        if wanted.of(column) in left:
            left.remove(wanted.of(column))
    for column, like in (("time_s", _TIME), ("voltage_v", _VOLTAGE)):
        if column in wanted.needed and wanted.of(column) not in names and left:
            best = next((name for name in left if like.match(name)), None)
            if best is None and column == "time_s" and len(left) == 1:
                continue  # the only other column is the signal
            guessed[column] = best or left[0]
            left.remove(guessed[column])
    if not guessed:
        return ""
    options = [f"--column {column}={shlex.quote(name)}" for column, name in guessed.items()]
    if is_force(guessed.get("voltage_v", "")):
        options.append("--quiet-s 0.5 (a force has no threshold in volts: say how long nothing happens at its start)")
    return f"; or name the file's column{'s' * (len(guessed) > 1)}: {' '.join(options)}"


def is_number(cell: str) -> bool:
    """Whether a cell holds a number, be it with a decimal comma."""
    try:
        float(cell.replace(",", "."))
    except ValueError:
        return False
    return True
