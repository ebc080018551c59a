"""How one parameter is declared: its default, unit, bounds and meaning in a single line of a section."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, ConfigDict, Field


class Section(BaseModel):
    """A table of the design file: frozen, and strict about what it accepts."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)


def quantity(
    default: float,
    unit: str,
    meaning: str,
    *,
    minimum: float | None = None,
    above: float | None = None,
    maximum: float | None = None,
    verified: bool = True,
) -> Any:
    """A number with a unit.

    Parameters
    ----------
    default
        Value used when the file is silent.
    unit
        What the number counts ("mm", "Hz", "" for a ratio); the field's name carries it too.
    meaning
        One sentence for `fingertip params` and for editors.
    least, above, most
        Closed lower, open lower and closed upper bound, in `unit`.
    verified
        False marks a figure no document was found for.
    """
    if not verified:
        meaning += " (unverified figure)"
    return Field(default, ge=minimum, gt=above, le=maximum, description=meaning, json_schema_extra={"unit": unit})


def choice(default: str, meaning: str) -> Any:
    """A word out of a fixed list (the list stands in the field's Literal type)."""
    return Field(default, description=meaning)
