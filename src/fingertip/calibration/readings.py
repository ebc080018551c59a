"""File of caliper readings: its template for a design, and its reading with all faults reported at once."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fingertip.calibration.lengths import Length, list_lengths
from fingertip.design import Design
from fingertip.design.issues import suggest_name
from fingertip.errors import DesignError, Issue
from fingertip.output_set import hash_parameters
from fingertip.toml_files import read_toml

IDENTITY = "coupon"
"""Key that says which coupon the readings belong to."""
PLAN = "coupon.png"
"""Name of the plan view with the numbers of the lengths."""
MIN_READINGS = 3
"""Least number of readings of a length that has any, so that a slip of the calipers shows."""
MIN_LENGTHS = 3
"""Least number of outer lengths with readings, and of inner ones."""
MAX_SCALE_ERROR, MAX_OFFSET_MM = 0.02, 0.3
"""Largest deviation of a reading from the nominal length: a share of it, and a length [mm]. More is a mistake."""
MAX_WALL_DEVIATION_MM = 0.5
"""Largest deviation of a thin wall, which may be one bead wide [mm]."""
_FACTORS = {"inches": 25.4, "centimetres": 10.0}
"""Units that are mistaken for millimetres, with their size in millimetres."""


@dataclass(frozen=True)
class Measured:
    """Length with its readings."""

    length: Length
    readings_mm: tuple[float, ...]

    @property
    def mean_mm(self) -> float:
        """Mean of the readings."""
        return math.fsum(self.readings_mm) / len(self.readings_mm)


def identify_coupon(design: Design) -> str:
    """Identify the coupon of a design by its nominal lengths."""
    return hash_parameters({length.name: length.nominal_mm for length in list_lengths(design)})[:8]


def write_template(design: Design) -> str:
    """Write the file of readings, each length with an empty list."""
    lines = [
        f"# Caliper readings of the fit coupon of {design.name}, in millimetres. Save this file under another name.",
        f"# Write at least {MIN_READINGS} readings of each length, with a decimal point: [12.30, 12.32, 12.31].",
        "# Turn the piece and set the calipers anew for each one. Leave a length empty that you cannot measure.",
        f"# The numbers are those of {PLAN}. All lengths lie in the plane of the bed; none is a height.",
        "",
        f'{IDENTITY} = "{identify_coupon(design)}"  # do not change: it names the coupon that these lengths belong to',
    ]
    titles = {"outer": "Outer lengths", "inner": "Inner lengths", "wall": "Thin walls"}
    before = ""
    for number, length in enumerate(list_lengths(design), 1):
        if length.kind != before:
            lines += ["", f"# {titles[length.kind]}"]
            before = length.kind
        lines.append(f"{length.name} = []  # {number}: nominal {length.nominal_mm:.3f}. {length.where}")
    return "\n".join(lines) + "\n"


def read_readings(path: Path, design: Design) -> tuple[Measured, ...]:
    """Read a file of readings of the coupon of a design. Lengths without readings are left out, but for thin walls.

    Raises
    ------
    TomlFileError
        If the file cannot be read or is not valid TOML.
    DesignError
        If it is of another coupon, holds unknown names or values that are no lengths, or too few readings.
    """
    return check_readings(read_toml(path), design, str(path))


def check_readings(tables: Mapping[str, Any], design: Design, source: str) -> tuple[Measured, ...]:
    """Check the contents of a file of readings, as `read_readings` does; `source` names it in messages."""
    lengths = {length.name: length for length in list_lengths(design)}
    if IDENTITY not in tables and not lengths.keys() & tables.keys():
        remedy = "`fingertip coupon` writes one to fill in"
        raise DesignError(Issue(source, f"is not a file of caliper readings; {remedy}."))
    issues = list(_find_issues(tables, design, lengths))
    if not issues:
        issues = list(_find_missing(tables, lengths.values()))
    if issues:
        raise DesignError(issues)
    measured = (Measured(length, tuple(map(float, tables.get(name, ())))) for name, length in lengths.items())
    return tuple(each for each in measured if each.readings_mm or each.length.kind == "wall")


def _find_issues(tables: Mapping[str, Any], design: Design, lengths: Mapping[str, Length]) -> Iterator[Issue]:
    """Find what cannot be used, in the order of the file."""
    identity = identify_coupon(design)
    if IDENTITY not in tables:
        yield Issue(IDENTITY, "is missing; copy the line from the template that `fingertip coupon` wrote.")
    for name, value in tables.items():
        if name == IDENTITY:
            if value != identity:
                yield Issue(
                    IDENTITY,
                    f"{value!r} is another coupon than that of {design.name}, which is {identity!r}; give the design, "
                    "and the --set, from which the measured coupon was made.",
                )
        elif name not in lengths:
            yield Issue(name, f"is no length of the coupon; {suggest_name(name, list(lengths))}")
        elif not isinstance(value, list):
            yield Issue(name, f"{value!r} is no list of readings; write {MIN_READINGS} or more in square brackets.")
        else:
            for number, reading in enumerate(value, 1):
                if problem := _describe_problem(reading, lengths[name]):
                    yield Issue(name, f"reading {number}, {problem}")


def _describe_problem(reading: Any, length: Length) -> str | None:
    """Describe what is wrong with a reading; None if nothing is."""
    if isinstance(reading, str):
        return f"{reading!r}, is text; write the number in mm with a decimal point and without quotes."
    if isinstance(reading, int) and not isinstance(reading, bool):
        return (
            f"{reading}, is a whole number, as a decimal comma leaves two of them; write it with a decimal point, such "
            f"as {length.nominal_mm:.2f}."
        )
    if not isinstance(reading, float) or not math.isfinite(reading):
        return f"{reading!r}, is not a length; write a number in mm, such as {length.nominal_mm:.2f}."
    if reading <= 0.0:
        return f"{reading:g} mm, is not positive; set the calipers to zero and measure it again."
    nominal = length.nominal_mm
    limit = MAX_WALL_DEVIATION_MM if length.kind == "wall" else MAX_SCALE_ERROR * nominal + MAX_OFFSET_MM
    if abs(reading - nominal) <= limit:
        return None
    for unit, size in _FACTORS.items():
        if length.kind != "wall" and abs(reading * size - nominal) <= limit:
            return f"{reading:g}, looks like {unit}; write it in millimetres, about {nominal:.2f}."
    return (
        f"{reading:g} mm, is more than {limit:.2g} mm off the nominal {nominal:.2f} mm; measure where the template "
        "says, in millimetres, and see that it is not swapped with another length."
    )


def _find_missing(tables: Mapping[str, Any], lengths: Iterator[Length] | Any) -> Iterator[Issue]:
    """Find lengths with too few readings, and kinds with too few lengths."""
    kinds: dict[str, list[str]] = {"outer": [], "inner": []}
    given: dict[str, int] = {"outer": 0, "inner": 0}
    for length in lengths:
        count = len(tables.get(length.name, ()))
        needed = 1 if length.kind == "wall" else MIN_READINGS
        if 0 < count < needed:
            yield Issue(length.name, f"{_count(count, 'reading')} cannot show a slip; at least {needed}, or none.")
        if length.kind in kinds:
            given[length.kind] += count > 0
            if not count:
                kinds[length.kind].append(length.name)
    for kind, missing in kinds.items():
        if given[kind] < MIN_LENGTHS:
            yield Issue(
                "readings",
                f"{_count(given[kind], f'{kind} length')} with readings are too few to tell scale from offset; at "
                f"least {MIN_LENGTHS}, such as {_join(missing[: MIN_LENGTHS - given[kind]])}.",
            )


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'' if number == 1 else 's'}"


def _join(names: Sequence[str]) -> str:
    *first, last = names
    return f"{', '.join(first)} and {last}" if first else last
