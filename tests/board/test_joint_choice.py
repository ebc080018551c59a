"""R1, R2 and R3 chosen together: optimal by brute force, and nearer to a Butterworth response than chosen apart."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fingertip.board.components.selection import (
    DEVIATION_BAND,
    choose_jointly,
    compute_deviation_db,
    select_filter_capacitor,
    select_resistors,
    values_in_range,
)
from fingertip.design.formulas.filter import FilterComponents, ideal_components
from fingertip.design.parameters import Board


def ideal_ohm(cutoff_hz: float, capacitor_uf: float = 1.0) -> tuple[tuple[float, float, float], FilterComponents]:
    ideal = ideal_components(Board(cutoff_hz=cutoff_hz, capacitor_uf=capacitor_uf))
    return first_three(ideal), ideal


def first_three(values: FilterComponents) -> tuple[float, float, float]:
    return values.r1_ohm, values.r2_ohm, values.r3_ohm


def deviation_db(ohm: tuple[float, ...], ideal: tuple[float, float, float]) -> float:
    """Oracle: complex transfer functions of both stages over w = f / f_c, C omega_c = 1 / R1."""
    r1, r2, r3 = (value / ideal[0] for value in ohm)
    s = 1j * np.geomspace(*DEVIATION_BAND, 37)
    filter_ = s * r1 / (1 + s * r1) * s**2 * r2 * r3 / (1 + 2 * s * r2 + s**2 * r2 * r3)
    butterworth = s**3 / (1 + 2 * s + 2 * s**2 + s**3)
    return float(np.abs(20 * np.log10(np.abs(filter_ / butterworth))).max())


@pytest.mark.parametrize(("series", "ratio"), [("E12", 2.2), ("E24", 1.8), ("E96", 1.1)])
@pytest.mark.parametrize("cutoff", [30.0, 41.7, 67.0, 88.8, 123.0])
def test_no_combination_of_a_wide_search_is_better(series: str, ratio: float, cutoff: float) -> None:
    ideal, _ = ideal_ohm(cutoff)
    candidates = (values_in_range(ohm / ratio, ohm * ratio, series) for ohm in ideal)
    best = min(deviation_db(ohm, ideal) for ohm in itertools.product(*candidates))
    chosen, found = choose_jointly(ideal, series)
    assert found == pytest.approx(best, abs=1e-6)
    assert deviation_db(chosen, ideal) == pytest.approx(found, abs=1e-6)
    assert compute_deviation_db(chosen, ideal) == pytest.approx(found, abs=1e-6)


@settings(max_examples=100)
@given(st.floats(1.0, 1000.0), st.sampled_from(["E12", "E24", "E96"]))
def test_resistors_chosen_together_are_never_worse_than_apart(cutoff: float, series: str) -> None:
    ohm, ideal = ideal_ohm(cutoff)
    together, apart = (first_three(select_resistors(ideal, series, jointly=jointly)) for jointly in (True, False))
    assert deviation_db(together, ohm) <= deviation_db(apart, ohm) + 1e-6


# Largest deviation, and the one that 90 % of the cutoffs stay below [dB]: apart and together.
DEVIATIONS = {"E12": (1.6, 0.80, 0.65), "E24": (0.9, 0.42, 0.34), "E96": (0.24, 0.105, 0.085)}


@pytest.mark.parametrize("series", DEVIATIONS)
def test_deviations_fall_by_half(series: str) -> None:
    apart_db, together_db, most_db = DEVIATIONS[series]
    cutoffs = np.geomspace(10.0, 100.0, 120).tolist()
    pairs = [ideal_ohm(cutoff) for cutoff in cutoffs]
    apart = [compute_deviation_db(first_three(select_resistors(i, series, jointly=False)), ohm) for ohm, i in pairs]
    together = [choose_jointly(ohm, series)[1] for ohm, _ in pairs]
    assert max(apart) > apart_db
    assert max(together) < together_db
    assert np.quantile(together, 0.9) < most_db < np.quantile(apart, 0.9)


@pytest.mark.parametrize("cutoff", [33.0, 80.0, 140.0])
def test_no_capacitor_and_resistors_together_are_better(cutoff: float) -> None:
    board = Board(cutoff_hz=cutoff, capacitor_series="E6", series="E24")
    omega, best = math.tau * cutoff, math.inf
    for c_f in values_in_range(1 / (omega * 20e3), 1 / (omega * 2e3), "E6"):
        ohm, _ = ideal_ohm(cutoff, 1e6 * c_f)
        best = min(best, choose_jointly(ohm, "E24")[1])
    ohm, _ = ideal_ohm(cutoff, 1e6 * select_filter_capacitor(board))
    assert choose_jointly(ohm, "E24")[1] == pytest.approx(best, abs=1e-6)
