"""Table of a sweep, for Python: what is not computed yet is computed first."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from fingertip.design.files import Changes, list_changes
from fingertip.foundation.extras import load
from fingertip.foundation.workers import find_workers
from fingertip.sweep.database import SweepDatabase
from fingertip.sweep.engines import ProcessEngine
from fingertip.sweep.plan import SweepPlan
from fingertip.sweep.run import run_sweep as compute

if TYPE_CHECKING:
    import pandas


def run_sweep(
    file: str | Path,
    changes: Changes = (),
    out: str | Path | None = None,
    *,
    jobs: int | None = None,
    progress: Callable[[str], None] = lambda message: None,
) -> pandas.DataFrame:
    """Compute outputs of many designs, or read those that were computed before, as a table with a row for each.

    Parameters
    ----------
    file
        A sweep file, or a bundled sweep, such as "board".
    changes
        Changes of the sweep, of its design or of its scene.
    out
        Folder of the results, where an interrupted sweep goes on; `out/sweeps/<name>` if None.
    jobs
        Number of processes; one for each processor if None.
    progress
        Called with the state of the sweep.

    Raises
    ------
    SweepError
        If the sweep is refused, or the folder holds another one.
    MissingLibraryError
        If pandas is not installed.
    """
    frames = load("pandas", "run_sweep")
    plan = SweepPlan.load(Path(file), list_changes(changes))
    folder = Path("out", "sweeps", plan.file.name) if out is None else Path(out)
    begin = SweepDatabase.resume if SweepDatabase.exists(folder) else SweepDatabase.create
    engine = ProcessEngine(find_workers(jobs))
    with begin(folder, plan) as database:
        compute(plan, database, engine, lambda state: progress(f"{state.done} of {plan.size} designs"))
        rows = [
            {"point": row.point, **row.axes, **row.outputs, "status": row.status, "field": row.field,
             "reason": row.reason}
            for row in database.rows()
        ]  # fmt: skip
    return frames.DataFrame(rows).set_index("point")
