"""Text of a design file for people: wishes and measurements are stated, and what follows from them
stands in comments.

Parameters stand under their dotted names, such as `skin.width_mm = 17`, as in --set and in
messages. A line can so be moved, or its # removed, without regard to tables.
"""

from __future__ import annotations

import inspect
from collections.abc import Collection, Iterable, Iterator

from fingertip.design.design_file import Parameter, list_parameters, load_tables
from fingertip.design.geometry import DesignTables
from fingertip.design.parameters import PARAMETERS, Tables
from fingertip.design.parameters.declaration import OWN, parse_tables
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
    design: Tables, heading: Iterable[str], marked: Collection[str] = (), others: bool = False
) -> str:
    """Write a design as a file that reads back as equal, with meaning, unit and bounds of each
    parameter.

    Provisional parameters are `marked`. With `others`, all parameters stand in the file.
    """
    design = design.with_bare_names()
    listed = {parameter.path: parameter for parameter in list_parameters(marked)}
    # What it states in any case: the main wishes, and what its interface, sensor and silicone are.
    own = [*_INTERFACES[design.bone.interface]]
    own += ["custom_sensor."] * (design.sensor.model == "custom") + ["silicone."] * (
        design.silicone.product == OWN
    )
    of_kinds = (path for path in PARAMETERS if path.startswith(tuple(own)))
    main = list(dict.fromkeys(("name", *_WISHES[:2], *of_kinds, *_WISHES[2:])))
    loaded = parse_tables(
        DesignTables, fill_in(load_tables((), {path: design.value(path) for path in main}).tables)
    )
    stated = [
        *main,
        *(path for path in listed if path not in main and design.value(path) != loaded.value(path)),
    ]
    lines = [
        *(f"# {line}".rstrip() for line in heading),
        "",
        *_format_block(design, [listed["name"]]),
    ]

    for kind, title in _HEADINGS.items():
        block = [listed[path] for path in stated if listed[path].kind == kind and path != "name"]
        if block:
            lines += ["", f"# {title}", *_format_block(design, block)]

    rest = [parameter for path, parameter in listed.items() if path not in stated]
    lines += ["", "# Derived from the above. Remove the # in front of a name to state its value."]
    lines += _format_block(
        design, (parameter for parameter in rest if parameter.kind == "derived"), "#"
    )

    if others:
        lines += [
            "",
            "# All other parameters. Remove the # in front of a name, then change the value.",
        ]
        for table, info in Tables.model_fields.items():
            block = [p for p in rest if p.path.startswith(f"{table}.") and p.kind != "derived"]
            if block:
                title = " ".join((inspect.getdoc(info.annotation) or "").split())
                lines += ["", f"# {title}", *_format_block(design, block, "#")]

    return "\n".join([*lines, ""])


def _format_block(
    design: Tables, parameters: Iterable[Parameter], prefix: str = ""
) -> Iterator[str]:
    """Format parameters one per line, with their comments in one column."""
    import tomlkit  # noqa: PLC0415

    rows = [
        (f"{prefix}{p.path} = {tomlkit.item(design.value(p.path)).as_string()}", p)
        for p in parameters
    ]
    width = max(
        (len(setting) for setting, _ in rows if len(setting) <= _MAX_COLUMN_WIDTH), default=0
    )

    for setting, parameter in rows:
        limits = ", ".join(text for text in (parameter.unit, parameter.bounds) if text)
        yield f"{setting:{width}}  # {parameter.description}" + (f" [{limits}]" if limits else "")
