"""Sweep files and plans: what is accepted, and the messages for everything that is refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fingertip.foundation.errors import SweepError
from fingertip.sweep.axes import round_significant
from fingertip.sweep.plan import SweepPlan
from tests.conftest import ROOT
from tests.sweep.examples import BOARD, make_plan, run_sweep_command

LATIN: dict[str, Any] = {"sampling": "latin_hypercube", "points": 50}


def find_issues(**changes: Any) -> dict[str, str]:
    tables = {**BOARD, **changes}
    with pytest.raises(SweepError) as error:
        SweepPlan.from_tables({name: table for name, table in tables.items() if table is not None})
    return {issue.field: issue.message for issue in error.value.issues}


REFUSED_FILES: list[tuple[dict[str, Any], str, str]] = [
    ({"axes": {}}, "axes", "is empty"),
    ({"axes": None}, "axes", "is missing"),
    ({"axes": [1, 2]}, "axes", "is not a table"),
    ({"outputs": None}, "outputs", "is missing"),
    ({"outputs": "q"}, "outputs", "is not a list"),
    ({"outputs": ["Q"]}, "outputs", "did you mean q?"),
    ({"outputs": ["q", "q"]}, "outputs", "listed 2 times"),
    ({"outputs": ["weight"]}, "outputs", "is not an output"),
    ({"tolerance": 0.1}, "tolerance", "did you mean tolerance_mm?"),
    ({"tolerance_mm": 0.0}, "tolerance_mm", "at least 0.0005 mm"),
    ({"time_limit_s": "long"}, "time_limit_s", "is not a number"),
    ({"name": "../boards"}, "name", "cannot name a folder"),
    ({"sampling": "random"}, "sampling", "choose 'grid', 'latin_hypercube' or 'sobol'"),
    ({"points": 10}, "points", "a grid of 72 points"),
    ({"sampling": "sobol"}, "points", "is missing"),
    ({**LATIN, "points": -3}, "points", "at least 0"),
    ({"minimise": ["gain"]}, "minimise", "not among the sweep's outputs"),
    ({"minimise": ["q"], "maximise": ["q"]}, "maximise", "leave it out of one"),
    ({"silicone": "sylgard_184"}, "silicone", "write silicone.product under [design]"),
    ({"detector": "fats"}, "detector", "did you mean fast?"),
    ({"outputs": ["delay_ms"]}, "scene", "is missing"),
    ({"scene": {"slide": {"speed_m_s": 9.0}}}, "scene.slide.speed_m_s", "at most 0.2 m/s"),
    ({"design": {"skin": {"width": 17}}}, "design.skin.width", "did you mean skin.width_mm?"),
    ({"design": {"skin": {"thickness_dorsal_mm": 9.0}}}, "design.skin.thickness_dorsal_mm", "No axis changes that."),
]

REFUSED_AXES: list[tuple[dict[str, Any], str, str]] = [
    ({"skin.widht_mm": [17]}, "axes.skin.widht_mm", "did you mean skin.width_mm?"),
    ({"slide.speed_m_s": [0.04]}, "axes.slide.speed_m_s", "did you mean scene.slide.speed_m_s?"),
    ({"scene.slide.speed_m_s": [0.04]}, "axes.scene.slide.speed_m_s", "changes none of the outputs"),
    ({"skin": [1]}, "axes.skin", "there is no such parameter"),
    ({"scene.knock.speed_m_s": [0.08]}, "axes.scene.knock.speed_m_s", "is a parameter of a manipulation"),
    ({"silicone.product": ["addition_40"]}, "axes.silicone.product", "Did you mean addition_40a?"),
    ({"skin.width_mm": []}, "axes.skin.width_mm", "empty list"),
    ({"skin.width_mm": 17}, "axes.skin.width_mm", "is not an axis"),
    ({"skin.width_mm": [17, 17.0]}, "axes.skin.width_mm", "listed more than once"),
    ({"skin.width_mm": ["wide"]}, "axes.skin.width_mm", "is not a number"),
    ({"skin.width_mm": [17, 5]}, "axes.skin.width_mm", "at least 6 mm"),
    ({"skin.width_mm": [float("nan")]}, "axes.skin.width_mm", "not a finite number"),
    ({"skin.width_mm": {"low": 17, "high": 70, "steps": 3}}, "axes.skin.width_mm", "at most 60 mm"),
    ({"skin.width_mm": {"low": 17, "high": 18}}, "axes.skin.width_mm.steps", "at least 2"),
    ({"skin.width_mm": {"low": 17, "high": 18, "steps": 1}}, "axes.skin.width_mm.steps", "at least 2"),
    ({"skin.width_mm": {"low": 18, "high": 17, "steps": 3}}, "axes.skin.width_mm.high", "more than 18"),
    ({"skin.width_mm": {"low": 17, "steps": 3}}, "axes.skin.width_mm.high", "is missing; give the high end"),
    ({"skin.width_mm": {"low": "a", "high": 18, "steps": 3}}, "axes.skin.width_mm.low", "is not a finite number"),
    ({"skin.width_mm": {"low": 17, "high": 18, "step": 3}}, "axes.skin.width_mm.step", "did you mean steps?"),
    (
        {"board.cutoff_hz": {"low": 9, "high": 99, "steps": 3, "spacing": "log"}},
        "axes.board.cutoff_hz.spacing",
        "choose",
    ),
    (
        {"mold.sleeve_interference_mm": {"low": 0, "high": 1, "steps": 3, "spacing": "logarithmic"}},
        "axes.mold.sleeve_interference_mm.low",
        "is not above 0",
    ),
    ({"mold.method": {"low": 0, "high": 1, "steps": 2}}, "axes.mold.method", "list its values"),
    ({"mold.method": ["overmould"]}, "axes.mold.method", "'overmold' or 'sleeve'"),
    ({"detector.window_samples": [1.5]}, "axes.detector.window_samples", "is not a whole number"),
    (
        {"detector.window_samples": {"low": 10, "high": 12, "steps": 9}},
        "axes.detector.window_samples.steps",
        "at most 3",
    ),
    (
        {name: {"low": 16, "high": 17, "steps": 1000} for name in ("skin.width_mm", "skin.length_mm", "mold.land_mm")},
        "axes",
        "at most 100000000",
    ),
]


def test_invalid_files_are_refused_with_a_remedy() -> None:
    found = [(field, message, find_issues(**changes)) for changes, field, message in REFUSED_FILES]
    assert [case for case in found if case[1] not in case[2].get(case[0], "")] == []


def test_invalid_axes_are_refused_with_a_remedy() -> None:
    wrong = []
    for axes, field, message in REFUSED_AXES:
        found = find_issues(axes=axes)
        if message not in found.get(field, "") or (field != "axes" and list(found) != [field]):
            wrong.append((field, message, found))
    assert wrong == []


def test_all_issues_are_reported_at_once() -> None:
    found = find_issues(
        axes={"skin.widht_mm": [1], "mold.method": ["x"]}, outputs=["Q"], tolerance_mm=9.0, scene={"tap": {"count": 0}}
    )
    assert list(found) == ["tolerance_mm", "axes.skin.widht_mm", "axes.mold.method", "scene.tap.count", "outputs"]


def test_sobol_needs_a_power_of_two_and_the_message_names_the_nearest_two() -> None:
    axes = {"board.cutoff_hz": {"low": 20.0, "high": 80.0}}
    assert "choose 512 or 1024" in find_issues(sampling="sobol", points=1000, axes=axes)["points"]
    assert make_plan(sampling="sobol", points=512, axes=axes).size == 512


def test_sampled_axis_refuses_steps() -> None:
    axes = {"board.cutoff_hz": {"low": 20.0, "high": 80.0, "steps": 3}}
    assert "leave it out" in find_issues(**LATIN, axes=axes)["axes.board.cutoff_hz.steps"]


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
    plan, again, other = (make_plan(sampling=sampling, points=64, seed=seed, axes=axes) for seed in (1, 1, 2))
    columns = plan.columns(np.arange(64))
    for name, column in again.columns(np.arange(64)).items():
        assert (columns[name] == column).all()
    assert (columns["board.cutoff_hz"] != other.columns(np.arange(64))["board.cutoff_hz"]).any()
    # Both samplers are stratified: each of 64 equal parts of an axis contains one point.
    shares = np.log10(columns["board.cutoff_hz"] / 10.0) / 2.0
    assert sorted(np.floor(64 * shares)) == list(range(64))
    assert np.sum(columns["board.series"] == "E12") == 32
    assert sorted(columns["detector.window_samples"].tolist()) == list(
        range(1, 65)
    )  # the ends are as likely as other values
    assert plan.point(17) == {name: column[17].item() for name, column in columns.items()}


def test_points_of_a_large_grid_are_computed_by_number() -> None:
    steps = {"low": 20.0, "high": 80.0, "steps": 1000}
    plan = make_plan(axes={"board.cutoff_hz": steps, "board.envelope_cutoff_hz": steps, "board.series": ["E12"]})
    assert plan.size == 1_000_000
    assert plan.point(999_999) == {"board.cutoff_hz": 80.0, "board.envelope_cutoff_hz": 80.0, "board.series": "E12"}
    assert len(plan.computing_order(999_990, 2_000_000)) == 10


def test_computed_values_are_rounded_to_nine_significant_digits() -> None:
    values = 10.0 ** np.random.default_rng(0).uniform(-12, 12, 5000)
    assert round_significant(values).tolist() == [float(f"{value:.9g}") for value in values.tolist()]
    assert round_significant(np.array([0.0, 0.1, 1000.0])).tolist() == [0.0, 0.1, 1000.0]


def test_broken_rule_of_the_base_design_is_accepted_if_an_axis_changes_it() -> None:
    design = {"skin": {"width_mm": 6.0}}
    assert make_plan(design=design, outputs=[], axes={"skin.width_mm": [17.0, 18.0]}).size == 2


@pytest.mark.full
@pytest.mark.parametrize("name", ["board", "delay", "geometry", "map"])
def test_bundled_sweep_is_valid_and_survives_a_round_trip(name: str) -> None:
    plan = SweepPlan.load(ROOT / "params" / "sweeps" / f"{name}.toml")
    assert plan.file.name == name
    again = SweepPlan.from_toml(plan.to_toml())
    assert again.to_toml() == plan.to_toml()
    assert [again.point(i) for i in range(50)] == [plan.point(i) for i in range(50)]


def test_changes_apply_to_sweep_file_design_and_scene() -> None:
    changes = ["tolerance_mm=0.05", "skin.length_mm=35", "scene.slide.distance_m=0.03", "axes.board.cutoff_hz=[50, 60]"]
    plan = SweepPlan.load(ROOT / "params" / "sweeps" / "delay.toml", changes)
    assert (plan.file.tolerance_mm, plan.design.skin.length_mm) == (0.05, 35.0)
    assert plan.scene is not None
    assert plan.scene.slide.distance_m == 0.03
    assert plan.axes[0].values == (50.0, 60.0)


@pytest.mark.parametrize("change", ["board.cutoff_hz=5000", "scene.slide.speed_m_s=0.1"])
def test_change_of_a_swept_parameter_is_refused(change: str) -> None:
    path, name = ROOT / "params" / "sweeps" / "delay.toml", change.partition("=")[0]
    with pytest.raises(SweepError, match=rf"{name} is an axis of the sweep; set axes\.{name}=\["):
        SweepPlan.load(path, [change])


def test_unreadable_files_are_named(tmp_path: Path) -> None:
    (tmp_path / "sweep.toml").write_text(
        'design = "none.toml"\nscene = 3\noutputs = []\n[axes]\nskin.width_mm = [17]\n'
    )
    result = run_sweep_command(tmp_path / "sweep.toml", "--out", tmp_path / "out")
    assert result.exit_code == 2
    assert "none.toml: cannot be read" in result.stderr
    assert "scene: 3 is neither a file nor a table" in result.stderr
    assert not (tmp_path / "out").exists()
    (tmp_path / "sweep.toml").write_text("[axes\n")
    assert "is not valid TOML" in run_sweep_command(tmp_path / "sweep.toml").stderr


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "SWEEP.toml: is missing"),
        (["params/sweeps/board.toml", "--jobs", "0"], "choose 1 to 1024"),
        (["params/sweeps/board.toml", "--jobs", "2", "--cluster", "tcp://h:1"], "leave one of them out"),
        (["--show"], "needs a sweep"),
        (["--show", "--out", "nowhere"], "holds no sweep"),
    ],
)
def test_invalid_command_lines_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], message: str
) -> None:
    monkeypatch.chdir(tmp_path)
    result = run_sweep_command(*(ROOT / a if a.endswith(".toml") else a for a in arguments))
    assert result.exit_code == 2
    assert message in result.stderr
    assert list(tmp_path.iterdir()) == []
