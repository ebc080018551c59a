"""New design files: the main parameters at the top, all others below them as comments with their defaults.

Parameters stand under their dotted names, such as `skin.width_mm = 17`, as in --set and in messages. A line can so be
moved, or its # removed, without regard to tables.
"""

from __future__ import annotations

import inspect
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import ValidationError

from fingertip.design.export import Parameter, list_parameters
from fingertip.design.issues import issues_from_pydantic, suggest_name
from fingertip.design.load import load_tables
from fingertip.design.model import Design
from fingertip.design.parameters import DesignTables
from fingertip.errors import DesignError, Issue


@dataclass(frozen=True)
class _Base:
    """Bundled design that fits a sensor."""

    design: str
    changes: tuple[str, ...] = ()
    """Further changes that the sensor needs."""


_BASES: Mapping[str, _Base] = {
    "fsr400": _Base("fsr400"),
    "fsr400_short": _Base("fsr400"),
    "fsr402": _Base("fsr402", ("bone.base_length_mm=37",)),  # its tail of 56 mm runs on through a longer base
    "fsr402_short": _Base("fsr402"),
    "custom": _Base("fsr400"),
}
"""Base design by sensor.model."""

_MAIN_PARAMETERS = (
    "sensor.model",
    "skin.width_mm",
    "skin.length_mm",
    "skin.semi_axis_palmar_mm",
    "skin.semi_axis_dorsal_mm",
    "skin.thickness_palmar_mm",
    "bone.base_length_mm",
    "bone.interface",
    "mold.method",
    "board.variant",
    "board.supply",
)
"""Parameters that a user changes first. They stand at the top."""

_MAX_COLUMN_WIDTH = 40
"""Maximum column in which the comments of a block begin. A longer line shifts its own comment only."""


def write_new_design(name: str, sensor: str) -> str:
    """Write a design file with the bundled design of a sensor as its base.

    Parameters
    ----------
    name
        Name of the design.
    sensor
        Model of the sensor, as in sensor.model.

    Returns
    -------
    str
        TOML text with a description, the unit and the bounds of each parameter in a comment.

    Raises
    ------
    DesignError
        If the name cannot name a design, or if the sensor is not known.
    """
    issues: list[Issue] = []
    try:
        DesignTables(name=name)
    except ValidationError as error:
        issues += issues_from_pydantic(error, Design)
    if sensor not in _BASES:
        issues.append(Issue("sensor", f"{sensor!r} is not known; {suggest_name(sensor, list(_BASES))}"))
    if issues:
        raise DesignError(issues)
    base = _BASES[sensor]
    tables = load_tables([base.design], [f"sensor.model={sensor}", *base.changes]).tables
    return "\n".join(_list_lines(Design(**tables | {"name": name}), base.design)) + "\n"


def _list_lines(design: Design, base: str) -> Iterator[str]:
    """Yield the lines of the file."""
    parameters = {parameter.path: parameter for parameter in list_parameters()}
    name = parameters.pop("name")
    main = [parameters.pop(path) for path in _MAIN_PARAMETERS]
    if design.sensor.model == "custom":
        main[1:1] = [parameters.pop(path) for path in list(parameters) if path.startswith("custom_sensor.")]
    changed = [p for p in parameters.values() if design.value(p.path) != p.default]
    yield f"# Design of a fingertip, begun from the bundled design {base}."
    yield "# A comment holds the meaning of a parameter and, in brackets, its unit and bounds."
    yield ""
    yield from _format_block(design, [name])
    yield ""
    yield "# Main parameters."
    yield from _format_block(design, main)
    if changed:
        yield ""
        yield f"# Other parameters in which the bundled design {base} differs from the defaults."
        yield from _format_block(design, changed)
    yield ""
    yield "# All other parameters with their defaults. Remove the # in front of a name, then change the value."
    for table, info in Design.model_fields.items():
        rest = [p for p in parameters.values() if p.path.startswith(f"{table}.") and p not in changed]
        if rest:
            yield ""
            yield f"# {_summarise(info.annotation)}"
            yield from _format_block(design, rest, prefix="#")


def _format_block(design: Design, parameters: Iterable[Parameter], prefix: str = "") -> Iterator[str]:
    """Format parameters one per line, with their comments in one column."""
    import tomlkit

    rows = [(f"{prefix}{p.path} = {tomlkit.item(design.value(p.path)).as_string()}", p) for p in parameters]
    width = max((len(setting) for setting, _ in rows if len(setting) <= _MAX_COLUMN_WIDTH), default=0)
    for setting, parameter in rows:
        limits = ", ".join(text for text in (parameter.unit, parameter.bounds) if text)
        yield f"{setting:{width}}  # {parameter.description}" + (f" [{limits}]" if limits else "")


def _summarise(table: Any) -> str:
    """Return the docstring of a table in one line."""
    return " ".join((inspect.getdoc(table) or "").split())
