"""CadQuery scripts of the parts: parameters, a script for each part, and a copy of the models.

The scripts run where cadquery alone is installed, and make the solids of the STEP files.
"""

from __future__ import annotations

import json
import textwrap
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from string import Template

from pydantic.fields import FieldInfo

import fingertip.models
from fingertip.cad.files.part_formats import part_file
from fingertip.catalogues import output_files
from fingertip.catalogues.electronics import SENSORS
from fingertip.catalogues.materials import PRINT_MATERIALS
from fingertip.design import Design
from fingertip.design.geometry.letters import outline_letters
from fingertip.design.parameters import PARAMETERS
from fingertip.design.parameters.declaration import find_bounds, list_choices
from fingertip.design.search import describe_bands, find_bands
from fingertip.models.cad_tags import list_tagged_planes, list_tagged_points
from fingertip.models.hardware import hardware
from fingertip.models.parts import parts_by_name

_MODELS = Path(fingertip.models.__file__).parent
_TABLES = ("skin", "sensor", "custom_sensor", "bone", "hand", "mold", "printer", "strength")
_SENSOR_SIZES = ("head_diameter_mm", "thickness_mm", "length_mm", "tail_width_mm")
"""Tables of parameters.py, and what the models read of a sensor."""
_WIDTH = 96
_TEMPLATES = Path(__file__).with_name("script_templates")


def write_scripts(design: Design, parts: tuple[str, ...]) -> dict[str, bytes]:
    """Write parameters and the scripts of parts, and of the finger if these are all.

    They need `write_models` in the folder MODELS_FOLDER beside them, or beside their folder.
    """
    names = list(parts)
    files = {output_files.PARAMETERS: write_parameters(design)}
    if parts == tuple(parts_by_name(design)):
        names += [item.name for item in hardware(design, parts)]
        files["finger.cq.py"] = _fill("finger.cq.py", design=design.name)

    for name in names:
        tags = [*list_tagged_points(design, name), *list_tagged_planes(design, name)]
        files[part_file(name, "cq")] = _fill(
            "part.cq.py",
            title=name.replace("_", " ").capitalize(),
            design=design.name,
            part=name,
            tags=", ".join(tags) or "none",
        )

    return files


def _fill(template: str, **words: str) -> bytes:
    text = (_TEMPLATES / f"{template}.txt").read_text(encoding="utf-8")
    return Template(text).substitute(words).encode()


def write_models() -> dict[str, bytes]:
    """Copy the package of the models, with what the program knows in catalogue.json."""
    paths = sorted(_MODELS.glob("*.py"))
    catalogue = json.dumps(_collect_catalogue()).encode()
    return {
        **{path.name: path.read_bytes() for path in paths},
        "catalogue.json": catalogue + b"\n",
    }


def _collect_catalogue() -> dict[str, object]:
    fields = dict(_list_fields())
    return {
        "bounds": {path: _ends(field) for path, field in fields.items() if _is_number(field)},
        "choices": {
            path: _choices(field) for path, field in fields.items() if not _is_number(field)
        },
        "sensors": {
            model: {size: getattr(sensor, size) for size in _SENSOR_SIZES}
            for model, sensor in SENSORS.items()
        },
        "strengths_mpa": {name: each.strength_mpa for name, each in PRINT_MATERIALS.items()},
        "letters": dict(outline_letters()),
    }


def _list_fields() -> Iterator[tuple[str, FieldInfo]]:
    """List numbers and choices of the tables that scripts carry, without those of an adapter."""
    for path, field in PARAMETERS.items():
        is_listed = path.partition(".")[0] in _TABLES and not path.startswith("bone.adapter_")
        if is_listed and (_is_number(field) or _choices(field)):
            yield path, field


def _is_number(field: FieldInfo) -> bool:
    return field.annotation is float


def _choices(field: FieldInfo) -> tuple[object, ...]:
    if field.annotation is bool:
        return False, True

    return tuple(name for name in list_choices(field) if name != "file")


def _ends(field: FieldInfo) -> tuple[float, float]:
    bounds = find_bounds(field)
    assert bounds.minimum is not None
    assert bounds.maximum is not None
    return bounds.minimum, bounds.maximum


@lru_cache(8)
def write_parameters(design: Design) -> bytes:
    """Write parameters.py: each value of a design with its meaning, and where it may lie."""
    tables: dict[str, list[str]] = {name: [] for name in _TABLES}
    for path, field in _list_fields():
        table, _, key = path.partition(".")
        value = design.value(path)
        allowed = _describe_allowed(design, path, field)
        meaning = f"{str(field.description).rstrip('.')} [{allowed}]"
        tables[table] += textwrap.wrap(
            meaning, _WIDTH, initial_indent="    # ", subsequent_indent="    # "
        )
        tables[table].append(f"    {key}={json.dumps(value) if isinstance(value, str) else value},")

    texts = ("\n".join([f"{name} = Table(", *lines, ")"]) for name, lines in tables.items())
    return _fill(
        output_files.PARAMETERS,
        design=design.name,
        tables="\n\n".join(texts),
        arguments="\n".join(f"    {name}={name}," for name in _TABLES),
    )


def _describe_allowed(design: Design, path: str, field: FieldInfo) -> str:
    """Describe the choices of a parameter, or where the rules allow its number."""
    choices = _choices(field)
    if choices:
        return ", ".join(map(str, choices))

    return describe_bands(path, find_bands(design, path))
