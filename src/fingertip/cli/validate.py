"""`fingertip validate`: test a design's detectors on simulated trials, before anything is printed."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from fingertip.cli.console import CHECK_FAILED, Console, JsonOption, QuietOption, SetOption, command

STUDY_TRIALS = 24
"""Trials of each study beside the campaign: three for each surface and object."""


@command
def validate(
    design: Annotated[Path | None, typer.Argument(help="Design file; default: the default design.")] = None,
    trials: Annotated[int, typer.Option(help="Number of trials with slip (article: 120).")] = 120,
    minutes: Annotated[float, typer.Option(help="Minutes of scenes without slip.")] = 40.0,
    detector: Annotated[
        str, typer.Option("--detector", help="Detector that the requirements apply to; all are compared.")
    ] = "fast",
    out: Annotated[Path | None, typer.Option("--out", "-o", help="Folder; default: out/NAME/validation.")] = None,
    changes: SetOption = None,
    as_json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Test a design's detectors on simulated slips and on scenes without slip. Exit code 1: a requirement is missed."""
    from fingertip import jit
    from fingertip.board.values.board_values import board_values
    from fingertip.board.values.voltage_limits import adc_range_warnings
    from fingertip.campaign.closed_loop import run_closed_loop, summarize
    from fingertip.campaign.plan import CampaignPlan
    from fingertip.campaign.report import omissions, tables
    from fingertip.campaign.requirements import RequirementLimits, check_closed_loop, check_detection
    from fingertip.campaign.run import run_campaign
    from fingertip.campaign.studies.acceleration_sensitivity import study_accelerations
    from fingertip.campaign.studies.article_figures import compute_spectra, study_windows
    from fingertip.campaign.studies.assumption_sensitivity import study_assumptions
    from fingertip.campaign.studies.board_variants import study_board_variants
    from fingertip.campaign.studies.detection_bound import compute_bounds_s
    from fingertip.campaign.studies.knock_rejection import study_knock_rejection
    from fingertip.campaign.studies.motor_discrimination import study_motor_discrimination
    from fingertip.campaign.studies.sampling_rates import study_sampling_rates
    from fingertip.cli.load import load_design
    from fingertip.files import atomic_write
    from fingertip.slip.detectors import noise, registry

    console = Console(as_json, quiet)
    loaded, _ = load_design(design, changes)
    registry.find_detector_type(detector)
    plan = CampaignPlan(trials, minutes)
    if not jit.available():
        console.progress("numba is not installed (pip install 'fingertip[fast]'): this takes some twenty times longer")
    for warning in (
        *noise.settings_warnings(loaded, detector),
        *adc_range_warnings(board_values(loaded).voltage_limits),
    ):
        console.progress(f"warning: {warning}")
    result = run_campaign(loaded, plan, progress=console.progress)
    console.progress("closed loop: simulating four objects that a pin hits")
    loop_detectors = tuple(dict.fromkeys(("analog", "fast", detector)))
    loop_trials = run_closed_loop(loaded, loop_detectors, 3 if trials >= 12 else 1)
    loop = summarize(loop_trials)
    limits = RequirementLimits()
    requirements = [
        *check_detection(result, detector, limits),
        *check_closed_loop(next(summary for summary in loop if summary.detector == detector), limits),
    ]
    few = min(STUDY_TRIALS, trials)
    console.progress("studies: detection bound, assumptions, windows, accelerations, sampling rates, boards, knocks")
    studies = tables.StudyResults(
        compute_bounds_s(loaded, plan),
        study_assumptions(loaded, detector, few),
        study_windows(loaded, few),
        compute_spectra(loaded),
        study_accelerations(loaded, few),
        study_sampling_rates(loaded, min(2 * STUDY_TRIALS, trials)),
        study_board_variants(loaded, few),
        study_motor_discrimination(loaded, few),
        study_knock_rejection(loaded),
        loop,
    )
    data = tables.as_data(result, detector, requirements, studies)

    from fingertip.campaign.report import plots, trial_plots

    console.progress("drawing plots")
    folder = out or Path("out") / loaded.name / "validation"
    files = {
        "validation.json": (json.dumps(data, indent=2, allow_nan=False) + "\n").encode(),
        "delays.png": plots.plot_delays(result),
        "surfaces.png": plots.plot_surfaces(result, detector),
        "surfaces_digital.png": plots.plot_surfaces(result, "digital"),
        "spectra.png": plots.plot_spectra(studies.spectra),
        "windows.png": plots.plot_windows(studies.windows),
        "comparison.png": plots.plot_comparison(result, studies.bound_s(0.5)),
        **trial_plots.plot_trials(loaded),
        **trial_plots.plot_loop(loop_trials, detector),
        "omissions.md": omissions.as_markdown(result, requirements, loop_trials).encode(),
    }
    atomic_write(folder, files)
    console.progress(f"wrote {', '.join(files)} to {folder}")
    console.result(data, tables.as_text(result, detector, requirements, studies))
    if not data["passed"]:
        raise typer.Exit(CHECK_FAILED)
