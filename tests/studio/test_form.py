"""Form of the studio: every parameter of the JSON schema, with its bounds, as a field."""

from __future__ import annotations

import math

import pytest

from fingertip.design.files import json_schema
from fingertip.design.parameters import PARAMETERS
from fingertip.design.parameters.declaration import find_bounds, find_unit, list_choices
from fingertip.studio.answers import make_pointer
from fingertip.studio.page import Field, make_form

FIELDS = {field.path: field for group in make_form(json_schema()) for field in group.fields}
DESIGNS = ("fsr400", "fsr402", "fsr400_compact", "adult_finger", "child_thumb")


def test_fields_say_what_the_declarations_say_in_the_order_of_the_file() -> None:
    """The form is made from the schema; the declarations are the second source."""
    assert list(FIELDS) == list(PARAMETERS)
    kinds = {float: "number", int: "integer", str: "text"}
    wrong = []
    for path, declared in PARAMETERS.items():
        field, choices = FIELDS[path], list_choices(declared)
        kind = "choice" if choices else kinds[type(declared.default)]
        said = (field.description, field.unit, field.default, field.choices, field.kind)
        declaration = (declared.description, find_unit(declared), declared.default, choices, kind)
        if said != declaration or not slider_has_the_bounds(field):
            wrong.append((path, said, declaration, field.slider))
    assert wrong == []


def slider_has_the_bounds(field: Field) -> bool:
    """Return whether the slider of a number ends at the declared bounds, and above the one that is excluded."""
    declared = PARAMETERS[field.path]
    bounds, slider = find_bounds(declared), field.slider
    if not slider:
        return field.kind in ("choice", "text")
    if bounds.above is None:
        return (slider.minimum, slider.maximum) == (bounds.minimum, bounds.maximum)
    low = bounds.above if bounds.minimum is None else bounds.minimum
    return slider.maximum == bounds.maximum and low < slider.minimum < declared.default


def test_sliders_have_some_hundred_steps_of_round_size() -> None:
    sliders = {field: field.slider for field in FIELDS.values() if field.slider}
    assert len(sliders) > 100
    wrong = []
    for field, slider in sliders.items():
        if slider.is_logarithmic:
            right = slider.maximum / slider.minimum > 1000
        elif field.kind == "integer":
            right = slider.step >= 1
        else:
            exponent, count = math.log10(slider.step), (slider.maximum - slider.minimum) / slider.step
            right = count + 1.001 >= 200 and count <= 2001 and exponent == pytest.approx(round(exponent))
        if not right:
            wrong.append((field.path, slider))
    assert wrong == []


def test_pointers_are_those_of_rfc_6901() -> None:
    assert make_pointer("skin.width_mm") == "/skin/width_mm"
    assert make_pointer("") == ""
    assert make_pointer("a/b.c~d") == "/a~1b/c~0d"


def test_a_type_without_field_is_refused() -> None:
    with pytest.raises(ValueError, match=r"flags.open: there is no field for the type 'boolean'"):
        make_form({"properties": {"flags": {"properties": {"open": {"type": "boolean"}}}}})
