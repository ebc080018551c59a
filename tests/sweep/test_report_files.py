"""The report's files: pictures, the best design, exports; read back from disk."""

from __future__ import annotations

import csv
import hashlib
import io
import json
import math
import sys
import tracemalloc
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

from fingertip.cli import app
from fingertip.design import Design
from fingertip.errors import MissingLibraryError, OutputError
from fingertip.sweep.plan import Plan
from fingertip.sweep.report import write
from fingertip.sweep.report.export import write_csv, write_parquet
from fingertip.sweep.report.feasibility import verdicts
from fingertip.sweep.report.pictures import front
from fingertip.sweep.report import scatter_matrix
from fingertip.sweep.report import feasibility_plot
from fingertip.sweep.report.summary import as_data, findings
from fingertip.sweep.report.text import as_text
from fingertip.sweep.database import Row, Store
from tests.conftest import run_python
from tests.sweep.tables import table

SWEEP: dict[str, Any] = {
    "name": "hand",
    "outputs": ["skin_volume_mm3", "cutoff_3db_hz", "delay_ms", "checks_failed"],
    "sampling": "latin_hypercube",
    "points": 400,
    "minimise": ["skin_volume_mm3", "delay_ms"],
    "scene": {"scene": "sliding_finger"},
    "axes": {
        "skin.width_mm": {"low": 15.0, "high": 23.0},
        "board.cutoff_hz": {"low": 20.0, "high": 200.0, "spacing": "logarithmic"},
        "board.series": ["E12", "E96"],
        "detector.window_samples": {"low": 20, "high": 90},
    },
}
TALE = 'refused, "for once"\nin two lines: \u00e9'


def rows(plan: Plan, failing: float = 0.0) -> Iterator[Row]:
    """What a sweep might give: narrow fingers refused, high cutoffs quick, some points lost."""
    for point in range(plan.size):
        axes = plan.point(point)
        width, cutoff = float(axes["skin.width_mm"]), float(axes["board.cutoff_hz"])
        nothing = dict.fromkeys(plan.outputs, math.nan)
        if width < 17:
            yield Row(point, axes, nothing, "refused", "skin.width_mm", TALE)
        elif point % 97 == 5:
            yield Row(point, axes, nothing, "failed", "", "its worker died while it was computed, twice.")
        else:
            delay = math.inf if cutoff < 25 else 15.0 + 900.0 / cutoff
            figures = dict(zip(SWEEP["outputs"], (100 * width, cutoff * 1.01, delay, failing), strict=True))
            yield Row(point, axes, {name: figures[name] for name in plan.outputs}, "ok", "", "")


def swept(folder: Path, failing: float = 0.0, only: int | None = None, **changes: Any) -> Store:
    """A store with such rows."""
    plan = Plan.of({**SWEEP, **changes})
    store = Store.create(folder, plan)
    made = [
        (row.point, row.status, row.field, row.reason, *row.axes.values(), *row.outputs.values())
        for row in rows(plan, failing)
    ]
    store.add(made[:only])
    return store


def hashes(folder: Path) -> dict[str, str]:
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in folder.iterdir()}


@pytest.fixture(scope="module")
def reported(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Store, Path, dict[str, Any]]]:
    """A sweep, the folder of its report, and what the report says."""
    folder = tmp_path_factory.mktemp("report")
    with swept(folder / "sweep") as store:
        yield store, folder / "out", write(store, folder / "out")


def test_the_report_says_what_it_wrote(reported) -> None:
    _, out, said = reported
    assert sorted(path.name for path in out.iterdir()) == said["files"]
    assert {"best.toml", "front.csv", "front.png", "feasibility_plot.png", "weights.png", "scatter_matrix.png"} <= set(said["files"])
    assert {"heat_skin_volume_mm3.png", "heat_delay_ms.png"} <= set(said["files"])
    kept = json.loads((out / "summary.json").read_text())
    assert kept == {key: value for key, value in said.items() if key != "text"}
    assert kept["status"] == {"ok": 297, "refused": 100, "failed": 3, "timeout": 0}
    assert kept["limits"][0]["rule"] == "skin.width_mm"
    assert kept["limits"][0]["axes"][0]["axis"] == "skin.width_mm"
    assert kept["outputs"]["delay_ms"]["unbounded"] > 0
    weights = {one["output"]: one["axes"][0] for one in kept["sensitivity"]}
    assert weights["delay_ms"]["axis"] == "board.cutoff_hz"
    assert weights["delay_ms"]["share"] > 0.95
    assert weights["feasible"]["axis"] == "skin.width_mm"


def test_text_tells_people_the_same(reported) -> None:
    text = reported[2]["text"]
    assert text.startswith("hand: 400 of 400 points: 297 ok, 100 refused, 3 failed; 297 feasible (74 %)")
    assert "skin.width_mm (" in text
    assert "board.cutoff_hz" in text
    assert all(len(line) <= 200 for line in text.splitlines())


def test_the_best_design_is_a_file_that_gives_its_row(reported) -> None:
    store, out, said = reported
    best = said["best"]
    design = Design.load(out / "best.toml")
    for name, value in best["parameters"].items():
        section, _, key = name.rpartition(".")
        assert getattr(getattr(design, section), key) == value
    row = next(row for row in store.rows() if row.point == best["point"])
    assert best["outputs"] == pytest.approx(row.outputs)
    heading = (out / "best.toml").read_text().splitlines()
    assert heading[0].startswith(f"# Point {best['point']} of the sweep hand.")
    candidates = [row for row in store.rows() if row.status == "ok" and math.isfinite(row.outputs["delay_ms"])]
    nobody = [
        row.point
        for row in candidates
        if not any(
            other.outputs["skin_volume_mm3"] <= row.outputs["skin_volume_mm3"]
            and other.outputs["delay_ms"] <= row.outputs["delay_ms"]
            and other.outputs != row.outputs
            for other in candidates
        )
    ]
    assert said["front"] == nobody
    assert best["point"] in nobody
    listed = list(csv.DictReader((out / "front.csv").read_text().splitlines()))
    assert [int(line["point"]) for line in listed] == nobody
    assert [float(line["delay_ms"]) for line in listed] == [
        row.outputs["delay_ms"] for row in candidates if row.point in nobody
    ]


@pytest.mark.parametrize(("goal", "pick"), [("minimise", min), ("maximise", max)])
def test_one_objective_takes_its_end_and_the_first_of_equals(tmp_path: Path, goal: str, pick) -> None:
    for name in ("checks_failed", "skin_volume_mm3"):
        with swept(tmp_path / name, **{"minimise": [], "maximise": [], goal: [name]}) as store:
            said = as_data(findings(store.plan, store.table()))
            ok = [row for row in store.rows() if row.status == "ok"]
            end = pick(row.outputs[name] for row in ok)
            assert said["best"]["point"] == next(row.point for row in ok if row.outputs[name] == end)


def test_a_failed_check_makes_a_point_infeasible(tmp_path: Path) -> None:
    with swept(tmp_path / "sweep", failing=1.0) as store:
        found = findings(store.plan, store.table())
    assert as_data(found)["feasible"] == 0
    assert found.choice.best is None
    assert found.limits[0].rule == "checks_failed"
    assert "none of 400 points is feasible; most are refused by checks_failed (74 %)" in as_text(found)


def test_nothing_feasible_names_the_rule_and_what_to_move(tmp_path: Path) -> None:
    narrow = {**SWEEP["axes"], "skin.width_mm": {"low": 14.0, "high": 16.9}}
    with swept(tmp_path / "sweep", axes=narrow, points=50) as store:
        said = write(store, tmp_path / "out")
    assert "none of 50 points is feasible; most are refused by skin.width_mm (100 %)." in said["best_sentence"]
    assert TALE in said["best_sentence"]
    assert "best.toml" not in said["files"]
    assert "feasibility_plot.png" in said["files"]


def test_an_objective_without_bound_anywhere_has_no_best(tmp_path: Path) -> None:
    slow = {**SWEEP["axes"], "board.cutoff_hz": {"low": 20.0, "high": 24.0}}
    with swept(tmp_path / "sweep", axes=slow) as store:
        found = findings(store.plan, store.table())
    assert as_data(found)["feasible"] == 297
    assert (found.choice.best, found.choice.unbounded, len(found.choice.front)) == (None, 297, 0)
    goal = "minimise skin_volume_mm3 and minimise delay_ms"
    assert f"none of 297 feasible points has a finite number to {goal}." in as_text(found)


@pytest.mark.parametrize("only", [0, 1, 5])
def test_few_rows_are_reported_too(tmp_path: Path, only: int) -> None:
    with swept(tmp_path / "sweep", only=only) as store:
        said = write(store, tmp_path / "out")
    assert said["rows"] == only
    assert (tmp_path / "out" / "summary.json").exists()
    assert said["text"].startswith(f"hand: {only} of 400 points")


def test_a_sweep_without_outputs_or_objectives_still_has_its_map(tmp_path: Path) -> None:
    with swept(tmp_path / "sweep", outputs=["checks_failed"], minimise=[], maximise=[]) as store:
        said = write(store, tmp_path / "out")
    assert "feasibility_plot.png" in said["files"]
    assert "names no objective" in said["best_sentence"]


def test_the_same_rows_give_the_same_bytes(reported, tmp_path: Path) -> None:
    store, out, _ = reported
    write(store, tmp_path / "again")
    assert hashes(tmp_path / "again") == hashes(out)


def test_an_unwritable_folder_is_said(reported, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="cannot be written"):
        write_csv(reported[0], tmp_path / "file" / "out" / "rows.csv")


def pixels(png: bytes, *colours: int) -> list[int]:
    """How many pixels of a picture have each colour, 0xRRGGBB."""
    image = np.asarray(Image.open(io.BytesIO(png)).convert("RGB"), dtype=np.int64) @ (1 << 16, 1 << 8, 1)
    return [int(np.sum(image == colour)) for colour in colours]


def test_the_map_is_painted_in_the_shares_of_the_rules() -> None:
    n = 40
    x, y = (np.repeat(np.arange(float(n)), n), np.tile(np.arange(float(n)), n))
    status = np.where(x < 12, "refused", "ok")
    field = np.where(x < 12, "skin.width_mm", "")
    status[(x >= 12) & (y >= 30)] = "timeout"
    swept_grid = table({"a": x, "b": y}, {}, status, field, field)
    png = feasibility_plot.draw(swept_grid.axes, verdicts(swept_grid), ["a", "b"])
    feasible, refused, late = pixels(png, 0xCFE3D8, 0xB03A2E, 0x8A9199)
    total = feasible + refused + late
    assert (feasible / total, refused / total, late / total) == pytest.approx((0.525, 0.3, 0.175), abs=0.01)
    assert total > 500_000


def test_a_hundred_thousand_points_are_thinned_out_and_drawn_soon() -> None:
    rng = np.random.default_rng(0)
    columns = {name: rng.random(100_000) for name in ("skin.width_mm", "board.cutoff_hz", "delay_ms")}
    assert scatter_matrix.draw(columns, rng.random(100_000) < 0.5).startswith(b"\x89PNG")
    place = np.arange(3)
    x, y = columns["delay_ms"], columns["skin.width_mm"]
    assert front.draw(("x", "y"), ("minimise", "minimise"), (x, y), place, 0, 2).startswith(b"\x89PNG")


def test_csv_reads_back_as_the_rows(reported, tmp_path: Path) -> None:
    store, _, _ = reported
    write_csv(store, tmp_path / "rows.csv")
    with (tmp_path / "rows.csv").open(newline="", encoding="utf-8") as file:
        lines = list(csv.DictReader(file))
    expected = list(store.rows())
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


def test_parquet_has_types_groups_and_the_same_rows(reported, tmp_path: Path, monkeypatch) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    store, _, _ = reported
    monkeypatch.setattr("fingertip.sweep.report.export._GROUP", 150)
    write_parquet(store, tmp_path / "rows.parquet")
    file = parquet.ParquetFile(tmp_path / "rows.parquet")
    assert file.num_row_groups == 3
    types = {field.name: str(field.type) for field in file.schema_arrow}
    assert types["point"] == types["detector.window_samples"] == "int64"
    assert types["skin.width_mm"] == types["delay_ms"] == "double"
    assert types["status"].startswith("dictionary<values=string")
    for found, row in zip(file.read().to_pylist(), store.rows(), strict=True):
        outputs = {name: None if math.isnan(value) else value for name, value in row.outputs.items()}
        assert found == {
            "point": row.point, **row.axes, **outputs, "status": row.status, "field": row.field, "reason": row.reason,
        }  # fmt: skip
    first = (tmp_path / "rows.parquet").read_bytes()
    write_parquet(store, tmp_path / "rows.parquet")
    assert (tmp_path / "rows.parquet").read_bytes() == first


class Endless:
    """Rows that are made while they are asked for."""

    def __init__(self, count: int, breaks: bool = False) -> None:
        self.plan = Plan.of({**SWEEP, "points": 8})
        self.count, self.breaks = count, breaks

    def rows(self) -> Iterator[Row]:
        axes, outputs = self.plan.point(0), dict.fromkeys(self.plan.outputs, 1.0 / 3.0)
        for point in range(self.count):
            yield Row(point, dict(axes), dict(outputs), "refused", "skin.width_mm", f"{point} " + "x" * 200)
        if self.breaks:
            raise ZeroDivisionError


@pytest.mark.parametrize("export", [write_csv, write_parquet])
def test_exports_need_no_memory_for_many_rows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, export) -> None:
    monkeypatch.setattr("fingertip.sweep.report.export._GROUP", 200)
    write_parquet(Endless(1), tmp_path / "first")  # what pyarrow needs once
    rows = Endless(8_000)
    tracemalloc.start()
    export(rows, tmp_path / "rows")
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert len((tmp_path / "rows").read_bytes()) > 200_000
    assert peak < 1_000_000  # the rows themselves are ten times that


@pytest.mark.parametrize("export", [write_csv, write_parquet])
def test_an_export_that_fails_leaves_what_was_there(tmp_path: Path, export) -> None:
    (tmp_path / "rows").write_bytes(b"old")
    with pytest.raises(ZeroDivisionError):
        export(Endless(100, breaks=True), tmp_path / "rows")
    assert (tmp_path / "rows").read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [tmp_path / "rows"]
    (tmp_path / "folder").mkdir()
    with pytest.raises(OutputError, match="is a folder"):
        export(Endless(1), tmp_path / "folder")


def test_parquet_without_its_package_is_a_sentence(reported, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(MissingLibraryError, match=r"--parquet: needs the package pyarrow.*fingertip\[parquet\].*--csv"):
        write_parquet(reported[0], tmp_path / "rows.parquet")
    file = tmp_path / "sweep.toml"  # which is not even read: nobody wants to learn this after a night
    done = CliRunner().invoke(app, ["sweep", str(file), "--out", str(tmp_path / "out"), "--parquet", "rows.parquet"])
    assert done.exit_code == 2
    assert "needs the package pyarrow" in done.stderr
    assert not any(tmp_path.iterdir())


def test_only_drawing_loads_matplotlib() -> None:
    code = (
        "import sys, fingertip.sweep.report, fingertip.sweep.report.text, fingertip.sweep.report.export\n"
        "print(*{'matplotlib', 'pyarrow', 'scipy', 'cadquery', 'distributed'} & set(sys.modules))"
    )
    assert run_python("-c", code).stdout.strip() == ""


BOARDS = """
name = "boards"
outputs = ["cutoff_3db_hz", "gain"]
GOAL
[axes]
board.cutoff_hz = [60, 67, 75]
"""


def test_show_asks_what_the_file_now_wants(tmp_path: Path) -> None:
    """Rows do not depend on objectives: a file that asks for others is answered; any other change is told apart."""
    file, out = tmp_path / "s.toml", tmp_path / "rows"

    def asked(goal: str, *words: str) -> Any:
        file.write_text(BOARDS.replace("GOAL", goal))
        return CliRunner().invoke(app, ["sweep", str(file), "--out", str(out), "--json", "--quiet", *words])

    assert asked("", "--jobs", "1").exit_code == 0
    assert json.loads(asked("", "--show").stdout)["best"] is None
    for goal, point in (('minimise = ["cutoff_3db_hz"]', 0), ('maximise = ["cutoff_3db_hz"]', 2)):
        shown = asked(goal, "--show")
        assert shown.exit_code == 0, shown.stderr
        assert json.loads(shown.stdout)["best"]["point"] == point
        assert (out / "best.toml").read_text().startswith(f"# Point {point} of the sweep boards.")

    # the folder alone answers by what it was last run with
    alone = ["sweep", "--show", "--out", str(out), "--json", "--quiet"]
    assert json.loads(CliRunner().invoke(app, alone).stdout)["best"] is None
    resumed = asked('minimise = ["cutoff_3db_hz"]', "--resume", "--jobs", "1")
    assert resumed.exit_code == 0, resumed.stderr
    assert json.loads(resumed.stdout)["computed_now"] == 0
    assert json.loads(CliRunner().invoke(app, alone).stdout)["best"]["point"] == 0
    assert "--set: changes a sweep file" in CliRunner().invoke(app, [*alone, "--set", "trials=4"]).stderr

    for words in (("--show",), ("--resume",)):
        for change in ("skin.width_mm=18", "axes.board.cutoff_hz=[60, 68, 75]"):
            other = asked('maximise = ["cutoff_3db_hz"]', *words, "--set", change)
            assert other.exit_code == 2
            assert "holds another sweep than the file now asks for (- then, + now)" in other.stderr
            assert "maximise" not in other.stderr, "that is no difference"
            assert "18" in other.stderr or "68" in other.stderr
