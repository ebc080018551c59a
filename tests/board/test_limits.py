"""How far the voltages go on both supplies, and why the bridge returns to the middle of a single one."""

from __future__ import annotations

import pytest

from fingertip.board import board_values
from fingertip.board.supplies import SUPPLIES
from fingertip.board.values.amplifiers import AMPLIFIERS, OTHERS, PAPERS, dual_amplifier
from fingertip.board.values.bridge import fit_bridge
from fingertip.board.values.limits import converter_line, converter_remarks, limits, swing_line, swing_of
from fingertip.board.variants import VARIANTS
from fingertip.design import Design


def test_limits_of_both_supplies() -> None:
    split, single = (board_values(Design.load(changes=[f"board.supply={s}"])).limits for s in ("split", "single"))
    assert (split.rest_v, single.rest_v) == (0.0, 2.5)
    assert (split.filter_peak_v, single.filter_peak_v) == pytest.approx((3.5, 2.4))
    assert (split.filter_trough_v, single.filter_trough_v) == pytest.approx((2.0, 2.4))
    assert split.vibration_peak_v == pytest.approx(2.0 / 67.667, rel=1e-3)
    assert single.vibration_peak_v == pytest.approx(2.4 / 67.667, rel=1e-3)
    for found in (split, single):
        assert 0 < found.min_tactile_v < 3.85 < 4.3 < found.max_tactile_v < 4.5
    assert found.max_tactile_v <= found.clamp_high_v


def test_a_converter_too_small_for_the_board_is_said() -> None:
    fits, small = (
        board_values(Design.load(changes=["board.supply=single", f"detector.adc_range_v={v}"])).limits
        for v in (10.0, 3.3)
    )
    assert fits.converter_misses_v == 0
    assert converter_line(fits) == "a converter for plus and minus 10 V takes all of it"
    assert small.converter_misses_v == pytest.approx(max(small.max_tactile_v, 2.5 + small.max_envelope_v) - 3.3)
    assert "cuts the last 1.06 V off" in converter_line(small)
    assert "detector.adc_range_v to 4.36 at least" in converter_line(small)
    assert list(converter_remarks(fits)) == []
    (clipped,) = converter_remarks(small)
    assert converter_line(small) in clipped


def test_only_the_articles_own_board_has_an_amplifier_whose_inputs_end_early() -> None:
    """The TL082: 3 V above its negative rail typically, 4 V to be sure; below, its output jumps up."""
    for name, variant in VARIANTS.items():
        values = board_values(Design.load(changes=variant.changes))
        found, article = values.limits, name == "article_split"
        assert values.amplifier == (PAPERS if article else OTHERS) == dual_amplifier(*name.split("_"))
        assert found.reverses_below == article == ("jumps up" in swing_line(found))
        if article:
            assert (found.filter_trough_v, found.filter_sure_trough_v) == (2.0, 1.0)
        else:
            assert found.filter_trough_v == found.filter_sure_trough_v == found.filter_peak_v
        assert f"{found.filter_trough_v:.1f} V down" in swing_line(found)
    higher = board_values(Design.load(changes=["board.supply_v=6"])).limits
    assert (higher.filter_peak_v, higher.filter_trough_v) == (4.5, 3.0)


@pytest.mark.parametrize("series", ["E12", "E24", "E96"])
@pytest.mark.parametrize("supply_v", [5.0, 5.5, 6.0])
@pytest.mark.parametrize("supply", ["split", "single"])
def test_the_bridges_amplifier_stays_within_its_rails(supply: str, supply_v: float, series: str) -> None:
    changes = [f"board.supply={supply}", f"board.supply_v={supply_v}", f"board.series={series}"]
    assert board_values(Design.load(changes=changes)).limits.bridge_amplifier_margin_v > 0


def test_a_bridge_at_ground_would_not_do_on_a_single_supply() -> None:
    """Why it returns to the middle: the AD623's inner amplifiers would have to go below ground."""
    bridge = fit_bridge(5.0, "E24", 5.08)
    for name, minimum, maximum in (("split", 0.0, 5.0), ("single", -5.0, -1.0)):
        supply = SUPPLIES[name]
        swing = swing_of(AMPLIFIERS[OTHERS], supply, 5.0)
        assert minimum < limits(bridge, supply, 5.0, swing, 67.7, True, 10.0).bridge_amplifier_margin_v < maximum
