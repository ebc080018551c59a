"""File of a board's readings: its template, and its reading with all faults reported at once."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fingertip.board.bringup.bench import TONE_V
from fingertip.board.bringup.plan import BringUp
from fingertip.board.nets import VCC
from fingertip.design.issues import suggest_name
from fingertip.errors import BoardError, Issue
from fingertip.toml_files import read_toml

IDENTITY, TONE = "board", "tone_v"
UNITS = {"_v": "V", "_ohm": "ohm", "_ma": "mA"}
MAX_TONE_RATIO = 2.0
"""Largest ratio of the tone to the planned one, either way: more clips, less drowns in the meter's error."""

_SUPPLY_RATIO = 1.1
"""Largest voltage that is accepted as a reading, in units of the supply."""


@dataclass(frozen=True)
class Readings:
    """Readings that were taken."""

    tone_v: float
    """RMS of the generator's tone [V]."""
    values: Mapping[str, float]
    """Readings by name, each in the unit that its name ends in. What was not measured is left out."""


def unit_of(name: str) -> str:
    """Unit of a reading, by the end of its name."""
    return next(unit for end, unit in UNITS.items() if name.endswith(end))


def readings_template(plan: BringUp, name: str) -> str:
    """Write the file of readings, each still without a value."""
    lines = [
        f"# Readings of a board of {name}, as bringup.md describes them. Save this file under another name.",
        "# Write each reading in place of nan. What you did not measure stays nan.",
        "",
        f'{IDENTITY} = "{plan.identity}"  # do not change: it names the board that these readings belong to',
        f"{TONE} = {TONE_V}  # V RMS of the tone, measured at the generator while it is connected",
        "",
    ]
    for key, limits in plan.all.items():
        expected = f"expected {round(limits.expected_v, 4) + 0.0:.4g}"
        if math.isinf(limits.high_v):
            expected = f"above {limits.low_v:.0f}"
        lines.append(f"{key} = nan  # {unit_of(key)}, {expected}")
    return "\n".join(lines) + "\n"


def read_readings(path: Path, plan: BringUp) -> Readings:
    """Read a file of readings.

    Raises
    ------
    TomlFileError
        If the file cannot be read or is not valid TOML.
    BoardError
        If it is of another board, holds unknown names, or values that are no readings.
    """
    tables = read_toml(path)
    if issues := list(_find_issues(tables, plan, path)):
        raise BoardError(issues)
    taken = {n: float(v) for n, v in tables.items() if n in plan.all and not math.isnan(v)}
    return Readings(float(tables.get(TONE, TONE_V)), taken)


def _find_issues(tables: Mapping[str, Any], plan: BringUp, path: Path) -> Iterator[Issue]:
    names = plan.all
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
        elif name in plan.voltages and abs(value) > (bound := _SUPPLY_RATIO * plan.board.rails_v[VCC]):
            volts = value / 1e3
            remedy = f"write {volts:g} if the meter showed mV" if abs(volts) <= bound else "measure again, or write nan"
            yield Issue(
                name,
                f"{value:g} V cannot be: no voltage of this board exceeds {plan.board.rails_v[VCC]:g} V; {remedy}.",
            )
        elif math.isinf(value) and not name.endswith("_ohm"):
            yield Issue(name, f"{value} {unit_of(name)} is no reading; write a number, or nan.")
    if not any(n in names and isinstance(v, int | float) and not math.isnan(v) for n, v in tables.items()):
        yield Issue(str(path), "holds no reading; write at least one in place of nan.")
