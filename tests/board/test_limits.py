"""How far the voltages go on both supplies, and why the bridge returns to the middle of a single one."""

from __future__ import annotations

import pytest

from fingertip.board import board_values
from fingertip.board.supplies import SUPPLIES
from fingertip.board.values.bridge import fit_bridge
from fingertip.board.values.limits import converter_line, limits
from fingertip.design import Design


def test_limits_of_both_supplies() -> None:
    split, single = (board_values(Design.load(changes=[f"board.supply={s}"])).limits for s in ("split", "single"))
    assert (split.rest_v, single.rest_v) == (0.0, 2.5)
    assert (split.filter_peak_v, single.filter_peak_v) == pytest.approx((3.5, 2.4))
    assert single.vibration_peak_v == pytest.approx(2.4 / 67.667, rel=1e-4)
    for found in (split, single):
        assert 0 < found.tactile_least_v < 3.85 < 4.3 < found.tactile_most_v < 4.5
    assert found.tactile_most_v <= found.clamp_high_v


def test_a_converter_too_small_for_the_board_is_said() -> None:
    fits, small = (
        board_values(Design.load(changes=["board.supply=single", f"detector.adc_range_v={v}"])).limits
        for v in (10.0, 3.3)
    )
    assert fits.converter_misses_v == 0
    assert converter_line(fits) == "a converter for plus and minus 10 V takes all of it"
    assert small.converter_misses_v == pytest.approx(max(small.tactile_most_v, 2.5 + small.envelope_most_v) - 3.3)
    assert "cuts the last 1.06 V off" in converter_line(small)
    assert "detector.adc_range_v to 4.36 at least" in converter_line(small)


@pytest.mark.parametrize("series", ["E12", "E24", "E96"])
@pytest.mark.parametrize("supply_v", [5.0, 5.5, 6.0])
@pytest.mark.parametrize("supply", ["split", "single"])
def test_the_bridges_amplifier_stays_within_its_rails(supply: str, supply_v: float, series: str) -> None:
    changes = [f"board.supply={supply}", f"board.supply_v={supply_v}", f"board.series={series}"]
    assert board_values(Design.load(changes=changes)).limits.bridge_amplifier_margin_v > 0


def test_a_bridge_at_ground_would_not_do_on_a_single_supply() -> None:
    """Why it returns to the middle: the AD623's inner amplifiers would have to go below ground."""
    bridge = fit_bridge(5.0, "E24", 5.08)
    assert limits(bridge, SUPPLIES["split"], 5.0, 67.7, True, 10.0).bridge_amplifier_margin_v > 0
    assert limits(bridge, SUPPLIES["single"], 5.0, 67.7, True, 10.0).bridge_amplifier_margin_v < -1
