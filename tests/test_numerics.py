"""The searches of `fingertip.numerics`, compared with those of scipy."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq, minimize_scalar

from fingertip.arrays import Array
from fingertip.numerics import bisect, bisect_arrays, find_maximum, find_maximum_arrays, find_root

ROOTS: list[tuple[Callable[[float], float], float, float]] = [
    (lambda x: x * x - 2.0, 0.0, 2.0),
    (lambda x: math.cos(x) - x, 0.0, 1.0),
    (lambda x: math.exp(-x) - 1e-3, 0.0, 50.0),
    (lambda x: x**9 - 0.1, -1.0, 1.5),
    (lambda x: math.atan(x - 3.0), -20.0, 40.0),
]
MAXIMA: list[tuple[Callable[[float], float], float, float]] = [
    (lambda x: -((x - 0.3) ** 2), -1.0, 2.0),
    (lambda x: math.sin(x), 0.0, math.pi),
    (lambda x: x * math.exp(-x), 0.0, 10.0),
    (lambda x: -abs(x - 1.25), 0.0, 3.0),
]


@pytest.mark.parametrize(("function", "low", "high"), ROOTS)
def test_bisect_finds_the_root_that_brentq_finds(function: Callable[[float], float], low: float, high: float) -> None:
    root = brentq(function, low, high, xtol=1e-15, rtol=8.9e-16)
    sign = -1.0 if function(low) < 0.0 else 1.0
    ends = bisect(lambda x: sign * function(x) > 0.0, low, high)
    assert ends == pytest.approx((root, root), rel=1e-13, abs=1e-15)
    assert math.nextafter(ends[0], math.inf) == ends[1]  # no number lies between the two ends


def test_bisect_ends_at_the_tolerance_or_after_the_given_number_of_halvings() -> None:
    evaluated: list[float] = []

    def is_below(x: float) -> bool:
        evaluated.append(x)
        return x < 0.3

    assert bisect(is_below, 0.0, 1.0, halvings=3) == (0.25, 0.375)
    assert evaluated == [0.5, 0.25, 0.375]
    low, high = bisect(is_below, 0.0, 1.0, tolerance=0.01)
    assert low < 0.3 <= high
    assert 0.005 < high - low <= 0.01
    assert bisect(is_below, 0.0, 1.0, halvings=0) == (0.0, 1.0)


@given(st.floats(-1e6, 1e6), st.floats(1e-6, 1e6), st.floats(1e-6, 1e6))
def test_bisect_returns_the_neighbouring_floats_around_any_boundary(boundary: float, left: float, right: float) -> None:
    low, high = bisect(lambda x: x < boundary, boundary - left, boundary + right)
    assert low < boundary <= high
    assert math.nextafter(low, math.inf) == high


@pytest.mark.parametrize(("function", "low", "high"), ROOTS)
@pytest.mark.parametrize("known", [False, True])
def test_find_root_finds_the_root_that_brentq_finds(
    function: Callable[[float], float], low: float, high: float, known: bool
) -> None:
    root = brentq(function, low, high, xtol=1e-15, rtol=8.9e-16)
    for ends in ((low, high), (high, low)):
        values = (function(ends[0]), function(ends[1])) if known else None
        assert find_root(function, ends, 1e-13, values) == pytest.approx(root, rel=1e-12)


def test_find_root_returns_an_end_that_is_the_root_within_a_step() -> None:
    assert find_root(lambda x: x, (-1.0, 1.0), 1e-13) == 0.0
    assert find_root(lambda x: x - 1.0, (0.0, 1.0), 1e-13) == 1.0


@pytest.mark.parametrize(("function", "low", "high"), MAXIMA)
def test_find_maximum_finds_the_maximum_that_scipy_finds(
    function: Callable[[float], float], low: float, high: float
) -> None:
    oracle = minimize_scalar(lambda x: -function(x), bounds=(low, high), method="bounded", options={"xatol": 1e-9})
    location, value = find_maximum(function, low, high, 1e-7)
    assert location == pytest.approx(oracle.x, abs=2e-7)
    assert value == pytest.approx(-oracle.fun, abs=2e-7)
    assert value == function(location)


@pytest.mark.parametrize(("function", "low", "high"), MAXIMA[:3])
def test_find_maximum_of_a_smooth_function_needs_few_evaluations(
    function: Callable[[float], float], low: float, high: float
) -> None:
    evaluated: list[float] = []

    def counted(x: float) -> float:
        evaluated.append(x)
        return function(x)

    find_maximum(counted, low, high, 1e-6)
    assert len(evaluated) < 20  # golden-section search alone needs 30
    assert all(low < x < high for x in evaluated)


def test_find_maximum_ends_for_a_constant_function() -> None:
    location, value = find_maximum(lambda x: 3.0, 0.0, 1.0, 1e-6)
    assert 0.0 <= location <= 1.0
    assert value == 3.0


def test_find_maximum_finds_a_maximum_at_an_end() -> None:
    assert find_maximum(lambda x: x, 0.0, 1.0, 1e-9)[0] == pytest.approx(1.0, abs=1e-9)
    assert find_maximum(lambda x: -x, 0.0, 1.0, 1e-9)[0] == pytest.approx(0.0, abs=1e-9)


def test_bisect_arrays_finds_a_root_in_every_element() -> None:
    targets = np.linspace(0.1, 8.0, 40)
    low, high = bisect_arrays(lambda x: x**3 < targets, np.zeros(40), np.full(40, 3.0), 50)
    roots = [brentq(lambda x, t=t: x**3 - t, 0.0, 3.0, xtol=1e-15) for t in targets]
    assert low == pytest.approx(roots, rel=1e-13)
    assert np.all(high - low == pytest.approx(3.0 / 2**50, rel=0.1))


def test_bisect_arrays_takes_the_steps_of_bisect() -> None:
    boundaries = np.array([0.2, 0.5, 1.7])
    low, high = bisect_arrays(lambda x: x < boundaries, np.zeros(3), np.full(3, 2.0), 30)
    for i, boundary in enumerate(boundaries):
        assert bisect(lambda x, b=float(boundary): x < b, 0.0, 2.0, halvings=30) == (low[i], high[i])  # type: ignore[misc]


def test_find_maximum_arrays_finds_a_maximum_in_every_element() -> None:
    peaks = np.linspace(0.1, 2.9, 30)

    def function(x: Array) -> Array:
        result: Array = np.cos(x - peaks)
        return result

    location, value = find_maximum_arrays(function, np.zeros(30), np.full(30, 3.0), 40)
    for i, peak in enumerate(peaks):
        oracle = minimize_scalar(
            lambda x, p=float(peak): -math.cos(x - p), bounds=(0.0, 3.0), method="bounded", options={"xatol": 1e-9}
        )
        assert location[i] == pytest.approx(oracle.x, abs=1e-7)
        assert value[i] == pytest.approx(-oracle.fun, abs=1e-12)
