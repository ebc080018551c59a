"""`fingertip sweep`: many designs from one file, on all processors or a cluster; stopped at any moment, it goes on."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fingertip.cli.console import CHECK_FAILED, INTERRUPTED, Console, JsonOption, QuietOption, command

if TYPE_CHECKING:
    from fingertip.sweep.engines import Engine
    from fingertip.sweep.plan import Plan
    from fingertip.sweep.database import Store


@command
def sweep(
    file: Annotated[Path | None, typer.Argument(metavar="[SWEEP.toml]", help="Sweep file; see params/sweeps.")] = None,
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="Folder for the rows; without it, out/sweeps/NAME.")
    ] = None,
    jobs: Annotated[int | None, typer.Option(help="Processes; without it, one for each processor.")] = None,
    cluster: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="A Dask scheduler's, such as tcp://127.0.0.1:8786.")
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Go on with a sweep that was stopped.")] = False,
    show: Annotated[
        bool,
        typer.Option("--show", help="Compute nothing; report on the rows there are: rules, pictures, best design."),
    ] = False,
    csv: Annotated[Path | None, typer.Option("--csv", metavar="FILE", help="Write the rows there too.")] = None,
    parquet: Annotated[
        Path | None, typer.Option("--parquet", metavar="FILE", help="Write the rows there too; needs pyarrow.")
    ] = None,
    outputs: Annotated[bool, typer.Option("--outputs", help="Print what can be computed, and exit.")] = False,
    changes: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="KEY=VALUE",
            help="Change the sweep file, its design (skin.width_mm=18) or scene (scene.tap.force_n=2); repeatable.",
        ),
    ] = None,
    as_json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Compute outputs of many designs. Exit code 0: every point has its row; 1: some failed or took too long."""
    from fingertip.errors import Issue, SweepError
    from fingertip.sweep.engines import Processes, default_jobs
    from fingertip.sweep.report import export

    console = Console(as_json, quiet)
    if outputs:
        _list_outputs(console)
        return
    if parquet is not None:
        export.arrow()
    if show:
        _show(console, _asked(file, out, changes or ()), out, csv, parquet)
        return
    if file is None:
        raise SweepError(Issue("SWEEP.toml", "is missing; give a sweep file, such as params/sweeps/board.toml."))
    if jobs is not None and not 1 <= jobs <= 1024:
        raise SweepError(Issue("--jobs", f"{jobs} is refused; choose 1 to 1024, or leave it out."))
    if jobs is not None and cluster:
        raise SweepError(Issue("--jobs", "stands beside --cluster, which has its own workers; leave one of them out."))
    plan = _load(file, changes or ())
    folder = out or _default(plan)
    engine = _cluster(cluster) if cluster else Processes(jobs or default_jobs())
    with _open(console, folder, plan, resume) as store:
        code = _run(console, store, engine)
        _export(console, store, csv, parquet)
    if code:
        raise typer.Exit(code)


def _load(file: Path, changes: Sequence[str]) -> Plan:
    """The sweep of a file; a file of another kind is answered with what it is."""
    from fingertip.cli.load import refuse_other
    from fingertip.errors import SweepError
    from fingertip.sweep.plan import Plan

    try:
        return Plan.load(file, changes)
    except SweepError:
        refuse_other(file, "a sweep")
        raise


def _cluster(address: str) -> Engine:
    from fingertip.sweep.dask_engine import Cluster

    return Cluster(address)


def _default(plan: Plan) -> Path:
    return Path("out") / "sweeps" / plan.file.name


def _asked(file: Path | None, out: Path | None, changes: Sequence[str]) -> Plan | None:
    """The sweep that is asked about; None where its folder alone is given."""
    from fingertip.errors import Issue, SweepError

    if file is not None:
        return _load(file, changes)
    if out is None:
        raise SweepError(Issue("--show", "needs a sweep: give its file, or its folder with --out."))
    if changes:
        raise SweepError(Issue("--set", "changes a sweep file; give it beside --show."))
    return None


def _show(console: Console, plan: Plan | None, out: Path | None, csv: Path | None, parquet: Path | None) -> None:
    from fingertip.sweep.report import write
    from fingertip.sweep.database import Store

    folder = out if out is not None or plan is None else _default(plan)
    assert folder is not None
    with Store.open(folder) as store:
        data = write(store, folder, console.progress, plan)
        _export(console, store, csv, parquet)
    text = data.pop("text")
    console.result(data, text)


def _export(console: Console, store: Store, csv: Path | None, parquet: Path | None) -> None:
    from fingertip.sweep.report import export

    for path, write in ((csv, export.write_csv), (parquet, export.write_parquet)):
        if path is not None:
            write(store, path)
            console.progress(f"wrote {path}")


def _open(console: Console, folder: Path, plan: Plan, resume: bool) -> Store:
    from fingertip.sweep.database import Store

    if resume and folder.is_dir() and Store.exists(folder):
        return Store.resume(folder, plan)
    if resume:
        console.progress(f"nothing to go on with in {folder}: beginning there")
    return Store.create(folder, plan)


def _run(console: Console, store: Store, engine: Engine) -> int:
    from fingertip.cli.progress import progress
    from fingertip.sweep.run import run

    plan, folder = store.plan, store.folder
    console.progress(
        f"{plan.file.name}: {plan.size} points, {len(plan.outputs)} outputs, {engine.workers} {engine.what}"
    )
    interrupted, start_s = False, time.perf_counter()
    with progress(console, plan.size) as told:
        try:
            state = run(plan, store, engine, told)
        except KeyboardInterrupt:
            interrupted = True
    counts = store.counts()
    rows = sum(counts.values())
    if interrupted:
        console.progress(f"stopped with {rows} of {plan.size} points in {folder}; go on with --resume")
        console.result({"folder": folder.as_posix(), "points": plan.size, "rows": rows, **counts}, "")
        return INTERRUPTED
    data: dict[str, Any] = {
        "name": plan.file.name,
        "folder": folder.as_posix(),
        "points": plan.size,
        "rows": rows,
        **counts,
        "computed_now": state.written,
    }
    text = f"{rows} of {plan.size} points in {folder}: " + ", ".join(
        f"{n} {status}" for status, n in counts.items() if n
    )
    took_s = time.perf_counter() - start_s
    pace = f"{state.written} points in {took_s:.1f} s, {state.written / took_s:.3g} points/s"
    console.progress(pace if state.written else "every point had its row already")
    console.progress(f"rules, pictures and the best design: fingertip sweep --show --out {folder.as_posix()}")
    console.result(data, text)
    return CHECK_FAILED if counts["failed"] + counts["timeout"] or rows < plan.size else 0


def _list_outputs(console: Console) -> None:
    from fingertip.sweep.outputs import OUTPUTS

    data = [{"name": o.name, "stage": o.stage, "meaning": o.meaning} for o in OUTPUTS.values()]
    text = "\n".join(f"{o.name:24} {o.stage:10} {o.meaning}" for o in OUTPUTS.values())
    console.result({"outputs": data}, text)
