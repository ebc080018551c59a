"""Every rule between parameters can be broken, blames its field, and prints a bound that passes."""

from __future__ import annotations

import contextlib
import re

import pytest

from fingertip.design import Design, rules
from fingertip.errors import DesignError
from tests.conftest import design_file

BROKEN = {
    "skin.tip_length_mm": ["skin.tip_length_mm=33"],
    "skin.thickness_side_mm": ["skin.thickness_side_mm=5.5"],
    "skin.min_thickness_mm": ["skin.min_thickness_mm=1.7"],
    "skin.thickness_dorsal_mm": ["skin.thickness_dorsal_mm=6.5"],
    "skin.thickness_tip_mm": ["skin.thickness_tip_mm=9.5"],
    "skin.squareness_tip": ["skin.taper_ratio=0.4", "skin.tip_length_mm=20"],
    "sensor.distance_from_tip_mm": ["sensor.distance_from_tip_mm=31"],
    "skin.thickness_palmar_mm": ["skin.thickness_palmar_mm=6"],
    "skin.width_mm": ["skin.width_mm=15"],
    "bone.squareness_palmar": ["skin.thickness_side_mm=0.6", "bone.squareness_palmar=8"],
    "bone.wall_mm": ["bone.wall_mm=4"],
    "bone.channel_diameter_mm": ["bone.channel_diameter_mm=9"],
    "bone.channel_bend_radius_mm": ["bone.channel_bend_radius_mm=1.2"],
    "bone.base_length_mm": ["bone.base_length_mm=15"],
    "bone.relief_length_mm": ["sensor.model=fsr402_short", "bone.relief_length_mm=18"],
    "bone.collar_length_mm": ["bone.collar_length_mm=0.8"],
    "bone.collar_inset_mm": ["bone.collar_inset_mm=1.45"],
    "bone.groove_depth_mm": ["bone.groove_depth_mm=2.5"],
    "bone.tie_hole_diameter_mm": ["bone.tie_hole_diameter_mm=3"],
    "bone.post_diameter_mm": ["bone.post_diameter_mm=9"],
    "bone.socket_diameter_mm": ["bone.interface=socket", "bone.base_length_mm=35", "bone.socket_diameter_mm=8"],
    "bone.cross_bolt_diameter_mm": ["bone.cross_bolt_diameter_mm=5.5"],
    "mold.recess_length_mm": ["mold.recess_length_mm=25"],
    "mold.fit_clearance_mm": ["mold.fit_clearance_mm=0.9"],
    "mold.gate_diameter_mm": ["mold.gate_diameter_mm=8"],
    "mold.funnel_diameter_mm": ["mold.funnel_diameter_mm=12"],
    "mold.draft_deg": ["mold.key_height_mm=8", "mold.draft_deg=14"],
    "mold.key_diameter_mm": ["mold.land_mm=13"],
    "mold.key_height_mm": ["mold.key_height_mm=9.5"],
    "mold.nut_depth_mm": ["mold.nut_depth_mm=9"],
    "mold.nut_width_mm": ["mold.nut_width_mm=4"],
    "custom_sensor.active_diameter_mm": ["sensor.model=custom", "custom_sensor.active_diameter_mm=20"],
    "custom_sensor.tail_width_mm": ["sensor.model=custom", "custom_sensor.tail_width_mm=1"],
    "mold.pry_depth_mm": ["mold.pry_depth_mm=4"],
    "mold.pry_width_mm": [
        "skin.length_mm=23",
        "skin.tip_length_mm=8",
        "mold.pry_width_mm=38",
        "mold.recess_length_mm=4",
    ],
    "mold.engraving_depth_mm": ["mold.wall_mm=2", "mold.engraving_depth_mm=1.5"],
}
MORE = [  # fields that a second rule blames too
    ("sensor.distance_from_tip_mm", ["sensor.model=fsr400_short", "sensor.distance_from_tip_mm=18"]),
    (
        "skin.min_thickness_mm",
        ["skin.thickness_side_mm=1.2", "skin.min_thickness_mm=1.2", "bone.squareness_palmar=2.5"],
    ),
    ("bone.wall_mm", ["bone.wall_mm=0.6"]),
    ("mold.recess_length_mm", ["mold.recess_length_mm=2.5"]),
    (
        "bone.cross_bolt_diameter_mm",
        ["bone.interface=socket", "bone.base_length_mm=35", "bone.cross_bolt_diameter_mm=5"],
    ),
    ("bone.base_length_mm", ["bone.interface=socket"]),
    ("bone.groove_depth_mm", ["bone.groove_distance_mm=14"]),
    ("mold.fit_clearance_mm", ["mold.fit_clearance_mm=0.3", "bone.collar_inset_mm=0.5"]),
    ("mold.fit_clearance_mm", ["skin.length_mm=70"]),
    ("mold.nut_width_mm", ["mold.bolt_diameter_mm=4.5"]),
    ("mold.nut_width_mm", ["mold.nut_width_mm=6.4"]),
    ("mold.pry_depth_mm", ["mold.key_diameter_mm=8", "mold.key_clearance_mm=1", "mold.pry_depth_mm=2.6"]),
    (
        "bone.collar_inset_mm",
        ["mold.method=sleeve", "mold.silicone_shrinkage_percent=5", "bone.collar_inset_mm=1.3"],
    ),
]
# No single value of the blamed field mends these: their sentences name another remedy.
NO_OWN_BOUND = {"skin.squareness_tip", "mold.key_diameter_mm"}


def test_every_rule_of_the_parts_stands_in_the_table() -> None:
    assert {rule.field for rule in rules.PARTS} == set(BROKEN)


CASES = [*BROKEN.items(), *MORE]


@pytest.mark.parametrize(("field", "changes"), CASES)
def test_a_broken_rule_blames_its_field(field: str, changes: list[str]) -> None:
    assert field in blamed(changes)


@pytest.mark.parametrize(("field", "changes"), [case for case in CASES if case[0] not in NO_OWN_BOUND])
def test_the_printed_bound_passes_when_typed_in(field: str, changes: list[str]) -> None:
    with pytest.raises(DesignError) as caught:
        Design.load(changes=changes)
    sentence = next(issue.message for issue in caught.value.issues if issue.field == field)
    bound = re.search(r"(?:at least|at most|between) (\d+(?:\.\d+)?)", sentence)
    assert bound, sentence
    assert field not in blamed([*changes, f"{field}={bound[1]}"]), sentence


def blamed(changes: list[str]) -> set[str]:
    with contextlib.suppress(DesignError):
        Design.load(changes=changes)
        return set()
    with pytest.raises(DesignError) as caught:
        Design.load(changes=changes)
    return {issue.field for issue in caught.value.issues}


@pytest.mark.parametrize("name", ["fsr400", "fsr402"])
def test_other_tails_fit_as_the_files_say(name: str) -> None:
    change = {
        "fsr400": ["sensor.model=fsr400_short", "bone.base_length_mm=15"],
        "fsr402": ["sensor.model=fsr402", "bone.base_length_mm=37"],
    }[name]
    Design.load(design_file(name), changes=change)
