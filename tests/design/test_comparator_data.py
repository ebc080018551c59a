"""Figures of variant comparator's LMV331: the data sheet's, entered a second time, and what follows from them."""

from __future__ import annotations

import pytest

from fingertip.design.formulas import filter as data


def test_figures_are_the_data_sheets() -> None:
    """Supply, input bias current, offset and drift of the LMV331 at 25 degrees Celsius, and over temperature."""
    assert data.MAX_COMPARATOR_V == 5.5
    assert pytest.approx((25, 250, 400)) == (1e9 * data.BIAS_A, 1e9 * data.MAX_BIAS_A, 1e9 * data.HOT_BIAS_A)
    assert pytest.approx((1.7, 7)) == (1e3 * data.COMPARATOR_OFFSET_V, 1e3 * data.MAX_COMPARATOR_OFFSET_V)
    assert pytest.approx(5) == 1e6 * data.COMPARATOR_DRIFT_V_PER_K
    assert data.DATA_SHEET_C == 25.0


def test_worst_cases_are_stated_for_a_room_from_frost_to_summer_sun() -> None:
    """Both ends are equally far from the data sheet's temperature, so that one drift holds for both."""
    assert data.MIN_TEMPERATURE_C == 0.0
    assert data.MAX_TEMPERATURE_C == 2 * data.DATA_SHEET_C


def test_the_least_threshold_is_above_the_largest_offset() -> None:
    """The offset is then 64 % of the threshold."""
    assert pytest.approx(0.64, abs=0.005) == data.MAX_COMPARATOR_OFFSET_V / data.MIN_COMPARATOR_V


def test_the_low_pass_has_parts_that_exist() -> None:
    assert pytest.approx(1e-6) == data.MAX_AVERAGING_F
    assert data.AVERAGING_OHM == 15e3, "a value of series E12"
    assert data.TRIMMER_TOLERANCE == 0.2


@pytest.mark.parametrize(("threshold_v", "window_s"), [(0.025, 0.1), (0.05, 0.2), (0.011, 0.044)])
def test_at_the_longest_window_the_bias_current_takes_half_of_the_threshold(
    threshold_v: float, window_s: float
) -> None:
    """At 25 mV, 250 nA drop 12.5 mV in 50 kohm, which charge 1 uF with a time constant of 50 ms."""
    assert data.max_window_s(threshold_v) == pytest.approx(window_s, rel=1e-12)
    assert data.MAX_BIAS_A * (window_s / 2 / data.MAX_AVERAGING_F) == pytest.approx(threshold_v / 2)
