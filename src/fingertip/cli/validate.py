"""`fingertip validate`: will this design's detector see slip in time? Simulated trials, before anything is printed."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from fingertip.cli.console import CHECK_FAILED, Console, JsonOption, QuietOption, SetOption, command

FEW = 24
"""Trials of each table beside the campaign: three for each surface and object."""


@command
def validate(
    design: Annotated[Path | None, typer.Argument(help="Design file; without it, the defaults.")] = None,
    trials: Annotated[int, typer.Option(help="Slips; the article's are 120.")] = 120,
    minutes: Annotated[float, typer.Option(help="Minutes in which nothing slips.")] = 40.0,
    detector: Annotated[
        str, typer.Option("--detector", help="The one the requirements are asked of; all are compared.")
    ] = "fast",
    out: Annotated[Path | None, typer.Option("--out", "-o", help="Folder; without it, out/NAME/validation.")] = None,
    changes: SetOption = None,
    as_json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Try a design's detectors on simulated slips, and on minutes without any. Exit code 1: a requirement is missed."""
    from fingertip import jit
    from fingertip.board.values.board_values import board_values
    from fingertip.board.values.limits import converter_remarks
    from fingertip.campaign import plan, requirements, study
    from fingertip.campaign.closed_loop import manipulations as closed_loop
    from fingertip.campaign.report import omissions
    from fingertip.campaign.report import tables as report
    from fingertip.campaign.studies import boards, limit, rates, sensitivity, spectra, starts, taps, tones, windows
    from fingertip.cli.load import load_design
    from fingertip.files import atomic_write
    from fingertip.slip.detectors import noise, registry

    console = Console(as_json, quiet)
    loaded, _ = load_design(design, changes)
    registry.find_detector_type(detector)
    amount = plan.Amount(trials, minutes)
    if not jit.available():
        console.progress("numba is not installed (pip install 'fingertip[fast]'): this takes some twenty times longer")
    for remark in (*noise.settings_warnings(loaded, detector), *converter_remarks(board_values(loaded).limits)):
        console.progress(f"warning: {remark}")
    found = study.run(loaded, amount, progress=console.progress)
    console.progress("closed loop: four objects, knocked")
    handled = closed_loop.closed_loop(
        loaded, tuple(dict.fromkeys(("analog", "fast", detector))), 3 if trials >= 12 else 1
    )
    loop = closed_loop.totals(handled)
    required = requirements.Requirements()
    checked = [
        *requirements.checks(found, detector, required),
        *requirements.loop_checks(next(total for total in loop if total.detector == detector), required),
    ]
    few = min(FEW, trials)
    console.progress("the limit for this spectrum and noise; what moves the delay; the window")
    grounds = report.Grounds(
        limit.limits_s(loaded, amount),
        sensitivity.table(loaded, detector, few),
        windows.table(loaded, few),
        spectra.spectra(loaded),
        starts.starts(loaded, few),
        rates.rates(loaded, min(2 * FEW, trials)),
        boards.boards(loaded, few),
        tones.tones(loaded, few),
        taps.taps(loaded),
        loop,
    )
    data = report.as_data(found, detector, checked, grounds)

    from fingertip.campaign.closed_loop import loop_pictures
    from fingertip.campaign.report import pictures, trial_pictures

    console.progress("drawing")
    folder = out or Path("out") / loaded.name / "validation"
    files = {
        "validation.json": (json.dumps(data, indent=2, allow_nan=False) + "\n").encode(),
        "delays.png": pictures.delays(found),
        "surfaces.png": pictures.surfaces(found, detector),
        "surfaces_digital.png": pictures.surfaces(found, "digital"),
        "spectra.png": pictures.spectra(grounds.spectra),
        "windows.png": pictures.windows(grounds.windows),
        "comparison.png": pictures.comparison(found, grounds.limit_s(0.5)),
        **trial_pictures.files(loaded),
        **loop_pictures.files(handled, detector),
        "omissions.md": omissions.as_markdown(found, checked, handled).encode(),
    }
    atomic_write(folder, files)
    console.progress(f"wrote {', '.join(files)} to {folder}")
    console.result(data, report.as_text(found, detector, checked, grounds))
    if not data["passed"]:
        raise typer.Exit(CHECK_FAILED)
