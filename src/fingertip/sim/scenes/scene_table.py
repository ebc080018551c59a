"""A scene's parameters as a person looks them up: value, unit, bounds, meaning, read from the file's schema."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from fingertip.design.parameters import ParameterTable
from fingertip.sim.scenes.simulation_file import StrictFile


def parameters(scene: StrictFile) -> Iterator[dict[str, Any]]:
    """Every parameter of a scene, in the file's order."""
    schema = type(scene).model_json_schema()
    for name in type(scene).model_fields:
        value = getattr(scene, name)
        if isinstance(value, ParameterTable):
            table = schema["$defs"][type(value).__name__]["properties"]
            for key, field in table.items():
                yield _row(f"{name}.{key}", getattr(value, key), field, scene.known_outputs)
        else:
            yield _row(name, value, schema["properties"][name], scene.known_outputs)


def as_text(scene: StrictFile) -> list[str]:
    """One line for each."""
    return [
        f"{row['name']:28} {row['value']!s:>14} {row['unit']:5} {row['bounds']:24} {row['description']}"
        for row in parameters(scene)
    ]


def _row(path: str, value: Any, field: dict[str, Any], outputs: Sequence[str]) -> dict[str, Any]:
    low = f">= {field['minimum']:g}" if "minimum" in field else ""
    low = f"> {field['exclusiveMinimum']:g}" if "exclusiveMinimum" in field else low
    high = f"<= {field['maximum']:g}" if "maximum" in field else ""
    bounds = " | ".join(field["enum"]) if "enum" in field else ", ".join(part for part in (low, high) if part)
    if path == "outputs":
        bounds = " | ".join(outputs)
    return {
        "name": path,
        "value": value,
        "default": field.get("default"),
        "unit": field.get("unit", ""),
        "bounds": bounds,
        "description": field.get("description", ""),
    }
