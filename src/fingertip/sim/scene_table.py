"""A scene's parameters as a person looks them up: value, unit, bounds, meaning, read from the file's schema."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from fingertip.design.fields import Section
from fingertip.sim.scene_file import OUTPUTS, SceneFile


def parameters(scene: SceneFile) -> Iterator[dict[str, Any]]:
    """Every parameter of a scene, in the file's order."""
    schema = SceneFile.model_json_schema()
    for name in SceneFile.model_fields:
        value = getattr(scene, name)
        if isinstance(value, Section):
            table = schema["$defs"][type(value).__name__]["properties"]
            for key, field in table.items():
                yield _row(f"{name}.{key}", getattr(value, key), field)
        else:
            yield _row(name, value, schema["properties"][name])


def as_text(scene: SceneFile) -> list[str]:
    """One line for each."""
    return [
        f"{row['name']:28} {row['value']!s:>14.14} {row['unit']:5} {row['bounds']:24} {row['description']}"
        for row in parameters(scene)
    ]


def _row(path: str, value: Any, field: dict[str, Any]) -> dict[str, Any]:
    low = f">= {field['minimum']:g}" if "minimum" in field else ""
    low = f"> {field['exclusiveMinimum']:g}" if "exclusiveMinimum" in field else low
    high = f"<= {field['maximum']:g}" if "maximum" in field else ""
    bounds = " | ".join(field["enum"]) if "enum" in field else ", ".join(part for part in (low, high) if part)
    if path == "outputs":
        bounds = " | ".join(OUTPUTS)
    return {
        "name": path,
        "value": value,
        "default": field.get("default"),
        "unit": field.get("unit", ""),
        "bounds": bounds,
        "description": field.get("description", ""),
    }
