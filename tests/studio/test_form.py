"""Form of the studio: every parameter of the JSON schema, with its bounds, as a field."""

from __future__ import annotations

import math

import pytest

from fingertip import Design
from fingertip.design.export import json_schema
from fingertip.design.parameters.declaration import find_bounds, find_unit, list_choices
from fingertip.design.parameters.design_tables import PARAMETERS
from fingertip.studio.form import Field, make_form, make_pointer
from fingertip.studio.page import render_studio
from tests.page.conftest import Page

FIELDS = {field.path: field for group in make_form(json_schema()) for field in group.fields}
DESIGNS = ("fsr400", "fsr402", "fsr400_compact", "adult_finger", "child_thumb")


def test_every_parameter_has_one_field_in_the_order_of_the_file() -> None:
    assert list(FIELDS) == list(PARAMETERS)


@pytest.mark.parametrize("path", PARAMETERS)
def test_field_says_what_the_declaration_says(path: str) -> None:
    """The form is made from the schema; the declarations are the second source."""
    field, declared = FIELDS[path], PARAMETERS[path]
    assert field.description == declared.description
    assert field.unit == find_unit(declared)
    assert field.default == declared.default
    assert field.choices == list_choices(declared)
    kinds = {float: "number", int: "integer", str: "text"}
    assert field.kind == ("choice" if field.choices else kinds[type(declared.default)])
    bounds = find_bounds(declared)
    if field.slider:
        assert field.slider.maximum == bounds.maximum
        low = bounds.minimum if bounds.minimum is not None else bounds.above
        assert low is not None
        assert field.slider.minimum == low if bounds.above is None else low < field.slider.minimum < declared.default
    else:
        assert field.kind in ("choice", "text")


@pytest.mark.parametrize("field", [field for field in FIELDS.values() if field.slider], ids=lambda field: field.path)
def test_slider_has_some_hundred_steps_of_round_size(field: Field) -> None:
    slider = field.slider
    assert slider
    if slider.is_logarithmic:
        assert slider.maximum / slider.minimum > 1000
    elif field.kind == "integer":
        assert slider.step >= 1
    else:
        assert (slider.maximum - slider.minimum) / slider.step + 1.001 >= 200
        assert (slider.maximum - slider.minimum) / slider.step <= 2001
        assert math.log10(slider.step) == pytest.approx(round(math.log10(slider.step)))


def test_pointers_are_those_of_rfc_6901() -> None:
    assert make_pointer("skin.width_mm") == "/skin/width_mm"
    assert make_pointer("") == ""
    assert make_pointer("a/b.c~d") == "/a~1b/c~0d"


def test_a_type_without_field_is_refused() -> None:
    with pytest.raises(ValueError, match=r"flags.open: there is no field for the type 'boolean'"):
        make_form({"properties": {"flags": {"properties": {"open": {"type": "boolean"}}}}})


@pytest.mark.full
@pytest.mark.parametrize("name", DESIGNS)
def test_page_holds_the_values_of_the_design(name: str) -> None:
    design = Design.load(name)
    page = Page(render_studio(design, "TOKEN").decode())
    assert not page.faults
    shown = {attributes["id"]: attributes for tag, attributes in page.elements if tag == "input" and "id" in attributes}
    groups = [attributes["data-pointer"] for _, attributes in page.elements if "data-pointer" in attributes]
    assert groups == [make_pointer(path) for path in PARAMETERS]
    for path, field in FIELDS.items():
        if field.kind in ("number", "integer"):
            assert float(shown[f"f-{path}"]["value"] or "") == design.value(path)
        elif field.kind == "text":
            assert shown[f"f-{path}"]["value"] == design.value(path)
    selected = [
        attributes["value"] for tag, attributes in page.elements if tag == "option" and "selected" in attributes
    ]
    assert selected == [design.value(path) for path, field in FIELDS.items() if field.kind == "choice"]
    identifiers = list(page.attributes("id"))
    assert len(identifiers) == len(set(identifiers))
    assert {name for text in page.attributes("aria-describedby") for name in text.split()} <= set(identifiers)
    assert not [url for url in (*page.attributes("src"), *page.attributes("href")) if url.startswith("http")]
