"""`fingertip bench`: error against run time of the simulation, beside scipy and ngspice; times of campaigns."""

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
    seconds: Annotated[float, typer.Option(help="Length of the problems; a fifth of it for the board's.")] = 5.0,
    boards: Annotated[int, typer.Option(help="How many boards at once.")] = 10_000,
    solvers: Annotated[str, typer.Option(help="Methods of scipy to compare with.")] = "LSODA,Radau,BDF",
    first_run: Annotated[bool, typer.Option(help="Measure the compiler's first run too.")] = True,
    as_json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Measure the simulation's error against its run time, beside other solvers."""
    import json

    from fingertip.errors import FingertipError, Issue
    from fingertip.files import atomic_write
    from fingertip.sim.bench import report

    console = Console(as_json, quiet)
    methods = tuple(name.strip() for name in solvers.split(",") if name.strip())
    known = ("LSODA", "Radau", "BDF")
    issues = [
        Issue("--solvers", f"{name!r} is not known; choose among {', '.join(known)}.")
        for name in methods
        if name not in known
    ]
    if not 1.0 <= seconds <= 60.0:
        issues.append(Issue("--seconds", f"{seconds:g} s is refused; choose 1 to 60 s."))
    if not 1 <= boards <= 1_000_000:
        issues.append(Issue("--boards", f"{boards} is refused; choose 1 to 1000000."))
    if issues:
        raise FingertipError(issues)
    report.require()

    from fingertip.jit import compiled
    from fingertip.sim.bench import board, contact, throughput
    from fingertip.sim.bench.measure import machine
    from fingertip.sim.bench.plot import draw

    state = machine()
    with compiled(console.progress):
        console.progress("contact: every solver at every tolerance")
        diagrams = [contact.diagram(seconds, methods)]
        console.progress("board: every solver at every tolerance (scipy's Radau is slow)")
        diagrams.append(board.diagram(seconds / 5, methods))
        console.progress("120 trials")
        trials = throughput.campaign()
        console.progress("12 manipulations")
        hands = throughput.hands()
        console.progress(f"{boards} boards")
        many = throughput.boards(boards)
    first = None
    if first_run:
        console.progress("first run of the compiler")
        first = throughput.first_run()
    state["load_after"] = machine()["load"]
    data: dict[str, Any] = {
        "machine": state,
        "diagrams": [report.as_data(diagram) for diagram in diagrams],
        "campaign": trials,
        "manipulations": hands,
        "boards": many,
        "first_run": first,
    }
    load = (
        f"{state['machine']}, {state['cores']} cores, load {state['load'][0]} before and {state['load_after'][0]} after"
    )
    picture = draw(diagrams, f"{load}. CPU time, loops compiled before; making the input is part of every point.")
    whole = json.dumps(data, indent=2, allow_nan=False) + "\n"
    atomic_write(out, {"work_precision.png": picture, "work_precision.json": whole.encode()})
    console.progress(f"wrote {out / 'work_precision.png'} and .json")
    lines = [load]
    for diagram in diagrams:
        lines += report.as_text(diagram)
    lines += [
        f"{trials['trials']} trials: {trials['cpu_s']:.2f} s of CPU, target {trials['target_s']:g} s",
        f"{hands['manipulations']} manipulations of {hands['simulated_s']:.0f} s in all, stepped every 10 ms: "
        f"{hands['cpu_s']:.2f} s of CPU, target {hands['target_s']:g} s",
        f"{many['boards']} boards x {many['samples']} samples: {many['cpu_s']:.2f} s of CPU, target "
        f"{many['target_s']:g} s; the diode conducts in {100 * many['conducting']:.1f} % of the steps",
    ]
    if first:
        lines.append(
            f"fresh process: {first['empty_cache_cpu_s']:.1f} s of CPU with an empty compiler cache, then "
            f"{first['kept_cache_cpu_s']:.1f} s"
        )
    console.result(data, "\n".join(lines))
    if any(found["cpu_s"] > found["target_s"] for found in (trials, hands, many)):
        raise typer.Exit(CHECK_FAILED)
