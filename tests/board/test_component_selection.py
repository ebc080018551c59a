"""Capacitors that the board selects itself, compared with brute force over both series."""

from __future__ import annotations

import itertools
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fingertip.board import board_values
from fingertip.board.components.selection import filter_error, mantissas, select_capacitors, select_filter_capacitor
from fingertip.design.formulas.filter import MAX_OHM, MIN_OHM, FilterComponents
from fingertip.design.parameters import Board
from fingertip.foundation.errors import DesignError
from tests.designs import ARTICLE, load_article

capacitor_series = st.sampled_from(["E6", "E12"])
resistor_series = st.sampled_from(["E12", "E24", "E96"])


def preferred_values(series: str, low: float, high: float) -> list[float]:
    """All values of a series from `low` to `high`."""
    digits = len(str(mantissas(series)[0])) - 1
    values = (m * 10.0 ** (e - digits) for e in range(-13, 8) for m in mantissas(series))
    return [v for v in values if low * (1 - 1e-9) <= v <= high * (1 + 1e-9)]


@settings(max_examples=25)
@given(st.floats(5.0, 500.0), capacitor_series, st.sampled_from(["E12", "E24"]))
def test_no_combination_of_components_is_better_than_the_selected_one(
    cutoff: float, capacitors: str, resistors: str
) -> None:
    """Every C up to 10 uF with R1 from 2k to 20k is combined with every R1, R2, R3 near its ideal value."""
    board = Board(cutoff_hz=cutoff, capacitor_series=capacitors, series=resistors, resistor_choice="apart")
    omega, best = math.tau * cutoff, math.inf
    for c in preferred_values(capacitors, 1 / (omega * 20e3), min(1 / (omega * 2e3), 10e-6)):
        ideal = (1 / (omega * c), 1 / (2 * omega * c), 2 / (omega * c))
        for r1, r2, r3 in itertools.product(*(preferred_values(resistors, 0.8 * r, 1.25 * r) for r in ideal)):
            f1, f0 = 1 / (math.tau * r1 * c), 1 / (math.tau * c * math.sqrt(r2 * r3))
            errors = (math.log(f0 / cutoff), math.log(math.sqrt(r3 / r2) / 2), math.log(f1 / cutoff))
            best = min(best, math.sqrt(sum(e * e for e in errors)))
    assert filter_error(select_filter_capacitor(board), board) == pytest.approx(best, abs=1e-12)




def test_selecting_capacitors_reproduces_the_article_and_reduces_the_error_of_other_designs() -> None:
    article = FilterComponents(2400.0, 1200.0, 4700.0, 1500.0, 100e3, 2000.0, 1e-6, 2.2e-6)
    assert board_values(ARTICLE).preferred == article
    # The article's own values are the best of E12 and E24 for 67 Hz and 36.17 Hz.
    for series in ("E6", "E12"):
        assert board_values(load_article([f"board.capacitor_series={series}"])).preferred == article
    changes = ["board.cutoff_hz=80", "board.series=E96", "board.envelope_cutoff_hz=30"]
    default, selected = (board_values(load_article([*changes, *more])) for more in ([], ["board.capacitor_series=E12"]))
    apart = Board(cutoff_hz=80, series="E96", resistor_choice="apart")
    assert filter_error(selected.preferred.c_f, apart) < 0.2 * filter_error(default.preferred.c_f, apart)
    board = Board(cutoff_hz=80, capacitor_series="E12", series="E96")
    assert selected.preferred.c_f == select_filter_capacitor(board) == 390e-9
    selected_error, default_error = (
        abs(values.achieved_response.envelope_pole_hz / 30 - 1) for values in (selected, default)
    )
    assert selected_error <= default_error


def test_given_capacitors_are_ignored_where_the_board_selects_its_own() -> None:
    changes = ["board.capacitor_series=E12", "board.capacitor_uf=1000", "board.envelope_capacitor_uf=1e-6"]
    assert board_values(load_article(changes)) == board_values(load_article(changes[:1]))
    with pytest.raises(DesignError, match=r"board\.capacitor_uf"):
        load_article(changes[1:])
