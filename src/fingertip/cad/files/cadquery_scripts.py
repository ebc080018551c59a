"""CadQuery scripts of the parts: parameters, a script for each part, and a copy of the models.

The scripts run where cadquery alone is installed, and make the solids of the STEP files.
"""

from __future__ import annotations

import json
import textwrap
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path

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
from fingertip.design.rules.ruleset import Rule, RuleChecker, find_violations, record_reads
from fingertip.design.search import RULES
from fingertip.foundation.numerics import bisect
from fingertip.models.parts import hardware, list_tagged_planes, list_tagged_points, parts_by_name

_MODELS = Path(fingertip.models.__file__).parent
_TABLES = ("skin", "sensor", "custom_sensor", "bone", "hand", "mold", "printer", "strength")
_SENSOR_SIZES = ("head_diameter_mm", "thickness_mm", "length_mm", "tail_width_mm")
"""Tables of parameters.py, and what the models read of a sensor."""
_WIDTH = 96
_HALVINGS = 12
_PARAMETERS = '''"""Parameters of the fingertip {design}.

Change numbers and choices, and all parts follow. Lengths are in mm; x is the width, y points to the
back, z to the tip. In brackets stands where the program's rules (walls, fit) allow a number while
all others stay, or what can be chosen. Scripts check bounds alone; `fingertip build` checks the
rules, walls and strength too.
"""

from fingertip_models.finger import Finger, Table

name = "{design}"  # engraved into the mold

{tables}

finger = Finger(
    name,
{arguments}
)
'''
_BEGIN = """
import sys
from pathlib import Path
{run_path}
import cadquery as cq

folder = Path(globals().get("__file__", "script.py")).absolute().parent  # the current one in CQGI
sys.path[:0] = [str(folder), str(folder.parent)]  # one of them holds fingertip_models

from fingertip_models.finger import read_finger  # noqa: E402
"""
_PART = '''"""{title} of the fingertip {design}, in CadQuery.

Run it with Python, or open it in CQ-editor. Sizes stand in parameters.py, and the shape in
fingertip_models.
"""
{begin}from fingertip_models.workplanes import make_part  # noqa: E402

finger = read_finger(folder, __name__)
{part} = make_part(finger, "{part}")

# Add your own features here. Tags of faces: {tags}.

if show := globals().get("show_object"):  # in CQ-editor, or imported from ocp_vscode
    show({part}, name="{part}")
elif __name__ == "__main__":
    size = {part}.val().BoundingBox()
    print(f"{part}: {{size.xlen:.3f}} x {{size.ylen:.3f}} x {{size.zlen:.3f}} mm")
    cq.exporters.export({part}, "{part}.step")
'''
_FINGER = '''"""The fingertip {design} in its closed mold: the core lies where the bone will.

A part is made by its script, with your own features, or else by fingertip_models.
"""
{begin}from fingertip_models.parts import hardware, parts_by_name, print_scale  # noqa: E402
from fingertip_models.workplanes import make_part  # noqa: E402

finger = read_finger(folder, __name__)
parts = parts_by_name(finger)
bought = {{item.name: item for item in hardware(finger, parts)}}
made = {{}}
for name in [*parts, *bought]:
    script = folder / f"{{name}}.cq.py"
    made[name] = run_path(str(script))[name] if script.is_file() else make_part(finger, name)

assembly = cq.Assembly(name=finger.name)
for name, each in {{**parts, **bought}}.items():
    if name in bought or not each.is_tool:  # tools lie nowhere in the finger or its mold
        assembly.add(made[name], name=name, color=cq.Color(*each.colour))

if show := globals().get("show_object"):  # in CQ-editor, or imported from ocp_vscode
    for name, workplane in made.items():
        show(workplane, name=name)
    show(assembly, name="finger")
elif __name__ == "__main__":
    out = folder / "out"
    out.mkdir(exist_ok=True)
    assembly.export(str(out / f"{{finger.name}}.step"))
    for name, workplane in made.items():
        cq.exporters.export(workplane, str(out / f"{{name}}.step"))
        scale = print_scale(finger, parts[name]) if name in parts else 1.0  # of the printer
        solid = workplane.val().scale(scale)
        mesh = str(out / f"{{name}}.stl")
        cq.exporters.export(solid, mesh, tolerance=0.01, angularTolerance=0.1)
    print(f"{{out}}: {{finger.name}}.step, and .step and .stl of {{', '.join(made)}}")
'''


def write_scripts(design: Design, parts: tuple[str, ...]) -> dict[str, bytes]:
    """Write parameters and the scripts of parts, and of the finger if these are all.

    They need `write_models` in the folder MODELS_FOLDER beside them, or beside their folder.
    """
    names = list(parts)
    files = {output_files.PARAMETERS: write_parameters(design)}
    if parts == tuple(parts_by_name(design)):
        names += [item.name for item in hardware(design, parts)]
        begin = _BEGIN.format(run_path="from runpy import run_path\n")
        files["finger.cq.py"] = _FINGER.format(design=design.name, begin=begin).encode()

    for name in names:
        text = _PART.format(
            title=name.replace("_", " ").capitalize(),
            design=design.name,
            part=name,
            begin=_BEGIN.format(run_path=""),
            tags=", ".join(_list_tags(design, name)) or "none",
        )
        files[part_file(name, "cq")] = text.encode()

    return files


def _list_tags(design: Design, part: str) -> list[str]:
    return [*list_tagged_points(design, part), *list_tagged_planes(design, part)]


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
        allowed = ", ".join(map(str, _choices(field))) or _find_range(design, path, field)
        meaning = f"{str(field.description).rstrip('.')} [{allowed}]"
        tables[table] += textwrap.wrap(
            meaning, _WIDTH, initial_indent="    # ", subsequent_indent="    # "
        )
        tables[table].append(f"    {key}={json.dumps(value) if isinstance(value, str) else value},")

    texts = ("\n".join([f"{name} = Table(", *lines, ")"]) for name, lines in tables.items())
    return _PARAMETERS.format(
        design=design.name,
        tables="\n\n".join(texts),
        arguments="\n".join(f"    {name}={name}," for name in _TABLES),
    ).encode()


def _find_range(design: Design, path: str, field: FieldInfo) -> str:
    """Find from where to where a number may change alone, so that a design passes all rules."""
    low, high = (_find_last(design, path, end) for end in _ends(field))
    is_apart = low > 0.0 and _ends(field)[0] == 0.0 and _passes(design, path, 0.0)
    return f"{low:g} to {high:g}{', or 0' if is_apart else ''}"


def _find_last(design: Design, path: str, end: float) -> float:
    """Find the last number on the way to an end of its bounds that passes all rules, to 0.001."""
    value = design.value(path)

    def at(share: float) -> float:
        return float(round(value + share * (end - value), 3))

    if _passes(design, path, at(0.999)) and _passes(design, path, end):
        return end

    return at(
        bisect(lambda share: _passes(design, path, at(share)), 0.0, 1.0, halvings=_HALVINGS)[0]
    )


def _passes(design: Design, path: str, value: float) -> bool:
    rules = _rules_by_parameter(design).get(path, ())
    return not any(find_violations(rules, design.with_values({path: value})))


@lru_cache(8)
def _rules_by_parameter(design: Design) -> dict[str, list[Rule]]:
    """Find the rules that read each parameter: a change of it alone cannot break the others."""
    found: dict[str, list[Rule]] = {}
    for rule in RULES:
        tables, reads = record_reads(design)
        RuleChecker(tables).passes(rule)
        for path in reads:
            found.setdefault(path, []).append(rule)

    return found
