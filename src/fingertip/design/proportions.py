"""Proportions of proven fingers: what a design file leaves out follows the nearest bundled finger.

Each column of `catalogues/proportions.csv` is a bundled design. The first rows are the parameters
by which the nearest finger is found. The others follow from these, or are sizes of interfaces that
the finger does not have.
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
    """Return the tables of a design file, completed by values of the nearest proven finger."""
    filled = dict(tables)
    nearest = min(load_proportions().values(), key=lambda finger: _measure_distance(tables, finger))
    for table, values in nearest.items():
        own = filled.get(table, {})
        if isinstance(own, Mapping):
            follows = {key: value for key, value in values.items() if f"{table}.{key}" not in KEYS}
            filled[table] = follows | {**own}

    return filled


def _measure_distance(
    tables: Mapping[str, Any], proven: Mapping[str, Any]
) -> tuple[float, bool, bool, float]:
    """Measure how far a finger is from a proven one.

    The head of the sensor counts first, then interface, knuckle and lengths.
    """
    head_mm, *lengths = _read_lengths(tables)
    proven_head_mm, *proven_lengths = _read_lengths(proven)
    interface, knuckle = (_read(tables, path) != _read(proven, path) for path in _CHOICES)
    pairs = zip(lengths, proven_lengths, strict=True)
    relative = sum(abs(length / proven_length - 1.0) for length, proven_length in pairs)

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
    """Read a value; the default stands for one that is missing or of another type."""
    table, _, key = path.partition(".")
    default = PARAMETERS[path].default
    own = tables.get(table)
    value = own.get(key) if isinstance(own, Mapping) else None
    has_type = (
        isinstance(value, int | float) if isinstance(default, float) else isinstance(value, str)
    )

    return value if has_type else default
