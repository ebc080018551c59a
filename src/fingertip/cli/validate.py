"""`fingertip validate` tests a design's detectors on simulated trials and scenes."""

from __future__ import annotations

from pathlib import Path

import typer

from fingertip.cli.console import Console
from fingertip.cli.options import ForceOption, OptionalDesignArgument, SetOption, VerboseOption, command, load_design


@command
def validate(
    console: Console,
    design: OptionalDesignArgument = None,
    trials: int = typer.Option(120, help="Number of trials with slip (article: 120)."),
    minutes: float = typer.Option(40.0, help="Minutes of scenes without slip."),
    detector: str = typer.Option("fast", help="Detector that the requirements apply to; all are compared."),
    seed: int = typer.Option(5_000_000, help="First seed; every one from 5000000 on is held out."),
    out: Path | None = typer.Option(None, "--out", "-o", help="Folder; default: out/NAME/validation."),
    force: ForceOption = False,
    verbose: VerboseOption = False,
    changes: SetOption = None,
) -> None:
    """Test a design's detectors on simulated slips and on scenes without slip. Exit code 1: a requirement is missed."""
    from fingertip.board.analysis.board_values import board_values
    from fingertip.board.analysis.limits import adc_range_warnings
    from fingertip.detection.warnings import settings_warnings
    from fingertip.foundation import extras
    from fingertip.foundation.output_set import SetWriter, hash_parameters
    from fingertip.lab import validation as campaign
    from fingertip.lab.campaign.plan import CampaignPlan, check_first_seed
    from fingertip.slip.detectors import registry

    loaded = load_design(design, changes)
    registry.find_detector_type(detector)
    plan = CampaignPlan(trials, minutes)
    check_first_seed(seed)
    with_plots = extras.is_installed("matplotlib")
    extras.say_left_out({"matplotlib": "plots", "numba": "compiled loops (20 times faster)"}, console.progress)
    warnings = [*settings_warnings(loaded, detector), *adc_range_warnings(board_values(loaded).voltage_limits)]
    console.warn(warnings)
    folder = out or Path("out") / loaded.name / "validation"
    parameters = hash_parameters(loaded.model_dump(mode="json"))
    writer = SetWriter(folder, "validation", loaded.name, parameters, force=force)
    writer.check(campaign.FILES)
    validation = campaign.validate(loaded, plan, detector, progress=console.progress, first_seed=seed)
    files = validation.files(with_plots)
    writer.write(files)
    text = validation.as_verdict()
    details = f"details: {folder / 'validation.txt'}, or --verbose"
    said = f"{text}\n\n{validation.as_text()}" if verbose else f"{text}\n{details}"
    console.result(validation.as_data(), said, validation.passed)
