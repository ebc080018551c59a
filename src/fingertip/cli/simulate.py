"""`fingertip simulate`: simulate a trial, a scene or a manipulation, and write its trace."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

import typer

from fingertip.cli.console import Console
from fingertip.cli.options import (
    FORCE,
    command,
    find_file_issues,
    find_idle_issues,
    flag,
    parse_design,
)
from fingertip.foundation.errors import FingertipError, Issue, gather
from fingertip.foundation.files import temporary_folder

if TYPE_CHECKING:
    from fingertip.sim.runs.manipulation import ManipulationResult
    from fingertip.sim.runs.scene import SceneRecord
    from fingertip.sim.simulation import Simulation
    from fingertip.sim.simulation_summary import Cost


def parse_simulated(typed: str) -> Path:
    """Parse the path or the bundled name of a design, scene or manipulation."""
    from fingertip.catalogues.file_kinds import DESIGN, MANIPULATION, SCENE, parse_source

    return parse_source(typed, DESIGN, SCENE, MANIPULATION)


@command
def simulate(
    console: Console,
    file: Path | None = typer.Argument(
        None,
        parser=parse_simulated,
        help="Design, scene or manipulation: file or bundled name; the default design if left out.",
    ),
    design: Path | None = typer.Option(
        None,
        "--design",
        "-d",
        parser=parse_design,
        metavar="PATH",
        help="Design file or bundled name, for a scene or manipulation.",
    ),
    out: Path | None = typer.Option(
        None,
        "--out",
        "-o",
        help="Trace to write: .csv or .npz; out/NAME/signal/trace.csv by default.",
    ),
    plot: Path | None = typer.Option(None, help="Plot of the outputs to write (PNG)."),
    seed: int = typer.Option(0, help="Seed of force, surface and noise."),
    speed_m_s: float | None = typer.Option(
        None, help="Peak sliding speed (article: 0.04, 0.06, 0.08), or speed of the knock (0.08)."
    ),
    surface: str | None = typer.Option(
        None, help="Bundled name, such as wood or ridged_fine, or a surface file (.toml, .csv)."
    ),
    force_n: float | None = typer.Option(
        None,
        help="Holding force, or that of the thumb; if left out, the seed draws it (trial: 0.2 to "
        "2 N).",
    ),
    grip: str | None = typer.Option(
        None, help="Let the hand tighten its grip when this detector (fast, ...) reports slip."
    ),
    changes: list[str] | None = typer.Option(
        None,
        "--set",
        metavar="TABLE.KEY=VALUE",
        help="Change a parameter of the scene or manipulation, or of the design; repeatable.",
    ),
    parameters: bool = flag("Print the scene's parameters with unit, bounds and meaning."),
    plan: bool = flag("Print the stages that would run for the scene's outputs, and their cost."),
    verbose: bool = flag("Measure the error of the time step, by half of it, in 3 times the time."),
    force: bool = FORCE,
) -> None:
    """Simulate one trial of a design, or a scene with --design, and write its trace."""
    from fingertip.foundation import extras
    from fingertip.sim import trace_file
    from fingertip.sim.simulation import load_simulation

    issues = [
        *find_file_issues("--out", out, *trace_file.SUFFIXES),
        *find_file_issues("--plot", plot, ".png"),
    ]

    for option, is_given in {"--parameters": parameters, "--plan": plan}.items():
        if is_given:
            idle = {"--out": out, "--plot": plot, "--grip": grip, "--verbose": verbose}
            issues += find_idle_issues(option, idle)

    if verbose and grip is not None:
        message = (
            "has no effect with --grip, whose commands change with the step; leave one of them out."
        )
        issues.append(Issue("--verbose", message))

    simulation: Simulation | None = None
    with gather(issues):
        simulation = load_simulation(
            file,
            design,
            changes=changes or (),
            surface=surface,
            speed_m_s=speed_m_s,
            force_n=force_n,
            seed=seed,
        )

    if grip is not None:
        from fingertip.lab.campaign.closed_loop import find_grip_issues

        issues.extend(find_grip_issues(grip, simulation))

    if issues or simulation is None:
        raise FingertipError(issues)

    if parameters:
        scene = simulation.scene.complete()
        console.result(
            {"parameters": [*map(vars, scene.list_parameters())]},
            "\n".join(scene.format_parameters()),
        )
    elif plan:
        from fingertip.sim.stages import plan_simulation

        stages = plan_simulation(simulation)
        console.result(stages.as_data(), "\n".join(stages.as_text()))
    else:
        if plot is not None:
            extras.require("--plot", "matplotlib", alternative="leave --plot out")

        console.warn(simulation.find_warnings())
        _write(
            console,
            simulation=simulation,
            out=out,
            plot=plot,
            grip=grip,
            verbose=verbose,
            force=force,
        )


def _write(
    console: Console,
    simulation: Simulation,
    out: Path | None,
    plot: Path | None,
    grip: str | None,
    verbose: bool,
    force: bool,
) -> None:
    """Simulate, and write trace and plot; without `out`, beside the parts of the design."""
    from fingertip.catalogues.output_files import SIGNAL
    from fingertip.foundation.files import open_atomic, write_file
    from fingertip.sim import simulation_summary as summary
    from fingertip.sim import trace_file

    path = out or SIGNAL.folder(simulation.design) / f"{simulation.name}.csv"
    if out is None:  # refused before the work starts
        SIGNAL.writer(simulation.design, path.parent, force).check((path.name,))

    begin = time.perf_counter()
    with temporary_folder() as folder:
        finished = folder / path.name
        with open_atomic(out) if out else finished.open("wb") as opened:
            record, grips_s, picture = _simulate(
                simulation,
                file=opened,
                path=path,
                grip=grip,
                plotted=plot is not None,
                progress=console.progress,
            )

        computed_s = time.perf_counter() - begin
        removed = []
        if out is None:
            removed = [*trace_file.write_trace(simulation.design, path, finished, force)]
        if removed:
            console.progress(
                f"removed what was made from earlier traces or another design: {', '.join(removed)}"
            )

    console.warn(summary.find_warnings(record))
    if simulation.scene.sensing.bridge == "board":
        console.progress(simulation.design.force_curve.describe(simulation.design.sensor.model))
    if plot is not None and picture is not None:
        write_file(plot, picture, "--plot")

    files = {"trace": path.as_posix()} | ({"plot": plot.as_posix()} if plot else {})
    cost = summary.Cost(computed_s, record.step_s)
    if verbose:
        cost = _measure_error(cost, simulation)
    elif grip is None:
        cost = replace(cost, errors=summary.find_targets(simulation))

    lines = [*summary.as_text(record, grips_s), cost.as_text()]
    lines.append(f"wrote {' and '.join(files.values())}")
    data = files | summary.as_data(record, grips_s) | cost.as_data()
    console.result(data, "\n".join(lines))


def _measure_error(cost: Cost, simulation: Simulation) -> Cost:
    """Add the errors by half the step, of what the simulation writes."""
    from fingertip.lab.accuracy.step_error import bound_errors
    from fingertip.sim.simulation_summary import list_error_signals

    signals = list_error_signals(simulation)
    if not signals:
        return cost

    begin = time.perf_counter()
    errors = bound_errors(simulation, signals)
    return replace(cost, errors=errors, compared_s=time.perf_counter() - begin)


def _simulate(
    simulation: Simulation,
    file: BinaryIO,
    path: Path,
    grip: str | None,
    plotted: bool,
    progress: Callable[[str], None],
) -> tuple[SceneRecord | ManipulationResult, tuple[float, ...] | None, bytes | None]:
    """Simulate and write the trace; return the record, moments of grip, and the plot."""
    from fingertip.sim import trace_file

    if grip is None and not plotted:
        return simulation.write(file, path, progress), None, None

    grips_s = None
    if grip is None:
        record = simulation.run(progress=progress)
    else:
        from fingertip.lab.campaign.closed_loop import run_with_grip

        record, grips_s = run_with_grip(simulation, grip, progress)

    trace_file.write_columns(file, path, record.time_s, record.columns)
    if not plotted:
        return record, grips_s, None

    from fingertip.sim.simulation_plot import draw
    from fingertip.sim.simulation_summary import as_text

    return record, grips_s, draw(record, as_text(record, grips_s)[0])
