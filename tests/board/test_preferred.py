"""Preferred values against the standard's lists, and the joint choice against brute force."""

from __future__ import annotations

import itertools
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fingertip.board.values.preferred import choose_section, decade, nearest, neighbours, section_error
from fingertip.errors import BoardError

# IEC 60063, typed from the standard's tables.
E6 = "10 15 22 33 47 68"
E12 = "10 12 15 18 22 27 33 39 47 56 68 82"
E24 = "10 11 12 13 15 16 18 20 22 24 27 30 33 36 39 43 47 51 56 62 68 75 82 91"
E96 = """100 102 105 107 110 113 115 118 121 124 127 130 133 137 140 143 147 150 154 158 162 165 169 174 178 182 187
191 196 200 205 210 215 221 226 232 237 243 249 255 261 267 274 280 287 294 301 309 316 324 332 340 348 357 365 374 383
392 402 412 422 432 442 453 464 475 487 499 511 523 536 549 562 576 590 604 619 634 649 665 681 698 715 732 750 768 787
806 825 845 866 887 909 931 953 976"""

series = st.sampled_from(["E12", "E24", "E96"])
resistances = st.floats(10.0, 10e6)


@pytest.mark.parametrize(("name", "listed"), [("E6", E6), ("E12", E12), ("E24", E24), ("E96", E96)])
def test_series(name: str, listed: str) -> None:
    assert decade(name) == tuple(map(int, listed.split()))


def all_values(name: str) -> list[float]:
    scale = 10 if name == "E96" else 1
    found = {m * 10**e / scale for m in decade(name) for e in range(7)}
    return sorted(v for v in found if 10 <= v <= 10e6)


@given(resistances, series)
def test_nearest_is_nearest(value: float, name: str) -> None:
    best = min(abs(math.log(v / value)) for v in all_values(name))
    assert abs(math.log(nearest(value, name) / value)) == pytest.approx(best, abs=1e-12)
    assert nearest(value, name) in all_values(name)


@given(series, st.data())
def test_preferred_values_stay(name: str, data: st.DataObject) -> None:
    value = data.draw(st.sampled_from(all_values(name)))
    assert nearest(value, name) == value
    assert neighbours(value, name) == (value,)


@settings(max_examples=60)
@given(st.floats(1.0, 5000.0), st.floats(0.3, 5.0), st.sampled_from([1e-8, 1e-7, 4.7e-7, 1e-6]), series)
def test_joint_choice_is_optimal(f0: float, q: float, c_f: float, name: str) -> None:
    """No pair of the series within a factor of 4 of the ideal misses f0 and Q by less."""
    r2, r3 = 1 / (2 * q * math.tau * f0 * c_f), 2 * q / (math.tau * f0 * c_f)
    if not (20 < r2 < 5e6 and 20 < r3 < 5e6):
        return
    chosen = choose_section(f0, q, c_f, name)
    near = [[v for v in all_values(name) if r / 4 < v < r * 4] for r in (r2, r3)]
    best = min(section_error(a, b, c_f, f0, q) for a, b in itertools.product(*near))
    assert section_error(*chosen, c_f, f0, q) == pytest.approx(best, abs=1e-12)


@given(resistances, resistances, st.floats(0.2, 5), st.floats(0.2, 5))
def test_error_separates(r2: float, r3: float, a: float, b: float) -> None:
    """The identity on which the fast choice rests: the error in f0 and Q is that of both resistors, added squared."""
    c_f = 1e-7
    f0, q = 1 / (math.tau * c_f * math.sqrt(r2 * r3)), math.sqrt(r3 / r2) / 2
    expected = math.hypot(math.log(a), math.log(b)) / math.sqrt(2)
    assert section_error(r2 * a, r3 * b, c_f, f0, q) == pytest.approx(expected, rel=1e-9, abs=1e-12)


def test_choice_stays_within_the_range() -> None:
    assert nearest(9.0, "E24") == 10.0
    assert nearest(2e7, "E96") == 10e6
    assert nearest(10.2, "E24") == 10.0


@pytest.mark.parametrize("value", [0.0, -1.0, math.inf, math.nan])
def test_no_value_for_nonsense(value: float) -> None:
    with pytest.raises(BoardError, match="positive finite"):
        nearest(value, "E24")


def test_unknown_series() -> None:
    with pytest.raises(BoardError, match="choose E6, E12, E24, E96"):
        nearest(100.0, "E48")
