"""Preferred values, compared with the standard's tables, and the selection of R2 and R3, compared with brute force."""

from __future__ import annotations

import itertools
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fingertip.board.components.selection import (
    mantissas,
    nearest_value,
    neighbouring_values,
    select_resistors,
    values_in_range,
)
from fingertip.design.formulas.filter import ideal_components
from fingertip.design.parameters import Board
from fingertip.foundation.errors import BoardError

# IEC 60063, transcribed from the standard's tables.
E6 = "10 15 22 33 47 68"
E12 = "10 12 15 18 22 27 33 39 47 56 68 82"
E24 = "10 11 12 13 15 16 18 20 22 24 27 30 33 36 39 43 47 51 56 62 68 75 82 91"
E96 = """100 102 105 107 110 113 115 118 121 124 127 130 133 137 140 143 147 150 154 158 162 165 169 174 178 182 187
191 196 200 205 210 215 221 226 232 237 243 249 255 261 267 274 280 287 294 301 309 316 324 332 340 348 357 365 374 383
392 402 412 422 432 442 453 464 475 487 499 511 523 536 549 562 576 590 604 619 634 649 665 681 698 715 732 750 768 787
806 825 845 866 887 909 931 953 976"""

series = st.sampled_from(["E12", "E24", "E96"])
resistances = st.floats(10.0, 10e6)


@pytest.mark.parametrize(("name", "table"), [("E6", E6), ("E12", E12), ("E24", E24), ("E96", E96)])
def test_mantissas_are_those_of_the_standard(name: str, table: str) -> None:
    assert mantissas(name) == tuple(map(int, table.split()))


def all_values(name: str) -> list[float]:
    """All preferred resistances of a series from 10 ohm to 10 Mohm."""
    scale = 10 if name == "E96" else 1
    values = {m * 10**e / scale for m in mantissas(name) for e in range(7)}
    return sorted(v for v in values if 10 <= v <= 10e6)


@given(resistances, series)
def test_nearest_value_is_the_nearest_of_all(value: float, name: str) -> None:
    best = min(abs(math.log(v / value)) for v in all_values(name))
    assert abs(math.log(nearest_value(value, name) / value)) == pytest.approx(best, abs=1e-12)
    assert nearest_value(value, name) in all_values(name)


@given(series, st.data())
def test_nearest_value_of_a_preferred_value_is_itself(name: str, data: st.DataObject) -> None:
    value = data.draw(st.sampled_from(all_values(name)))
    assert nearest_value(value, name) == value
    assert neighbouring_values(value, name) == (value,)


@settings(max_examples=60)
@given(st.floats(1.0, 5000.0), st.sampled_from([1e-8, 1e-7, 4.7e-7, 1e-6]), series)
def test_no_pair_of_section_resistors_is_better_than_those_selected_apart(f0: float, c_f: float, name: str) -> None:
    """All pairs of the series within a factor of 4 of the ideal values are compared by the errors of f0 and Q."""
    ideal = ideal_components(Board(cutoff_hz=f0, capacitor_uf=1e6 * c_f))
    if not (ideal.r2_ohm > 20 and ideal.r3_ohm < 2.5e6):
        return

    def error(r2: float, r3: float) -> float:
        f, q = 1 / (math.tau * c_f * math.sqrt(r2 * r3)), math.sqrt(r3 / r2) / 2
        return math.hypot(math.log(f / f0), math.log(q))

    selected = select_resistors(ideal, name, jointly=False)
    candidates = [[v for v in all_values(name) if r / 4 < v < r * 4] for r in (ideal.r2_ohm, ideal.r3_ohm)]
    best = min(error(*pair) for pair in itertools.product(*candidates))
    assert error(selected.r2_ohm, selected.r3_ohm) == pytest.approx(best, abs=1e-12)


def test_nearest_value_stays_within_the_range() -> None:
    assert nearest_value(9.0, "E24") == 10.0
    assert nearest_value(2e7, "E96") == 10e6
    assert nearest_value(10.2, "E24") == 10.0


def test_values_in_range_contains_at_least_one_value() -> None:
    assert values_in_range(1e-6, 1e-5, "E6") == (1e-6, 1.5e-6, 2.2e-6, 3.3e-6, 4.7e-6, 6.8e-6, 1e-5)
    assert values_in_range(1.1e-6, 1.2e-6, "E6") == (1e-6,)


def test_nearest_value_refuses_what_has_none() -> None:
    for value in (0.0, -1.0, math.inf, math.nan):
        with pytest.raises(BoardError, match="positive finite"):
            nearest_value(value, "E24")
    with pytest.raises(BoardError, match="choose E6, E12, E24, E96"):
        nearest_value(100.0, "E48")
