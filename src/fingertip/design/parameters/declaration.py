"""Declaration of one parameter: its default, unit, bounds and description, in a single line of its table."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, get_args, get_origin

from pydantic import BaseModel, ConfigDict, Field
from pydantic.fields import FieldInfo


class ParameterTable(BaseModel):
    """A table of a TOML file. It is frozen, and strict about the types and names it accepts."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)


@dataclass(frozen=True)
class Bounds:
    """Bounds of a numeric parameter, in its unit; None where it has none."""

    minimum: float | None = None
    above: float | None = None
    """Exclusive lower bound."""
    maximum: float | None = None

    def contain(self, value: float) -> bool:
        """Return whether a value lies within the bounds."""
        return (
            (self.minimum is None or value >= self.minimum)
            and (self.above is None or value > self.above)
            and (self.maximum is None or value <= self.maximum)
        )


def quantity(
    default: float,
    unit: str,
    description: str,
    *,
    minimum: float | None = None,
    above: float | None = None,
    maximum: float | None = None,
    verified: bool = True,
) -> Any:
    """Declare a number with a unit."""
    if not verified:
        description += " (unverified)"
    return Field(default, ge=minimum, gt=above, le=maximum, description=description, json_schema_extra={"unit": unit})


def choice(default: str, description: str) -> Any:
    """Declare a word from a fixed list, which is the field's Literal type."""
    return Field(default, description=description)


def text(default: str, description: str, *, pattern: str, allowed: str) -> Any:
    """Declare a text that matches a pattern; `allowed` says in a message what it may hold."""
    return Field(default, pattern=pattern, description=description, json_schema_extra={"allowed": allowed})


def find_allowed(field: FieldInfo) -> str:
    """Return what a text may hold, as a part of a sentence; "" if the parameter is no text declared here."""
    extra = field.json_schema_extra
    return str(extra.get("allowed", "")) if isinstance(extra, dict) else ""


def find_unit(field: FieldInfo) -> str:
    """Return the unit of a parameter; "" if it has none."""
    extra = field.json_schema_extra
    return str(extra.get("unit", "")) if isinstance(extra, dict) else ""


def find_bounds(field: FieldInfo) -> Bounds:
    """Return the bounds of a numeric parameter."""
    found: dict[str, float] = {}
    for constraint in field.metadata:
        for key, name in (("ge", "minimum"), ("gt", "above"), ("le", "maximum")):
            if (bound := getattr(constraint, key, None)) is not None:
                found[name] = bound
    return Bounds(**found)


def list_choices(field: FieldInfo) -> tuple[str, ...]:
    """Return the words that a parameter accepts; none for a number or free text."""
    return get_args(field.annotation) if get_origin(field.annotation) is Literal else ()


def format_unit(unit: str) -> str:
    """Return a unit as it follows a number in a sentence, with the space before it."""
    return f" {_PLURALS.get(unit, unit)}" if unit else ""


_PLURALS = {"degree": "degrees", "bit": "bits"}
