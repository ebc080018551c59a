"""Axes of a sweep: one swept parameter each, with listed values, a stepped range, or an interval to
sample.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, TypeAlias, get_args, get_origin

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from fingertip.catalogues.electronics import split_finger
from fingertip.design.geometry import DesignTables
from fingertip.design.parameters import ELECTRONIC_TABLES, ParameterTable, declaration
from fingertip.foundation.errors import Issue, SweepError, quote_value, raise_issues

Value: TypeAlias = float | int | bool | str
Spacing: TypeAlias = Literal["linear", "logarithmic"]
RANGE_KEYS = ("low", "high", "steps", "spacing")
MAX_STEPS = 100_000
"""Maximum number of values of one axis. They are held in memory."""
_DIGITS = 9
"""Significant digits of a computed value.
The last bits of a logarithm differ between processors.
"""
_POWERS = np.array([float(f"1e{i}") for i in range(309)])
"""Powers of ten, each the float nearest to its decimal."""


@dataclass(frozen=True)
class Axis:
    """Swept parameter, and where its values come from."""

    name: str
    """Dotted name of the parameter."""
    listed: tuple[Value, ...] = ()
    low: float = 0.0
    high: float = 0.0
    steps: int = 0
    """Number of values of a range on a grid; 0 for an interval that a sampler draws from."""
    spacing: Spacing = "linear"
    integer: bool = False

    @property
    def count(self) -> int:
        """Number of values of a list or of a stepped range, without making them.

        0 for an interval.
        """
        return len(self.listed) or self.steps

    @cached_property
    def values(self) -> tuple[Value, ...]:
        """Every value of a list or of a stepped range; empty for an interval."""
        if self.listed:
            return self.listed

        fractions = np.arange(self.steps) / max(1, self.steps - 1)
        return tuple(self._interpolate(fractions).tolist())

    def restore_type(self, stored: Any) -> Value:
        """Return a value its type back; the database stores booleans as integers."""
        if self.listed and all(isinstance(value, bool) for value in self.listed):
            return bool(stored)

        value: Value = stored
        return value

    def sample(self, fractions: NDArray[np.float64]) -> NDArray[Any]:
        """Map fractions in [0, 1) to values: equal parts for the values of a list, else
        interpolation.
        """
        if self.values:
            return self.array[
                np.minimum((fractions * len(self.values)).astype(np.int64), len(self.values) - 1)
            ]
        # Gives every integer, the ends too, the same probability.
        if self.integer and self.spacing == "linear":
            return (self.low + np.floor(fractions * (self.high - self.low + 1.0))).astype(np.int64)

        return self._interpolate(fractions)

    @cached_property
    def array(self) -> NDArray[Any]:
        words = [isinstance(value, str) for value in self.values]
        return np.array(self.values, dtype=object if any(words) and not all(words) else None)

    def _interpolate(self, fractions: NDArray[np.float64]) -> NDArray[Any]:
        if self.spacing == "logarithmic":
            exact = self.low * (self.high / self.low) ** fractions
        else:
            exact = self.low + (self.high - self.low) * fractions

        exact = np.clip(exact, self.low, self.high)
        if self.integer:
            return np.round(exact).astype(np.int64)

        return round_significant(exact)


def round_significant(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Round to `_DIGITS` significant digits; each result is the float nearest to its decimal."""
    with np.errstate(divide="ignore"):
        decimals = _DIGITS - 1 - np.floor(np.log10(np.abs(values)))

    # The smallest floats have more decimals than there are powers of ten.
    most = len(_POWERS) - 1
    places = np.clip(np.where(np.isfinite(decimals), decimals, 0.0), -most, most).astype(np.int64)
    up = _POWERS[np.maximum(places, 0)]
    down = _POWERS[np.maximum(-places, 0)]
    result: NDArray[np.float64] = np.round(values * up / down) * down / up

    return result


def flatten_axes(tables: Mapping[str, Any], path: str = "") -> Iterator[tuple[str, Any]]:
    """Return each dotted name of nested tables with its list or its range."""
    for key, inner in tables.items():
        name = f"{path}.{key}" if path else key
        if isinstance(inner, Mapping) and not (set(inner) & set(RANGE_KEYS)) and inner:
            yield from flatten_axes(inner, name)
        else:
            yield name, inner


def select_changes(parameters: Mapping[str, Value], finger: str = "") -> dict[str, Value]:
    """Select what a point changes in a design, or in a finger of a set, whose own parameters come
    last.
    """
    of_all: dict[str, Value] = {}
    of_finger: dict[str, Value] = {}
    for name, value in parameters.items():
        owner, path = split_finger(name)
        if name.startswith("scene."):
            continue
        if not owner:
            of_all[path] = value
        elif owner == finger:
            of_finger[path] = value

    return of_all | of_finger


def is_of_parts(name: str) -> bool:
    """Return whether the shape of parts may depend on a parameter, dotted."""
    return split_finger(name)[1].partition(".")[0] not in {*ELECTRONIC_TABLES, "scene"}


def list_parameter_names(model: type[BaseModel], prefix: str = "") -> list[str]:
    """List the dotted names of all parameters of a design or a scene."""
    names = []
    for name, info in model.model_fields.items():
        if isinstance(info.default, ParameterTable):
            names += [f"{prefix}{name}.{key}" for key in type(info.default).model_fields]
        elif get_origin(info.annotation) is not list:
            names.append(f"{prefix}{name}")

    return names


def read_axis(name: str, entry: Any, sampled: bool) -> tuple[Axis, list[Issue]]:
    """Read an axis of a sweep file, and the issues of values beyond their bounds.

    Raises SweepError.
    """
    field = f"axes.{name}"
    model: type[BaseModel] = DesignTables
    path = split_finger(name)[1]

    if name.startswith("scene."):
        model = _load_scene_models()[0]
        path = name.removeprefix("scene.")

    if path not in list_parameter_names(model):
        if name.startswith("scene.") and path in list_parameter_names(_load_scene_models()[1]):
            problem = "is a parameter of a manipulation, but a sweep simulates scenes of one finger"
            raise SweepError(
                Issue(field, f"{problem}; use `fingertip simulate` with --set for a manipulation.")
            )

        known = list_parameter_names(DesignTables) + list_parameter_names(
            _load_scene_models()[0], "scene."
        )
        if path in declaration.load_retired():
            raise SweepError(Issue(field, declaration.load_retired()[path]))

        similar = declaration.find_similar_name(name, known)
        # The list of all names would be too long for a message.
        remedy = (
            f"did you mean {similar}?"
            if similar
            else "`fingertip params` lists the names of a design."
        )
        raise SweepError(Issue(field, f"there is no such parameter; {remedy}"))

    axis = _parse_axis(
        name,
        field=field,
        entry=entry,
        sampled=sampled,
        declared=_find_declaration(model, path),
    )
    # A parameter's own bounds hold between the ends of a range, or of a list of numbers, if they
    # hold there.
    values = axis.listed or (axis.low, axis.high)
    are_numbers = all(type(value) in (float, int) and _is_finite(value) for value in axis.listed)
    if axis.listed and are_numbers:
        of_other_type = (value for value in axis.listed if type(value) is not type(axis.listed[0]))
        values = (min(axis.listed), max(axis.listed), *of_other_type)
    if axis.integer and not axis.listed:
        values = tuple(int(value) for value in values)

    # Many values break the same bound: each message is reported once.
    issues_by_text: dict[str, Issue] = {}
    for value in values:
        for issue in _check_value(model, path, field, value):
            issues_by_text[issue.message] = issue

    return axis, list(issues_by_text.values())


def _parse_axis(
    name: str,
    field: str,
    entry: Any,
    sampled: bool,
    declared: FieldInfo,
) -> Axis:
    annotation = declared.annotation
    if isinstance(entry, list):
        if not entry:
            raise SweepError(Issue(field, "is an empty list; give at least one value."))
        if len(entry) > MAX_STEPS:
            raise SweepError(
                Issue(field, f"lists {len(entry)} values; at most {MAX_STEPS}, or give a range.")
            )

        nested = next((value for value in entry if not isinstance(value, get_args(Value))), None)
        if nested is not None:
            raise SweepError(
                Issue(
                    field,
                    f"{quote_value(nested)} is no value of a parameter; list numbers or texts.",
                )
            )

        seen = set[Value]()
        for value in entry:
            if value in seen:
                raise SweepError(
                    Issue(field, f"{quote_value(value)} is listed more than once; list it once.")
                )

            seen.add(value)

        # 1 and 1.0 are the same value; rows must not depend on how it was typed.
        values = tuple(float(v) if annotation is float and type(v) is int else v for v in entry)
        return Axis(name, values, integer=annotation is int)

    if not isinstance(entry, Mapping):
        remedy = "write a list of values, or {low = 1, high = 2, steps = 5}"
        raise SweepError(Issue(field, f"{quote_value(entry)} is not an axis; {remedy}."))

    return _parse_range(
        name,
        field=field,
        entry=entry,
        sampled=sampled,
        declared=declared,
    )


def _parse_range(
    name: str,
    field: str,
    entry: Mapping[str, Any],
    sampled: bool,
    declared: FieldInfo,
) -> Axis:
    annotation = declared.annotation
    if annotation not in (float, int):
        remedy = (
            "list its values, such as "
            f"{list(declaration.list_choices(declared) or ('its values',))}"
        )
        raise SweepError(Issue(field, f"is not a number, so it has no range; {remedy}."))

    # Keys and types of their values
    unknown = {
        key: declaration.suggest_name(key, RANGE_KEYS) for key in entry if key not in RANGE_KEYS
    }
    issues = [
        Issue(f"{field}.{key}", f"there is no such key; {remedy}")
        for key, remedy in unknown.items()
    ]
    low = entry.get("low")
    high = entry.get("high")

    for key, value in (("low", low), ("high", high)):
        if key not in entry:
            issues.append(Issue(f"{field}.{key}", f"is missing; give the {key} end of the range."))
        elif type(value) not in (float, int) or not _is_finite(value):
            problem = (
                f"{quote_value(value)} is not a finite number; give the {key} end of the range."
            )
            issues.append(Issue(f"{field}.{key}", problem))

    steps = entry.get("steps", 0)
    spacing = entry.get("spacing", "linear")
    if sampled and "steps" in entry:
        message = 'is only for sampling = "grid"; a sampler draws `points` values, leave it out.'
        issues.append(Issue(f"{field}.steps", message))

    if not sampled and not issues and (type(steps) is not int or steps < 2):
        problem = (
            f"{quote_value(steps)} is not a number of values" if "steps" in entry else "is missing"
        )
        issues.append(Issue(f"{field}.steps", f"{problem}; give a whole number of at least 2."))

    if not sampled and type(steps) is int and steps > MAX_STEPS:
        issues.append(
            Issue(
                f"{field}.steps",
                f"{steps} values are too many; at most {MAX_STEPS}, or use a sampler.",
            )
        )

    if spacing not in get_args(Spacing):
        remedy = f"choose {' or '.join(get_args(Spacing))}."
        issues.append(Issue(f"{field}.spacing", f"{quote_value(spacing)} is unknown; {remedy}"))

    raise_issues(SweepError, issues)
    assert low is not None
    assert high is not None

    # Order of the ends, and what the spacing requires of them
    if not low < high:
        raise SweepError(
            Issue(f"{field}.high", f"{high:g} is not above low; give more than {low:g}.")
        )

    if spacing == "logarithmic" and low <= 0:
        problem = f"{low:g} is not above 0, which a logarithmic spacing requires"
        raise SweepError(
            Issue(f"{field}.low", f'{problem}; give more than 0, or spacing = "linear".')
        )

    return Axis(
        name=name,
        listed=(),
        low=float(low),
        high=float(high),
        steps=steps,
        spacing=spacing,
        integer=annotation is int,
    )


def find_repeats(axis: Axis) -> list[Issue]:
    """Find an axis of whole numbers whose range has fewer of them than steps. Makes its values."""
    if axis.listed or len(set(axis.values)) == len(axis.values):
        return []

    maximum = int(axis.high) - int(axis.low) + 1
    message = (
        f"{axis.steps} steps repeat a whole number; give at most {maximum}, or list the values."
    )
    return [Issue(f"axes.{axis.name}.steps", message)]


def _is_finite(value: Any) -> bool:
    try:
        return math.isfinite(value)
    except OverflowError:  # a whole number beyond every float
        return False


def _load_scene_models() -> tuple[type[BaseModel], type[BaseModel]]:
    """Models of a scene and of a manipulation.

    They import the whole simulation, which most sweeps do not use.
    """
    from fingertip.sim.runs.scene_and_manipulation_files import ManipulationFile, SceneFile  # noqa: PLC0415

    return SceneFile, ManipulationFile


def _find_declaration(model: type[BaseModel], path: str) -> FieldInfo:
    table, _, key = path.rpartition(".")
    section = model.model_fields[table].annotation if table else model
    assert isinstance(section, type)
    assert issubclass(section, BaseModel)

    return section.model_fields[key]


def _check_value(model: type[BaseModel], path: str, field: str, value: Value) -> list[Issue]:
    table, _, key = path.rpartition(".")
    tables: dict[str, Any] = {table: {key: value}} if table else {key: value}
    try:
        # This validates the fields alone. Rules between parameters are checked at each point.
        model.__pydantic_validator__.validate_python(tables, self_instance=model.model_construct())
    except ValidationError as error:
        return [
            Issue(field, issue.message) for issue in declaration.issues_from_pydantic(error, model)
        ]

    return []
