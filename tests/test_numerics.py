"""The searches of `fingertip.foundation.numerics`, compared with those of scipy."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from fingertip.foundation import numerics
from fingertip.foundation.numerics import (
    bisect,
    bisect_arrays,
    find_maximum,
    find_maximum_arrays,
    find_root,
    maximise_linear,
)

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


@pytest.mark.every_case
@pytest.mark.parametrize(("function", "low", "high"), ROOTS)
@pytest.mark.parametrize("known", [False, True])
def test_find_root_finds_the_root_that_brentq_finds(
    function: Callable[[float], float], low: float, high: float, known: bool
) -> None:
    from scipy.optimize import brentq

    root = brentq(function, low, high, xtol=1e-15, rtol=8.9e-16)
    for ends in ((low, high), (high, low)):
        values = (function(ends[0]), function(ends[1])) if known else None
        assert find_root(function, ends, 1e-13, values) == pytest.approx(root, rel=1e-12)


def test_bisect_takes_the_given_number_of_halvings_in_arrays_too() -> None:
    is_below = Counted(lambda x: x < 0.3)
    assert bisect(is_below, 0.0, 1.0, halvings=3) == (0.25, 0.375)
    assert is_below.points == [0.5, 0.25, 0.375]
    assert bisect(is_below, 0.0, 1.0, halvings=0) == (0.0, 1.0)
    boundaries = np.array([0.2, 0.5, 1.7])
    low, high = bisect_arrays(lambda x: x < boundaries, np.zeros(3), np.full(3, 2.0), 30)
    for i, boundary in enumerate(boundaries):
        assert bisect(lambda x, b=float(boundary): x < b, 0.0, 2.0, halvings=30) == (low[i], high[i])


class Counted:
    """Function that remembers where it was evaluated, and fails where a search does not end."""

    def __init__(self, function: Callable[[float], float], most: int = 300) -> None:
        self.function, self.most, self.points = function, most, list[float]()

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


def test_find_root_takes_the_steps_of_the_illinois_method() -> None:
    """For x^2 - 2 between 0 and 2 they are fractions: after two chords that leave 2, its value is halved."""
    function = Counted(lambda x: x * x - 2.0)
    root = find_root(function, (0.0, 2.0), 1e-13)
    assert root == pytest.approx(math.sqrt(2.0), rel=1e-15)
    assert function.points[:5] == pytest.approx([0.0, 2.0, 1.0, 4 / 3, 16 / 11], rel=1e-14)
    assert len(function.points) < 14
    known = Counted(function.function)
    assert find_root(known, (0.0, 2.0), 1e-13, (-2.0, 2.0)) == root
    assert known.points == function.points[2:]
    line = Counted(lambda x: 3.0 * x - 1.5)
    assert find_root(line, (0.0, 4.0), 1e-13) == 0.5
    assert line.points == [0.0, 4.0, 0.5]
    assert find_root(lambda _: 1.0, (0.0, 4.0), 1e-13) == 4.0, "no chord crosses"
    assert find_root(lambda x: x, (-1.0, 1.0), 1e-13) == 0.0
    assert find_root(lambda x: x - 1.0, (0.0, 1.0), 1e-13) == 1.0


@pytest.mark.parametrize(("tolerance", "count"), [(2.0, 2), (1.0, 3), (0.5, 3), (0.2, 5), (0.02, 6), (1e-6, 8)])
def test_find_root_stops_where_its_chord_is_shorter_than_the_tolerance(tolerance: float, count: int) -> None:
    """Points 0, 1, 0.58, 0.68, 0.704, 0.6931, 0.69315 and ln 2: 0.68 and 0.704 are on either side."""
    function = Counted(lambda x: math.exp(x) - 2.0)
    root = find_root(function, (0.0, 1.0), tolerance)
    assert len(function.points) == count
    assert root == function.points[-1]
    assert abs(root - math.log(2.0)) < tolerance
    assert function.points[2:3] == pytest.approx([1 / (math.e - 1)][: count - 2])


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4])
def test_find_maximum_takes_the_steps_of_brents_method(tolerance: float) -> None:
    """SciPy's steps differ by its least one, which grows by 1.5e-8 of the location."""
    from scipy.optimize import fminbound

    searches: list[tuple[Callable[[float], float], float, float]] = [
        *MAXIMA,
        (lambda x: x, 0.0, 1.0),
        (lambda x: -x, 0.0, 1.0),
        (lambda x: 3.0, 0.0, 1.0),
        (lambda x: -((x - 0.9) ** 4), 0.0, 1.0),
        (lambda x: -math.cosh(3.0 * x - 1.0), -5.0, 1.0),
        (lambda x: -math.exp(6.0 * x) - math.exp(-x), -2.0, 2.0),
        (lambda x: -math.sqrt(abs(x - 0.7)), 0.0, 2.0),
        (lambda x: -abs(x - 0.2) - 3.0 * max(0.0, x - 0.2), -1.0, 1.0),
        (lambda x: math.floor(5.0 * math.sin(x)), 0.0, 3.0),
        # Parabolas whose vertex lies beyond the one or the other end, and steps on which values are equal.
        (lambda x: -(abs(x + 0.3) ** 3.2) - (x + 0.3) * (7.1 if x > -0.3 else -1.4), -2.4, 3.0),
        (lambda x: -(abs(x + 0.1) ** 1.3) * (1.0 if x > -0.1 else 8.5), -1.6, 1.8),
        (lambda x: math.floor(-5.0 * (math.exp(7.3 * x) + math.exp(-6.5 * x))), -0.8, 1.6),
        (lambda x: math.floor(-2.0 * (math.exp(x) + math.exp(-8.3 * x))), -1.0, 2.0),
    ]
    for number, (function, low, high) in enumerate(searches):
        ours, scipys = Counted(function), Counted(lambda x, f=function: -f(x))  # type: ignore[misc]
        location, value = find_maximum(ours, low, high, tolerance)
        expected = fminbound(scipys, low, high, xtol=tolerance)
        assert ours.points == pytest.approx(scipys.points, abs=3e-6), number
        assert location == pytest.approx(expected, abs=3e-6), number
        assert value == function(location), number


def test_equal_values_on_both_sides_give_the_left_one() -> None:
    location, value = find_maximum_arrays(lambda x: 0.0 * x, np.zeros(1), np.ones(1), 0)
    golden = (math.sqrt(5) - 1) / 2
    assert (location[0], value[0]) == (pytest.approx(1 - golden), 0.0)
    location, _ = find_maximum_arrays(lambda x: 0.0 * x, np.zeros(1), np.ones(1), 5)
    assert location[0] == pytest.approx((1 - golden) * golden**5)


def test_corners_at_which_many_planes_meet() -> None:
    """Ten planes touch the corner of a cube, and cut nothing off."""
    rows = [[1.0, 1.0 + i / 10, 1.0] for i in range(10)]
    bounds = [3.0 + i / 10 for i in range(10)]
    for objective in ([1.0, 1.0, 1.0], [3.0, 1.0, 2.0], [1.0, 0.0, 0.0]):
        ((value, _),) = maximise_linear([objective], rows, bounds, 1.0)
        assert value == pytest.approx(sum(objective))
    sides = [[1.0, 0.0, 1.0], [-1.0, 0.0, 1.0], [0.0, 1.0, 1.0], [0.0, -1.0, 1.0]]  # of a pyramid
    ((value, point),) = maximise_linear([[0.2, -0.1, 1.0]], sides, [1.0] * 4, 50.0)
    assert (value, *point) == pytest.approx((1.0, 0.0, 0.0, 1.0), abs=1e-12)
    assert maximise_linear([[0.0, 0.0]], [[1.0, 1.0]], [1.0], 5.0) == [(0.0, [0.0, 0.0])]


@pytest.mark.parametrize("size", [1, 2, 3, 4, 6])
def test_linear_programs_have_the_maxima_of_a_library(size: int) -> None:
    from scipy.optimize import linprog

    rng = np.random.default_rng(size)
    for count in (3, 9, 24):
        rows, bounds = rng.normal(size=(count, size)), rng.uniform(0.01, 2.0, count)
        objectives = [*rng.normal(size=(4, size)), *rows[:2], np.eye(size)[0]]
        found = maximise_linear([c.tolist() for c in objectives], rows.tolist(), bounds.tolist(), 5.0)
        for c, (value, point) in zip(objectives, found, strict=True):
            oracle = linprog(-c, A_ub=rows, b_ub=bounds, bounds=[(-5.0, 5.0)] * size)
            assert value == pytest.approx(-oracle.fun, rel=1e-9, abs=1e-12)
            assert value == pytest.approx(float(c @ point), rel=1e-12)
            assert np.all(rows @ point <= bounds + 1e-9)
            assert np.max(np.abs(point)) <= 5.0 + 1e-9
            ((alone, _),) = maximise_linear([c.tolist()], rows.tolist(), bounds.tolist(), 5.0)
            assert alone == pytest.approx(value, rel=1e-9, abs=1e-12)


@pytest.mark.every_case
@pytest.mark.parametrize(
    ("rates", "slacks", "active", "hit"),
    [
        ([1.0, 1.0, 1.0], [3.0, 2.0, 2.5], [], (1, 2.0)),
        ([1.0, 4.0], [3.0, 8.0], [], (1, 2.0)),
        ([1.0, 1.0, 1.0], [3.0, 2.0, 2.5], [1], (2, 2.5)),
        ([-1.0, 0.0, 1e-13, 1.0], [0.1, 0.1, 0.1, 9.0], [None], (3, 9.0)),
        ([1.0, 1.0], [2.0, -1e-9], [], (1, 0.0)),  # a plane that rounding errors have passed is at a distance of 0
        # Of equally near planes, in either order, the one that is met most steeply.
        ([1.0, 2.0, 1.5], [1.0, 2.0, 1.5], [], (1, 1.0)),
        ([2.0, 1.0], [2.0, 1.0], [], (0, 1.0)),
        ([1.0, 2.0], [1.0, 2.0 + 1e-13], [], (1, 1.0)),
        ([1.0, 2.0], [1.0 + 5e-14, 2.0], [], (1, 1.0)),
        ([2.0, 1.0], [2.0 + 1e-13, 1.0], [], (0, 1.0)),
        ([1.0, 2.0], [1.0, 2.0 + 1e-12], [], (0, 1.0)),
        ([2.0, 1.0], [2.0 + 1e-12, 1.0], [], (1, 1.0)),
    ],
)
def test_a_ray_meets_the_nearest_plane_that_it_approaches(
    rates: list[float], slacks: list[float], active: list[int | None], hit: tuple[int, float]
) -> None:
    plane, distance = numerics._find_first_hit(rates, slacks, active)
    assert plane == hit[0]
    assert distance == pytest.approx(hit[1], abs=2e-13)
