"""Files of the report: plots, best design, summary and exports, read back from disk."""

from __future__ import annotations

import csv
import hashlib
import io
import json
import math
import tracemalloc
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import Result
from PIL import Image
from typer.testing import CliRunner

from fingertip.cli import app
from fingertip.design import Design
from fingertip.foundation.errors import OutputError
from fingertip.foundation.plot_style import PALE_TEAL, RED, TEXT_COLOUR
from fingertip.sweep.database import SweepDatabase, SweepRow
from fingertip.sweep.plan import SweepPlan
from fingertip.sweep.report import RowSource, write_csv, write_parquet, write_report
from fingertip.sweep.report.feasibility_plot import draw_feasibility
from fingertip.sweep.report.plots import draw_pareto_front, draw_scatter_matrix
from fingertip.sweep.report.statistics import classify_points
from fingertip.sweep.report.summary import Objective, format_text, summarise, to_json_data
from tests.sweep.examples import InlineEngine, make_table

SWEEP: dict[str, Any] = {
    "name": "hand",
    "outputs": ["skin_volume_mm3", "cutoff_3db_hz", "delay_ms", "checks_failed"],
    "sampling": "latin_hypercube",
    "points": 400,
    "minimise": ["skin_volume_mm3", "delay_ms"],
    "scene": {"scene": "sliding_finger"},
    "axes": {
        "skin.width_mm": {"low": 15.0, "high": 23.0},
        "board.cutoff_hz": {"low": 20.0, "high": 130.0, "spacing": "logarithmic"},
        "board.series": ["E12", "E96"],
        "detector.window_samples": {"low": 20, "high": 90},
    },
}
REASON = 'refused, with "quotes"\nin two lines: \u00e9'


def generate_rows(plan: SweepPlan, checks_failed: float = 0.0) -> Iterator[SweepRow]:
    """Generate plausible rows: narrow fingers are refused, some points fail, high cutoffs give short delays."""
    for point in range(plan.size):
        axes = plan.point(point)
        width, cutoff = float(axes["skin.width_mm"]), float(axes["board.cutoff_hz"])
        no_outputs = dict.fromkeys(plan.outputs, math.nan)
        if width < 17:
            yield SweepRow(point, axes, no_outputs, "refused", "skin.width_mm", REASON)
        elif point % 97 == 5:
            yield SweepRow(point, axes, no_outputs, "failed", "", "its worker died while it was computed, twice.")
        else:
            delay = math.inf if cutoff < 25 else 15.0 + 900.0 / cutoff
            values = dict(zip(SWEEP["outputs"], (100 * width, cutoff * 1.01, delay, checks_failed), strict=True))
            yield SweepRow(point, axes, {name: values[name] for name in plan.outputs}, "ok", "", "")


def make_database(
    folder: Path, checks_failed: float = 0.0, row_count: int | None = None, **changes: Any
) -> SweepDatabase:
    plan = SweepPlan.from_tables({**SWEEP, **changes})
    database = SweepDatabase.create(folder, plan)
    rows = [
        (row.point, row.status, row.field, row.reason, *row.axes.values(), *row.outputs.values())
        for row in generate_rows(plan, checks_failed)
    ]
    database.add(rows[:row_count])
    return database


Report = tuple[SweepDatabase, Path, dict[str, Any]]
"""A database, the folder of its report, and the data that `write_report` returned."""


def compute_hashes(folder: Path) -> dict[str, str]:
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in folder.iterdir()}


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Report]:
    folder = tmp_path_factory.mktemp("report")
    with make_database(folder / "sweep") as database:
        yield database, folder / "out", write_report(database, folder / "out")


@pytest.mark.full
def test_report_contains_the_files_and_numbers_that_it_names(report: Report) -> None:
    _, out, data = report
    assert sorted(path.name for path in out.iterdir() if path.name != "manifest.json") == data["files"]
    assert set(data["files"]) >= {
        "best.toml",
        "feasibility.png",
        "heatmap_delay_ms.png",
        "heatmap_skin_volume_mm3.png",
        "pareto_front.csv",
        "pareto_front.png",
        "scatter_matrix.png",
        "sensitivity.png",
    }
    summary = json.loads((out / "summary.json").read_text())
    assert summary == {key: value for key, value in data.items() if key != "text"}
    assert summary["status"] == {"ok": 297, "refused": 100, "failed": 3, "timeout": 0}
    assert summary["limiting_rules"][0]["rule"] == "skin.width_mm"
    assert summary["limiting_rules"][0]["axes"][0]["axis"] == "skin.width_mm"
    assert summary["outputs"]["delay_ms"]["infinite"] > 0
    strongest = {sensitivity["output"]: sensitivity["axes"][0] for sensitivity in summary["sensitivity"]}
    assert strongest["delay_ms"]["axis"] == "board.cutoff_hz"
    assert strongest["delay_ms"]["first_order_index"] > 0.95
    assert strongest["feasible"]["axis"] == "skin.width_mm"


@pytest.mark.full
def test_best_design_file_reproduces_its_row_and_the_front_is_listed(report: Report) -> None:
    database, out, data = report
    best = data["best"]
    design = Design.load(out / "best.toml")
    for name, value in best["parameters"].items():
        section, _, key = name.rpartition(".")
        assert getattr(getattr(design, section), key) == value
    row = next(row for row in database.rows() if row.point == best["point"])
    assert best["outputs"] == pytest.approx(row.outputs)
    heading = (out / "best.toml").read_text().splitlines()
    assert heading[0].startswith(f"# Point {best['point']} of the sweep hand.")
    assert best["point"] in data["pareto_front"]
    listed = list(csv.DictReader((out / "pareto_front.csv").read_text().splitlines()))
    assert [int(line["point"]) for line in listed] == data["pareto_front"]
    delay_ms = {row.point: row.outputs["delay_ms"] for row in database.rows()}
    assert [float(line["delay_ms"]) for line in listed] == [delay_ms[point] for point in data["pareto_front"]]


def test_failed_check_makes_a_point_infeasible(tmp_path: Path) -> None:
    with make_database(tmp_path / "sweep", checks_failed=1.0) as database:
        summary = summarise(database.plan, database.table())
    assert to_json_data(summary)["feasible"] == 0
    assert summary.selection.best is None
    assert summary.limiting_rules[0].rule == "checks_failed"
    assert "None of 400 points is feasible; the most frequent limiting rule is checks_failed (74 %)" in format_text(
        summary
    )


@pytest.mark.full
def test_report_without_feasible_points_names_the_limiting_rule(tmp_path: Path) -> None:
    narrow = {**SWEEP["axes"], "skin.width_mm": {"low": 14.0, "high": 16.9}}
    with make_database(tmp_path / "sweep", axes=narrow, points=50) as database:
        data = write_report(database, tmp_path / "out")
    assert (
        "None of 50 points is feasible; the most frequent limiting rule is skin.width_mm (100 %)."
        in data["best_summary"]
    )
    assert REASON in data["best_summary"]
    assert "best.toml" not in data["files"]
    assert "feasibility.png" in data["files"]


def test_objective_that_is_always_infinite_gives_no_best_point(tmp_path: Path) -> None:
    slow = {**SWEEP["axes"], "board.cutoff_hz": {"low": 20.0, "high": 24.0}}
    with make_database(tmp_path / "sweep", axes=slow) as database:
        summary = summarise(database.plan, database.table())
    assert to_json_data(summary)["feasible"] == 297
    assert (summary.selection.best, summary.selection.excluded, len(summary.selection.front)) == (None, 297, 0)
    goals = "minimise skin_volume_mm3 and minimise delay_ms"
    assert f"None of 297 feasible points has a finite value of every objective ({goals})." in format_text(summary)


@pytest.mark.full
@pytest.mark.parametrize("row_count", [0, 1, 5])
def test_report_works_with_few_rows(tmp_path: Path, row_count: int) -> None:
    with make_database(tmp_path / "sweep", row_count=row_count) as database:
        data = write_report(database, tmp_path / "out")
    assert data["rows"] == row_count
    assert (tmp_path / "out" / "summary.json").exists()
    assert data["text"].startswith(f"hand: {row_count} of 400 points")


def test_sweep_without_objectives_still_has_a_feasibility_plot(tmp_path: Path) -> None:
    with make_database(tmp_path / "sweep", outputs=["checks_failed"], minimise=[], maximise=[]) as database:
        data = write_report(database, tmp_path / "out")
    assert "feasibility.png" in data["files"]
    assert "has no objective" in data["best_summary"]


@pytest.mark.full
def test_same_rows_give_the_same_bytes(report: Report, tmp_path: Path) -> None:
    database, out, _ = report
    write_report(database, tmp_path / "again")
    assert compute_hashes(tmp_path / "again") == compute_hashes(out)


@pytest.mark.full
def test_unwritable_folder_is_reported(report: Report, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="cannot be written"):
        write_csv(report[0], tmp_path / "file" / "out" / "rows.csv")


def count_pixels(png: bytes, *colours: int) -> list[int]:
    image = np.asarray(Image.open(io.BytesIO(png)).convert("RGB"), dtype=np.int64) @ (1 << 16, 1 << 8, 1)
    return [int(np.sum(image == colour)) for colour in colours]


def test_areas_of_the_feasibility_map_equal_the_shares_of_the_rules() -> None:
    n = 40
    x, y = (np.repeat(np.arange(float(n)), n), np.tile(np.arange(float(n)), n))
    status = np.where(x < 12, "refused", "ok")
    field = np.where(x < 12, "skin.width_mm", "")
    status[(x >= 12) & (y >= 30)] = "timeout"
    table = make_table({"a": x, "b": y}, {}, status, field, field)
    png = draw_feasibility(table.axes, classify_points(table), ["a", "b"])
    feasible, refused, timeout = count_pixels(png, *(int(name[1:], 16) for name in (PALE_TEAL, RED, TEXT_COLOUR)))
    total = feasible + refused + timeout
    assert (feasible / total, refused / total, timeout / total) == pytest.approx((0.525, 0.3, 0.175), abs=0.01)
    assert total > 500_000


def test_plots_of_many_points_draw_a_sample() -> None:
    rng = np.random.default_rng(0)
    columns = {name: rng.random(100_000) for name in ("skin.width_mm", "board.cutoff_hz", "delay_ms")}
    assert draw_scatter_matrix(columns, rng.random(100_000) < 0.5).startswith(b"\x89PNG")
    objectives = [Objective("delay_ms", 1), Objective("skin.width_mm", 1)]
    x, y = columns["delay_ms"], columns["skin.width_mm"]
    assert draw_pareto_front(objectives, (x, y), np.arange(3), best=0).startswith(b"\x89PNG")


@pytest.mark.full
def test_csv_reads_back_as_the_rows(report: Report, tmp_path: Path) -> None:
    database, _, _ = report
    write_csv(database, tmp_path / "rows.csv")
    with (tmp_path / "rows.csv").open(newline="", encoding="utf-8") as file:
        lines = list(csv.DictReader(file))
    expected = list(database.rows())
    assert len(lines) == len(expected) == 400
    for line, row in zip(lines, expected, strict=True):
        assert (int(line["point"]), line["status"], line["field"], line["reason"]) == (
            row.point, row.status, row.field, row.reason,
        )  # fmt: skip
        assert float(line["board.cutoff_hz"]) == row.axes["board.cutoff_hz"]
        assert (line["board.series"], int(line["detector.window_samples"])) == (
            row.axes["board.series"], row.axes["detector.window_samples"],
        )  # fmt: skip
        for name, value in row.outputs.items():
            assert (line[name] == "") if math.isnan(value) else float(line[name]) == value
    assert b"\r" not in (tmp_path / "rows.csv").read_bytes()


@pytest.mark.full
def test_parquet_has_types_groups_and_the_same_rows(
    report: Report, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    database, _, _ = report
    monkeypatch.setattr("fingertip.sweep.report._GROUP_ROWS", 150)
    write_parquet(database, tmp_path / "rows.parquet")
    file = parquet.ParquetFile(tmp_path / "rows.parquet")
    assert file.num_row_groups == 3
    types = {field.name: str(field.type) for field in file.schema_arrow}
    assert types["point"] == types["detector.window_samples"] == "int64"
    assert types["skin.width_mm"] == types["delay_ms"] == "double"
    assert types["status"].startswith("dictionary<values=string")
    for entry, row in zip(file.read().to_pylist(), database.rows(), strict=True):
        outputs = {name: None if math.isnan(value) else value for name, value in row.outputs.items()}
        assert entry == {
            "point": row.point, **row.axes, **outputs, "status": row.status, "field": row.field, "reason": row.reason,
        }  # fmt: skip
    first = (tmp_path / "rows.parquet").read_bytes()
    write_parquet(database, tmp_path / "rows.parquet")
    assert (tmp_path / "rows.parquet").read_bytes() == first


class GeneratedRows:
    """Row source that generates rows while they are read, and may fail after the last."""

    def __init__(self, count: int, fails: bool = False) -> None:
        self.plan = SweepPlan.from_tables({**SWEEP, "points": 8})
        self.count, self.fails = count, fails

    def rows(self) -> Iterator[SweepRow]:
        axes, outputs = self.plan.point(0), dict.fromkeys(self.plan.outputs, 1.0 / 3.0)
        for point in range(self.count):
            yield SweepRow(point, dict(axes), dict(outputs), "refused", "skin.width_mm", f"{point} " + "x" * 200)
        if self.fails:
            raise ZeroDivisionError


@pytest.mark.parametrize("export", [write_csv, write_parquet])
def test_export_uses_constant_memory(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, export: Callable[[RowSource, Path], None]
) -> None:
    monkeypatch.setattr("fingertip.sweep.report._GROUP_ROWS", 200)
    write_parquet(GeneratedRows(1), tmp_path / "first")  # not measured: what pyarrow allocates once
    rows = GeneratedRows(8_000)
    tracemalloc.start()
    export(rows, tmp_path / "rows")
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert len((tmp_path / "rows").read_bytes()) > 200_000
    assert peak < 1_000_000  # all rows together would take ten times as much


@pytest.mark.parametrize("export", [write_csv, write_parquet])
def test_failed_export_leaves_the_existing_file_unchanged(
    tmp_path: Path, export: Callable[[RowSource, Path], None]
) -> None:
    (tmp_path / "rows").write_bytes(b"old")
    with pytest.raises(ZeroDivisionError):
        export(GeneratedRows(100, fails=True), tmp_path / "rows")
    assert (tmp_path / "rows").read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [tmp_path / "rows"]
    (tmp_path / "folder").mkdir()
    with pytest.raises(OutputError, match="is a folder"):
        export(GeneratedRows(1), tmp_path / "folder")


BOARDS = """
name = "boards"
outputs = ["cutoff_3db_hz", "gain"]
GOAL
[axes]
board.cutoff_hz = [60, 67, 75]
"""


@pytest.mark.full
def test_show_uses_the_objectives_of_the_file_and_refuses_a_different_sweep(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Rows do not depend on objectives, so a report may use others than the run. Any other change is refused."""
    monkeypatch.setattr("fingertip.sweep.engines.ProcessEngine", InlineEngine)
    file, out = tmp_path / "sweep.toml", tmp_path / "rows"

    def run(goal: str, *arguments: str) -> Result:
        file.write_text(BOARDS.replace("GOAL", goal))
        return CliRunner().invoke(app, ["sweep", str(file), "--out", str(out), "--json", "--quiet", *arguments])

    assert run("", "--jobs", "1").exit_code == 0
    assert json.loads(run("", "--show").stdout)["best"] is None
    for goal, point in (('minimise = ["cutoff_3db_hz"]', 0), ('maximise = ["cutoff_3db_hz"]', 2)):
        result = run(goal, "--show")
        assert result.exit_code == 0, result.stderr
        assert json.loads(result.stdout)["best"]["point"] == point
        assert (out / "best.toml").read_text().startswith(f"# Point {point} of the sweep boards.")

    # Given the folder alone, the report uses the objectives of the latest run.
    show_folder = ["sweep", "--show", "--out", str(out), "--json", "--quiet"]
    assert json.loads(CliRunner().invoke(app, show_folder).stdout)["best"] is None
    resumed = run('minimise = ["cutoff_3db_hz"]', "--resume", "--jobs", "1")
    assert resumed.exit_code == 0, resumed.stderr
    assert json.loads(resumed.stdout)["computed_now"] == 0
    assert json.loads(CliRunner().invoke(app, show_folder).stdout)["best"]["point"] == 0
    assert "--set: changes a sweep file" in CliRunner().invoke(app, [*show_folder, "--set", "trials=4"]).stderr

    for option in ("--show", "--resume"):
        for change in ("skin.width_mm=18", "axes.board.cutoff_hz=[60, 68, 75]"):
            result = run('maximise = ["cutoff_3db_hz"]', option, "--set", change)
            assert result.exit_code == 2
            assert "holds a different sweep than the file now describes (- stored, + file)" in result.stderr
            assert "maximise" not in result.stderr  # a different objective is no difference
            assert "18" in result.stderr or "68" in result.stderr
