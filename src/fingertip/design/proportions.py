"""Proportions of proven fingers: what a design file leaves out follows the bundled finger that is
nearest to it.

Each column of `catalogues/proportions.csv` is a bundled design. The first rows are what a finger is
chosen by. The others are what follows from these, and sizes of the interfaces that the finger has
not.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from fingertip import catalogues
from fingertip.catalogues.electronics import SENSORS
from fingertip.design.parameters import PARAMETERS
from fingertip.foundation.tables import read_rows

_CHOICES = ("bone.interface", "hand.knuckle")
_SIZES = ("skin.width_mm", "skin.length_mm", "skin.semi_axis_palmar_mm")
KEYS = ("sensor.model", *_CHOICES, *_SIZES)
"""Parameters by which the nearest finger is found, beside the outline of a custom sensor."""


@functools.cache
def load_proportions() -> Mapping[str, Mapping[str, Mapping[str, Any]]]:
    """Load the proven fingers: bundled design -> its tables."""
    fingers: dict[str, dict[str, dict[str, Any]]] = {}
    for row in read_rows(Path(catalogues.__file__).with_name("proportions.csv")):
        path = row.pop("parameter")
        table, _, key = path.partition(".")
        for finger, cell in row.items():
            if cell:
                value = float(cell) if isinstance(PARAMETERS[path].default, float) else cell
                fingers.setdefault(finger, {}).setdefault(table, {})[key] = value

    return fingers


def fill_in(tables: Mapping[str, Any]) -> dict[str, Any]:
    """Return the tables of a design file with the values of the
    nearest proven finger where they leave them out.
    """
    filled = dict(tables)
    for table, values in min(
        load_proportions().values(), key=lambda one: _measure_distance(tables, one)
    ).items():
        own = filled.get(table, {})
        if isinstance(own, Mapping):
            filled[table] = {
                key: value for key, value in values.items() if f"{table}.{key}" not in KEYS
            } | {**own}

    return filled


def _measure_distance(
    tables: Mapping[str, Any], proven: Mapping[str, Any]
) -> tuple[float, bool, bool, float]:
    """Measure how far a finger is from a proven one: by head of the
    sensor, interface, knuckle, then by lengths.
    """
    (head_mm, *lengths), (proven_head_mm, *others) = map(_read_lengths, (tables, proven))
    interface, knuckle = (_read(tables, path) != _read(proven, path) for path in _CHOICES)
    relative = sum(abs(ours / theirs - 1.0) for ours, theirs in zip(lengths, others, strict=True))

    return abs(head_mm - proven_head_mm), interface, knuckle, relative


def _read_lengths(tables: Mapping[str, Any]) -> list[float]:
    """Read diameter of the sensor's head, length of the sensor, and sizes of the skin [mm]."""
    sensor = SENSORS.get(_read(tables, "sensor.model"))
    names = ("head_diameter_mm", "length_mm")
    outline = (
        getattr(sensor, name) if sensor else _read(tables, f"custom_sensor.{name}")
        for name in names
    )

    return [*outline, *(_read(tables, path) for path in _SIZES)]


def _read(tables: Mapping[str, Any], path: str) -> Any:
    """Read a value; the default in place of one that is missing or of another type."""
    (table, _, key) = path.partition(".")
    default = PARAMETERS[path].default
    own = tables.get(table)
    value = own.get(key) if isinstance(own, Mapping) else None

    return (
        value if isinstance(value, int | float if isinstance(default, float) else str) else default
    )
