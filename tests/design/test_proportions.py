"""Proportions of proven fingers: a file of wishes and measurements
alone loads as the finger that is nearest to it.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from fingertip.design import Design
from fingertip.design.design_file import flatten
from fingertip.design.parameters import PARAMETERS, find_kind
from fingertip.design.proportions import KEYS, fill_in, load_proportions

FINGERS = list(load_proportions())


@pytest.mark.parametrize("name", FINGERS)
def test_each_column_is_its_bundled_design(name: str) -> None:
    design = Design.load(name)
    found = dict(flatten(load_proportions()[name]))
    assert {path: design.value(path) for path in found} == found
    assert {*KEYS, *(path for path in PARAMETERS if find_kind(path) == "derived")} <= {*found}


@pytest.mark.parametrize("name", FINGERS)
def test_what_a_file_leaves_out_follows_and_what_it_states_stays(name: str, tmp_path: Path) -> None:
    design = Design.load(name)
    path = tmp_path / "d.toml"
    lines = [
        f"{key} = {json.dumps(value)}"
        for key, value in design.changes().items()
        if find_kind(key) != "derived"
    ]
    path.write_text("\n".join(lines))
    assert Design.load(path).model_copy(update={"name": name}) == design
    path.write_text("\n".join([*lines, "printer.min_wall_mm = 0.79", "skin.bump_height_mm = 0.09"]))
    assert (Design.load(path).printer.min_wall_mm, Design.load(path).skin.bump_height_mm) == (
        0.79,
        0.09,
    )


def test_a_change_beside_a_file_does_not_choose_another_finger() -> None:
    assert Design.load("adult_finger", changes=["skin.width_mm=18.2"]).bone.platform_mm == 2.15
    assert Design.load(changes=["sensor.adhesive_thickness_mm=0.1"]).skin == Design().skin


@pytest.mark.parametrize(
    ("tables", "nearest"),
    [
        ({}, "fsr400"),
        ({"sensor": {"model": "fsr402"}}, "fsr402"),
        ({"sensor": {"model": "custom"}, "custom_sensor": {"head_diameter_mm": 15.0}}, "fsr402"),
        (
            {"bone": {"interface": "clevis"}, "skin": {"width_mm": 18.0, "length_mm": 25.0}},
            "adult_finger",
        ),
        (
            {"bone": {"interface": "clevis"}, "skin": {"width_mm": 30, "length_mm": 25}},
            "adult_thumb",
        ),
        ({"skin": {"width_mm": "wide"}, "bone": 3, "sensor": {"model": 4}}, "fsr400"),
    ],
)
def test_the_nearest_finger_has_the_head_then_the_interface_then_the_sizes(
    tables: dict, nearest: str
) -> None:
    filled = fill_in(tables)
    expected = load_proportions()[nearest]
    assert filled["skin"]["tip_length_mm"] == expected["skin"]["tip_length_mm"]
    assert filled["skin"]["thickness_side_mm"] == expected["skin"]["thickness_side_mm"]
    assert all(
        filled[table][key] == value
        for table, own in tables.items()
        if isinstance(own, dict)
        for key, value in own.items()
    )
