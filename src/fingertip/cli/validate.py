"""`fingertip validate` tests a design's detectors on simulated trials; `fingertip bench` measures the simulation."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from fingertip.cli.console import Console
from fingertip.cli.options import ForceOption, OptionalDesignArgument, SetOption, VerboseOption, command, load_design


@command
def validate(
    console: Console,
    design: OptionalDesignArgument = None,
    trials: Annotated[int, typer.Option(help="Number of trials with slip (article: 120).")] = 120,
    minutes: Annotated[float, typer.Option(help="Minutes of scenes without slip.")] = 40.0,
    detector: Annotated[str, typer.Option(help="Detector that the requirements apply to; all are compared.")] = "fast",
    seed: Annotated[int, typer.Option(help="First seed; every one from 5000000 on is held out.")] = 5_000_000,
    out: Annotated[Path | None, typer.Option("--out", "-o", help="Folder; default: out/NAME/validation.")] = None,
    force: ForceOption = False,
    verbose: VerboseOption = False,
    changes: SetOption = None,
) -> None:
    """Test a design's detectors on simulated slips and on scenes without slip. Exit code 1: a requirement is missed."""
    from fingertip import lab as campaign
    from fingertip.board.analysis.board_values import board_values
    from fingertip.board.analysis.limits import adc_range_warnings
    from fingertip.detection.warnings import settings_warnings
    from fingertip.foundation import extras, jit
    from fingertip.foundation.output_set import SetWriter, hash_parameters
    from fingertip.lab.campaign.plan import check_first_seed
    from fingertip.slip.detectors import registry

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
    warnings = [*settings_warnings(loaded, detector), *adc_range_warnings(board_values(loaded).voltage_limits)]
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
    said = f"{text}\n\n{validation.as_text()}" if verbose else f"{text}\n{details}"
    console.result(validation.as_data(), said, validation.passed)


_CHECKOUT = Path(__file__).parents[3]
"""Folder of a clone, which holds the other solvers' equations; they are not in the wheel."""


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
    from fingertip.foundation.output_set import SetWriter, hash_parameters

    _find_peers()
    from benchmarks.peers.options import FILES, read_options, require_libraries

    peers = read_options(solvers, seconds, boards)
    writer = SetWriter(out, "benchmark", "", hash_parameters([]))
    writer.check(FILES)
    require_libraries()
    from benchmarks.peers.run import run

    found = run(peers, seconds, boards, first_run, console.progress)
    writer.write(dict(zip(FILES, found.encode(), strict=True)))
    console.progress(f"wrote {', '.join(FILES)} to {out}")
    details = f"details: {out / 'work_precision.txt'}, or --verbose"
    said = found.text if verbose else "\n".join([*found.verdict, details])
    console.result(found.data, said, passed=not found.misses_target)


def _find_peers() -> None:
    """Make the package `benchmarks` of the clone importable. Raises FingertipError."""
    from fingertip.foundation.errors import FingertipError, Issue

    if not (_CHECKOUT / "benchmarks" / "peers" / "run.py").is_file():
        problem = "compares with solvers whose equations are in a clone of the project, not in what pip installs"
        remedy = "run `sh install.sh` in a clone, then `.venv/bin/fingertip bench` there"
        raise FingertipError(Issue("fingertip bench", f"{problem}; {remedy}."))
    sys.path.insert(0, str(_CHECKOUT))
