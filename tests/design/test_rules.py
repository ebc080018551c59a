"""Every rule between parameters can be broken, and its refusal is the approved one, with a remedy that passes."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from fingertip.design import Design
from fingertip.design.formulas import filter as formulas
from fingertip.foundation.errors import DesignError, Issue
from tools.fuzz.remedies import as_changes, read_alternatives, read_remedy

APPROVED = Path(__file__).parent / "approved" / "refusals.txt"
FLANGE = "bone.interface=flange bone.base_length_mm=27"
SOCKET = "bone.interface=socket bone.base_length_mm=35"
CASES = [  # changes of the default design, or of the bundled one that is named first
    "board.variant=article board.supply_v=5 detector.window_samples=2000",  # passes: a controller averages it
    "fsr402 skin.width_mm=20",
    "adult_finger hand.axis_height_mm=2",
    "adult_finger hand.axis_height_mm=9 hand.clearance_radius_mm=2.6 hand.travel_deg=80 hand.pin_diameter_mm=2 "
    "bone.base_length_mm=9",
    "adult_finger hand.clearance_radius_mm=6.5 hand.axis_height_mm=5 bone.base_length_mm=13",
    "adult_finger hand.tendon_diameter_mm=2",
    "adult_finger hand.length_limit_mm=34.5",
    "adult_finger hand.pin_diameter_mm=6.5",
    "adult_finger hand.axis_height_mm=4",
    "adult_finger hand.width_mm=12",
    "adult_finger hand.clearance_radius_mm=2",
    "adult_finger hand.travel_deg=90",
    "skin.tip_length_mm=33",
    "skin.thickness_side_mm=5.5",
    "skin.min_thickness_mm=1.7",
    "skin.thickness_dorsal_mm=7.6",
    "skin.crown_radius_mm=90",
    "skin.thickness_tip_mm=9.5",
    "skin.taper_ratio=0.4 skin.tip_length_mm=20",
    "sensor.distance_from_tip_mm=31",
    "skin.thickness_palmar_mm=6",
    "skin.width_mm=15",
    "skin.thickness_side_mm=0.6 bone.palmar_fullness=0.998",
    "bone.wall_mm=4",
    "bone.channel_diameter_mm=9",
    "first_finger bone.channel_diameter_mm=2",
    "bone.channel_bend_radius_mm=1.2",
    "bone.base_length_mm=15",
    "sensor.model=custom custom_sensor.tail_width_mm=1",
    "bone.collar_inset_mm=1.45",
    "bone.groove_depth_mm=2.5",
    "bone.post_width_mm=12",
    "first_finger bone.channel_diameter_mm=1.5",
    "first_finger sensor.clearance_mm=0.2",
    "bone.post_height_mm=10.5",
    f"{FLANGE} bone.flange_spacing_x_mm=17",
    f"{FLANGE} bone.flange_spacing_y_mm=3",
    f"{FLANGE} bone.flange_width_mm=24",
    f"{FLANGE} bone.flange_height_mm=6",
    "bone.interface=flange bone.wall_mm=1.3 bone.flange_thickness_mm=1.1",
    f"{SOCKET} bone.socket_diameter_mm=12",
    "bone.post_length_mm=6 bone.foot_radius_mm=3",
    "sensor.model=custom custom_sensor.active_diameter_mm=20",
    "mold.wall_mm=2 mold.engraving_depth_mm=1.5",
    "sensor.model=fsr400_short sensor.distance_from_tip_mm=18",
    "adult_finger bone.base_length_mm=9.5",
    "adult_finger hand.knuckle=fork bone.base_length_mm=13",
    "adult_finger bone.collar_length_mm=4.5",
    "adult_finger hand.knuckle=fork bone.base_length_mm=14.3 hand.width_mm=2",
    pytest.param(
        "skin.thickness_side_mm=1.2 skin.min_thickness_mm=1.2 bone.palmar_fullness=0.9815", marks=pytest.mark.full
    ),
    "bone.wall_mm=0.6",
    f"{SOCKET} bone.cross_bolt_diameter_mm=5",
    "bone.interface=socket",
    "bone.interface=flange",
    f"{FLANGE} bone.flange_width_mm=12 bone.flange_spacing_x_mm=6 bone.flange_spacing_y_mm=18 bone.flange_height_mm=24",
    f"{FLANGE} bone.flange_spacing_y_mm=8",
    "bone.groove_distance_mm=14",
    "skin.width_mm=6 bone.collar_inset_mm=3.1661 skin.nail_fullness=0.9748",
    "board.variant=comparator board.channels=3",
    "board.passband_gain=1",
    "board.variant=comparator board.cutoff_hz=400",
    "sensor.model=fsr402",
    "skin.width_mm=1",
    "board.variant=comparator detector.window_samples=185",
    "board.variant=comparator detector.threshold_v=0.046 detector.window_samples=369",
    "board.variant=comparator detector.sample_rate_hz=4000 detector.window_samples=369",
    "detector.window_samples=2001",
    "detector.sample_rate_hz=4000 detector.window_samples=4001",
    "board.envelope_cutoff_hz=300 detector.window_samples=20 detector.sample_rate_hz=1199",
    "bone.cross_bolt_diameter_mm=1.5",
    "board.capacitor_uf=1000",
    "board.envelope_capacitor_uf=100",
    "board.capacitor_uf=1e-6",
    "board.envelope_cutoff_hz=0.001",
    "board.cutoff_hz=0.001 board.capacitor_series=preferred",
    "board.envelope_cutoff_hz=0.001 board.capacitor_series=preferred",
    "board.passband_gain=1.0001",
    "board.capacitor_uf=0.11",
    "board.envelope_capacitor_uf=0.11",
    "board.r5_ohm=1000",
    "board.band_limit_hz=10",
    "board.r5_ohm=1e7 board.band_limit_hz=100000",
    "board.supply_v=6",
    "board.amplifier=TL082",
    "board.passband_gain=10000",
    "board.variant=article board.supply_v=5 board.passband_gain=10000",
    "board.passband_gain=1.0001 board.r5_ohm=1e7",
    "board.capacitor_uf=20",
    "board.variant=article board.envelope_capacitor_uf=100 board.supply_v=5",
    "board.variant=article board.supply_v=3.3",
    "board.variant=comparator board.supply_v=5",
    "board.variant=comparator detector.threshold_v=10",
    "board.variant=comparator detector.threshold_v=0.0001",
    "board.variant=comparator detector.window_samples=10000",
    "board.envelope_cutoff_hz=10000",
    "detector.window_samples=10000",
    "detector.threshold_v=10",
    "force_curve.turn_on_n=5",
    "force_curve.min_force_n=100",
]


def find_issues(words: list[str]) -> tuple[Issue, ...]:
    """Issues of a design; none if it passes."""
    files, changes = ([word for word in words if ("=" in word) == is_change] for is_change in (False, True))
    try:
        Design.load(*files, changes=changes)
    except DesignError as error:
        return error.issues
    return ()


def check_section(path: Path, heading: str, text: str) -> None:
    """Compare a text with a section of an approved file, whose sections begin with "# " and their heading."""
    _, *sections = path.read_text(encoding="utf-8").split("# ")
    approved = dict(section.split("\n", 1) for section in sections)
    if os.environ.get("FINGERTIP_APPROVE"):
        approved[heading] = text
        path.write_text("".join(f"# {name}\n{body}" for name, body in approved.items()), encoding="utf-8")
    assert text == approved[heading]


@pytest.mark.parametrize("case", CASES)
def test_a_refusal_is_the_approved_one_and_its_remedies_pass(case: str) -> None:
    changes = case.split()
    issues = find_issues(changes)
    check_section(APPROVED, case, "".join(f"{issue}\n" for issue in issues))
    assert all(map(read_remedy, issues))
    for remedy in ([*as_changes(issues)], *([one] for issue in issues[:1] for one in read_alternatives(issue))):
        assert not find_issues([*changes, *remedy]), remedy


def test_dimensions_follow_a_copy_with_other_parameters() -> None:
    design = Design()
    assert design.dimensions.shrinkage > 1.0
    assert design.mold_layout.half_width > 0.0
    wider = design.with_values({"skin.width_mm": 20.0, "board.cutoff_hz": 70.0})
    assert wider.dimensions.outer.section.half_width == 10.0
    assert wider.mold_layout.half_width > design.mold_layout.half_width
    assert design.with_values({"board.cutoff_hz": 70.0}).dimensions is design.dimensions


def test_figures_of_the_comparator_are_those_of_its_data_sheet() -> None:
    """The LMV331's supply, input bias current, offset and drift, entered a second time."""
    assert pytest.approx((25, 250, 400)) == (
        1e9 * formulas.BIAS_A,
        1e9 * formulas.MAX_BIAS_A,
        1e9 * formulas.HOT_BIAS_A,
    )
    assert pytest.approx((1.7, 7)) == (1e3 * formulas.COMPARATOR_OFFSET_V, 1e3 * formulas.MAX_COMPARATOR_OFFSET_V)
    assert pytest.approx(5) == 1e6 * formulas.COMPARATOR_DRIFT_V_PER_K
    # Both ends are equally far from the data sheet's temperature, so that one drift holds for both.
    assert (formulas.MIN_TEMPERATURE_C, formulas.DATA_SHEET_C, formulas.MAX_TEMPERATURE_C) == (0.0, 25.0, 50.0)
