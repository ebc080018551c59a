"""Files of the report: plots, best design, summary and exports, read back from disk."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.axis import Axis
from PIL import Image

from fingertip.design import Design
from fingertip.foundation.display import PALE_TEAL, RED, TEXT_COLOUR
from fingertip.sweep.database import SweepDatabase, SweepRow
from fingertip.sweep.report import report_files
from fingertip.sweep.report.best_design_file import name_best_design
from fingertip.sweep.report.feasibility_plot import draw_feasibility
from fingertip.sweep.report.plots import draw_scatter_matrix
from fingertip.sweep.report.report_files import write_csv, write_report
from fingertip.sweep.report.statistics import classify_points
from fingertip.sweep.sweep_plan import SweepPlan
from tests.approved import check_figures, list_data
from tests.figures import describe_figure, keep_figures, list_words
from tests.sweep.examples import make_table

APPROVED = Path(__file__).parent / "approved"
SWEEP: dict[str, Any] = {
    "name": "hand",
    "outputs": ["skin_volume_mm3", "cutoff_3db_hz", "delay_ms", "checks_failed"],
    "sampling": "latin_hypercube",
    "points": 400,
    "minimise": ["skin_volume_mm3", "delay_ms"],
    "scene": {"scene": "sliding_finger"},
    "axes": {
        "skin.width_mm": {"low": 15.0, "high": 19.0},
        "board.cutoff_hz": {"low": 20.0, "high": 130.0, "spacing": "logarithmic"},
        "board.series": ["E12", "E96"],
        "detector.window_samples": {"low": 20, "high": 90},
    },
}
REASON = 'refused, with "quotes"\nin two lines: \u00e9'


def generate_rows(plan: SweepPlan, checks_failed: float = 0.0) -> Iterator[SweepRow]:
    """Generate plausible rows: narrow fingers are refused, some
    points fail, high cutoffs give short delays.
    """
    for point in range(plan.size):
        axes = plan.point(point)
        width = float(axes["skin.width_mm"])
        cutoff = float(axes["board.cutoff_hz"])
        no_outputs = dict.fromkeys(plan.outputs, math.nan)
        if width < 17:
            yield SweepRow(point, axes, no_outputs, "refused", "skin.width_mm", REASON)
        elif point % 97 == 5:
            yield SweepRow(
                point,
                axes,
                no_outputs,
                "failed",
                "",
                "its worker died while it was computed, twice.",
            )
        else:
            delay = math.inf if cutoff < 25 else 15.0 + 900.0 / cutoff
            values = dict(
                zip(
                    SWEEP["outputs"],
                    (100 * width, cutoff * 1.01, delay, checks_failed),
                    strict=True,
                )
            )
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


@pytest.fixture(scope="module")
def database(tmp_path_factory: pytest.TempPathFactory) -> Iterator[SweepDatabase]:
    with make_database(tmp_path_factory.mktemp("report") / "sweep") as database:
        yield database


GRID = {
    "skin.width_mm": [15.0, 16.0, 17.0, 18.0, 19.0],
    "board.cutoff_hz": {"low": 20.0, "high": 130.0, "steps": 6},
}
NARROW = {**SWEEP["axes"], "skin.width_mm": {"low": 14.0, "high": 16.9}}
SLOW = {**SWEEP["axes"], "board.cutoff_hz": {"low": 20.0, "high": 24.0}}
CASES: dict[str, dict[str, Any]] = {
    "complete": {"maximise": ["cutoff_3db_hz"]},
    "grid": {
        "axes": GRID,
        "sampling": "grid",
        "points": 0,
        "minimise": [],
        "maximise": ["cutoff_3db_hz"],
    },
    "failed_checks": {"points": 60, "checks_failed": 1.0},
    "nothing_feasible": {"points": 50, "axes": NARROW},
    "no_finite_objective": {"points": 60, "axes": SLOW},
    "no_objective": {"points": 60, "outputs": ["checks_failed"], "minimise": []},
    "no_row": {"row_count": 0},
    "one_row": {"row_count": 1},
    "five_rows": {"row_count": 5},
}


@pytest.mark.every_case
@pytest.mark.parametrize("name", CASES)
def test_reports_are_the_approved_ones(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Text, and figures of some: what matplotlib is asked to draw
    stands for its pixels; of a matrix, its words.
    """
    pytest.importorskip("matplotlib")
    if name not in ("complete", "grid", "one_row"):
        monkeypatch.setattr(report_files, "select_plots", lambda _: iter(()))
    with make_database(tmp_path / "sweep", **CASES[name]) as database, keep_figures() as figures:
        told: list[Any] = []
        data = write_report(database, tmp_path / "out", told.append)
    shares = [f"{one.label} {one.share:.3f}" for one in told]
    written = sorted(
        path.name for path in (tmp_path / "out").iterdir() if path.name != "manifest.json"
    )
    assert written == data["files"]
    summary = json.loads((tmp_path / "out/summary.json").read_text())
    assert summary == {key: value for key, value in data.items() if key != "text"}
    text, _, told = data["text"].rpartition("\n\n")
    assert told == f"wrote {', '.join(name for name in data['files'])} to {tmp_path / 'out'}"
    lines = text.splitlines()
    lines += list_data(summary["limiting_rules"][:1], "rules")
    lines += (", ".join(written), ", ".join(shares))
    for figure in figures:
        lines += describe_figure(figure) if len(figure.axes) < 9 else list_words([figure])
    check_figures(APPROVED / f"{name}.txt", lines, 1e-3, 1e-9)


def test_axes_of_a_scatter_matrix_have_few_ticks_but_counts_have_theirs() -> None:
    pytest.importorskip("matplotlib")
    columns = {
        name: np.random.default_rng(seed).uniform(0.0, 100.0, 500) for seed, name in enumerate("ab")
    }
    with keep_figures() as figures:
        draw_scatter_matrix(columns, np.ones(500, dtype=bool))
        draw_scatter_matrix({"a": columns["a"]}, np.ones(500, dtype=bool))
    counts_a, _, scatter, counts_b = figures[0].axes
    for axis in (counts_a.xaxis, counts_b.xaxis, scatter.xaxis, scatter.yaxis):
        assert len(list_ticks(axis)) <= 4
    for axis in (counts_a.yaxis, counts_b.yaxis):
        assert len(list_ticks(axis)) > 4


def list_ticks(axis: Axis) -> list[float]:
    low, high = axis.get_view_interval()
    return [at for at in axis.get_ticklocs() if low <= at <= high]


@pytest.mark.full
def test_best_design_file_reproduces_its_row_and_the_front_is_listed(
    database: SweepDatabase, tmp_path: Path
) -> None:
    out = tmp_path
    data = write_report(database, out)
    best = data["best"]
    design = Design.load(out / "best.toml")
    for name, value in best["parameters"].items():
        section, _, key = name.rpartition(".")
        assert getattr(getattr(design, section), key) == value
    row = next(row for row in database.rows() if row.point == best["point"])
    assert best["outputs"] == pytest.approx(row.outputs)
    assert (design.name, database.plan.designs[""].name) == (best["name"], "fsr400")
    assert best["name"] == "hand_best"
    assert "  name = hand_best\n" in data["text"]
    heading = (out / "best.toml").read_text().splitlines()
    assert "files do not replace those of fsr400" in heading[1]
    assert heading[0].startswith(f"# Point {best['point']} of the sweep hand.")
    assert best["point"] in data["pareto_front"]
    listed = list(csv.DictReader((out / "pareto_front.csv").read_text().splitlines()))
    assert [int(line["point"]) for line in listed] == data["pareto_front"]
    delay_ms = {row.point: row.outputs["delay_ms"] for row in database.rows()}
    assert [float(line["delay_ms"]) for line in listed] == [
        delay_ms[point] for point in data["pareto_front"]
    ]


@pytest.mark.every_case
@pytest.mark.parametrize(
    ("sweep", "base", "best"),
    [
        ("widths", "first_finger", "widths_best"),
        ("widths", "widths_best", "widths_best2"),
        (40 * "w", "first_finger", f"{34 * 'w'}_best"),
        (40 * "w", f"{34 * 'w'}_best", f"{34 * 'w'}_best2"),
    ],
)
def test_best_design_has_a_valid_name_that_is_not_that_of_its_base(
    sweep: str, base: str, best: str
) -> None:
    """A build of `best.toml` once replaced the files of the base."""
    tables = {
        "name": sweep,
        "outputs": ["q"],
        "axes": {"skin.width_mm": [17]},
        "design": {"name": base},
    }
    assert name_best_design(SweepPlan.from_tables(tables)) == best
    assert Design.load("first_finger", changes=[f"name={best}"]).name == best


def count_pixels(png: bytes, *colours: int) -> list[int]:
    image = np.asarray(Image.open(io.BytesIO(png)).convert("RGB"), dtype=np.int64) @ (
        1 << 16,
        1 << 8,
        1,
    )
    return [int(np.sum(image == colour)) for colour in colours]


def test_areas_of_the_feasibility_map_equal_the_shares_of_the_rules() -> None:
    n = 40
    x = np.repeat(np.arange(float(n)), n)
    y = np.tile(np.arange(float(n)), n)
    status = np.where(x < 12, "refused", "ok")
    field = np.where(x < 12, "skin.width_mm", "")
    status[(x >= 12) & (y >= 30)] = "timeout"
    table = make_table({"a": x, "b": y}, {}, status, field, field)
    png = draw_feasibility(table.axes, classify_points(table), ["a", "b"])
    feasible, refused, timeout = count_pixels(
        png, *(int(name[1:], 16) for name in (PALE_TEAL, RED, TEXT_COLOUR))
    )
    total = feasible + refused + timeout
    assert (feasible / total, refused / total, timeout / total) == pytest.approx(
        (0.525, 0.3, 0.175), abs=0.01
    )
    assert total > 500_000


def test_a_map_with_one_axis_in_steps_marks_each_design() -> None:
    axes = {"a": np.repeat(np.arange(4.0), 50), "b": np.random.default_rng(0).uniform(size=200)}
    table = make_table(axes, {}, ["ok"] * 200, [""] * 200, [""] * 200)
    with keep_figures() as figures:
        draw_feasibility(table.axes, classify_points(table), ["a", "b"])
    (marks,) = figures[0].axes[0].collections
    assert np.array_equal(marks.get_offsets()[:, 1], axes["b"])


def test_csv_reads_back_as_the_rows(database: SweepDatabase, tmp_path: Path) -> None:
    write_csv(database, tmp_path / "rows.csv")
    with (tmp_path / "rows.csv").open(newline="", encoding="utf-8") as file:
        lines = list(csv.DictReader(file))
    expected = list(database.rows())
    assert len(lines) == len(expected) == 400
    for line, row in zip(lines, expected, strict=True):
        assert (int(line["point"]), line["status"], line["field"], line["reason"]) == (
            row.point,
            row.status,
            row.field,
            row.reason,
        )
        assert float(line["board.cutoff_hz"]) == row.axes["board.cutoff_hz"]
        assert (line["board.series"], int(line["detector.window_samples"])) == (
            row.axes["board.series"],
            row.axes["detector.window_samples"],
        )
        for name, value in row.outputs.items():
            assert (line[name] == "") if math.isnan(value) else float(line[name]) == value
    assert b"\r" not in (tmp_path / "rows.csv").read_bytes()
