"""Parameters of a page: value, unit, bounds, what each means, and what of the design it shapes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import cast

from fingertip.cad.shapes.parts import hardware, parts_by_name
from fingertip.design import Design
from fingertip.design.files import Parameter, format_value, list_parameters
from fingertip.design.rules.ruleset import RecordingTables
from fingertip.page.html import Markup, code, element, join, table
from fingertip.page.scene import label_item

# Parts and bought items that a parameter moves: those whose shape reads it.


_HARDWARE_OF = (("bone",), ("mold_dorsal",), ("mold_palmar", "mold_dorsal"))
"""Parts whose hardware is made apart, so that each item is blamed for little more than it reads itself."""


def parameters_of_shapes(design: Design) -> dict[str, frozenset[str]]:
    """Find the parameters that the shape of each part and bought item reads, by the item's name.

    They are recorded while the shape is made, so a parameter that this design does not use is in none of the sets.
    """
    found: dict[str, frozenset[str]] = {}
    for name, part in parts_by_name(design).items():
        recorder = RecordingTables(design)
        part.solid(cast(Design, recorder))
        found[name] = frozenset(recorder.reads)
    for parts in _HARDWARE_OF:
        recorder = RecordingTables(design)
        for item in hardware(cast(Design, recorder), parts):
            found.setdefault(item.name, frozenset(recorder.reads))
    return found


def shapes_of_parameters(design: Design) -> Mapping[str, tuple[str, ...]]:
    """Find the items whose shape reads each parameter, by its name; parameters that move nothing are left out."""
    moved: dict[str, list[str]] = {}
    for item, parameters in parameters_of_shapes(design).items():
        for parameter in sorted(parameters):
            moved.setdefault(parameter, []).append(item)
    return {parameter: tuple(items) for parameter, items in moved.items()}


_EFFECTS = {
    "silicone": ("quantities and times of casting", "casting"),
    "printer": ("compensation and checks of the printed parts", "checks"),
    "strength": ("safety factors of the bone", "checks"),
    "force_curve": ("forces and voltages", "trial"),
    "board": ("component values of the board", "board"),
    "detector": ("detection of slip", "trial"),
}
"""Table of parameters -> what it decides beside shapes, and the section that shows it."""


def render_parameters(design: Design) -> Markup:
    """Render all parameters by their tables. The name of one that shapes parts is a button that highlights them."""
    moved, tables = shapes_of_parameters(design), group_parameters()
    parts = [
        element(
            "p",
            "Press the name of a parameter to see in the 3D view what it shapes: every part whose shape reads it. "
            "Change one in the design file, or with ", element("code", "--set TABLE.KEY=VALUE"), ".",
        )
    ]  # fmt: skip
    for name, parameters in tables.items():
        changed = sum(design.value(p.path) != p.default for p in parameters)
        note = f", {changed} changed" if changed else ""
        title = f"{name or 'design'}: {len(parameters)} parameter{'s' if len(parameters) > 1 else ''}{note}"
        rows = [_render_row(design, parameter, moved) for parameter in parameters]
        body = table(("parameter", "value", "bounds"), rows, f"parameters of [{name}]" if name else "name")
        parts.append(element("details", element("summary", title), body, open=name == "skin"))
    return join(parts)


def group_parameters() -> dict[str, list[Parameter]]:
    """Group the parameters by their tables; the table "" holds those that stand in none."""
    tables: dict[str, list[Parameter]] = {}
    for parameter in list_parameters():
        tables.setdefault(parameter.path.rpartition(".")[0], []).append(parameter)
    return tables


def _render_row(design: Design, parameter: Parameter, moved: Mapping[str, tuple[str, ...]]) -> tuple[str, str, str]:
    path, value = parameter.path, design.value(parameter.path)
    items = moved.get(path, ())
    if items:
        name = element(
            "button", code(path), type="button", class_="code", data_moves=" ".join(items), aria_pressed="false",
            id=f"p-{path}",
        )  # fmt: skip
    else:
        name = element("span", code(path), class_="code", id=f"p-{path}", tabindex="-1")
    shown = element("span", f"{format_value(value)} {parameter.unit}".rstrip(), class_="num")
    if value != parameter.default:
        shown = join((shown, element("br"), element("small", f"default {format_value(parameter.default)}")))
    description = element("div", parameter.description)
    return join((name, description, describe_effect(path, items))), shown, parameter.bounds


def describe_effect(path: str, items: tuple[str, ...], *, linked: bool = True) -> Markup:
    """Say what a parameter decides, with a link to the section of the page that shows it."""
    effect = _EFFECTS.get(path.partition(".")[0])
    if items:
        said: tuple[str, ...] = ("Shapes ", ", ".join(dict.fromkeys(label_item(item) for item in items)), ".")
    elif effect:
        said = ("Decides ", element("a", effect[0], href=f"#{effect[1]}") if linked else effect[0], ".")
    else:
        said = ("Shapes no part of this design: a limit, or a choice that it does not use.",)
    return element("small", *said)
