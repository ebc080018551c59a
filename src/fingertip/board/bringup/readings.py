"""File of a board's readings, of one finger or several: its template, and its reading with all faults at once."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fingertip.board.bringup.bench import TONE_V
from fingertip.board.bringup.plan import QUIET, SUPPLY_MA, BringUp
from fingertip.board.bringup.prediction import Limits
from fingertip.board.bringup.resistances import SUPPLY_OHM, limit_resistances
from fingertip.board.parts.nets import VCC
from fingertip.design.parameters.declaration import suggest_name
from fingertip.foundation.errors import BoardError, Issue, raise_issues
from fingertip.foundation.tables import read_toml

IDENTITY, TONE = "board", "tone_v"
UNITS = {"_v": "V", "_ohm": "ohm", "_ma": "mA"}
MAX_TONE_RATIO = 2.0
"""Largest ratio of the tone to the planned one, either way: more clips, less drowns in the meter's error."""

_SUPPLY_RATIO = 1.1
"""Largest voltage that is accepted as a reading, in units of the supply."""


@dataclass(frozen=True)
class Readings:
    tone_v: float
    """RMS of the generator's tone [V]."""
    values: Mapping[str, float]
    """Readings by name, each in the unit that its name ends in. What was not measured is left out."""


def unit_of(name: str) -> str:
    return next(unit for end, unit in UNITS.items() if name.endswith(end))


def readings_template(plan: BringUp, name: str) -> str:
    """Write the file of readings, each still without a value."""
    lines = (format_entry(key, limits) for key, limits in plan.all.items())
    return "\n".join((*list_head(plan, name), "", *lines)) + "\n"


def list_head(plan: BringUp, name: str) -> list[str]:
    return [
        f"# Readings of a board of {name}, as bringup.md describes them. Save this file under another name.",
        "# Write each reading in place of nan. What you did not measure stays nan.",
        "",
        f'{IDENTITY} = "{plan.identity}"  # do not change: it names the board that these readings belong to',
        f"{TONE} = {TONE_V}  # V RMS of the tone, measured at the generator while it is connected",
    ]


def format_entry(key: str, limits: Limits) -> str:
    expected = f"expected {round(float(f'{limits.expected_v:.4g}'), 4) + 0.0:.4g}"
    if math.isinf(limits.high_v):
        expected = f"above {limits.low_v:.0f}"
    return f"{key} = nan  # {unit_of(key)}, {expected}"


def read_readings(path: Path, plan: BringUp) -> Readings:
    """Read a file of readings. Raises TomlFileError or BoardError."""
    tables = read_toml(path)
    raise_issues(BoardError, find_reading_issues(tables, plan, path))
    return select_readings(tables, plan)


def select_readings(tables: Mapping[str, Any], plan: BringUp) -> Readings:
    return Readings(float(tables.get(TONE, TONE_V)), take_values(tables, plan))


def take_values(tables: Mapping[str, Any], plan: BringUp) -> dict[str, float]:
    """Take what was measured, by the reading's name; what is no number is an issue of its own."""
    known = plan.all.keys() | limit_resistances(plan.board.circuit).keys()
    return {n: float(v) for n, v in tables.items() if n in known and isinstance(v, int | float) and not math.isnan(v)}


def find_reading_issues(
    tables: Mapping[str, Any], plan: BringUp, path: Path, *, needs_reading: bool = True
) -> Iterator[Issue]:
    names = plan.all | limit_resistances(plan.board.circuit)
    if IDENTITY not in tables:
        remedy = "`fingertip board DESIGN --bringup` writes a file to fill in, with the line that names the board"
        yield Issue(f"{path}, {IDENTITY}", f"is missing; {remedy}.")
    for name, value in tables.items():
        if name == IDENTITY:
            if value != plan.identity:
                remedy = "give the design, and the --set, from which the board was made"
                yield Issue(IDENTITY, f"{value!r} is another board than this design's, {plan.identity!r}; {remedy}.")
        elif name != TONE and name not in names:
            yield Issue(name, f"is no reading of this board; {suggest_name(name, [TONE, *names])}")
        elif isinstance(value, bool) or not isinstance(value, int | float):
            yield Issue(name, f"{value!r} is no number; write the reading in {unit_of(name)}, or nan.")
        elif name == TONE and not TONE_V / MAX_TONE_RATIO <= value <= TONE_V * MAX_TONE_RATIO:
            low, high = TONE_V / MAX_TONE_RATIO, TONE_V * MAX_TONE_RATIO
            yield Issue(name, f"{value:g} V is no tone for this test; measure again with {low:g} to {high:g} V RMS.")
        elif name in {*plan.levels, QUIET} and abs(value) > (bound := _SUPPLY_RATIO * plan.board.rails_v[VCC]):
            volts = value / 1e3
            remedy = f"write {volts:g} if the meter showed mV" if abs(volts) <= bound else "measure again, or write nan"
            yield Issue(
                name,
                f"{value:g} V cannot be: no voltage of this board exceeds {plan.board.rails_v[VCC]:g} V; {remedy}.",
            )
        elif math.isinf(value) and not name.endswith("_ohm"):
            yield Issue(name, f"{value} {unit_of(name)} is no reading; write a number, or nan.")
    if needs_reading and not take_values(tables, plan):
        yield Issue(str(path), "holds no reading; write at least one in place of nan.")


# File of a board for several fingers: a table of readings for each, and what is read once for all.

COMMON_READINGS = (SUPPLY_OHM, SUPPLY_MA)
"""Readings that are taken once, and not for each finger."""
WHOLE_BOARD = "board"


def write_template(plan: BringUp, fingers: Sequence[str], name: str) -> str:
    """Write the file of readings, each still without a value: a table for each finger."""
    own = [format_entry(key, limits) for key, limits in plan.all.items() if key not in COMMON_READINGS]
    lines = [*list_head(plan, name), *(format_entry(key, plan.all[key]) for key in COMMON_READINGS)]
    for channel, finger in enumerate(fingers, start=1):
        lines += ["", f"[{finger}]  # finger {channel}: TP1 is TP{channel}01", *own]
    return "\n".join(lines) + "\n"


def read_fingers(path: Path, plan: BringUp, fingers: Sequence[str]) -> dict[str, Readings]:
    """Read a file of readings by finger; one that was not measured is left out. Raises TomlFileError or BoardError."""
    content = read_toml(path)
    tables = {name: value for name, value in content.items() if isinstance(value, dict)}
    common = {name: value for name, value in content.items() if name not in tables}
    raise_issues(BoardError, _find_issues(common, tables, plan, fingers, path))
    tone = {TONE: common[TONE]} if TONE in common else {}
    found = {WHOLE_BOARD: select_readings(common, plan)}
    found |= {finger: select_readings({**tone, **tables.get(finger, {})}, plan) for finger in fingers}
    return {finger: taken for finger, taken in found.items() if taken.values}


def _find_issues(
    common: Mapping[str, Any], tables: Mapping[str, Any], plan: BringUp, fingers: Sequence[str], path: Path
) -> Iterator[Issue]:
    for name in (name for name in tables if name not in fingers):
        yield Issue(f"[{name}]", f"is no finger of this board; {suggest_name(name, list(fingers))}")
    expected = (IDENTITY, TONE, *COMMON_READINGS)
    stated = {name: value for name, value in common.items() if name in expected}
    for name in (name for name in common if name not in stated):
        yield Issue(name, f"stands ahead of the tables; write it below one of [{'], ['.join(fingers)}].")
    yield from find_reading_issues(stated, plan, path, needs_reading=False)
    for finger in fingers:
        own = {IDENTITY: plan.identity, **tables.get(finger, {})}
        for issue in find_reading_issues(own, plan, path, needs_reading=False):
            yield Issue(f"{finger}.{issue.field}", issue.message)
    if not any(take_values(table, plan) for table in (common, *tables.values())):
        yield Issue(str(path), "holds no reading; write at least one in place of nan.")
