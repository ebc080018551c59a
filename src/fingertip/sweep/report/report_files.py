"""Files of the report on a sweep: summary, plots and best design, and its rows as CSV."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

from fingertip.foundation import extras
from fingertip.foundation.files import encode_json, open_atomic
from fingertip.foundation.output_set import SetWriter, hash_parameters
from fingertip.foundation.progress import Work
from fingertip.sweep.database import SweepDatabase
from fingertip.sweep.report import best_design_file, summary
from fingertip.sweep.report.plots import select_plots
from fingertip.sweep.sweep_plan import SweepPlan


def write_report(
    database: SweepDatabase,
    folder: Path,
    progress: Callable[[str], None] = lambda message: None,
    plan: SweepPlan | None = None,
) -> dict[str, Any]:
    """Write the report on a sweep, finished or not, into a folder.

    It always contains `summary.json`. It contains `feasibility.png`, `sensitivity.png`,
    `heatmap_OUTPUT.png` and `scatter_matrix.png` if the rows have something to draw, `best.toml`
    and `pareto_front.csv` if the sweep has an objective, and `pareto_front.png` if it has two or
    more. Without matplotlib, the plots are left out. Raises OutputError or SweepError.
    """
    work = Work("", {"reading the rows": 1.0, "drawing": 2.0}, progress)
    work.begin("reading the rows")
    if plan is not None:
        database.check_same_sweep(plan)

    sweep_summary = summary.summarise(plan or database.plan, database.table())
    files: dict[str, bytes] = {}
    if sweep_summary.selection.best is not None:
        files["best.toml"] = best_design_file.format_best_design(
            sweep_summary.plan, sweep_summary.table, sweep_summary.selection
        ).encode()
        files["pareto_front.csv"] = best_design_file.format_front(
            sweep_summary.table, sweep_summary.selection
        )

    if len(sweep_summary.table.point):
        plots = dict(select_plots(sweep_summary))
        if extras.is_installed("matplotlib"):
            work.begin("drawing")
            files |= {name: draw() for name, draw in plots.items()}
        elif plots:
            progress(
                f"left out {', '.join(plots)}: plots need {extras.describe_missing('matplotlib')}"
            )

    names = sorted([*files, "summary.json"])
    data = summary.to_json_data(sweep_summary) | {
        "best_summary": summary.describe_best(sweep_summary),
        "files": names,
    }
    files["summary.json"] = encode_json(data)
    # The database in the folder is open, so the folder must stay where it is.
    parameters = hash_parameters(sweep_summary.plan.to_toml())
    SetWriter(
        folder, "sweep report", sweep_summary.plan.file.name, parameters, force=True, in_place=True
    ).write(files)

    return data | {
        "text": f"{summary.format_text(sweep_summary)}\n\nwrote {', '.join(names)} to {folder}"
    }


def write_csv(source: SweepDatabase, path: Path) -> None:
    """Write one line for each row: point, parameters, outputs (with the unit in their name),
    status, field, reason.

    Numbers read back exactly. An output that was not computed is empty; an unbounded one is inf.
    The same rows give the same bytes. Raises OutputError.
    """
    with open_atomic(path, "--csv") as raw:
        text = io.TextIOWrapper(raw, encoding="utf-8", newline="", write_through=False)
        lines = csv.writer(text, lineterminator="\n")
        axes = (axis.name for axis in source.plan.axes)
        outputs = source.find_outputs()
        lines.writerow(["point", *axes, *outputs, "status", "field", "reason"])

        for row in source.rows():
            numbers = (
                "" if math.isnan(row.outputs[name]) else row.outputs[name] for name in outputs
            )
            lines.writerow(
                [row.point, *row.axes.values(), *numbers, row.status, row.field, row.reason]
            )

        text.flush()
        text.detach()
