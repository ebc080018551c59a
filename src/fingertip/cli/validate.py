"""`fingertip validate`: test a design's detectors on simulated trials, before anything is printed."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from fingertip.cli.console import CHECK_FAILED, Console
from fingertip.cli.options import ForceOption, OptionalDesignArgument, SetOption, VerboseOption, command, load_design


@command
def validate(
    console: Console,
    design: OptionalDesignArgument = None,
    trials: Annotated[int, typer.Option(help="Number of trials with slip (article: 120).")] = 120,
    minutes: Annotated[float, typer.Option(help="Minutes of scenes without slip.")] = 40.0,
    detector: Annotated[
        str, typer.Option("--detector", help="Detector that the requirements apply to; all are compared.")
    ] = "fast",
    seed: Annotated[int, typer.Option("--seed", help="First seed; every one from 5000000 on is held out.")] = 5_000_000,
    out: Annotated[Path | None, typer.Option("--out", "-o", help="Folder; default: out/NAME/validation.")] = None,
    force: ForceOption = False,
    verbose: VerboseOption = False,
    changes: SetOption = None,
) -> None:
    """Test a design's detectors on simulated slips and on scenes without slip. Exit code 1: a requirement is missed."""
    from fingertip import lab as campaign
    from fingertip.board.analysis.board_values import board_values
    from fingertip.board.analysis.limits import adc_range_warnings
    from fingertip.foundation import extras, jit
    from fingertip.foundation.output_set import SetWriter, hash_parameters
    from fingertip.lab.campaign.plan import check_first_seed
    from fingertip.slip.detectors import noise, registry

    loaded = load_design(design, changes)
    registry.find_detector_type(detector)
    plan = campaign.CampaignPlan(trials, minutes)
    check_first_seed(seed)
    if not jit.available():
        console.progress(
            f"numba is not installed ({extras.install_command('numba')}): this takes some twenty times longer"
        )
    with_plots = extras.is_installed("matplotlib")
    if not with_plots:
        console.progress(f"the plots (*.png) are left out: they need {extras.describe_missing('matplotlib')}")
    warnings = [*noise.settings_warnings(loaded, detector), *adc_range_warnings(board_values(loaded).voltage_limits)]
    console.warn(warnings)
    folder = out or Path("out") / loaded.name / "validation"
    parameters = hash_parameters(loaded.model_dump(mode="json"))
    writer = SetWriter(folder, "validation", loaded.name, parameters, force=force)
    writer.check(campaign.FILES)
    validation = campaign.validate(loaded, plan, detector, progress=console.progress, first_seed=seed)
    if with_plots:
        console.progress("drawing plots")
    files = validation.files(with_plots)
    writer.write(files)
    console.progress(f"wrote {', '.join(files)} to {folder}")
    text = validation.as_verdict()
    details = f"details: {folder / 'validation.txt'}, or --verbose"
    console.result(validation.as_data(), f"{text}\n\n{validation.as_text()}" if verbose else f"{text}\n{details}")
    if not validation.passed:
        raise typer.Exit(CHECK_FAILED)


# `fingertip bench`: error and run time of the simulation beside other solvers; run time of campaigns.


STAGES = {
    "contact": 20.0,
    "board": 40.0,
    "start-up": 8.0,
    "a whole trial": 10.0,
    "120 trials": 3.0,
    "12 manipulations": 8.0,
    "many boards": 8.0,
    "fresh process": 30.0,
}
"""Stages with their durations relative to each other, measured with all solvers."""
FILES = ("work_precision.png", "trial_accuracy.png", "work_precision.json", "work_precision.txt")
"""Files that the command writes."""


@command
def bench(
    console: Console,
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder for work_precision.png and .json.")] = Path(
        "out/bench"
    ),
    seconds: Annotated[
        float, typer.Option(help="Seconds of the contact problem; the board's is a fifth as long, at least 0.5 s.")
    ] = 5.0,
    boards: Annotated[int, typer.Option(help="Number of boards to simulate at once.")] = 10_000,
    solvers: Annotated[
        str, typer.Option(help="Solvers to compare with, comma-separated: scipy's, SUNDIALS CVODE, ngspice.")
    ] = "LSODA,Radau,BDF,odeint,CVODE,ngspice",
    first_run: Annotated[
        bool, typer.Option(help="Also measure a fresh process, with an empty and with a full compiler cache.")
    ] = True,
    verbose: VerboseOption = False,
) -> None:
    """Measure error and run time of the simulation beside other solvers."""
    import contextlib
    import json

    from fingertip.foundation.errors import FingertipError, Issue
    from fingertip.foundation.output_set import SetWriter, hash_parameters
    from fingertip.foundation.progress import Work
    from fingertip.sim.bench.peers import read_peers
    from fingertip.sim.bench.work_precision import describe_machine, require_libraries

    peers, issues = read_peers(solvers)
    if not 1.0 <= seconds <= 60.0:
        issues.append(Issue("--seconds", f"{seconds:g} s is out of bounds; choose 1 to 60 s."))
    if not 1 <= boards <= 1_000_000:
        issues.append(Issue("--boards", f"{boards} is out of bounds; choose 1 to 1000000."))
    if issues:
        raise FingertipError(issues)
    writer = SetWriter(out, "benchmark", "", hash_parameters([]))
    writer.check(FILES)
    require_libraries()

    from fingertip.foundation.jit import compiled
    from fingertip.sim.bench import throughput
    from fingertip.sim.bench.board import measure_board
    from fingertip.sim.bench.contact import measure_contact
    from fingertip.sim.bench.cvode import CvodeLibrary, CvodeMissingError, compile_cvode
    from fingertip.sim.bench.plot import draw
    from fingertip.sim.bench.start_up import measure_start_up
    from fingertip.sim.bench.trial import measure_trial
    from fingertip.sim.bench.trial_plot import draw_trials

    machine = describe_machine()
    with compiled(console.progress), contextlib.ExitStack() as resources:
        cvode: CvodeLibrary | str = ""
        if "CVODE" in peers:
            try:
                cvode = resources.enter_context(compile_cvode())
            except CvodeMissingError as missing:
                cvode = str(missing)
                console.progress(f"CVODE is NOT MEASURED: {cvode}")
        work = Work("bench", STAGES, console.progress)
        work.begin("contact")
        diagrams = [measure_contact(seconds, peers, cvode, work.advance)]
        work.begin("board")
        diagrams.append(measure_board(seconds / 5, peers, cvode, work.advance))
        work.begin("start-up")
        start_up = measure_start_up(peers, cvode)
        work.begin("a whole trial")
        whole_trial = measure_trial()
        work.begin("120 trials")
        trials = throughput.measure_trials()
        work.begin("12 manipulations")
        manipulations = throughput.measure_manipulations()
        work.begin("many boards")
        many = throughput.measure_boards(boards)
    first = None
    if first_run:
        work.begin("fresh process")
        first = throughput.measure_first_run()
    machine["load_after"] = describe_machine()["load"]
    data: dict[str, Any] = {
        "machine": machine,
        "diagrams": [diagram.as_data() for diagram in diagrams],
        "start_up_cpu_s": start_up,
        "whole_trial": whole_trial.as_data(),
        "trials": trials,
        "manipulations": manipulations,
        "boards": many,
        "first_run": first,
    }
    load = (
        f"{machine['machine']}, {machine['cores']} cores, load {machine['load'][0]} before and "
        f"{machine['load_after'][0]} after"
    )
    picture = draw(
        diagrams,
        f"{load}. CPU time of the integration, without start-up and input. Pale: beaten by another point of the solver",
    )
    whole = json.dumps(data, indent=2, allow_nan=False) + "\n"
    trial_picture = draw_trials(whole_trial, f"{load}. A trial of the article with each variant of the board.")
    targets = {
        **{diagram.problem: diagram.misses_target for diagram in diagrams},
        "whole trial": whole_trial.misses_target,
        **{
            name: found["cpu_s"] > found["target_s"]
            for name, found in (("trials", trials), ("manipulations", manipulations), ("boards", many))
        },
    }
    misses = any(targets.values())
    verdict = ["a target is MISSED" if misses else "all targets are met"]
    verdict += [f"  {'MISSED' if missed else 'met   '}  {name}" for name, missed in targets.items()]
    lines = [load]
    for diagram in diagrams:
        lines += diagram.as_text()
    lines.append("start-up, not part of any point above, CPU time:")
    lines += [f"  {name}: {cpu_s:.2f} s" for name, cpu_s in start_up.items()]
    lines += whole_trial.as_text()
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
    text = "\n".join([*verdict, "", *lines])
    writer.write(dict(zip(FILES, (picture, trial_picture, whole.encode(), f"{text}\n".encode()), strict=True)))
    console.progress(f"wrote {', '.join(FILES)} to {out}")
    details = f"details: {out / 'work_precision.txt'}, or --verbose"
    console.result(data, text if verbose else "\n".join([*verdict, details]))
    if misses:
        raise typer.Exit(CHECK_FAILED)
