"""Text of a design file for people: it states wishes and measurements, and what follows from them
in comments.

Parameters have their dotted names, such as `skin.width_mm = 17`, as in --set and in messages. So a
line can be moved, or its # removed, without regard to tables.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator

from fingertip.design.design_file import Parameter, list_parameters, load_tables
from fingertip.design.geometry import DesignTables
from fingertip.design.parameters import PARAMETERS, Tables
from fingertip.design.parameters.declaration import OWN, describe_table, parse_tables
from fingertip.design.proportions import fill_in

_WISHES = (
    "sensor.model",
    "bone.interface",
    "skin.width_mm",
    "skin.length_mm",
    "skin.semi_axis_palmar_mm",
    "skin.thickness_palmar_mm",
    "silicone.product",
    "strength.print_material",
    "strength.grip_force_n",
    "strength.hand_mass_kg",
    "strength.knock_speed_m_s",
    "board.variant",
)
"""Wishes that every design states."""
_INTERFACES = {
    "post": ("bone.post_", "bone.cross_bolt_"),
    "socket": ("bone.socket_", "bone.cross_bolt_"),
    "flange": ("bone.flange_",),
    "clevis": ("hand.",),
    "file": ("bone.adapter_",),
}
"""Interface -> beginnings of its sizes."""
_HEADINGS = {
    "wish": "Wishes.",
    "measurement": "Measured on hand, sensor and printer.",
    "derived": "Fitted to the above; --fit renews them.",
}
_MAX_COLUMN_WIDTH = 40
"""Maximum column in which the comments of a block begin.
A longer line shifts its own comment only.
"""


def write_design(
    design: Tables, heading: Iterable[str], marked: Collection[str] = (), with_others: bool = False
) -> str:
    """Write a design as a file that reads back as equal.

    Each parameter has its meaning, unit and bounds beside it. `marked` are the provisional ones.
    With `with_others`, the file has all parameters.
    """
    design = design.with_bare_names()
    parameters = {parameter.path: parameter for parameter in list_parameters(marked)}
    stated = _list_stated(design)
    lines = [
        *(f"# {line}".rstrip() for line in heading),
        "",
        *_format_block(design, [parameters["name"]]),
    ]

    for kind, title in _HEADINGS.items():
        block = [
            parameters[path] for path in stated if parameters[path].kind == kind and path != "name"
        ]
        if block:
            lines += ["", f"# {title}", *_format_block(design, block)]

    rest = [parameter for path, parameter in parameters.items() if path not in stated]
    derived = [parameter for parameter in rest if parameter.kind == "derived"]
    lines += ["", "# Derived from the above. Remove the # in front of a name to state its value."]
    lines += _format_block(design, derived, "#")

    if with_others:
        others = [parameter for parameter in rest if parameter.kind != "derived"]
        lines += _format_others(design, others)

    return "\n".join([*lines, ""])


def _list_stated(design: Tables) -> list[str]:
    """List the parameters that a file states.

    They are the main wishes, the sizes of its interface, sensor and silicone, and all others that
    do not follow from these.
    """
    tables = [*_INTERFACES[design.bone.interface]]
    if design.sensor.model == "custom":
        tables.append("custom_sensor.")
    if design.silicone.product == OWN:
        tables.append("silicone.")

    sizes = (path for path in PARAMETERS if path.startswith(tuple(tables)))
    main = list(dict.fromkeys(("name", *_WISHES[:2], *sizes, *_WISHES[2:])))
    changes = {path: design.value(path) for path in main}
    loaded = parse_tables(DesignTables, fill_in(load_tables((), changes).tables))
    differing = (path for path in PARAMETERS if design.value(path) != loaded.value(path))
    return list(dict.fromkeys((*main, *differing)))


def _format_others(design: Tables, parameters: Iterable[Parameter]) -> Iterator[str]:
    """Format parameters as comments, under a title for each table."""
    yield ""
    yield "# All other parameters. Remove the # in front of a name, then change the value."
    by_table: dict[str, list[Parameter]] = {}
    for parameter in parameters:
        by_table.setdefault(parameter.path.partition(".")[0], []).append(parameter)

    for table, info in Tables.model_fields.items():
        if table in by_table:
            yield ""
            yield f"# {describe_table(info.annotation)}"
            yield from _format_block(design, by_table[table], "#")


def _format_block(
    design: Tables, parameters: Iterable[Parameter], prefix: str = ""
) -> Iterator[str]:
    """Format parameters one per line, with their comments in one column."""
    import tomlkit  # noqa: PLC0415

    rows = []
    for parameter in parameters:
        value = tomlkit.item(design.value(parameter.path)).as_string()
        rows.append((f"{prefix}{parameter.path} = {value}", parameter))

    lengths = [len(setting) for setting, _ in rows]
    width = max((length for length in lengths if length <= _MAX_COLUMN_WIDTH), default=0)

    for setting, parameter in rows:
        limits = ", ".join(text for text in (parameter.unit, parameter.bounds) if text)
        note = f" [{limits}]" if limits else ""
        yield f"{setting:{width}}  # {parameter.description}{note}"
