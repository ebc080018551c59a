"""Form of a design, made from the JSON schema of design files: groups of fields with bounds, units and choices."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

_STEPS = 200
"""Least number of steps of a slider."""
_LOGARITHMIC_RATIO = 1000.0
"""Ratio of the bounds from which a slider is logarithmic."""


@dataclass(frozen=True)
class Slider:
    """Range of a slider, in the unit of its field."""

    minimum: float
    maximum: float
    step: float
    is_logarithmic: bool
    """True if equal ways of the slider are equal ratios of the value."""


@dataclass(frozen=True)
class Field:
    """Field of the form: one parameter."""

    path: str
    """Dotted name, such as "skin.width_mm"."""
    pointer: str
    """JSON pointer to its value in a design (RFC 6901), such as "/skin/width_mm"."""
    kind: str
    """One of "number", "integer", "choice" and "text"."""
    default: Any
    unit: str
    description: str
    choices: tuple[str, ...] = ()
    bounds: str = ""
    """Bounds of a number for people, such as "8 to 40"."""
    slider: Slider | None = None
    """Slider of a number; None if it has a bound on one side only."""

    @property
    def key(self) -> str:
        """Name within its table."""
        return self.path.rpartition(".")[2]


@dataclass(frozen=True)
class Group:
    """Fields of one table; the fields that stand in no table are the group ""."""

    name: str
    description: str
    fields: tuple[Field, ...]


def make_form(schema: Mapping[str, Any]) -> tuple[Group, ...]:
    """Make the form of a JSON schema whose objects are nested at most once, as those of design files are.

    Raises ValueError.
    """
    loose: list[Field] = []
    groups: list[Group] = []
    for name, entry in schema["properties"].items():
        table = _resolve(schema, entry)
        if "properties" in table:
            fields = tuple(_make_field((name, key), inner) for key, inner in table["properties"].items())
            groups.append(Group(name, " ".join(table.get("description", "").split()), fields))
        else:
            loose.append(_make_field((name,), table))
    return (Group("", "", tuple(loose)), *groups) if loose else tuple(groups)


def make_pointer(path: str) -> str:
    """Make the JSON pointer of a dotted name; "" for a problem of the whole design."""
    steps = path.split(".") if path else []
    return "".join("/" + step.replace("~", "~0").replace("/", "~1") for step in steps)


def _resolve(schema: Mapping[str, Any], entry: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return what an entry refers to within the schema, or the entry itself."""
    reference = entry.get("$ref")
    if reference is None:
        return entry
    found: Any = schema
    for step in reference.removeprefix("#/").split("/"):
        found = found[step]
    return {**found, **{key: value for key, value in entry.items() if key != "$ref"}}


def _make_field(steps: tuple[str, ...], entry: Mapping[str, Any]) -> Field:
    path, kind = ".".join(steps), entry.get("type")
    common = (entry.get("default"), entry.get("unit", ""), entry.get("description", ""))
    if kind == "string":
        choices = tuple(entry.get("enum", ()))
        return Field(path, make_pointer(path), "choice" if choices else "text", *common, choices)
    if kind in ("number", "integer"):
        slider = _make_slider(entry, kind == "integer")
        return Field(path, make_pointer(path), kind, *common, (), _describe_bounds(entry), slider)
    raise ValueError(f"{path}: there is no field for the type {kind!r}")


def _make_slider(entry: Mapping[str, Any], is_whole: bool) -> Slider | None:
    above = entry.get("exclusiveMinimum")
    low, high = entry.get("minimum", above), entry.get("maximum")
    if low is None or high is None:
        return None
    step = 10.0 ** math.floor(math.log10((high - low) / _STEPS))
    if is_whole:
        step = max(1.0, step)
    if above is not None:
        low += step
    return Slider(low, high, step, low > 0 and high / low > _LOGARITHMIC_RATIO)


def _describe_bounds(entry: Mapping[str, Any]) -> str:
    low, above, high = entry.get("minimum"), entry.get("exclusiveMinimum"), entry.get("maximum")
    start = f"above {above:g}" if above is not None else f"{low:g}" if low is not None else ""
    if high is None:
        return f"at least {start}" if low is not None else start
    if not start:
        return f"at most {high:g}"
    return f"{start}, at most {high:g}" if above is not None else f"{start} to {high:g}"
