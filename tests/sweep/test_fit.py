"""Sweeps with a fit: axes stay as they are given, derived values
follow, and what moved has a column.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from fingertip.design import Design
from fingertip.foundation.errors import DesignError
from fingertip.sweep.database import SweepDatabase
from fingertip.sweep.engines import ProcessEngine
from fingertip.sweep.point_evaluator import PointEvaluator
from fingertip.sweep.report.report_files import write_csv, write_report
from fingertip.sweep.run import compute_rows
from fingertip.sweep.sweep_plan import SweepPlan

TEXT = """name = "fitted"
outputs = ["finger_length_mm"]
maximise = ["finger_length_mm"]
design = "adult_finger"
[axes]
"skin.thickness_palmar_mm" = [2.7, 3.2]
"board.cutoff_hz" = [50.0, 60.0]
"""


@pytest.mark.second
def test_columns_hold_what_moved_and_each_row_is_a_design_that_passes(tmp_path: Path) -> None:
    (tmp_path / "fitted.toml").write_text(TEXT, encoding="utf-8")
    plan = SweepPlan.load(tmp_path / "fitted.toml", ["fit=true"])
    with SweepDatabase.create(tmp_path / "rows", plan) as database:
        compute_rows(plan, database, ProcessEngine(1))
        rows = list(database.rows())
        outputs = database.find_outputs()
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
    # What the points before it were does not count.
    again = PointEvaluator(plan).evaluate(0, plan.point(0))
    assert again[4] == tuple(
        {**dict.fromkeys(plan.recorded), **plan.fitted, **rows[0].outputs}.values()
    )
    best = rows[report["best"]["point"]]
    written = Design.load(tmp_path / "best.toml")
    assert {name: written.value(name.removeprefix("fitted.")) for name in fitted} == {
        name: best.outputs[name] for name in fitted
    }
    assert (tmp_path / "rows.csv").read_text().splitlines()[0].split(",")[3:-3] == list(outputs)
