"""One swept parameter: its values as listed, as a range in steps, or as an interval that a sampler draws from."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, TypeAlias, get_args, get_origin

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ValidationError

from fingertip.design.issues import issues_from_pydantic, suggest_name
from fingertip.design.parameters import DesignTables, ParameterTable
from fingertip.errors import Issue

Value: TypeAlias = float | int | bool | str
Spacing: TypeAlias = Literal["linear", "logarithmic"]
KEYS = ("low", "high", "steps", "spacing")
_DIGITS = 9
"""Significant digits of a computed value: the last bits of logarithms differ between processors, nine digits do not."""
_POWERS = np.array([float(f"1e{i}") for i in range(309)])


@dataclass(frozen=True)
class Axis:
    """A swept parameter, dotted, and where its values come from."""

    name: str
    given: tuple[Value, ...] = ()
    """The values as listed; empty for a range."""
    low: float = 0.0
    high: float = 0.0
    steps: int = 0
    """Values of a range on a grid; 0 for an interval that a sampler draws from."""
    spacing: Spacing = "linear"
    whole: bool = False
    """Whether the parameter counts in whole numbers."""

    @cached_property
    def values(self) -> tuple[Value, ...]:
        """Every value of a list or of a range in steps; empty for an interval."""
        if self.given:
            return self.given
        shares = np.arange(self.steps) / max(1, self.steps - 1)
        return tuple(self._between(shares).tolist())

    def typed(self, stored: Any) -> Value:
        """A value as the database keeps it (it has no truth values), as it was."""
        if self.given and all(isinstance(value, bool) for value in self.given):
            return bool(stored)
        value: Value = stored
        return value

    def drawn(self, shares: NDArray[np.float64]) -> NDArray[Any]:
        """Values for shares in [0, 1), one each: equally long parts of a list, or places in the interval."""
        if self.values:
            places = np.minimum((shares * len(self.values)).astype(np.int64), len(self.values) - 1)
            return self.column(places)
        if self.whole and self.spacing == "linear":  # every whole number as likely as any other
            return (self.low + np.floor(shares * (self.high - self.low + 1.0))).astype(np.int64)
        return self._between(shares)

    def column(self, places: NDArray[np.int64]) -> NDArray[Any]:
        """The listed values at these places of the list."""
        return self._array[places]

    @cached_property
    def _array(self) -> NDArray[Any]:
        mixed = not all(isinstance(value, str) for value in self.values) and any(
            isinstance(value, str) for value in self.values
        )
        return np.array(self.values, dtype=object if mixed else None)

    def _between(self, shares: NDArray[np.float64]) -> NDArray[Any]:
        if self.spacing == "logarithmic":
            exact = self.low * (self.high / self.low) ** shares
        else:
            exact = self.low + (self.high - self.low) * shares
        exact = np.clip(exact, self.low, self.high)
        if self.whole:
            return np.round(exact).astype(np.int64)
        return rounded(exact)


def rounded(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values to `_DIGITS` significant digits, each the number nearest to its decimal."""
    with np.errstate(divide="ignore"):
        decimals = _DIGITS - 1 - np.floor(np.log10(np.abs(values)))
    places = np.where(np.isfinite(decimals), decimals, 0.0).astype(np.int64)
    up, down = _POWERS[np.maximum(places, 0)], _POWERS[np.maximum(-places, 0)]
    result: NDArray[np.float64] = np.round(values * up / down) * down / up
    return result


def flatten(tables: Mapping[str, Any], path: str = "") -> Iterator[tuple[str, Any]]:
    """Dotted names and what stands there, down to lists and to tables that hold a range."""
    for key, inner in tables.items():
        name = f"{path}.{key}" if path else key
        if isinstance(inner, Mapping) and not (set(inner) & set(KEYS)) and inner:
            yield from flatten(inner, name)
        else:
            yield name, inner


def parameter_names(model: type[BaseModel], before: str = "") -> list[str]:
    """Dotted names of all parameters of a design or a scene."""
    names = []
    for name, info in model.model_fields.items():
        if isinstance(info.default, ParameterTable):
            names += [f"{before}{name}.{key}" for key in type(info.default).model_fields]
        elif get_origin(info.annotation) is not list:
            names.append(f"{before}{name}")
    return names


def read_axis(name: str, given: Any, sampled: bool) -> tuple[Axis | None, list[Issue]]:
    """An axis as the file gives it, or what is wrong with it.

    Parameters
    ----------
    name
        Dotted; `scene.` before a parameter of the scene.
    given
        A list of values, or a table of `KEYS`.
    sampled
        Whether a sampler draws from it; else it takes part in a grid.
    """
    field = f"axes.{name}"
    model: type[BaseModel] = DesignTables
    path = name
    if name.startswith("scene."):
        model, path = _scene(), name.removeprefix("scene.")
    if path not in parameter_names(model):
        if name.startswith("scene.") and path in parameter_names(_manipulation()):
            words = "is a manipulation's, and sweeps run scenes of one finger; `fingertip simulate --set` takes it."
            return None, [Issue(field, words)]
        known = parameter_names(DesignTables) + parameter_names(_scene(), "scene.")
        return None, [Issue(field, f"there is no such parameter; {suggest_name(name, known)}")]
    axis, issues = _read(name, field, given, sampled, _annotation(model, path))
    if axis is None or issues:
        return None, issues
    values = axis.values or (axis.low, axis.high)
    if axis.whole and not axis.given:
        values = tuple(int(value) for value in values)
    found = {issue.message: issue for value in values for issue in _bounds(model, path, field, value)}
    return axis, list(found.values())


def _read(name: str, field: str, given: Any, sampled: bool, annotation: Any) -> tuple[Axis | None, list[Issue]]:
    if isinstance(given, list):
        if not given:
            return None, [Issue(field, "is an empty list; give at least one value.")]
        twice = next((value for i, value in enumerate(given) if value in given[:i]), None)
        if twice is not None:
            return None, [Issue(field, f"{twice!r} is listed more than once; list it once.")]
        # 1 and 1.0 are one value, and rows must not depend on how it was typed.
        floats = tuple(float(v) if annotation is float and type(v) is int else v for v in given)
        return Axis(name, floats, whole=annotation is int), []
    if not isinstance(given, Mapping):
        return None, [
            Issue(field, f"{given!r} is no axis; write a list of values, or {{low = 1, high = 2, steps = 5}}.")
        ]
    return _range(name, field, given, sampled, annotation)


def _range(
    name: str, field: str, given: Mapping[str, Any], sampled: bool, annotation: Any
) -> tuple[Axis | None, list[Issue]]:
    if annotation not in (float, int):
        words = get_args(annotation) or ("its values",)
        return None, [Issue(field, f"is no number, so it has no range; list its values, such as {list(words)}.")]
    issues = [
        Issue(f"{field}.{key}", f"there is no such key; {suggest_name(key, KEYS)}") for key in given if key not in KEYS
    ]
    low, high = given.get("low"), given.get("high")
    for key, value in (("low", low), ("high", high)):
        if type(value) not in (float, int) or not math.isfinite(value or 0):
            issues.append(Issue(f"{field}.{key}", f"{value!r} is no finite number; give the range's {key} end."))
    steps, spacing = given.get("steps", 0), given.get("spacing", "linear")
    if sampled and "steps" in given:
        issues.append(
            Issue(f"{field}.steps", 'is for sampling = "grid"; a sampler draws `points` values, leave it out.')
        )
    if not sampled and not issues and (type(steps) is not int or steps < 2):
        issues.append(Issue(f"{field}.steps", f"{given.get('steps')!r} is refused; give a whole number of at least 2."))
    if spacing not in get_args(Spacing):
        issues.append(Issue(f"{field}.spacing", f"{spacing!r} is not known; choose {' or '.join(get_args(Spacing))}."))
    if issues:
        return None, issues
    assert low is not None
    assert high is not None
    if not low < high:
        return None, [Issue(f"{field}.high", f"{high:g} is not above low; give more than {low:g}.")]
    if spacing == "logarithmic" and low <= 0:
        return None, [Issue(f"{field}.low", f'{low:g} has no logarithm; give more than 0, or spacing = "linear".')]
    axis = Axis(name, (), float(low), float(high), steps, spacing, whole=annotation is int)
    if len(set(axis.values)) < len(axis.values):
        maximum = int(high) - int(low) + 1
        return None, [
            Issue(f"{field}.steps", f"{steps} steps give a whole number twice; at most {maximum}, or list them.")
        ]
    return axis, []


def _scene() -> type[BaseModel]:
    from fingertip.sim.scenes.scene_file import SceneFile  # loads the whole simulation, which most sweeps do without

    return SceneFile


def _manipulation() -> type[BaseModel]:
    from fingertip.sim.hand.manipulation_file import ManipulationFile

    return ManipulationFile


def _annotation(model: type[BaseModel], path: str) -> Any:
    table, _, key = path.rpartition(".")
    section = model.model_fields[table].annotation if table else model
    assert isinstance(section, type)
    assert issubclass(section, BaseModel)
    return section.model_fields[key].annotation


def _bounds(model: type[BaseModel], path: str, field: str, value: Value) -> list[Issue]:
    """What the parameter itself refuses of a value: its type and its bounds."""
    table, _, key = path.rpartition(".")
    tables: dict[str, Any] = {table: {key: value}} if table else {key: value}
    checked = DesignTables if model is DesignTables else model
    try:
        # The fields alone: rules between parameters are asked of each point.
        checked.__pydantic_validator__.validate_python(tables, self_instance=checked.model_construct())
    except ValidationError as error:
        return [Issue(field, issue.message) for issue in issues_from_pydantic(error, model)]
    return []
