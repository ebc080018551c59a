"""Report on a sweep: summary, plots and best design, made from its rows."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fingertip.foundation import extras

if TYPE_CHECKING:
    from fingertip.sweep.database import SweepDatabase
    from fingertip.sweep.plan import SweepPlan
    from fingertip.sweep.report.summary import SweepSummary


def write_report(
    database: SweepDatabase,
    folder: Path,
    progress: Callable[[str], None] = lambda message: None,
    plan: SweepPlan | None = None,
) -> dict[str, Any]:
    """Write the report on a sweep, finished or not, into a folder.

    It always contains `summary.json`. It contains `feasibility.png`, `sensitivity.png`, `heatmap_OUTPUT.png` and
    `scatter_matrix.png` if the rows have something to draw, `best.toml` and `pareto_front.csv` if the sweep has an
    objective, and `pareto_front.png` if it has two or more. Without matplotlib, the plots are left out.

    Raises OutputError or SweepError.
    """
    from fingertip.foundation.output_set import SetWriter, hash_parameters
    from fingertip.sweep.report.best_design import format_best_design
    from fingertip.sweep.report.summary import describe_best, format_text, summarise, to_json_data

    progress("reading the rows")
    if plan is not None:
        database.check_same_sweep(plan)
    summary = summarise(plan or database.plan, database.table())
    files: dict[str, bytes] = {}
    if summary.selection.best is not None:
        files["best.toml"] = format_best_design(summary.plan, summary.table, summary.selection).encode()
        files["pareto_front.csv"] = _format_front(summary)
    if len(summary.table.point):
        from fingertip.sweep.report.plots import select_plots

        plots = dict(select_plots(summary))
        if extras.is_installed("matplotlib"):
            progress("drawing")
            files |= {name: draw() for name, draw in plots.items()}
        elif plots:
            progress(f"left out {', '.join(plots)}: plots need {extras.describe_missing('matplotlib')}")
    names = sorted([*files, "summary.json"])
    data = to_json_data(summary) | {"best_summary": describe_best(summary), "files": names}
    files["summary.json"] = (json.dumps(data, indent=2, allow_nan=False) + "\n").encode()
    # The database in the folder is open, so the folder must stay where it is.
    parameters = hash_parameters(summary.plan.to_toml())
    SetWriter(folder, "sweep report", summary.plan.file.name, parameters, force=True, in_place=True).write(files)
    progress(f"wrote {', '.join(names)} to {folder}")
    return data | {"text": format_text(summary)}


def _format_front(summary: SweepSummary) -> bytes:
    """Format the Pareto front as CSV: one line with parameters and outputs for each point."""
    table = summary.table
    columns = [table.point, *table.axes.values(), *table.outputs.values()]
    out = io.StringIO()
    lines = csv.writer(out, lineterminator="\n")
    lines.writerow(["point", *table.axes, *table.outputs])
    for row in summary.selection.front:
        values = [column[row].item() if column.dtype != object else column[row] for column in columns]
        lines.writerow(["" if value != value else value for value in values])  # only NaN differs from itself
    return out.getvalue().encode()
