"""Page of the studio: 3D view, form and checks."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from fingertip.cad.parts import shapes_of_parameters
from fingertip.catalogues.file_kinds import DESIGN, list_bundled_files
from fingertip.design import Design
from fingertip.design.design_file import Parameter
from fingertip.design.parameters import PARAMETERS
from fingertip.design.parameters.declaration import describe_table, find_bounds, list_choices
from fingertip.design.search import describe_bands
from fingertip.page.html import (
    Markup,
    button,
    code,
    element,
    read_asset,
    read_viewer_library,
    render_document,
)
from fingertip.page.model_section import render_model, render_no_view, scene_json
from fingertip.page.parameters_and_checks import group_parameters
from fingertip.studio.answers import DOWNLOADS, FILE_TOLERANCE_MM, VIEW_TOLERANCE_MM, make_items

_LOGARITHMIC_STEP = 0.002
"""Step of a logarithmic slider, half a percent of the value."""
_MAIN = (
    "sensor.model",
    "skin.width_mm",
    "skin.length_mm",
    "skin.semi_axis_palmar_mm",
    "skin.thickness_palmar_mm",
    "skin.thickness_side_mm",
    "silicone.product",
    "bone.interface",
    "bone.base_length_mm",
)
"""Parameters that people change first. They stand above all tables, with their whole names."""


def render_form(design: Design, moved: Mapping[str, tuple[str, ...]]) -> Markup:
    return element(
        "form",
        element(
            "div",
            element("label", "find a parameter", for_="find"),
            element("input", type="search", id="find", autocomplete="off"),
            class_="row",
        ),
        element("ul", "", id="other-refusals", class_="refusal", hidden=True),
        element("ul", "", id="fitted", class_="hint", hidden=True),
        *(_render_group(name, fields, design, moved) for name, fields in make_form().items()),
        id="form",
        novalidate=True,
        autocomplete="off",
    )


def _render_group(
    name: str, fields: Sequence[Field], design: Design, moved: Mapping[str, tuple[str, ...]]
) -> Markup:
    count = len(fields)
    is_main = name == MAIN
    title = (
        element("span", name, class_=None if is_main else "code"),
        f": {count} parameter{'s' if count > 1 else ''}",
        element("span", "", class_="counts"),
    )
    hint = []
    if name not in (MAIN, "design"):
        hint.append(element("p", describe_table(type(getattr(design, name))), class_="hint"))

    rendered = (
        _render_field(field, design, moved.get(field.parameter.path, ()), is_main)
        for field in fields
    )

    return element(
        "details", element("summary", *title), *hint, *rendered, class_="group", open=is_main
    )


def _render_field(field: Field, design: Design, items: tuple[str, ...], is_main: bool) -> Markup:
    path = field.parameter.path
    name = f"f-{path}"
    value = design.value(path)
    shapes = button(
        "show",
        data_moves=" ".join(items),
        aria_pressed="false",
        hidden=not items,
        aria_label=f"{path}: show what it shapes",
        data_named=path,
    )
    reset = button("undo", class_="reset", hidden=True, aria_label=f"undo {path}")
    bounds = f" [{field.bounds}]" if field.bounds else ""
    label = element(
        "label", code(path if is_main else path.rpartition(".")[2]), for_=name, class_="code"
    )

    return element(
        "div",
        element("div", label, shapes, reset, class_="head"),
        element("div", *_render_controls(field, value), class_="control"),
        element("p", "", id=f"e-{path}", class_="refusal", hidden=True),
        element("p", "", id=f"b-{path}", class_="hint passing", hidden=True),
        element("p", f"{field.parameter.description}{bounds}", id=f"d-{path}", class_="hint"),
        class_="field",
        id=f"p-{path}",
        tabindex="-1",
        data_path=path,
        data_kind=field.kind,
    )


def _render_controls(field: Field, value: Any) -> list[Markup]:
    """Render what changes a value: a list of choices, a text, or a number with its slider."""
    path = field.parameter.path
    name = f"f-{path}"
    descriptions = f"e-{path} b-{path} d-{path}"

    if field.kind == "choice":
        chosen = str(value).lower() if isinstance(value, bool) else value
        options = (
            element("option", word, value=word, selected=word == chosen) for word in field.choices
        )
        return [element("select", *options, id=name, aria_describedby=descriptions)]

    if field.kind == "text":
        return [
            element("input", type="text", id=name, value=str(value), aria_describedby=descriptions)
        ]

    controls = []
    if field.slider:
        controls.append(_render_slider(path, field.slider, value, descriptions))

    number = repr(value).removesuffix(".0")
    controls.append(
        element(
            "input",
            type="number",
            id=name,
            value=number,
            step="any",
            aria_describedby=descriptions,
        )
    )
    controls.append(element("span", field.parameter.unit, class_="unit"))
    return controls


def _render_slider(path: str, slider: Slider, value: float, descriptions: str) -> Markup:
    """Render a slider; the position of a logarithmic one is the common logarithm of its value."""
    low = slider.minimum
    high = slider.maximum
    step = slider.step

    if slider.is_logarithmic:
        low = math.log10(low)
        high = math.log10(high)
        step = _LOGARITHMIC_STEP
        value = math.log10(value) if value > 0 else low

    numbers = {
        "min": f"{low:.6g}",
        "max": f"{high:.6g}",
        "step": f"{step:.6g}",
        "value": f"{value:.6g}",
    }
    return element(
        "input",
        type="range",
        aria_label=f"{path}, slider",
        aria_describedby=descriptions,
        data_log=slider.is_logarithmic,
        **numbers,
    )


_LEAD = (
    "Move a slider: the parts and their checks follow. Nothing is written until you download "
    "a file."
)
_ORIGIN = (
    f"The parts are meshes within {VIEW_TOLERANCE_MM:g} mm of the exact surface, coarser than "
    "those of the files "
    f"({FILE_TOLERANCE_MM:g} mm); sensor, bolts and nuts are plain bodies without threads."
)


def render_studio(design: Design, token: str) -> bytes:
    items = make_items(design)
    bundled = {name: Design.load(name) for name in list_bundled_files(DESIGN)}
    presets = {
        name: {path: preset.value(path) for path in PARAMETERS} for name, preset in bundled.items()
    }
    form = render_form(design, shapes_of_parameters(design))
    model = element(
        "div",
        element("h2", "Model", id="model"),
        render_no_view(),
        render_model(items, _ORIGIN, preset="opened"),
        element(
            "div",
            element("h2", "What it takes"),
            element("div", "", id="figures"),
            element("h2", "What the sensor feels"),
            element("div", "", id="pad"),
            class_="felt",
        ),
        class_="model",
    )
    beside = element(
        "div",
        model,
        element("div", element("h2", "Parameters", id="parameters"), form),
        class_="beside",
    )
    body = (
        element("a", "Skip to the parameters", href="#form", class_="skip"),
        element(
            "header", element("h1", f"Studio: {design.name}"), element("p", _LEAD, class_="lead")
        ),
        _render_bar(),
        element(
            "main", element("section", _render_presets(), beside), _render_checks(), id="content"
        ),
        element(
            "footer", element("p", "Served to this machine alone. Ctrl-C in the terminal ends it.")
        ),
        element("script", scene_json(items), type="application/json", id="scene"),
        element(
            "script",
            Markup(json.dumps(presets, separators=(",", ":"))),
            type="application/json",
            id="presets",
        ),
    )
    style = read_asset("page.css") + read_asset("studio.css", __package__)
    scripts = (read_viewer_library(), read_asset("viewer.js"), read_asset("studio.js", __package__))

    return render_document(
        f"{design.name}: fingertip studio",
        body=body,
        style=style,
        scripts=scripts,
        connect="'self'",
        data_design=design.name,
        data_token=token,
    )


def render_locked() -> bytes:
    """Render the page of an address without the token."""
    text = (
        "This is a fingertip studio. Open it with the address that its terminal shows: it ends "
        "in a token."
    )
    body = (element("main", element("section", element("h1", "Studio"), element("p", text))),)
    return render_document("fingertip studio", body, read_asset("page.css"), ())


def _render_bar() -> Markup:
    buttons = (button(label, data_download=name) for name, (label, _) in DOWNLOADS.items() if label)
    return element(
        "section",
        element("div", element("p", "checking", class_="verdict"), id="verdict", role="status"),
        element("p", "", id="change-time", class_="hint"),
        element(
            "div",
            element("span", "download"),
            *buttons,
            class_="row",
            role="group",
            aria_label="download",
        ),
        class_="bar",
        aria_label="verdict and downloads",
    )


def _render_presets() -> Markup:
    """Render a button for each bundled design; the script asks for its picture."""
    buttons = (
        button(element("img", alt="", hidden=True), name, data_design=name)
        for name in list_bundled_files(DESIGN)
    )
    summary = element("summary", "Start from a bundled design")
    return element("details", summary, element("div", *buttons), class_="presets", open=True)


def _render_checks() -> Markup:
    return element(
        "section",
        element("h2", "Checks", id="checks-title"),
        element(
            "div",
            button("make the files and check all", id="check-all"),
            element("span", "as fingertip check does, in some seconds", class_="hint"),
            class_="row",
        ),
        element("div", "", id="checks"),
        aria_labelledby="checks-title",
    )


_STEPS = 200
"""Least number of steps of a slider."""
_LOGARITHMIC_RATIO = 1000.0
"""Ratio of the bounds from which a slider is logarithmic."""
_KINDS = {float: "number", int: "integer", str: "text"}


@dataclass(frozen=True)
class Slider:
    """Range of a slider, in the unit of its field."""

    minimum: float
    maximum: float
    step: float
    is_logarithmic: bool
    """True if equal ways of the slider are equal ratios of the value."""


@dataclass(frozen=True)
class Field:
    """Field of the form for one parameter."""

    parameter: Parameter
    kind: str
    """One of "number", "integer", "choice" and "text"."""
    choices: tuple[str, ...]
    bounds: str
    """Bounds of a number for people, such as "8 to 40 mm"."""
    slider: Slider | None


MAIN = "what people change first"
"""Name of the first group of the form."""


def make_form() -> dict[str, list[Field]]:
    """Make the fields of each group: main parameters first, then each table."""
    groups: dict[str, list[Field]] = {MAIN: []}
    for table, parameters in group_parameters().items():
        for parameter in parameters:
            group = MAIN if parameter.path in _MAIN else table or "design"
            groups.setdefault(group, []).append(_make_field(parameter))

    groups[MAIN].sort(key=lambda field: _MAIN.index(field.parameter.path))
    return groups


def _make_field(parameter: Parameter) -> Field:
    declared = PARAMETERS[parameter.path]
    choices = list_choices(declared)
    if isinstance(parameter.default, bool):
        choices = choices or ("false", "true")
    if choices:
        return Field(
            parameter=parameter,
            kind="choice",
            choices=choices,
            bounds="",
            slider=None,
        )

    kind = _KINDS[type(parameter.default)]
    bounds = find_bounds(declared)
    low = bounds.above if bounds.minimum is None else bounds.minimum
    high = bounds.maximum

    if low is None or high is None:
        return Field(
            parameter=parameter,
            kind=kind,
            choices=(),
            bounds="",
            slider=None,
        )

    step = 10.0 ** math.floor(math.log10((high - low) / _STEPS))
    first = low + step if bounds.above is not None else low
    is_logarithmic = first > 0 and high / first > _LOGARITHMIC_RATIO
    slider = Slider(first, high, max(1.0, step) if kind == "integer" else step, is_logarithmic)

    return Field(
        parameter=parameter,
        kind=kind,
        choices=(),
        bounds=describe_bands(parameter.path, [(low, high)]),
        slider=slider,
    )
