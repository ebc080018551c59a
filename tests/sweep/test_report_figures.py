"""The report's figures against closed forms, brute force and other people's statistics."""

from __future__ import annotations

import itertools
import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy import stats
from scipy.stats import qmc

from fingertip.cad.verification.checks import Check
from fingertip.sweep.point_evaluator import Bench
from fingertip.sweep.report.statistics import by_count, by_value, is_spread_by_ratio, ranks
from fingertip.sweep.report.cells import cells
from fingertip.sweep.report.feasibility import feasible, limits, verdicts
from fingertip.sweep.report.pareto import front, nearest_to_ideal
from fingertip.sweep.report.sensitivity import sensitivity, strongest
from fingertip.sweep.report.variance import chance, explained
from tests.sweep.plans import plan
from tests.sweep.tables import table

COLUMNS = st.lists(st.sampled_from([0.0, 0.5, 1.0, 2.0, 3.5, 10.0, 80.0]) | st.floats(-50, 50), min_size=1, max_size=60)


@settings(max_examples=60, deadline=None)
@given(COLUMNS, st.integers(2, 9), st.sampled_from([by_count, by_value]))
def test_bins_part_a_column(values: list[float], maximum: int, cut) -> None:
    column = np.array(values)
    bins = cut(column, maximum)
    assert 1 <= bins.count <= maximum or bins.each_value
    for i in range(bins.count):
        held = column[bins.code == i]
        assert len(held)
        assert (held.min(), held.max()) == (bins.low[i], bins.high[i])
    assert np.all(bins.high[:-1] < bins.low[1:])


def test_bins_by_count_are_even_and_those_by_value_are_wide() -> None:
    column = np.random.default_rng(0).permutation(np.arange(1000.0)) ** 3
    assert set(np.bincount(by_count(column, 10).code)) == {100}
    wide = by_value(column, 10)
    assert np.all(wide.high - wide.low < 1e8)
    by_ratio = by_value(np.geomspace(1, 1000, 999), 3)
    assert set(np.bincount(by_ratio.code)) == {333}


def test_a_logarithmic_scale_is_seen_from_the_values() -> None:
    assert is_spread_by_ratio(np.geomspace(20, 200, 50))
    assert not is_spread_by_ratio(np.linspace(20, 200, 50))
    assert not is_spread_by_ratio(np.geomspace(15, 17, 50))
    assert not is_spread_by_ratio(np.array([-1.0, 10.0, 100.0]))


@settings(max_examples=40, deadline=None)
@given(COLUMNS)
def test_ranks_are_scipys(values: list[float]) -> None:
    assert ranks(np.array(values)).tolist() == stats.rankdata(values).tolist()


def shares(found) -> dict[str, float]:
    return {weight.axis: weight.share for weight in found.weights}


def test_shares_of_a_sum_are_the_squares_of_its_slopes() -> None:
    u = qmc.Sobol(4, rng=0).random(2**13)
    axes = {name: u[:, i] for i, name in enumerate("abcd")}
    found = sensitivity("y", 3 * u[:, 0] - 2 * u[:, 1] + u[:, 2], axes)
    assert found is not None
    assert shares(found) == pytest.approx({"a": 9 / 14, "b": 4 / 14, "c": 1 / 14, "d": 0.0}, abs=31 / 2**13)
    assert found.together == pytest.approx(0.0, abs=0.012)
    assert [weight.axis for weight in found.weights][:3] == ["a", "b", "c"]
    signs = {weight.axis: weight.rank_correlation for weight in found.weights}
    assert signs["a"] > 0.5
    assert signs["b"] < -0.3
    assert strongest(found, list(axes), 2) == ["a", "b"]
    assert strongest(None, list(axes), 2) == ["a", "b"]


def test_shares_of_ishigamis_function_are_sobols() -> None:
    """Homma and Saltelli 1996: a third axis that acts only together with the first."""
    x = np.pi * (2 * qmc.Sobol(3, rng=1).random(2**14) - 1)
    y = np.sin(x[:, 0]) + 7 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])
    found = sensitivity("y", y, dict(zip("abc", x.T, strict=True)))
    assert found is not None
    total = 0.5 + 7**2 / 8 + 0.1 * np.pi**4 / 5 + 0.1**2 * np.pi**8 / 18
    first = {"a": 0.5 * (1 + 0.1 * np.pi**4 / 5) ** 2 / total, "b": 7**2 / 8 / total, "c": 0.0}
    assert shares(found) == pytest.approx(first, abs=0.01)
    assert found.together == pytest.approx(1 - first["a"] - first["b"], abs=0.015)


def test_rank_correlation_is_spearmans() -> None:
    rng = np.random.default_rng(5)
    x, y = rng.integers(0, 9, 200).astype(float), rng.normal(size=200)
    found = sensitivity("y", y + 0.3 * x, {"x": x})
    assert found is not None
    assert found.weights[0].rank_correlation == pytest.approx(stats.spearmanr(x, y + 0.3 * x).statistic, abs=1e-12)


def test_chance_explains_nothing_and_scatters_as_said() -> None:
    rng = np.random.default_rng(2)
    found = [explained(rng.normal(size=400), by_count(rng.random(400), 10)) for _ in range(600)]
    assert np.mean(found) == pytest.approx(0.0, abs=4 * chance(10, 400) / math.sqrt(600))
    assert np.std(found) == pytest.approx(chance(10, 400), rel=0.1)
    unused = sensitivity("y", rng.normal(size=400), {"x": rng.random(400)})
    assert unused is not None
    assert unused.weights[0].share == 0.0


def test_words_have_shares_and_no_direction() -> None:
    words = np.array(["E12", "E24", "E96"] * 40)
    y = np.where(words == "E24", 1.0, 0.0)
    found = sensitivity("y", y, {"board.series": words})
    assert found is not None
    assert found.weights[0].share == pytest.approx(1.0)
    assert math.isnan(found.weights[0].rank_correlation)


@pytest.mark.parametrize("column", [np.ones(100), np.full(100, np.nan), np.arange(19.0)])
def test_what_does_not_vary_or_is_too_little_has_no_weights(column) -> None:
    assert sensitivity("y", column, {"x": np.random.default_rng(0).random(len(column))}) is None


def beaten(costs: NDArray[np.float64], row: int) -> bool:
    return any(np.all(other <= costs[row]) and np.any(other < costs[row]) for other in costs)


@settings(max_examples=80, deadline=None)
@given(st.integers(1, 4), st.integers(1, 40), st.integers(1, 6), st.integers(0, 10**6))
def test_the_front_is_what_brute_force_finds(objectives: int, points: int, levels: int, seed: int) -> None:
    costs = np.random.default_rng(seed).integers(0, levels, (points, objectives)).astype(float)
    expected = [row for row in range(points) if not beaten(costs, row)]
    assert front(costs).tolist() == expected
    chosen = nearest_to_ideal(costs, front(costs))
    assert chosen in expected
    if objectives == 1:
        assert chosen == int(np.argmin(costs[:, 0]))  # the first of equals


def test_the_front_knows_no_rounding() -> None:
    costs = np.array([[1e16, 1.0, 0.0], [1e16, 1.0 + 2e-16, 0.0], [1e16 - 2, 2.0, 0.0]])
    assert front(costs).tolist() == [0, 2]


def test_the_best_balances_objectives_by_their_range_on_the_front() -> None:
    costs = np.array([[0.0, 1000.0], [1.0, 0.0], [0.3, 400.0], [0.9, 900.0]])
    assert front(costs).tolist() == [0, 1, 2]
    assert nearest_to_ideal(costs, front(costs)) == 2


def grid(n: int = 10):
    """Two axes from 0 to n - 1: the rule on x refuses x < 3, then the one on y refuses y > 7; one point fails, one has
    a failed check."""
    x, y = (np.array(c, dtype=float) for c in zip(*itertools.product(range(n), range(n)), strict=True))
    status = np.where((x < 3) | (y > 7), "refused", "ok")
    field = np.where(x < 3, "skin.width_mm", np.where(y > 7, "skin.length_mm", ""))
    reason = np.where(field != "", np.char.add(field, " says why"), "")
    status[55] = "failed"
    failed = np.where(status == "ok", 0.0, np.nan)
    failed[66] = 2.0
    return table({"skin.width_mm": x, "skin.length_mm": y}, {"checks_failed": failed}, status, field, reason)


def test_verdicts_and_the_ranges_in_which_rules_limit() -> None:
    swept = grid()
    found = verdicts(swept)
    assert found.names == ("feasible", "skin.width_mm", "skin.length_mm", "checks_failed", "failed")
    assert found.counts().tolist() == [54, 30, 14, 1, 1]
    assert feasible(swept).sum() == 54
    width, length, checks, failed = limits(swept, found)
    assert (width.points, width.share, width.example) == (30, 0.3, "skin.width_mm says why")
    places = {place.axis: place for place in width.places}
    assert width.places[0].axis == "skin.width_mm"
    assert places["skin.width_mm"].share == pytest.approx(1.0)
    assert places["skin.width_mm"].limiting == ((0.0, 2.0),)
    assert places["skin.length_mm"].limiting == ((0.0, 7.0),)
    places = {place.axis: place for place in length.places}
    assert places["skin.length_mm"].limiting == ((8.0, 9.0),)
    assert places["skin.width_mm"].limiting == ((3.0, 9.0),)
    assert (checks.rule, checks.points, failed.rule) == ("checks_failed", 1, "failed")


def test_verdicts_where_nothing_is_feasible() -> None:
    swept = table({"a": np.arange(3.0)}, {}, ["refused"] * 3, ["x", "y", "y"], ["1", "2", "3"])
    found = verdicts(swept)
    assert found.names == ("feasible", "y", "x")
    assert found.counts().tolist() == [0, 2, 1]
    assert [limit.example for limit in limits(swept, found)] == ["2", "1"]


def test_cells_hold_the_best_and_the_mean_over_other_axes() -> None:
    x, y, z = (np.array(c, dtype=float) for c in zip(*itertools.product(range(3), range(2), range(5)), strict=True))
    values = 100 * x + 10 * y + z
    values[7] = np.inf
    ok = x < 2
    found = cells(by_value(x, 9), by_value(y, 9), values, ok, lower_is_better=False)
    assert found.asked.tolist() == [[5, 5, 5], [5, 5, 5]]
    assert found.count.tolist() == [[5, 5, 0], [4, 5, 0]]
    assert found.best.tolist()[0][:2] == [4.0, 104.0]
    assert found.mean.tolist()[1][:2] == [pytest.approx((10 + 11 + 13 + 14) / 4), 112.0]
    assert np.isnan(found.best[:, 2]).all()
    assert np.isnan(found.mean[:, 2]).all()
    assert cells(by_value(x, 9), by_value(y, 9), values, ok, lower_is_better=True).best[1, 0] == 10.0


def test_a_failed_check_is_told_by_its_name(monkeypatch: pytest.MonkeyPatch) -> None:
    found = (
        Check("skin.stl.genus", 1, 1, "holes", "exactly"),
        Check("skin_thickness", 0.75, 0.8, "mm", "at least"),
        Check("bone.wall", 0.5, 1.0, "mm", "at least"),
    )
    monkeypatch.setattr("fingertip.cad.verification.verify.verify", lambda *_: SimpleNamespace(checks=found))
    bench = Bench(plan(outputs=["checks_failed"], axes={"skin.width_mm": [17.0]}))
    point, status, field, reason, outputs = bench.outcome(0, {"skin.width_mm": 17.0})
    assert (point, status, field, outputs) == (0, "ok", "skin_thickness", (2.0,))
    assert reason == "is 0.75 mm, but at least 0.8 mm is sound (and 1 more: bone.wall)."
    swept = table({"skin.width_mm": [17.0]}, {"checks_failed": outputs}, [status], [field], [reason])
    (limit,) = limits(swept, verdicts(swept))
    assert (limit.rule, limit.example) == ("check skin_thickness", reason)
