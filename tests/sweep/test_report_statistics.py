"""Statistics of the report against closed forms, brute force and scipy; histograms
without combs.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from fingertip.cad.verification.check import Check
from fingertip.foundation.display import new_figure
from fingertip.sweep.database import SweepTable
from fingertip.sweep.point_evaluator import PointEvaluator
from fingertip.sweep.report.best_design_file import find_nearest_to_ideal, find_pareto_front
from fingertip.sweep.report.feasibility_plot import histogram_edges, make_scale
from fingertip.sweep.report.plots import _CHARACTER_IN, _write_heading
from fingertip.sweep.report.statistics import (
    Bins,
    Column,
    OutputSensitivity,
    bin_by_count,
    bin_by_value,
    classify_points,
    compute_cell_statistics,
    compute_correlation,
    compute_null_deviation,
    compute_ranks,
    compute_sensitivity,
    estimate_explained_variance,
    find_feasible,
    find_limiting_rules,
    is_categorical,
    select_strongest_axes,
    suits_log_scale,
    to_sortable,
)
from fingertip.sweep.report.summary import describe_sample, describe_tied
from tests.sweep.examples import make_plan, make_table
from tests.tools import require_module

COLUMNS = st.lists(
    st.sampled_from([0.0, 0.5, 1.0, 2.0, 3.5, 10.0, 80.0]) | st.floats(-50, 50),
    min_size=1,
    max_size=60,
)


@settings(max_examples=60)
@given(COLUMNS, st.integers(2, 9), st.sampled_from([bin_by_count, bin_by_value]))
def test_bins_cover_a_column_without_overlap(
    values: list[float], maximum: int, divide: Callable[[Column, int], Bins]
) -> None:
    column = np.array(values)
    bins = divide(column, maximum)
    assert 1 <= bins.count <= maximum or bins.is_exact
    for i in range(bins.count):
        values_in_bin = column[bins.indices == i]
        assert len(values_in_bin)
        assert (values_in_bin.min(), values_in_bin.max()) == (bins.low[i], bins.high[i])
    assert np.all(bins.high[:-1] < bins.low[1:])


@settings(max_examples=40)
@given(COLUMNS)
def test_ranks_equal_those_of_scipy(values: list[float]) -> None:
    from scipy import stats

    assert compute_ranks(np.array(values)).tolist() == stats.rankdata(values).tolist()


@settings(max_examples=40)
@given(st.lists(st.tuples(st.integers(0, 3), st.integers(0, 3)), min_size=2, max_size=30))
def test_correlation_equals_that_of_numpy(points: list[tuple[int, int]]) -> None:
    x, y = np.array(points, dtype=float).T
    if np.ptp(x) and np.ptp(y):
        assert compute_correlation(x, y) == pytest.approx(np.corrcoef(x, y)[0, 1], abs=1e-12)
    else:
        assert math.isnan(compute_correlation(x, y))


VALUES = st.sampled_from([-3.0, 0.5, 7.0, math.inf, math.nan])
CELLS = st.lists(
    st.tuples(st.integers(0, 3), st.integers(0, 2), VALUES, st.booleans()), min_size=1, max_size=40
)


@settings(max_examples=60)
@given(CELLS, st.booleans())
def test_cells_contain_the_best_value_and_the_mean_over_other_axes(
    points: list[tuple[int, int, float, bool]], minimise: bool
) -> None:
    x, y, values, feasible = (np.array(column, dtype=float) for column in zip(*points, strict=True))
    bins = [bin_by_value(axis, 9) for axis in (x, y)]
    with np.errstate(all="raise"):
        found = compute_cell_statistics(*bins, values, feasible.astype(bool), minimise=minimise)
    for i, j in itertools.product(range(bins[1].count), range(bins[0].count)):
        inside = (bins[0].indices == j) & (bins[1].indices == i)
        usable = values[inside & (feasible > 0) & np.isfinite(values)]
        assert (found[0][i, j], found[1][i, j]) == (inside.sum(), len(usable))
        best, mean = (
            (min(usable) if minimise else max(usable), usable.mean())
            if len(usable)
            else (math.nan, math.nan)
        )
        assert found[2][i, j] == pytest.approx(best, nan_ok=True)
        assert found[3][i, j] == pytest.approx(mean, nan_ok=True)


def get_indices(sensitivity: OutputSensitivity) -> dict[str, float]:
    return {axis.axis: axis.first_order_index for axis in sensitivity.axes}


def test_first_order_indices_of_a_linear_function_are_its_squared_coefficients() -> None:
    from scipy.stats import qmc

    u = qmc.Sobol(4, rng=0).random(2**13)
    axes = {name: u[:, i] for i, name in enumerate("abcd")}
    sensitivity = compute_sensitivity("y", 3 * u[:, 0] - 2 * u[:, 1] + u[:, 2], axes)
    assert sensitivity is not None
    assert get_indices(sensitivity) == pytest.approx(
        {"a": 9 / 14, "b": 4 / 14, "c": 1 / 14, "d": 0.0}, abs=31 / 2**13
    )
    assert sensitivity.unexplained == pytest.approx(0.0, abs=0.012)
    assert [axis.axis for axis in sensitivity.axes][:3] == ["a", "b", "c"]
    signs = {axis.axis: axis.rank_correlation for axis in sensitivity.axes}
    assert signs["a"] > 0.5
    assert signs["b"] < -0.3
    assert select_strongest_axes(sensitivity, list(axes), 2) == ["a", "b"]
    assert select_strongest_axes(None, list(axes), 2) == ["a", "b"]


def test_axes_that_rules_tie_to_each_other_have_no_index() -> None:
    """Of points near a line, on which two axes each explain 99 %: the
    output is the one, and the other says as much.
    """
    rng = np.random.default_rng(1)
    x = rng.random(500)
    free = rng.random(500)
    axes = {"x": x, "beside": -x + 0.01 * rng.random(500), "free": free}
    sensitivity = compute_sensitivity("y", x + 0.3 * free, axes)
    assert sensitivity is not None
    assert {axis.axis: axis.tied_to for axis in sensitivity.axes} == {
        "x": ("beside",),
        "beside": ("x",),
        "free": (),
    }
    assert (
        get_indices(sensitivity)["x"]
        == get_indices(sensitivity)["beside"]
        == 0.0
        < get_indices(sensitivity)["free"]
    )
    assert describe_tied(sensitivity) == ["beside and x cannot be told apart"]
    assert set(select_strongest_axes(sensitivity, list(axes), 2)) == {"x", "beside"}
    independent = compute_sensitivity("y", x + 0.3 * free, {"x": x, "free": free})
    assert independent is not None
    assert not describe_tied(independent)


def test_a_summary_says_how_far_shares_and_delays_of_its_trials_can_be_off() -> None:
    """By hand: 0.025^(1/8) = 0.631; of 8 values the median lies
    between the first and the last with 1 - 2^-7.
    """
    found = describe_sample(8)
    assert (
        "a share of 1 is above 0.63, and medians lie between delays 1 and 8 of 8 in order." in found
    )
    assert "a share of 1 is above 0.02, and medians are not bounded by so few" in describe_sample(1)


@pytest.mark.parametrize("count", [3, 6])
def test_an_output_of_one_axis_of_a_small_grid_is_explained_by_it_whole(count: int) -> None:
    x, other = (
        column.ravel() for column in np.meshgrid(np.arange(float(count)), np.arange(24.0 / count))
    )
    sensitivity = compute_sensitivity("y", 70.8 + 8.5 * x, {"x": x, "other": other})
    assert sensitivity is not None
    assert get_indices(sensitivity) == pytest.approx({"x": 1.0, "other": 0.0})


@pytest.mark.parametrize("column", [np.ones(100), np.full(100, np.nan), np.arange(19.0)])
def test_constant_or_too_few_values_have_no_sensitivity(column) -> None:
    assert (
        compute_sensitivity("y", column, {"x": np.random.default_rng(0).random(len(column))})
        is None
    )
    assert compute_sensitivity("y", np.arange(20.0), {"x": np.arange(20.0)}) is not None


def is_dominated(costs: NDArray[np.float64], row: int) -> bool:
    return any(np.all(other <= costs[row]) and np.any(other < costs[row]) for other in costs)


@settings(max_examples=80)
@given(st.integers(1, 4), st.integers(1, 40), st.integers(1, 6), st.integers(0, 10**6))
def test_pareto_front_equals_brute_force(
    objectives: int, points: int, levels: int, seed: int
) -> None:
    costs = np.random.default_rng(seed).integers(0, levels, (points, objectives)).astype(float)
    expected = [row for row in range(points) if not is_dominated(costs, row)]
    assert find_pareto_front(costs).tolist() == expected
    best = find_nearest_to_ideal(costs, find_pareto_front(costs))
    assert best in expected
    if objectives == 1:
        assert best == int(np.argmin(costs[:, 0]))  # the first of equals


def test_pareto_front_is_exact() -> None:
    costs = np.array([[1e16, 1.0, 0.0], [1e16, 1.0 + 2e-16, 0.0], [1e16 - 2, 2.0, 0.0]])
    assert find_pareto_front(costs).tolist() == [0, 2]


def make_grid(n: int = 10) -> SweepTable:
    """Make a table of two axes from 0 to n - 1.

    A rule refuses width < 3; another refuses length > 7. One point fails, and one has a failed
    check.
    """
    x, y = (
        np.array(c, dtype=float) for c in zip(*itertools.product(range(n), range(n)), strict=True)
    )
    status = np.where((x < 3) | (y > 7), "refused", "ok")
    field = np.where(x < 3, "skin.width_mm", np.where(y > 7, "skin.length_mm", ""))
    reason = np.where(field != "", np.char.add(field, " with its reason"), "")
    status[55] = "failed"
    checks_failed = np.where(status == "ok", 0.0, np.nan)
    checks_failed[66] = 2.0
    axes = {"skin.width_mm": x, "skin.length_mm": y}
    return make_table(axes, {"checks_failed": checks_failed}, status, field, reason)


def test_point_classes_and_ranges_of_limiting_rules() -> None:
    table = make_grid()
    classes = classify_points(table)
    assert classes.names == (
        "feasible",
        "skin.width_mm",
        "skin.length_mm",
        "checks_failed",
        "failed",
    )
    assert classes.count().tolist() == [54, 30, 14, 1, 1]
    assert find_feasible(table).sum() == 54
    width, length, checks, failed = find_limiting_rules(table, classes)
    assert (width.points, width.share, width.example) == (30, 0.3, "skin.width_mm with its reason")
    assert width.axes[0].axis == "skin.width_mm"
    axes = {axis.axis: axis for axis in width.axes}
    assert axes["skin.width_mm"].explained_variance == pytest.approx(1.0)
    assert axes["skin.width_mm"].limiting_ranges == ((0.0, 2.0),)
    assert axes["skin.length_mm"].limiting_ranges == ((0.0, 7.0),)
    axes = {axis.axis: axis for axis in length.axes}
    assert axes["skin.length_mm"].limiting_ranges == ((8.0, 9.0),)
    assert axes["skin.width_mm"].limiting_ranges == ((3.0, 9.0),)
    assert (checks.rule, checks.points, failed.rule) == ("checks_failed", 1, "failed")


def test_failed_check_is_reported_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    checks = (
        Check("skin.stl.genus", 1, 1, "holes", "exactly"),
        Check("skin_thickness", 0.75, 0.8, "mm", "at least"),
        Check("bone.wall", 0.5, 1.0, "mm", "at least"),
    )
    monkeypatch.setattr(
        "fingertip.cad.verification.verify.verify", lambda *_: SimpleNamespace(checks=checks)
    )
    evaluator = PointEvaluator(make_plan(outputs=["checks_failed"], axes={"skin.width_mm": [17.0]}))
    point, status, field, reason, outputs = evaluator.evaluate(0, {"skin.width_mm": 17.0})
    assert (point, status, field, outputs) == (0, "ok", "skin_thickness", (2.0,))
    assert reason == "is 0.75 mm, but must be at least 0.8 mm (and 1 more: bone.wall)."
    table = make_table(
        {"skin.width_mm": [17.0]}, {"checks_failed": outputs}, [status], [field], [reason]
    )
    (rule,) = find_limiting_rules(table, classify_points(table))
    assert (rule.rule, rule.example) == ("check skin_thickness", reason)


def test_few_values_have_a_bin_each_wherever_they_lie() -> None:
    column = np.array([10.0, 0.0, 0.1, 0.0])
    for divide in (bin_by_count, bin_by_value):
        for maximum in (3, 9):
            bins = divide(column, maximum)
            assert bins.is_exact
            assert (bins.indices.tolist(), bins.low.tolist()) == ([2, 0, 1, 0], [0.0, 0.1, 10.0])
        assert not divide(column, 2).is_exact


def test_bins_by_value_share_the_range() -> None:
    bins = bin_by_value(np.arange(11.0), 5)
    assert (bins.low.tolist(), bins.high.tolist()) == ([0, 2, 4, 6, 8], [1, 3, 5, 7, 10])
    assert bins.indices.tolist() == [0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4]
    shifted = bin_by_value(np.arange(11.0) - 100.0, 5)
    assert (shifted.indices.tolist(), shifted.low[0]) == (bins.indices.tolist(), -100.0)
    gap = bin_by_value(np.array([0.0, 1.0, 2.0, 9.0, 10.0]), 4)
    assert (gap.low.tolist(), gap.high.tolist()) == ([0, 9], [2, 10]), "empty bins are left out"
    assert set(np.bincount(bin_by_value(np.geomspace(1, 1000, 999), 3).indices)) == {333}, (
        "of equal ratio"
    )


@pytest.mark.parametrize(
    ("counts", "maximum", "low", "high"),
    [
        ([4, 1, 1, 1], 2, [5, 6], [5, 8]),
        (
            [6, 1, 1, 1],
            3,
            [5, 6],
            [5, 8],
        ),  # middles 3, 6.5, 7.5 and 8.5 of 9 points: no value is in the first third
        (
            [3, 5, 4],
            2,
            [5, 7],
            [6, 7],
        ),  # middles 1.5, 5.5 and 10 of 12 points, in halves: 0.25, 0.92 and 1.67
        (
            [2, 1, 2, 4],
            3,
            [5, 7, 8],
            [6, 7, 8],
        ),  # middles 1, 2.5, 4 and 7 of 9, in thirds: 0.33, 0.83, 1.33 and 2.33
    ],
)
def test_bins_by_count_place_a_value_by_the_middle_of_its_points(
    counts: list[int], maximum: int, low: list[int], high: list[int]
) -> None:
    bins = bin_by_count(np.repeat([5.0, 6.0, 7.0, 8.0][: len(counts)], counts), maximum)
    assert (bins.low.tolist(), bins.high.tolist()) == (low, high)


def test_words_have_a_bin_each_and_numbers_among_them_become_words() -> None:
    mixed = np.array(["auto", 3.0, "auto", 20.0], dtype=object)
    assert to_sortable(mixed).tolist() == ["auto", "3.0", "auto", "20.0"]
    bins = bin_by_value(mixed, 2)
    assert (bins.low.tolist(), bins.indices.tolist()) == (["20.0", "3.0", "auto"], [2, 1, 2, 0])
    numbers = np.arange(3.0)
    assert to_sortable(numbers) is numbers
    assert [is_categorical(np.array(column)) for column in (["a"], [1.0], [True])] == [
        True,
        False,
        False,
    ]
    assert is_categorical(mixed)
    assert is_categorical(np.array([b"a"]))


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_logarithmic_scale_does_not_depend_on_the_unit(unit: float) -> None:
    with np.errstate(all="raise"):
        for column in ([1.0, 4.0, 16.0], [1.0, 2.0, 16.0], [1.0, 2.2, 5.0]):
            assert suits_log_scale(unit * np.array(column))
        for column in (
            [1.0, 2.2, 4.99],
            [1.0, 6.0, 16.0],
            [1.0, 8.5, 16.0],
            [0.0, 4.0, 16.0],
            [-16.0, -4.0, -1.0],
            [],
        ):
            assert not suits_log_scale(unit * np.array(column))
        assert not suits_log_scale(np.array(["1", "4", "16"]))


def test_explained_variance_of_four_points_by_hand() -> None:
    """Means of 0.5 and 2.5: the variance between is 4 of 5, less what chance adds, 1 -
    0.2 x 3 / 2.
    """
    bins = bin_by_value(np.array([0.0, 0.0, 1.0, 1.0]), 2)
    assert estimate_explained_variance(np.arange(4.0), bins) == pytest.approx(0.7)
    assert estimate_explained_variance(np.array([3.0, 3.0, 8.0, 8.0]), bins) == pytest.approx(1.0)


@pytest.mark.parametrize(("bins", "points", "deviation"), [(3, 5, 1.0), (9, 25, 0.25), (1, 9, 0.0)])
def test_deviation_without_effect_is_that_of_chi_squared(
    bins: int, points: int, deviation: float
) -> None:
    """The variance of bins - 1 degrees of freedom is twice their number."""
    assert compute_null_deviation(bins, points) == pytest.approx(deviation)


def test_objective_that_is_the_same_on_the_whole_front_does_not_count() -> None:
    costs = np.array([[7.0, 0.0, 1.0], [7.0, 1.0, 0.0], [7.0, 0.4, 0.4]])
    with np.errstate(all="raise"):
        assert find_nearest_to_ideal(costs, np.arange(3)) == 2
        assert find_nearest_to_ideal(costs, np.array([0, 1])) == 0, (
            "the first of two that are equally near"
        )
        assert find_nearest_to_ideal(np.array([[3.0], [2.0], [2.0]]), np.array([1, 2])) == 1


@pytest.mark.parametrize("units", [(1.0, 1.0), (1e-3, 1e3), (5.0, 1e-6)])
def test_nearest_to_the_ideal_does_not_depend_on_the_units(units: tuple[float, float]) -> None:
    """The third row is 1.018 from the ideal, the other two 1."""
    costs = np.array([[0.0, 1.0], [1.0, 0.0], [0.72, 0.72], [0.69, 0.71]]) * units
    assert find_nearest_to_ideal(costs, np.array([0, 1, 2])) == 0
    assert find_nearest_to_ideal(costs, np.arange(4)) == 3
    assert find_nearest_to_ideal(costs + 7.0, np.arange(4)) == 3
    assert find_nearest_to_ideal(costs - 7.0, np.arange(4)) == 3


@pytest.mark.parametrize("count", [5, 24, 25, 37, 40, 100, 239])
def test_equally_frequent_numbers_give_a_flat_histogram(count: int) -> None:
    values = np.repeat(np.arange(1.0, count + 1), 50)
    scale = make_scale("x", values, 24)
    edges = histogram_edges(values, scale, 24)
    heights = np.histogram(values, edges)[0]
    assert heights.sum() == len(values)
    assert len(heights) <= 24
    density = heights / np.diff(edges)
    assert density.max() / density.min() == pytest.approx(1.0)
    comb = np.histogram(values, np.linspace(scale.edges[0], scale.edges[-1], 25))[0]
    if count in (37, 40):
        assert comb.max() >= 1.9 * comb.min()  # what bins of equal width would show


def test_preferred_values_on_a_logarithmic_scale() -> None:
    values = np.repeat(10 ** (np.arange(60) / 24), 7)
    scale = make_scale("x", values, 24)
    assert scale.log
    edges = histogram_edges(values, scale, 24)
    density = np.histogram(values, edges)[0] / np.diff(np.log(edges))
    assert density.max() / density.min() == pytest.approx(1.0)


@pytest.mark.parametrize("width_in", [3.4, 5.8, 8.2, 15.0])
def test_no_line_of_the_heading_is_cut_off(width_in: float) -> None:
    require_module("matplotlib")
    from fingertip.foundation.display import new_figure

    lines = _write_heading(
        2000, 4096, ["amplifier_bandwidth_hz", "board.r2_ohm", "board.r3_ohm"], width_in
    )
    assert " ".join(lines).count("board.r3_ohm") == 1
    figure = new_figure(width_in, 2.0, automatic_layout=False)
    text = figure.suptitle("\n".join(lines), x=0.01, ha="left", fontsize=9)
    assert text.get_window_extent().x1 <= figure.bbox.width
    assert max(map(len, lines)) <= width_in / _CHARACTER_IN


def test_continuous_values_have_bins_of_equal_width() -> None:
    values = np.random.default_rng(0).uniform(0, 1, 5000)
    edges = histogram_edges(values, make_scale("x", values, 24), 24)
    assert len(edges) == 25
    assert np.diff(edges) == pytest.approx(np.diff(edges)[0])
    assert np.histogram(values, edges)[0].sum() == len(values)


@pytest.mark.parametrize(
    ("words", "degrees"),
    [(("smooth", "wood"), 0.0), (tuple(f"variant_{i:02}" for i in range(8)), 30.0)],
)
def test_words_below_a_plot_that_would_lie_on_each_other_are_turned(
    words: tuple[str, ...], degrees: float
) -> None:
    pytest.importorskip("matplotlib")
    axes = new_figure(4, 3).subplots()
    make_scale("surface", np.array(words), 24).apply(axes, "x")
    assert [label.get_text() for label in axes.get_xticklabels()] == sorted(words)
    assert {label.get_rotation() for label in axes.get_xticklabels()} == {degrees}
