"""Form of the studio: every parameter of the JSON schema, with its bounds, as a field."""

from __future__ import annotations

import math
import re

import pytest

from fingertip import Design
from fingertip.design.parameters import PARAMETERS
from fingertip.design.parameters.declaration import find_bounds
from fingertip.studio.form_page import MAIN, Field, make_form, render_form

FIELDS = {field.parameter.path: field for fields in make_form().values() for field in fields}


def test_nine_fields_come_first_and_the_others_in_the_order_of_the_file() -> None:
    groups = make_form()
    main, *others = ([field.parameter.path for field in fields] for fields in groups.values())
    assert (next(iter(groups)), len(main)) == (MAIN, 9)
    assert [path for paths in others for path in paths] == [
        path for path in PARAMETERS if path not in main
    ]
    assert set(main) <= set(PARAMETERS)


def test_choices_show_the_values_of_the_design() -> None:
    """A choice without one would show its first word, which the studio would take for the value."""
    design = Design.load("fsr400")
    form = render_form(design, {})
    shown = {}
    for path, options in re.findall('<select id="f-([^"]+)"[^>]*>(.*?)</select>', form, re.DOTALL):
        shown[path] = re.findall("<option[^>]* selected[^>]*>([^<]*)<", options)
    choices = [path for path, field in FIELDS.items() if field.kind == "choice"]
    assert {path: [word.lower() for word in words] for path, words in shown.items()} == {
        path: [str(design.value(path)).lower()] for path in choices
    }


def test_sliders_are_between_the_declared_bounds() -> None:
    assert [field.slider for field in FIELDS.values() if not slider_has_the_bounds(field)] == []


def slider_has_the_bounds(field: Field) -> bool:
    """Return whether the slider of a number ends at the declared
    bounds, and above the one that is excluded.
    """
    declared = PARAMETERS[field.parameter.path]
    bounds = find_bounds(declared)
    slider = field.slider
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
            exponent = math.log10(slider.step)
            count = (slider.maximum - slider.minimum) / slider.step
            right = (
                count + 1.001 >= 200
                and count <= 2001
                and exponent == pytest.approx(round(exponent))
            )
        if not right:
            wrong.append((field.parameter.path, slider))
    assert wrong == []
