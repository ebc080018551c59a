"""Capacitors the board chooses itself, against brute force over both series."""

from __future__ import annotations

import itertools
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fingertip.board import board_values
from fingertip.board.values.capacitors import choose_capacitor, filter_error, fitted
from fingertip.board.values.preferred import decade, within
from fingertip.design import Design
from fingertip.design.filter_components import MAX_OHM, MIN_OHM, Components
from fingertip.design.sections import Board
from fingertip.errors import DesignError

capacitor_series = st.sampled_from(["E6", "E12"])
resistor_series = st.sampled_from(["E12", "E24", "E96"])


def values(series: str, low: float, high: float) -> list[float]:
    digits = len(str(decade(series)[0])) - 1
    found = (m * 10.0 ** (e - digits) for e in range(-13, 8) for m in decade(series))
    return [v for v in found if low * (1 - 1e-9) <= v <= high * (1 + 1e-9)]


@settings(max_examples=25, deadline=None)
@given(st.floats(5.0, 500.0), capacitor_series, st.sampled_from(["E12", "E24"]))
def test_no_combination_comes_nearer(cutoff: float, capacitors: str, resistors: str) -> None:
    """Every C of the series with R1 from 2k to 20k, every R1, R2, R3 near its ideal: f0, Q and the first pole."""
    board = Board(cutoff_hz=cutoff, capacitor_series=capacitors, series=resistors)
    omega, best = math.tau * cutoff, math.inf
    for c in values(capacitors, 1 / (omega * 20e3), 1 / (omega * 2e3)):
        ideal = (1 / (omega * c), 1 / (2 * omega * c), 2 / (omega * c))
        for r1, r2, r3 in itertools.product(*(values(resistors, 0.8 * r, 1.25 * r) for r in ideal)):
            f1, f0 = 1 / (math.tau * r1 * c), 1 / (math.tau * c * math.sqrt(r2 * r3))
            misses = (math.log(f0 / cutoff), math.log(math.sqrt(r3 / r2) / 2), math.log(f1 / cutoff))
            best = min(best, math.sqrt(sum(m * m for m in misses)))
    assert filter_error(choose_capacitor(board), cutoff, resistors) == pytest.approx(best, abs=1e-12)


@settings(max_examples=100)
@given(st.floats(0.01, 2000.0), st.floats(0.01, 2000.0), capacitor_series, resistor_series)
def test_chosen_boards_are_in_range_and_their_capacitors_of_the_series(
    cutoff: float, envelope: float, capacitors: str, resistors: str
) -> None:
    board = Board(cutoff_hz=cutoff, envelope_cutoff_hz=envelope, capacitor_series=capacitors, series=resistors)
    found = fitted(board)
    for microfarad in (found.capacitor_uf, found.envelope_capacitor_uf):
        assert 1e-4 <= microfarad <= 10
        assert int(f"{microfarad:e}".replace(".", "")[:2]) in decade(capacitors)
    ohm = 1 / (math.tau * cutoff * found.capacitor_uf / 1e6)
    assert ohm / 2 >= MIN_OHM
    assert 2 * ohm <= MAX_OHM
    assert 1.9e3 < ohm < 21e3 or found.capacitor_uf in (10, 1e-4)


def test_the_defaults_are_the_articles_and_choosing_comes_nearer() -> None:
    article = Components(2400.0, 1200.0, 4700.0, 1500.0, 100e3, 2000.0, 1e-6, 2.2e-6)
    assert board_values(Design()).preferred == article
    # Nor could the article have chosen better: of E12 and E24 at 67 and 36.17 Hz its own values are the nearest.
    for series in ("E6", "E12"):
        assert board_values(Design.load(changes=[f"board.capacitor_series={series}"])).preferred == article
    changes = ["board.cutoff_hz=80", "board.series=E96", "board.envelope_cutoff_hz=30"]
    given, chosen = (
        board_values(Design.load(changes=[*changes, *more])) for more in ([], ["board.capacitor_series=E12"])
    )
    assert filter_error(chosen.preferred.c_f, 80.0, "E96") < 0.2 * filter_error(given.preferred.c_f, 80.0, "E96")
    assert chosen.preferred.c_f == choose_capacitor(Board(cutoff_hz=80, capacitor_series="E12", series="E96")) == 390e-9
    assert abs(chosen.achieved.envelope_pole_hz / 30 - 1) <= abs(given.achieved.envelope_pole_hz / 30 - 1)


def test_capacitors_as_given_are_not_read_where_the_board_chooses() -> None:
    changes = ["board.capacitor_series=E12", "board.capacitor_uf=1000", "board.envelope_capacitor_uf=1e-6"]
    assert board_values(Design.load(changes=changes)) == board_values(Design.load(changes=changes[:1]))
    with pytest.raises(DesignError, match=r"board\.capacitor_uf"):
        Design.load(changes=changes[1:])


@pytest.mark.parametrize(
    ("change", "minimum"), [("board.cutoff_hz=0.003", "0.003184 Hz"), ("board.envelope_cutoff_hz=0.001", "0.001592 Hz")]
)
def test_cutoffs_without_a_capacitor_are_refused(change: str, minimum: str) -> None:
    with pytest.raises(DesignError) as caught:
        Design.load(changes=["board.capacitor_series=E6", change])
    assert [issue.field for issue in caught.value.issues] == [change.split("=")[0]]
    assert f"at least {minimum}, or board.capacitor_series=given" in str(caught.value)
    passing = f"{change.split('=')[0]}={minimum.split()[0]}"
    assert board_values(Design.load(changes=["board.capacitor_series=E6", passing]))


def test_within_gives_one_value_at_least() -> None:
    assert within(1e-6, 1e-5, "E6") == (1e-6, 1.5e-6, 2.2e-6, 3.3e-6, 4.7e-6, 6.8e-6, 1e-5)
    assert within(1.1e-6, 1.2e-6, "E6") == (1e-6,)
