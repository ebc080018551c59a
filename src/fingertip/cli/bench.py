"""`fingertip bench`: error and run time of the simulation beside scipy and ngspice; run time of campaigns."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from fingertip.cli.console import CHECK_FAILED, Console, JsonOption, QuietOption, command


@command
def bench(
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder for work_precision.png and .json.")] = Path(
        "out/bench"
    ),
    seconds: Annotated[
        float, typer.Option(help="Seconds of the contact problem; the board's problem is a fifth as long.")
    ] = 5.0,
    boards: Annotated[int, typer.Option(help="Number of boards to simulate at once.")] = 10_000,
    solvers: Annotated[str, typer.Option(help="scipy methods to compare with, comma-separated.")] = "LSODA,Radau,BDF",
    first_run: Annotated[
        bool, typer.Option(help="Also measure a fresh process, with an empty and with a full compiler cache.")
    ] = True,
    as_json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Measure error and run time of the simulation beside other solvers."""
    import json

    from fingertip.errors import FingertipError, Issue
    from fingertip.output_set import SetWriter, hash_parameters
    from fingertip.sim.bench.work_precision import describe_machine, require_libraries

    console = Console(as_json, quiet)
    methods = tuple(name.strip() for name in solvers.split(",") if name.strip())
    known = ("LSODA", "Radau", "BDF")
    issues = [
        Issue("--solvers", f"{name!r} is not known; choose among {', '.join(known)}.")
        for name in methods
        if name not in known
    ]
    if not 1.0 <= seconds <= 60.0:
        issues.append(Issue("--seconds", f"{seconds:g} s is out of bounds; choose 1 to 60 s."))
    if not 1 <= boards <= 1_000_000:
        issues.append(Issue("--boards", f"{boards} is out of bounds; choose 1 to 1000000."))
    if issues:
        raise FingertipError(issues)
    require_libraries()

    from fingertip.jit import compiled
    from fingertip.sim.bench import throughput
    from fingertip.sim.bench.board import measure_board
    from fingertip.sim.bench.contact import measure_contact
    from fingertip.sim.bench.plot import draw

    machine = describe_machine()
    with compiled(console.progress):
        console.progress("contact: running every solver at every tolerance")
        diagrams = [measure_contact(seconds, methods)]
        console.progress("board: running every solver at every tolerance (scipy's Radau is slow)")
        diagrams.append(measure_board(seconds / 5, methods))
        console.progress("running 120 trials")
        trials = throughput.measure_trials()
        console.progress("running 12 manipulations")
        manipulations = throughput.measure_manipulations()
        console.progress(f"simulating {boards} boards")
        many = throughput.measure_boards(boards)
    first = None
    if first_run:
        console.progress("measuring a fresh process, with an empty and with a full compiler cache")
        first = throughput.measure_first_run()
    machine["load_after"] = describe_machine()["load"]
    data: dict[str, Any] = {
        "machine": machine,
        "diagrams": [diagram.as_data() for diagram in diagrams],
        "trials": trials,
        "manipulations": manipulations,
        "boards": many,
        "first_run": first,
    }
    load = (
        f"{machine['machine']}, {machine['cores']} cores, load {machine['load'][0]} before and "
        f"{machine['load_after'][0]} after"
    )
    picture = draw(diagrams, f"{load}. CPU time without compilation; generating the input is part of every point.")
    whole = json.dumps(data, indent=2, allow_nan=False) + "\n"
    files = {"work_precision.png": picture, "work_precision.json": whole.encode()}
    SetWriter(out, "benchmark", "", hash_parameters([])).write(files)
    console.progress(f"wrote {out / 'work_precision.png'} and .json")
    lines = [load]
    for diagram in diagrams:
        lines += diagram.as_text()
    lines += [
        f"{trials['trials']} trials: {trials['cpu_s']:.2f} s of CPU time, target {trials['target_s']:g} s",
        f"{manipulations['manipulations']} manipulations of {manipulations['simulated_s']:.0f} s in total, "
        f"controlled every 10 ms: {manipulations['cpu_s']:.2f} s of CPU time, target {manipulations['target_s']:g} s",
        f"{many['boards']} boards x {many['samples']} samples: {many['cpu_s']:.2f} s of CPU time, target "
        f"{many['target_s']:g} s; the diode conducts in {100 * many['conducting_ratio']:.1f} % of the steps",
    ]
    if first:
        lines.append(
            f"fresh process: {first['empty_cache_cpu_s']:.1f} s of CPU time with an empty compiler cache, then "
            f"{first['full_cache_cpu_s']:.1f} s with a full one"
        )
    console.result(data, "\n".join(lines))
    if any(found["cpu_s"] > found["target_s"] for found in (trials, manipulations, many)):
        raise typer.Exit(CHECK_FAILED)
