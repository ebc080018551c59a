"""`fingertip sweep`: evaluate many designs from one file, here or on a cluster."""

from __future__ import annotations

import shlex
import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from fingertip.cli.console import CHECK_FAILED, Console, format_state
from fingertip.cli.options import JOBS, command, find_file_issues, find_idle_issues, flag, refuse
from fingertip.foundation import interruption
from fingertip.foundation.errors import Issue, SweepError
from fingertip.foundation.progress import ShareText

if TYPE_CHECKING:
    from fingertip.sweep.database import SweepDatabase
    from fingertip.sweep.engines import Engine
    from fingertip.sweep.sweep_plan import SweepPlan


def parse_sweep(typed: str) -> Path:
    """Parse the path or the bundled name of a sweep."""
    from fingertip.catalogues.file_kinds import SWEEP, parse_source

    return parse_source(typed, SWEEP)


@command
def sweep(
    console: Console,
    file: Path | None = typer.Argument(
        None, parser=parse_sweep, metavar="SWEEP", help="Sweep file, or a bundled one: {sweeps}."
    ),
    out: Path | None = typer.Option(
        None, "--out", "-o", help="Folder for the rows. Default: out/sweeps/NAME."
    ),
    jobs: int | None = JOBS,
    cluster: str | None = typer.Option(
        None, metavar="ADDRESS", help="Address of a Dask scheduler, such as tcp://127.0.0.1:8786."
    ),
    resume: bool = flag("Continue a sweep that was interrupted."),
    show: bool = flag(
        "Compute nothing; report on the existing rows: limiting rules, sensitivities, plots, best "
        "design."
    ),
    csv: Path | None = typer.Option(None, metavar="FILE", help="Also write the rows as CSV."),
    outputs: bool = flag("List the outputs that can be computed, and exit."),
    changes: list[str] | None = typer.Option(
        None,
        "--set",
        metavar="KEY=VALUE",
        help="Change a value of the sweep file, of its design (skin.width_mm=18) or of its scene "
        "(scene.tap.force_n=2); repeatable.",
    ),
) -> None:
    """Compute outputs of many designs, one row per design.

    Exit code 0: every point has its row; 1: some points failed or exceeded the time limit.
    """
    refuse(
        find_file_issues("--csv", csv, ".csv"),
        find_idle_issues("--outputs", {"--csv": csv} if outputs else {}),
    )
    if outputs:
        _list_outputs(console)
    elif show:
        _show_report(console, *_find_reported(file, out, changes or ()), csv)
    else:
        plan, engine = _prepare(file, changes or (), jobs, cluster)
        with _open_database(console, out or _default_folder(plan), plan, resume) as database:
            code = _run(console, database, engine)
            _export(database, csv)

        if code:
            raise typer.Exit(code)


def _list_outputs(console: Console) -> None:
    from fingertip.sweep.outputs import load_outputs

    data = []
    lines = [f"{'output':24} {'group':10} description"]
    for output in load_outputs().values():
        lines.append(f"{output.name:24} {output.group:10} {output.description}")
        data.append({"name": output.name, "group": output.group, "description": output.description})

    console.result({"outputs": data}, "\n".join(lines))


def _prepare(
    file: Path | None, changes: Sequence[str], jobs: int | None, cluster: str | None
) -> tuple[SweepPlan, Engine]:
    """Load a sweep file, and choose who computes its points. Raises SweepError."""
    from fingertip.foundation.workers import find_workers
    from fingertip.sweep.engines import DaskEngine, ProcessEngine
    from fingertip.sweep.sweep_plan import SweepPlan

    if file is None:
        raise SweepError(
            Issue("SWEEP.toml", "is missing; give a sweep file, or a bundled sweep, such as board.")
        )

    workers = find_workers(jobs)
    if jobs is not None and cluster:
        message = (
            "cannot be combined with --cluster, which has its own workers; leave one of them out."
        )
        raise SweepError(Issue("--jobs", message))

    return SweepPlan.load(file, changes), DaskEngine(cluster) if cluster else ProcessEngine(workers)


def _find_reported(
    file: Path | None, out: Path | None, changes: Sequence[str]
) -> tuple[Path, SweepPlan | None]:
    """Return the folder to report on, and its sweep, or None without its file."""
    from fingertip.sweep.sweep_plan import SweepPlan

    if file is not None:
        plan = SweepPlan.load(file, changes)
        return out or _default_folder(plan), plan

    if out is None:
        raise SweepError(Issue("--show", "needs a sweep; give its file, or its folder with --out."))
    if changes:
        raise SweepError(
            Issue(
                "--set",
                "changes a sweep file, but none is given; give the file together with --show.",
            )
        )

    return out, None


def _default_folder(plan: SweepPlan) -> Path:
    return Path("out") / "sweeps" / plan.file.name


def _open_database(console: Console, folder: Path, plan: SweepPlan, resume: bool) -> SweepDatabase:
    from fingertip.sweep.database import SweepDatabase

    if resume and folder.is_dir() and SweepDatabase.exists(folder):
        return SweepDatabase.resume(folder, plan)
    if resume:
        console.progress(f"{folder} holds no sweep to continue: starting a new one there")

    return SweepDatabase.create(folder, plan)


def _run(console: Console, database: SweepDatabase, engine: Engine) -> int:
    from fingertip.sweep.run import compute_rows

    plan = database.plan
    folder = database.folder
    interrupted = None
    start_s = time.perf_counter()

    try:
        state = compute_rows(
            plan,
            database,
            engine,
            lambda state: console.progress(ShareText(format_state(state), state.done / plan.size)),
        )
    except interruption.INTERRUPTIONS as error:
        interrupted = interruption.exit_code(error)
        interruption.forget_signal()

    counts = database.count_by_status()
    rows = sum(counts.values())
    data = {
        "folder": folder.as_posix(),
        "points": plan.size,
        "rows": rows,
        **counts,
    }

    if interrupted:
        console.progress(
            f"interrupted with {rows} of {plan.size} points in {folder}; continue with --resume"
        )
        console.result(data, "")
        return interrupted

    statuses = ", ".join(f"{count} {status}" for status, count in counts.items() if count)
    elapsed_s = time.perf_counter() - start_s
    speed = f"{state.written} now in {elapsed_s:.1f} s by {engine.workers} {engine.description}"
    if state.written:
        work = f"{speed}, {state.written / elapsed_s:.3g} points/s"
    else:
        work = "every point already had its row"

    lines = [
        f"{rows} of {plan.size} points in {folder}: {statuses}",
        work,
        f"next: fingertip sweep --show --out {shlex.quote(folder.as_posix())}",
    ]
    data = {"name": plan.file.name, **data, "computed_now": state.written}
    console.result(data, "\n".join(lines))

    return CHECK_FAILED if counts["failed"] + counts["timeout"] or rows < plan.size else 0


def _show_report(console: Console, folder: Path, plan: SweepPlan | None, csv: Path | None) -> None:
    from fingertip.sweep.database import SweepDatabase
    from fingertip.sweep.report.report_files import write_report

    with SweepDatabase.open(folder) as database:
        data = write_report(database, folder, console.progress, plan)
        _export(database, csv)

    console.result(data, data.pop("text"))


def _export(database: SweepDatabase, csv: Path | None) -> None:
    from fingertip.sweep.report.report_files import write_csv

    if csv is not None:
        write_csv(database, csv)
