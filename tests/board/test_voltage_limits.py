"""Voltage limits on both supplies, and why the bridge refers to VMID on a single supply."""

from __future__ import annotations

import pytest

from fingertip.board import board_values
from fingertip.board.supplies import SUPPLIES
from fingertip.board.values.amplifiers import (
    AMPLIFIERS,
    ARTICLE_AMPLIFIER,
    RAIL_TO_RAIL_AMPLIFIER,
    select_dual_amplifier,
)
from fingertip.board.values.bridge import size_bridge
from fingertip.board.values.voltage_limits import (
    adc_range_warnings,
    compute_output_swing,
    compute_voltage_limits,
    describe_adc_range,
    describe_filter_swing,
)
from fingertip.board.variants import BOARD_CONFIGURATIONS
from fingertip.design import Design


def test_voltage_limits_of_both_supplies() -> None:
    split, single = (
        board_values(Design.load(changes=[f"board.supply={s}"])).voltage_limits for s in ("split", "single")
    )
    assert (split.signal_ground_v, single.signal_ground_v) == (0.0, 2.5)
    assert (split.filter_peak_v, single.filter_peak_v) == pytest.approx((3.5, 2.4))
    assert (split.filter_trough_v, single.filter_trough_v) == pytest.approx((2.0, 2.4))
    assert split.vibration_peak_v == pytest.approx(2.0 / 67.667, rel=1e-3)
    assert single.vibration_peak_v == pytest.approx(2.4 / 67.667, rel=1e-3)
    for limits in (split, single):
        assert 0 < limits.min_tactile_v < 3.85 < 4.3 < limits.max_tactile_v < 4.5
        assert limits.max_tactile_v <= limits.clamp_high_rail_v


def test_an_adc_range_below_the_boards_signals_is_reported() -> None:
    sufficient, insufficient = (
        board_values(Design.load(changes=["board.supply=single", f"detector.adc_range_v={v}"])).voltage_limits
        for v in (10.0, 3.3)
    )
    assert sufficient.adc_overrange_v == 0
    assert describe_adc_range(sufficient) == "an ADC with a range of plus and minus 10 V covers all signals"
    maximum_v = max(insufficient.max_tactile_v, 2.5 + insufficient.max_envelope_v)
    assert insufficient.adc_overrange_v == pytest.approx(maximum_v - 3.3)
    assert "clips the top 1.06 V" in describe_adc_range(insufficient)
    assert "detector.adc_range_v to at least 4.36" in describe_adc_range(insufficient)
    assert list(adc_range_warnings(sufficient)) == []
    (warning,) = adc_range_warnings(insufficient)
    assert describe_adc_range(insufficient) in warning


def test_only_the_articles_board_has_an_amplifier_with_phase_reversal() -> None:
    """The TL082's input range ends 3 V above the negative rail (typical) or 4 V (guaranteed)."""
    for name, configuration in BOARD_CONFIGURATIONS.items():
        values = board_values(Design.load(changes=configuration.changes))
        limits, is_article = values.voltage_limits, name == "article_split"
        amplifier = ARTICLE_AMPLIFIER if is_article else RAIL_TO_RAIL_AMPLIFIER
        assert values.amplifier == amplifier == select_dual_amplifier(*name.split("_"))
        assert limits.has_phase_reversal == is_article == ("jumps up" in describe_filter_swing(limits))
        if is_article:
            assert (limits.filter_trough_v, limits.filter_guaranteed_trough_v) == (2.0, 1.0)
        else:
            assert limits.filter_trough_v == limits.filter_guaranteed_trough_v == limits.filter_peak_v
        assert f"{limits.filter_trough_v:.1f} V down" in describe_filter_swing(limits)
    higher_supply = board_values(Design.load(changes=["board.supply_v=6"])).voltage_limits
    assert (higher_supply.filter_peak_v, higher_supply.filter_trough_v) == (4.5, 3.0)


@pytest.mark.parametrize("series", ["E12", "E24", "E96"])
@pytest.mark.parametrize("supply_v", [5.0, 5.5, 6.0])
@pytest.mark.parametrize("supply", ["split", "single"])
def test_bridge_amplifier_stays_within_its_limits(supply: str, supply_v: float, series: str) -> None:
    changes = [f"board.supply={supply}", f"board.supply_v={supply_v}", f"board.series={series}"]
    assert board_values(Design.load(changes=changes)).voltage_limits.bridge_amplifier_margin_v > 0


def test_a_bridge_at_ground_violates_the_amplifiers_limits_on_a_single_supply() -> None:
    """The AD623's internal amplifiers would have to go below ground, so the bridge refers to VMID."""
    bridge = size_bridge(5.0, "E24", 5.08)
    for name, minimum, maximum in (("split", 0.0, 5.0), ("single", -5.0, -1.0)):
        supply = SUPPLIES[name]
        swing = compute_output_swing(AMPLIFIERS[RAIL_TO_RAIL_AMPLIFIER], supply, 5.0)
        limits = compute_voltage_limits(bridge, supply, 5.0, swing, 67.7, True, 10.0)
        assert minimum < limits.bridge_amplifier_margin_v < maximum
