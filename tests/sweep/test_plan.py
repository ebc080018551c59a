"""Sweep files and plans: what is accepted, and the messages for everything that is refused."""

from __future__ import annotations

import numpy as np
import pytest

from fingertip.foundation.errors import SweepError
from fingertip.sweep.axes import round_significant
from fingertip.sweep.sweep_plan import SweepPlan
from tests.conftest import ROOT
from tests.sweep.examples import make_plan


def test_grid_contains_every_combination_once_and_its_last_axis_varies_fastest() -> None:
    plan = make_plan()
    points = [plan.point(i) for i in range(plan.size)]
    assert len({tuple(p.values()) for p in points}) == plan.size == 12 * 3 * 2
    assert [p["board.series"] for p in points[:3]] == ["E12", "E96", "E12"]
    cutoffs = sorted({p["board.cutoff_hz"] for p in points})
    assert cutoffs == pytest.approx(np.geomspace(20, 2000, 12), rel=1e-8)
    assert (cutoffs[0], cutoffs[-1]) == (20.0, 2000.0)
    with pytest.raises(IndexError):
        plan.point(plan.size)


@pytest.mark.parametrize("sampling", ["latin_hypercube", "sobol"])
def test_samplers_are_stratified_and_reproducible_by_seed(sampling: str) -> None:
    axes = {
        "board.cutoff_hz": {"low": 10.0, "high": 1000.0, "spacing": "logarithmic"},
        "detector.window_samples": {"low": 1, "high": 64},
        "board.series": ["E12", "E24"],
    }
    plan, again, other = (
        make_plan(sampling=sampling, points=64, seed=seed, axes=axes) for seed in (1, 1, 2)
    )
    columns = plan.columns(np.arange(64))
    for name, column in again.columns(np.arange(64)).items():
        assert (columns[name] == column).all()
    assert (columns["board.cutoff_hz"] != other.columns(np.arange(64))["board.cutoff_hz"]).any()
    # Both samplers are stratified: each of 64 equal parts of an axis contains one point.
    shares = np.log10(columns["board.cutoff_hz"] / 10.0) / 2.0
    assert sorted(np.floor(64 * shares)) == list(range(64))
    assert np.sum(columns["board.series"] == "E12") == 32
    assert sorted(columns["detector.window_samples"].tolist()) == list(range(1, 65)), (
        "the ends are as likely"
    )
    assert plan.point(17) == {name: column[17].item() for name, column in columns.items()}


def test_points_of_the_largest_grid_are_computed_by_number() -> None:
    steps = {"low": 20.0, "high": 80.0, "steps": 10_000}
    plan = make_plan(
        axes={"board.cutoff_hz": steps, "board.envelope_cutoff_hz": steps, "board.series": ["E12"]}
    )
    assert plan.size == 100_000_000
    assert plan.point(99_999_999) == {
        "board.cutoff_hz": 80.0,
        "board.envelope_cutoff_hz": 80.0,
        "board.series": "E12",
    }
    assert len(plan.computing_order(99_999_990, 200_000_000)) == 10


def test_computed_values_are_rounded_to_nine_significant_digits() -> None:
    values = 10.0 ** np.random.default_rng(0).uniform(-12, 12, 5000)
    assert round_significant(values).tolist() == [
        float(f"{value:.9g}") for value in values.tolist()
    ]
    assert round_significant(np.array([0.0, 0.1, 1000.0])).tolist() == [0.0, 0.1, 1000.0]


def test_broken_rule_of_the_base_design_is_accepted_if_an_axis_changes_it() -> None:
    design = {"skin": {"width_mm": 6.0}}
    assert make_plan(design=design, outputs=[], axes={"skin.width_mm": [17.0, 18.0]}).size == 2


@pytest.mark.parametrize("name", ["axes", "design", "scene"])
def test_what_is_no_table_is_refused(name: str) -> None:
    for value in (5, 0, "x", "", [], [1], True, 1e400, [{}]):
        with pytest.raises(SweepError, match=rf"(?m)^{name}: .* is not a table; write \[{name}\]"):
            make_plan(**{name: value})


@pytest.mark.full
@pytest.mark.parametrize(
    "name", sorted(path.stem for path in (ROOT / "params" / "sweeps").glob("*.toml"))
)
def test_bundled_sweep_is_valid_and_survives_a_round_trip(name: str) -> None:
    plan = SweepPlan.load(ROOT / "params" / "sweeps" / f"{name}.toml")
    assert plan.file.name == name
    again = SweepPlan.from_toml(plan.to_toml())
    assert again.to_toml() == plan.to_toml()
    assert [again.point(i) for i in range(min(50, plan.size))] == [
        plan.point(i) for i in range(min(50, plan.size))
    ]


def test_changes_apply_to_sweep_file_design_and_scene() -> None:
    changes = [
        "tolerance_mm=0.05",
        "skin.length_mm=35",
        "scene.slide.distance_m=0.03",
        "axes.board.cutoff_hz=[50, 60]",
    ]
    plan = SweepPlan.load(ROOT / "params" / "sweeps" / "delay.toml", changes)
    assert (plan.file.tolerance_mm, plan.designs[""].skin.length_mm) == (0.05, 35.0)
    assert plan.scene is not None
    assert plan.scene.slide.distance_m == 0.03
    assert plan.axes[0].values == (50.0, 60.0)


def test_a_number_beyond_the_floats_is_refused() -> None:
    with pytest.raises(SweepError, match=r"axes.skin.width_mm: lists a number of more than 308"):
        SweepPlan.from_tables({"outputs": ["q"], "axes": {"skin.width_mm": [10**400, 17.0]}})
