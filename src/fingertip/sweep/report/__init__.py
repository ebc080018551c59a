"""What a sweep says: its figures, rules, pictures and best design, from the rows of its store."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fingertip.sweep.plan import Plan
    from fingertip.sweep.report.summary import Findings
    from fingertip.sweep.database import Store


def write(
    store: Store, folder: Path, progress: Callable[[str], None] = lambda message: None, plan: Plan | None = None
) -> dict[str, Any]:
    """Write the report of a sweep, finished or not, into a folder.

    `summary.json` always; `feasibility.png`, `weights.png`, `heat_OUTPUT.png` and `pairs.png` as far as the rows have
    something to draw; with objectives `best.toml`, `front.csv` and (with two or more) `front.png`.

    Parameters
    ----------
    store
        The sweep.
    folder
        Where to; files of these names are replaced.
    progress
        Called with a sentence at each step.
    plan
        The sweep with the objectives to judge by; by default those it was begun or last resumed with.

    Returns
    -------
    dict
        The contents of `summary.json`; `text` is the same for people, `files` what was written.

    Raises
    ------
    OutputError
        If the folder cannot be written; nothing has changed then.
    SweepError
        If the store holds another sweep than the plan.
    """
    from fingertip.files import atomic_write
    from fingertip.sweep.report.best_design import as_toml
    from fingertip.sweep.report.summary import as_data, findings
    from fingertip.sweep.report.text import as_text, best_sentence

    progress("reading the rows")
    if plan is not None:
        store.refuse_other(plan)
    found = findings(plan or store.plan, store.table())
    files: dict[str, bytes] = {}
    if found.choice.best is not None:
        files["best.toml"] = as_toml(found.plan, found.table, found.choice).encode()
        files["front.csv"] = front_csv(found)
    if len(found.table.point):
        from fingertip.sweep.report.plots import pictures

        progress("drawing")
        files |= dict(pictures(found))
    data = as_data(found) | {"best_sentence": best_sentence(found), "files": sorted([*files, "summary.json"])}
    files["summary.json"] = (json.dumps(data, indent=2, allow_nan=False) + "\n").encode()
    atomic_write(folder, files)
    progress(f"wrote {', '.join(sorted(files))} to {folder}")
    return data | {"text": as_text(found)}


def front_csv(found: Findings) -> bytes:
    """The points that none beats: their parameters and outputs, one line each."""
    table = found.table
    columns = [table.point, *table.axes.values(), *table.outputs.values()]
    out = io.StringIO()
    lines = csv.writer(out, lineterminator="\n")
    lines.writerow(["point", *table.axes, *table.outputs])
    for row in found.choice.front:
        values = [column[row].item() if column.dtype != object else column[row] for column in columns]
        lines.writerow(["" if value != value else value for value in values])  # NaN differs from itself
    return out.getvalue().encode()
