"""Every rule between parameters can be broken, blames its field, and names a remedy for it."""

from __future__ import annotations

import pytest

from fingertip.design import Design
from fingertip.design.all_rules import PART_RULES
from fingertip.design.formulas import filter as formulas
from fingertip.foundation.errors import DesignError, Issue
from tests.conftest import design_file
from tools.fuzz.remedies import as_changes, read_remedy

FOLDED = [
    "sensor.tail=folded", "skin.length_mm=25", "skin.tip_length_mm=8", "sensor.distance_from_tip_mm=9.5",
    "bone.base_length_mm=10", "bone.groove_depth_mm=0", "bone.wall_mm=0.8", "skin.semi_axis_dorsal_mm=7.6",
]  # fmt: skip
CLEVIS = [
    *FOLDED, "bone.interface=clevis", "bone.collar_length_mm=4.9", "mold.recess_length_mm=6.1", "hand.travel_deg=60",
    "hand.tendon_diameter_mm=0.1",
]  # fmt: skip
RECESS = "mold.recess_length_mm=4"
FLANGE = ["bone.interface=flange", "bone.base_length_mm=26"]
SOCKET = ["bone.interface=socket", "bone.base_length_mm=35"]
TALL = "bone.flange_height_mm=24"
CASE_BY_FIELD = {
    "skin.length_mm": [*CLEVIS, "hand.length_limit_mm=34.5"],
    "hand.pin_diameter_mm": [*CLEVIS, "hand.pin_diameter_mm=6.5"],
    "hand.axis_height_mm": [*CLEVIS, "hand.axis_height_mm=4"],
    "hand.width_mm": [*CLEVIS, "hand.width_mm=12"],
    "hand.tendon_distance_mm": [*CLEVIS, "hand.tendon_distance_mm=4.8"],
    "hand.travel_deg": [*CLEVIS, "hand.travel_deg=90"],
    "skin.tip_length_mm": ["skin.tip_length_mm=33"],
    "skin.thickness_side_mm": ["skin.thickness_side_mm=5.5"],
    "skin.min_thickness_mm": ["skin.min_thickness_mm=1.7"],
    "skin.thickness_dorsal_mm": ["skin.thickness_dorsal_mm=6.5"],
    "skin.thickness_tip_mm": ["skin.thickness_tip_mm=9.5"],
    "skin.taper_ratio": ["skin.taper_ratio=0.4", "skin.tip_length_mm=20"],
    "sensor.distance_from_tip_mm": ["sensor.distance_from_tip_mm=31"],
    "skin.thickness_palmar_mm": ["skin.thickness_palmar_mm=6"],
    "skin.width_mm": ["skin.width_mm=15"],
    "sensor.fold_radius_mm": [*FOLDED, "sensor.fold_radius_mm=2"],
    "sensor.crimp_height_mm": [*FOLDED, "sensor.crimp_height_mm=1.2"],
    "skin.semi_axis_dorsal_mm": [*FOLDED, "skin.semi_axis_dorsal_mm=6.2"],
    "bone.palmar_fullness": ["skin.thickness_side_mm=0.6", "bone.palmar_fullness=0.998"],
    "bone.wall_mm": ["bone.wall_mm=4"],
    "bone.channel_diameter_mm": ["bone.channel_diameter_mm=9"],
    "bone.channel_bend_radius_mm": ["bone.channel_bend_radius_mm=1.2"],
    "bone.base_length_mm": ["bone.base_length_mm=15"],
    "bone.relief_length_mm": ["sensor.model=fsr402_short", "bone.relief_length_mm=18"],
    "bone.collar_length_mm": ["bone.collar_length_mm=0.8"],
    "bone.collar_inset_mm": ["bone.collar_inset_mm=1.45"],
    "bone.groove_depth_mm": ["bone.groove_depth_mm=2.5"],
    "bone.tie_hole_diameter_mm": ["bone.tie_hole_diameter_mm=3"],
    "bone.post_width_mm": ["bone.post_width_mm=10"],
    "bone.post_height_mm": ["bone.post_height_mm=8.4"],
    "bone.flange_spacing_x_mm": [*FLANGE, "bone.flange_spacing_x_mm=17"],
    "bone.flange_spacing_y_mm": [*FLANGE, "bone.flange_spacing_y_mm=3"],
    "bone.flange_width_mm": [*FLANGE, "bone.flange_width_mm=24"],
    "bone.flange_height_mm": [*FLANGE, "bone.flange_height_mm=6"],
    "bone.flange_thickness_mm": ["bone.interface=flange", "bone.wall_mm=1.3", "bone.flange_thickness_mm=1.1"],
    "bone.socket_diameter_mm": [*SOCKET, "bone.socket_diameter_mm=8"],
    "bone.cross_bolt_diameter_mm": ["bone.cross_bolt_diameter_mm=5.8"],
    "mold.recess_length_mm": ["mold.recess_length_mm=25"],
    "mold.fit_clearance_mm": ["mold.fit_clearance_mm=0.9"],
    "mold.gate_diameter_mm": ["mold.filling=gravity", "mold.gate_diameter_mm=8"],
    "mold.funnel_diameter_mm": ["mold.filling=gravity", "mold.funnel_diameter_mm=12"],
    "mold.chaplet_diameter_mm": ["mold.chaplet_diameter_mm=3"],
    "mold.chaplet_from_tip_mm": ["mold.chaplet_from_tip_mm=3"],
    "mold.runner_width_mm": ["skin.length_mm=23", "skin.tip_length_mm=17", "mold.runner_width_mm=6"],
    "mold.runner_depth_mm": ["mold.runner_depth_mm=4"],
    "mold.draft_deg": ["mold.key_height_mm=8", "mold.draft_deg=14"],
    "mold.key_diameter_mm": ["mold.filling=gravity", "mold.land_mm=13"],
    "mold.key_height_mm": ["mold.key_height_mm=9.5"],
    "mold.nut_depth_mm": ["mold.nut_depth_mm=9"],
    "mold.nut_width_mm": ["mold.nut_width_mm=4"],
    "custom_sensor.active_diameter_mm": ["sensor.model=custom", "custom_sensor.active_diameter_mm=20"],
    "custom_sensor.tail_width_mm": ["sensor.model=custom", "custom_sensor.tail_width_mm=1"],
    "mold.pry_depth_mm": ["mold.pry_depth_mm=4"],
    "mold.pry_width_mm": ["skin.length_mm=23", "skin.tip_length_mm=8", "mold.pry_width_mm=38", RECESS],
    "mold.engraving_depth_mm": ["mold.wall_mm=2", "mold.engraving_depth_mm=1.5"],
}
MORE_CASES = [  # fields that a second rule blames too
    ("sensor.distance_from_tip_mm", ["sensor.model=fsr400_short", "sensor.distance_from_tip_mm=18"]),
    ("sensor.distance_from_tip_mm", [*FOLDED, "sensor.model=fsr400_short"]),
    ("sensor.distance_from_tip_mm", [*FOLDED, "sensor.distance_from_tip_mm=20"]),
    ("skin.width_mm", [*FOLDED, "skin.width_mm=13"]),
    ("bone.base_length_mm", [*FOLDED, "bone.base_length_mm=8.5"]),
    ("bone.base_length_mm", [*CLEVIS, "bone.base_length_mm=9.5"]),
    ("bone.base_length_mm", [*CLEVIS, "hand.knuckle=fork", "bone.base_length_mm=13"]),
    ("bone.collar_length_mm", [*CLEVIS, "bone.collar_length_mm=4.5"]),
    ("hand.width_mm", [*CLEVIS, "hand.knuckle=fork", "bone.base_length_mm=14.3", "hand.width_mm=2"]),
    ("sensor.crimp_height_mm", [*FOLDED, "bone.groove_depth_mm=0.6"]),
    (
        "skin.min_thickness_mm",
        ["skin.thickness_side_mm=1.2", "skin.min_thickness_mm=1.2", "bone.palmar_fullness=0.9815"],
    ),
    ("bone.wall_mm", ["bone.wall_mm=0.6"]),
    ("mold.recess_length_mm", ["mold.recess_length_mm=2.5"]),
    ("bone.cross_bolt_diameter_mm", [*SOCKET, "bone.cross_bolt_diameter_mm=5"]),
    ("bone.base_length_mm", ["bone.interface=socket"]),
    ("bone.base_length_mm", ["bone.interface=flange"]),
    (
        "bone.flange_width_mm",
        [*FLANGE, "bone.flange_width_mm=12", "bone.flange_spacing_x_mm=6", "bone.flange_spacing_y_mm=18", TALL],
    ),
    ("bone.flange_height_mm", [*FLANGE, "bone.flange_spacing_y_mm=8"]),
    ("bone.groove_depth_mm", ["bone.groove_distance_mm=14"]),
    ("mold.fit_clearance_mm", ["mold.fit_clearance_mm=0.3", "bone.collar_inset_mm=0.5"]),
    ("mold.fit_clearance_mm", ["mold.chaplet_diameter_mm=0"]),
    ("mold.fit_clearance_mm", ["printer.offset_mm=0.06"]),
    ("mold.nut_width_mm", ["printer.offset_mm=0.15", "mold.fit_clearance_mm=0.2"]),
    ("mold.nut_width_mm", ["mold.bolt_diameter_mm=4.5"]),
    ("mold.nut_width_mm", ["mold.nut_width_mm=6.4"]),
    ("mold.pry_depth_mm", ["mold.key_diameter_mm=8", "mold.key_clearance_mm=1", "mold.pry_depth_mm=2.6"]),
    (
        "bone.collar_inset_mm",
        ["mold.method=sleeve", "mold.silicone_shrinkage_percent=5", "bone.collar_inset_mm=1.3"],
    ),
]
CASES = [*CASE_BY_FIELD.items(), *MORE_CASES]
BOUND_IN_ANOTHER_FIELD = {
    "mold.key_diameter_mm": "mold.land_mm",
    "bone.palmar_fullness": "skin.thickness_side_mm",
    "mold.pry_width_mm": "skin.length_mm",
}
"""Blamed fields of which no value passes in these cases, with the field whose value does."""


def find_issues(changes: list[str]) -> dict[str, Issue]:
    """Issues of a design by the field they blame; none if it passes."""
    try:
        Design.load(changes=changes)
    except DesignError as error:
        return {issue.field: issue for issue in error.issues}
    return {}


def test_cases_cover_every_field_that_rules_of_the_parts_blame() -> None:
    assert {rule.field for rule in PART_RULES} == set(CASE_BY_FIELD)


@pytest.mark.every_case
@pytest.mark.parametrize(("field", "changes"), CASES)
def test_a_broken_rule_names_a_value_that_passes(field: str, changes: list[str]) -> None:
    issues = find_issues(changes)
    remedy = read_remedy(issues[field])
    assert remedy, issues[field]
    if field in BOUND_IN_ANOTHER_FIELD and len(issues) == 1:
        assert BOUND_IN_ANOTHER_FIELD[field] in remedy
    assert not find_issues([*changes, *as_changes(issues.values())]), issues[field]


def test_dimensions_follow_a_copy_with_other_parameters() -> None:
    design = Design()
    assert design.dimensions.draft_slope > 0.0
    assert design.mold_layout.half_width > 0.0
    wider = design.with_values({"skin.width_mm": 20.0, "board.cutoff_hz": 70.0})
    assert wider.dimensions.outer.section.half_width == 10.0
    assert wider.mold_layout.half_width > design.mold_layout.half_width
    assert design.with_values({"board.cutoff_hz": 70.0}).dimensions is design.dimensions


@pytest.mark.parametrize(
    ("changes", "samples"),
    [
        # The window is twice the time constant R C. At 92 ms, C of 1 uF and R of 46 kohm average it, and the bias
        # current of 250 nA drops 11.5 mV in R: half of the threshold of 23 mV.
        (["board.variant=comparator"], 184),
        (["board.variant=comparator", "detector.threshold_v=0.046"], 368),
        (["board.variant=comparator", "detector.sample_rate_hz=4000"], 368),
        # A controller averages any window up to one second.
        ([], 2000),
        (["detector.sample_rate_hz=4000"], 4000),
    ],
)
def test_the_longest_window_passes_and_one_sample_more_is_refused(changes: list[str], samples: int) -> None:
    Design.load(design_file("fsr400"), changes=[*changes, f"detector.window_samples={samples}"])
    with pytest.raises(DesignError, match=rf"detector.window_samples: .*; at most {samples} samples"):
        Design.load(design_file("fsr400"), changes=[*changes, f"detector.window_samples={samples + 1}"])


def test_the_sampling_rate_needs_four_samples_a_cycle_and_no_more() -> None:
    changes = ["board.envelope_cutoff_hz=300", "detector.window_samples=20"]
    Design.load(design_file("fsr400"), changes=[*changes, "detector.sample_rate_hz=1200"])
    with pytest.raises(DesignError, match=r"too slow for .* of 300 Hz; at least 1200 Hz, or "):
        Design.load(design_file("fsr400"), changes=[*changes, "detector.sample_rate_hz=1199"])


def test_figures_of_the_comparator_are_those_of_its_data_sheet() -> None:
    """The LMV331's supply, input bias current, offset and drift, entered a second time."""
    assert formulas.MAX_COMPARATOR_V == 5.5
    assert pytest.approx((25, 250, 400)) == (
        1e9 * formulas.BIAS_A,
        1e9 * formulas.MAX_BIAS_A,
        1e9 * formulas.HOT_BIAS_A,
    )
    assert pytest.approx((1.7, 7)) == (1e3 * formulas.COMPARATOR_OFFSET_V, 1e3 * formulas.MAX_COMPARATOR_OFFSET_V)
    assert pytest.approx(5) == 1e6 * formulas.COMPARATOR_DRIFT_V_PER_K
    # Both ends are equally far from the data sheet's temperature, so that one drift holds for both.
    assert (formulas.MIN_TEMPERATURE_C, formulas.DATA_SHEET_C, formulas.MAX_TEMPERATURE_C) == (0.0, 25.0, 50.0)
