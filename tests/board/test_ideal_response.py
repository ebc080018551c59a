"""Formulas of the ideal filter, compared with the article's figures, closed forms and the inverse formulas."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fingertip.board.values.ideal_response import decibel, ideal_response, overall_cutoff_hz
from fingertip.design.filter_components import FilterComponents, ideal_components
from fingertip.design.parameters import Board
from tests.oracles.ideal_filter import (
    envelope_impedance,
    ideal_filter_transfer,
    phase_degrees,
    second_stage_transfer,
)

ARTICLE = FilterComponents(2400.0, 1200.0, 4700.0, 1500.0, 100e3, 2000.0, 1e-6, 2.2e-6)
IDEAL = ideal_components(Board())

cutoffs = st.floats(1e-2, 1e4)
capacitors = st.floats(1e-6, 1e3)
gains = st.floats(1.01, 1e4)


def test_default_values_and_response_are_the_articles() -> None:
    assert [round(r, 1) for r in (IDEAL.r1_ohm, IDEAL.r2_ohm, IDEAL.r3_ohm)] == [2375.4, 1187.7, 4750.9]
    assert IDEAL.r4_ohm == pytest.approx(1500, rel=1e-12)
    assert IDEAL.r_lp_ohm == pytest.approx(2000, rel=1e-4)
    response = ideal_response(ARTICLE, 3e6)
    assert round(response.section_hz, 2) == 67.02
    assert round(response.section_quality, 4) == 0.9895
    assert round(response.first_pole_hz, 2) == 66.31
    assert round(response.cutoff_hz, 2) == 67.26
    assert round(response.passband_gain, 2) == 67.67
    assert round(response.passband_gain_db, 2) == 36.61
    assert round(response.envelope_pole_hz, 2) == 36.17
    assert round(1e3 * response.envelope_decay_s, 2) == 4.40


def test_article_errata_are_errors() -> None:
    assert round(100e3 / 1.5e3, 1) == 66.7  # R5 / R4, printed as G
    assert 1 / math.sqrt(1200 * 4700 * 1e-6) == pytest.approx(0.42, abs=0.01)  # eq. (10) as printed, not 421 rad/s
    assert envelope_impedance(0.0, ARTICLE) == pytest.approx(2000)  # an impedance [ohm], not a gain of 1
    peak = max(abs(second_stage_transfer(f / 10, IDEAL)) for f in range(500, 2000))
    assert round(decibel(peak), 2) == 1.25


@given(cutoffs, capacitors, gains)
def test_ideal_filter_has_half_its_power_at_the_cutoff(cutoff_hz: float, capacitor_uf: float, gain: float) -> None:
    c = ideal_components(Board(cutoff_hz=cutoff_hz, capacitor_uf=capacitor_uf, passband_gain=gain))
    relative_db = decibel(ideal_filter_transfer(cutoff_hz, c) / gain)
    assert relative_db == pytest.approx(-10 * math.log10(2), abs=1e-9)  # -3.0103 dB


@pytest.mark.parametrize("ratio", [0.01, 0.1, 0.5, 0.9, 1.0, 1.1, 2.0, 10.0, 100.0])
def test_ideal_filter_is_a_butterworth_filter(ratio: float) -> None:
    """|H|^2 = G^2 x^6 / (1 + x^6) with x = f / f_c, which is maximally flat at infinity."""
    magnitude = abs(ideal_filter_transfer(67.0 * ratio, IDEAL))
    expected = (1 + 100 / 1.5) * math.sqrt(ratio**6 / (1 + ratio**6))
    assert magnitude == pytest.approx(expected, rel=1e-12)


@given(cutoffs, capacitors, gains, cutoffs, capacitors)
def test_response_of_ideal_components_is_the_design(
    f_c: float, c_uf: float, gain: float, f_lp: float, c_lp_uf: float
) -> None:
    board = Board(
        cutoff_hz=f_c, capacitor_uf=c_uf, passband_gain=gain, envelope_cutoff_hz=f_lp, envelope_capacitor_uf=c_lp_uf
    )
    response = ideal_response(ideal_components(board), board.gain_bandwidth_hz)
    for frequency_hz in (response.first_pole_hz, response.section_hz, response.cutoff_hz):
        assert frequency_hz == pytest.approx(f_c, rel=1e-9)
    assert response.section_quality == pytest.approx(1.0, rel=1e-12)
    assert response.passband_gain == pytest.approx(gain, rel=1e-9)
    assert response.envelope_pole_hz == pytest.approx(f_lp, rel=1e-12)


@settings(max_examples=200)
@given(st.floats(0.02, 50), st.floats(0.2, 40))
def test_overall_cutoff_is_the_highest_half_power_frequency(first_pole: float, quality: float) -> None:
    def power(f: float) -> float:
        s = 1j * f
        return abs(s / (s + first_pole) * s * s / (s * s + s / quality + 1)) ** 2

    cutoff = overall_cutoff_hz(first_pole, 1.0, quality)
    assert power(cutoff) == pytest.approx(0.5, rel=1e-9)
    assert all(power(cutoff * 1.01**i) > 0.5 for i in range(1, 1200))


def test_ideal_filter_blocks_direct_current_and_passes_high_frequencies() -> None:
    assert ideal_filter_transfer(0.0, ARTICLE) == 0
    assert decibel(0.0) == -math.inf
    assert abs(ideal_filter_transfer(1e9, ARTICLE)) == pytest.approx(1 + 100 / 1.5, rel=1e-9)
    assert phase_degrees(ideal_filter_transfer(1e-3, ARTICLE)) == pytest.approx(-90, abs=0.01)  # s^3
