"""Form of the studio as HTML: a slider and a number for each number, a list for each choice, a place for refusals."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from fingertip.design import Design
from fingertip.page.html import Markup, code, element
from fingertip.studio.form import Field, Group, Slider

_LOGARITHMIC_STEP = 0.002
"""Step of a logarithmic slider, half a percent of the value."""


def render_form(groups: Iterable[Group], design: Design, moved: Mapping[str, tuple[str, ...]]) -> Markup:
    """Render the form with the values of a design.

    Parameters
    ----------
    groups
        Groups of its fields.
    design
        The fingertip.
    moved
        Items that each parameter shapes, by its dotted name.
    """
    return element(
        "form",
        element(
            "div", element("label", "find a parameter", for_="find"),
            element("input", type="search", id="find", autocomplete="off"), class_="row",
        ),
        element("ul", "", id="other-refusals", class_="refusal", hidden=True),
        *(_render_group(group, design, moved) for group in groups),
        id="form", novalidate=True, autocomplete="off",
    )  # fmt: skip


def _render_group(group: Group, design: Design, moved: Mapping[str, tuple[str, ...]]) -> Markup:
    name = group.name or "design"
    count = len(group.fields)
    title = (
        element("span", name, class_="code"), f": {count} parameter{'s' if count > 1 else ''}",
        element("span", "", class_="counts", data_counts=name),
    )  # fmt: skip
    fields = (_render_field(field, design, moved.get(field.path, ())) for field in group.fields)
    said = [element("p", group.description, class_="hint")] if group.description else []
    return element("details", element("summary", *title), *said, *fields, class_="group", open=name == "skin")


def _render_field(field: Field, design: Design, items: tuple[str, ...]) -> Markup:
    name, value = f"f-{field.path}", design.value(field.path)
    described = f"d-{field.path} e-{field.path}"
    controls: list[Markup] = []
    if field.kind == "choice":
        options = (element("option", word, value=word, selected=word == value) for word in field.choices)
        controls.append(element("select", *options, id=name, aria_describedby=described))
    elif field.kind == "text":
        controls.append(element("input", type="text", id=name, value=str(value), aria_describedby=described))
    else:
        if slider := field.slider:
            controls.append(_render_slider(field.path, slider, value))
        controls.append(
            element(
                "input",
                type="number",
                id=name,
                value=repr(value).removesuffix(".0"),
                step="any",
                aria_describedby=described,
            )
        )
        controls.append(element("span", field.unit, class_="unit"))
    shapes = element(
        "button", "show", type="button", data_moves=" ".join(items), aria_pressed="false", hidden=not items,
        aria_label=f"{field.path}: show what it shapes", data_named=field.path,
    )  # fmt: skip
    reset = element("button", "undo", type="button", class_="reset", hidden=True, aria_label=f"undo {field.path}")
    bounds = f" [{field.bounds}]" if field.bounds else ""
    return element(
        "div",
        element("div", element("label", code(field.key), for_=name, class_="code"), shapes, reset, class_="head"),
        element("div", *controls, class_="control"),
        element("p", f"{field.description}{bounds}", id=f"d-{field.path}", class_="hint"),
        element("p", "", id=f"e-{field.path}", class_="refusal", hidden=True),
        class_="field", id=f"p-{field.path}", tabindex="-1", data_path=field.path, data_kind=field.kind,
        data_pointer=field.pointer,
    )  # fmt: skip


def _render_slider(path: str, slider: Slider, value: float) -> Markup:
    """Render a slider; the position of a logarithmic one is the common logarithm of its value."""
    low, high, step = slider.minimum, slider.maximum, slider.step
    if slider.is_logarithmic:
        low, high, step = math.log10(low), math.log10(high), _LOGARITHMIC_STEP
        value = math.log10(value) if value > 0 else low
    numbers = {"min": f"{low:.6g}", "max": f"{high:.6g}", "step": f"{step:.6g}", "value": f"{value:.6g}"}
    return element("input", type="range", aria_label=f"{path}, slider", data_log=slider.is_logarithmic, **numbers)
