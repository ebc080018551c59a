"""The searches of `fingertip.foundation.numerics`, compared with those of scipy."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from fingertip.foundation.numerics import bisect, bisect_arrays, find_maximum_arrays, t_quantile

MAXIMA: list[tuple[Callable[[float], float], float, float]] = [
    (lambda x: -((x - 0.3) ** 2), -1.0, 2.0),
    (lambda x: math.sin(x), 0.0, math.pi),
    (lambda x: x * math.exp(-x), 0.0, 10.0),
    (lambda x: -abs(x - 1.25), 0.0, 3.0),
]


def test_bisect_takes_the_given_number_of_halvings_in_arrays_too() -> None:
    is_below = Counted(lambda x: x < 0.3)
    assert bisect(is_below, 0.0, 1.0, halvings=3) == (0.25, 0.375)
    assert is_below.points == [0.5, 0.25, 0.375]
    assert bisect(is_below, 0.0, 1.0, halvings=0) == (0.0, 1.0)
    boundaries = np.array([0.2, 0.5, 1.7])
    low, high = bisect_arrays(lambda x: x < boundaries, np.zeros(3), np.full(3, 2.0), 30)
    for i, boundary in enumerate(boundaries):
        assert bisect(lambda x, b=float(boundary): x < b, 0.0, 2.0, halvings=30) == (
            low[i],
            high[i],
        )


class Counted:
    """Function that remembers where it was evaluated, and fails where a search does not end."""

    def __init__(self, function: Callable[[float], float], most: int = 300) -> None:
        self.function = function
        self.most = most
        self.points = list[float]()

    def __call__(self, x: float) -> float:
        self.points.append(float(x))
        assert len(self.points) <= self.most, "the search does not end"
        return self.function(float(x))


@pytest.mark.parametrize("boundary", [0.0, 0.3, 0.5, 1.0])
def test_bisect_evaluates_every_middle_once(boundary: float) -> None:
    for halvings in (2, 3, None):
        is_below = Counted(lambda x: x < boundary, 1100)
        low, high = bisect(is_below, 0.0, 1.0, halvings=halvings)  # type: ignore[arg-type]
        assert halvings is None or len(is_below.points) == halvings
        assert low <= boundary <= high
        assert high - low == 0.5**halvings if halvings else math.nextafter(low, 2.0) == high


@pytest.mark.parametrize(("function", "low", "high"), MAXIMA)
def test_the_maximum_is_that_which_scipy_finds(
    function: Callable[[float], float], low: float, high: float
) -> None:
    from scipy.optimize import fminbound

    location, value = find_maximum_arrays(np.vectorize(function), np.array(low), np.array(high), 40)
    assert location == pytest.approx(
        fminbound(lambda x: -function(x), low, high, xtol=1e-9), abs=1e-7
    )
    assert value == function(float(location))


def test_equal_values_on_both_sides_give_the_left_one() -> None:
    location, value = find_maximum_arrays(lambda x: 0.0 * x, np.zeros(1), np.ones(1), 0)
    golden = (math.sqrt(5) - 1) / 2
    assert (location[0], value[0]) == (pytest.approx(1 - golden), 0.0)
    location, _ = find_maximum_arrays(lambda x: 0.0 * x, np.zeros(1), np.ones(1), 5)
    assert location[0] == pytest.approx((1 - golden) * golden**5)


@pytest.mark.parametrize(
    ("two_sided", "degrees", "quantile"),
    [(0.5, 1, 1.0), (0.95, 2, 4.302653), (0.95, 5, 2.570582), (0.99, 30, 2.749996)],
)
def test_quantiles_of_students_t_are_those_of_the_tables(
    two_sided: float, degrees: int, quantile: float
) -> None:
    assert t_quantile(two_sided, degrees) == pytest.approx(quantile, rel=1e-6)
