"""Solids of a finger by name, of its parts and of its hardware alike."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .hardware import hardware
from .parts import parts_by_name
from .solids import Solid

if TYPE_CHECKING:
    from .program_types import Finger


class UnknownPartError(ValueError):
    """The finger has no part or bought item of a name."""


def find_solid(finger: Finger, name: str) -> Solid:
    """Build the solid of a part or of a bought item. Raises UnknownPartError for another name."""
    parts = parts_by_name(finger)
    if name in parts:
        return parts[name].solid(finger)

    bought = {item.name: item.solid for item in hardware(finger, parts)}
    if name in bought:
        return bought[name]

    names = ", ".join([*parts, *bought])
    raise UnknownPartError(f"this finger has no {name}; it has {names}.")
