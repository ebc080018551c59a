"""Parser of the axes of a sweep file.

An axis is a list of values, or a table with the keys of `RANGE_KEYS`. An error names the axis and
all that is wrong with it.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, get_args

from pydantic.fields import FieldInfo

from fingertip.design.parameters import declaration
from fingertip.foundation.errors import Issue, SweepError, quote_value, raise_issues
from fingertip.sweep.axes import Axis, Spacing, Value
from fingertip.sweep.swept_parameters import SweptParameter, find_parameter

RANGE_KEYS = ("low", "high", "steps", "spacing")
"""Keys of a range, in the order in which a message lists them."""
MAX_STEPS = 100_000
"""Maximum number of values of one axis. They are held in memory."""
MIN_STEPS = 2
"""Minimum number of values of a range: its two ends."""


def flatten_axes(tables: Mapping[str, Any], path: str = "") -> Iterator[tuple[str, Any]]:
    """Yield each dotted name of nested tables with its list or its range."""
    for key, entry in tables.items():
        name = f"{path}.{key}" if path else key
        if _is_table_of_axes(entry):
            yield from flatten_axes(entry, name)
        else:
            yield name, entry


def _is_table_of_axes(entry: Any) -> bool:
    """Return whether an entry holds axes; it is an axis itself if it has a key of a range."""
    if not isinstance(entry, Mapping) or not entry:
        return False

    return not any(key in RANGE_KEYS for key in entry)


def read_axis(name: str, entry: Any, sampled: bool) -> tuple[Axis, list[Issue]]:
    """Read an axis of a sweep file, and the issues of values beyond the parameter's bounds.

    `sampled` is false for a grid, whose ranges need a number of steps. Raises SweepError if the
    name is that of no parameter, or the entry is no axis.
    """
    parameter = find_parameter(name)

    if isinstance(entry, list):
        axis = _parse_list(name, entry, parameter.field)
    elif isinstance(entry, Mapping):
        axis = _parse_range(name, entry, parameter.field, sampled)
    else:
        remedy = "write a list of values, or {low = 1, high = 2, steps = 5}"
        message = f"{quote_value(entry)} is not an axis; {remedy}."
        raise SweepError(Issue(f"axes.{name}", message))

    return axis, _check_bounds(axis, parameter)


# Bounds of the parameter
# -----------------------


def _check_bounds(axis: Axis, parameter: SweptParameter) -> list[Issue]:
    """Check the values of an axis; a bound that many of them break is reported once."""
    messages = dict[str, None]()  # in the order of the values
    for value in _select_extremes(axis):
        messages |= dict.fromkeys(parameter.check_value(value))

    return [Issue(f"axes.{axis.name}", message) for message in messages]


def _select_extremes(axis: Axis) -> tuple[Value, ...]:
    """Select the values that break a bound of the parameter if any value of the axis does.

    Bounds that hold at the ends of a range, or of a list of numbers, hold between them.
    """
    if not axis.listed:
        ends = (axis.low, axis.high)
        return tuple(int(end) for end in ends) if axis.integer else ends

    if not all(_is_finite_number(value) for value in axis.listed):
        return axis.listed

    # A whole number among fractions may be of the wrong type.
    first_type = type(axis.listed[0])
    of_other_type = [value for value in axis.listed if type(value) is not first_type]

    return (min(axis.listed), max(axis.listed), *of_other_type)


# Lists
# -----


def _parse_list(name: str, entry: Sequence[Any], parameter: FieldInfo) -> Axis:
    """Parse an axis of listed values. Raises SweepError."""
    message = _find_list_fault(entry)
    if message:
        raise SweepError(Issue(f"axes.{name}", message))

    values = tuple(entry)
    if parameter.annotation is float:
        # 1 and 1.0 are the same value; rows must not depend on how it was typed.
        values = tuple(float(value) if type(value) is int else value for value in entry)

    return Axis(name, values, integer=parameter.annotation is int)


def _find_list_fault(entry: Sequence[Any]) -> str:
    """Return what is wrong with a list of values, and what to do; "" if nothing is."""
    if not entry:
        return "is an empty list; give at least one value."

    if len(entry) > MAX_STEPS:
        return f"lists {len(entry)} values; at most {MAX_STEPS}, or give a range."

    for value in entry:
        if not isinstance(value, float | int | str):
            return f"{quote_value(value)} is no value of a parameter; list numbers or texts."
        if isinstance(value, int) and abs(value) > sys.float_info.max:
            return "lists a number of more than 308 digits; list smaller ones."

    earlier_values = set[Value]()
    for value in entry:
        if value in earlier_values:
            return f"{quote_value(value)} is listed more than once; list it once."

        earlier_values.add(value)

    return ""


# Ranges
# ------


def _parse_range(name: str, entry: Mapping[str, Any], parameter: FieldInfo, sampled: bool) -> Axis:
    """Parse an axis from a low to a high end. Raises SweepError."""
    field = f"axes.{name}"
    if parameter.annotation not in (float, int):
        choices = list(declaration.list_choices(parameter) or ("its values",))
        message = f"is not a number, so it has no range; list its values, such as {choices}."
        raise SweepError(Issue(field, message))

    raise_issues(SweepError, _check_keys(field, entry, sampled))
    axis = Axis(
        name=name,
        low=float(entry["low"]),
        high=float(entry["high"]),
        steps=entry.get("steps", 0),
        spacing=entry.get("spacing", "linear"),
        integer=parameter.annotation is int,
    )
    raise_issues(SweepError, _check_order(field, entry["low"], entry["high"], axis.spacing))

    return axis


def _check_keys(field: str, entry: Mapping[str, Any], sampled: bool) -> list[Issue]:
    """Check each key of a range by itself."""
    issues = [*_check_names(field, entry), *_check_ends(field, entry)]

    if sampled:
        issues += _check_absent_steps(field, entry)
    else:
        # A key that is misspelt may be the one that is missing, so its name is reported alone.
        issues += [] if issues else _check_minimum_steps(field, entry)
        issues += _check_maximum_steps(field, entry)

    issues += _check_spacing(field, entry)
    return issues


def _check_names(field: str, entry: Mapping[str, Any]) -> Iterator[Issue]:
    """Yield an issue for each key that a range does not have."""
    for key in entry:
        if key not in RANGE_KEYS:
            remedy = declaration.suggest_name(key, RANGE_KEYS)
            yield Issue(f"{field}.{key}", f"there is no such key; {remedy}")


def _check_ends(field: str, entry: Mapping[str, Any]) -> Iterator[Issue]:
    """Yield an issue for each end of a range that is missing or no finite number."""
    for key in ("low", "high"):
        remedy = f"give the {key} end of the range."
        if key not in entry:
            yield Issue(f"{field}.{key}", f"is missing; {remedy}")
        elif not _is_finite_number(entry[key]):
            problem = f"{quote_value(entry[key])} is not a finite number"
            yield Issue(f"{field}.{key}", f"{problem}; {remedy}")


def _check_absent_steps(field: str, entry: Mapping[str, Any]) -> Iterator[Issue]:
    """Yield an issue if a range that a sampler draws from has steps."""
    if "steps" in entry:
        message = 'is only for sampling = "grid"; a sampler draws `points` values, leave it out.'
        yield Issue(f"{field}.steps", message)


def _check_minimum_steps(field: str, entry: Mapping[str, Any]) -> Iterator[Issue]:
    """Yield an issue if a range of a grid has no whole number of steps, or too few."""
    remedy = f"give a whole number of at least {MIN_STEPS}."
    if "steps" not in entry:
        yield Issue(f"{field}.steps", f"is missing; {remedy}")
        return

    steps = entry["steps"]
    if type(steps) is not int or steps < MIN_STEPS:
        problem = f"{quote_value(steps)} is not a number of values"
        yield Issue(f"{field}.steps", f"{problem}; {remedy}")


def _check_maximum_steps(field: str, entry: Mapping[str, Any]) -> Iterator[Issue]:
    """Yield an issue if a range of a grid has too many steps."""
    steps = entry.get("steps")
    if type(steps) is int and steps > MAX_STEPS:
        message = f"{steps} values are too many; at most {MAX_STEPS}, or use a sampler."
        yield Issue(f"{field}.steps", message)


def _check_spacing(field: str, entry: Mapping[str, Any]) -> Iterator[Issue]:
    """Yield an issue if a range names a spacing that there is not."""
    names = get_args(Spacing)
    if "spacing" in entry and entry["spacing"] not in names:
        problem = f"{quote_value(entry['spacing'])} is unknown"
        yield Issue(f"{field}.spacing", f"{problem}; choose {' or '.join(names)}.")


def _check_order(field: str, low: float, high: float, spacing: Spacing) -> list[Issue]:
    """Check the order of the ends, and what a logarithmic spacing requires of them."""
    if low >= high:
        message = f"{high:g} is not above low; give more than {low:g}."
        return [Issue(f"{field}.high", message)]

    if spacing == "logarithmic" and low <= 0:
        problem = f"{low:g} is not above 0, which a logarithmic spacing requires"
        remedy = 'give more than 0, or spacing = "linear".'
        return [Issue(f"{field}.low", f"{problem}; {remedy}")]

    return []


def _is_finite_number(value: Any) -> bool:
    """Return whether a value is a number, but no flag, that a float can hold."""
    if type(value) not in (float, int):
        return False

    try:
        return math.isfinite(value)
    except OverflowError:  # a whole number beyond every float
        return False
