"""Sweeps with a fit: axes stay as they are given, derived values follow, and what moved has a column."""

from __future__ import annotations

from pathlib import Path

import pytest

from fingertip.design import Design
from fingertip.foundation.errors import DesignError
from fingertip.sweep.database import SweepDatabase
from fingertip.sweep.engines import ProcessEngine
from fingertip.sweep.plan import SweepPlan
from fingertip.sweep.point_evaluator import PointEvaluator
from fingertip.sweep.report.files import write_csv, write_report
from fingertip.sweep.run import compute_rows

TEXT = """name = "fitted"
outputs = ["finger_length_mm"]
maximise = ["finger_length_mm"]
design = "adult_finger"
[axes]
"skin.thickness_palmar_mm" = [2.7, 3.2]
"board.cutoff_hz" = [50.0, 60.0]
"""


@pytest.fixture(scope="module")
def plan(tmp_path_factory: pytest.TempPathFactory) -> SweepPlan:
    file = tmp_path_factory.mktemp("fit") / "fitted.toml"
    file.write_text(TEXT, encoding="utf-8")
    return SweepPlan.load(file, ["fit=true"])


def test_columns_hold_what_moved_and_each_row_is_a_design_that_passes(plan: SweepPlan, tmp_path: Path) -> None:
    with SweepDatabase.create(tmp_path, plan) as database:
        compute_rows(plan, database, ProcessEngine(1))
        rows, outputs = list(database.rows()), database.find_outputs()
        report = write_report(database, tmp_path)
        write_csv(database, tmp_path / "rows.csv")
    fitted = [name for name in outputs if name.startswith("fitted.")]
    assert [row.status for row in rows] == ["ok"] * 4
    assert fitted
    assert list(rows[0].outputs) == ["finger_length_mm", *fitted]
    first = Design.load("adult_finger")
    for row in rows:
        moved = {name.removeprefix("fitted."): row.outputs[name] for name in fitted}
        assert Design.load("adult_finger", changes=row.axes | moved)
    for name in fitted:
        assert any(row.outputs[name] != first.value(name.removeprefix("fitted.")) for row in rows)
    with pytest.raises(DesignError):
        Design.load("adult_finger", changes=rows[0].axes)
    best = rows[report["best"]["point"]]
    written = Design.load(tmp_path / "best.toml")
    assert {name: written.value(name.removeprefix("fitted.")) for name in fitted} == {
        name: best.outputs[name] for name in fitted
    }
    assert (tmp_path / "rows.csv").read_text().splitlines()[0].split(",")[3:-3] == list(outputs)


@pytest.mark.full
def test_points_in_another_order_give_the_same_rows(plan: SweepPlan) -> None:
    forward, backward = PointEvaluator(plan), PointEvaluator(plan)
    there = [forward.evaluate(point, plan.point(point)) for point in range(4)]
    assert [backward.evaluate(point, plan.point(point)) for point in reversed(range(4))] == there[::-1]


def test_without_a_fit_no_column_is_added(plan: SweepPlan) -> None:
    tables = plan.file.model_dump() | {"fit": False, "design": plan.designs[""].model_dump(), "scene": None}
    assert SweepPlan.from_tables(tables).recorded == ("finger_length_mm",)
