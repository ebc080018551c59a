"""Commands `detect`, on recordings and streams, and `validate`, on simulated trials."""

from __future__ import annotations

import functools
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from fingertip.cli import options
from fingertip.cli.console import BAD_INPUT, Console
from fingertip.cli.options import CHANGES, command, find_file_issues, load_design, refuse
from fingertip.foundation.errors import FingertipError, Issue, TraceError, raise_issues
from fingertip.foundation.interruption import INTERRUPTIONS, exit_code
from fingertip.slip.detectors.registry import DEFAULT

if TYPE_CHECKING:
    from fingertip.design import Design
    from fingertip.detection.live import StreamDetection


@command
def detect(
    console: Console,
    trace: Path = typer.Argument(
        help="Trace (CSV, LVM, NPZ, NPY, TDMS, MAT, Parquet, WAV) with the columns time_s, "
        "voltage_v and, if the "
        "filter board was recorded, envelope_v; - reads CSV lines from standard input as they "
        "arrive."
    ),
    design: Path | None = typer.Option(
        None,
        parser=options.parse_design,
        metavar="PATH",
        help="Design file or bundled name; the default design if left out.",
    ),
    detector: str | None = typer.Option(
        None,
        help=f"{{detectors}}. Default: the design's; without --design {DEFAULT}.",
    ),
    rate_hz: float | None = typer.Option(
        None, help="Sampling rate of the trace; if the file holds times, they must agree with it."
    ),
    calibrate: str | None = typer.Option(
        None,
        metavar="START:END",
        help="Interval in which nothing happens, in seconds after the first sample, such as "
        "4.0:4.5; thresholds "
        "follow from the noise there. Best in the held grasp.",
    ),
    floors: Path | None = typer.Option(
        None,
        help="Rest of 0.5 s or more, recorded the same way; fast starts with its floors, to begin "
        "within a slip.",
    ),
    scale: float = typer.Option(
        1.0, help="Volts per unit of the file's voltage, such as 0.00030518."
    ),
    time_scale: str = typer.Option(
        "s",
        metavar="SECONDS",
        help="Seconds per unit of the file's times: 1e-3 or another number, or ms, us, ns.",
    ),
    columns: list[str] | None = typer.Option(
        None,
        "--column",
        metavar="COLUMN=NAME",
        help="Name of a column in the file, such as voltage_v=AI0, or its number from 1; "
        "repeatable.",
    ),
    plot: Path | None = typer.Option(None, help="Plot of the detection to write (PNG)."),
    changes: list[str] | None = CHANGES,
) -> None:
    """Detect slip in a trace with the article's chain or another detector.

    The detector analog takes the board's output: the column envelope_v of the trace or, if there is
    none, the output of the design's board, simulated for the voltage.
    """
    from fingertip.detection.live import detect_stream
    from fingertip.detection.recordings import detect_file
    from fingertip.foundation import extras
    from fingertip.foundation.output_set import add_to_set, check_set
    from fingertip.slip.detection_results import as_data, as_text
    from fingertip.slip.plots import draw_detection

    is_stream = str(trace) == "-"
    refuse(find_file_issues("--plot", plot, ".png"))

    if plot is not None and not is_stream:
        check_set(plot)
        extras.require("--plot", "matplotlib", alternative="leave --plot out")

    loaded = load_design(design, changes)
    if detector is None:
        detector = _choose_detector(loaded, is_given=design is not None)
        if detector == loaded.detector.kind:
            console.progress(f"detector {detector}, that of the design {loaded.name}")

    column_names, channels = _parse_columns(columns or [])
    time_scale_s = _parse_time_scale(time_scale)

    if is_stream:
        _refuse_without_recording({"--plot": plot, "--calibrate": calibrate})
        begin = functools.partial(
            detect_stream,
            sys.stdin.buffer,
            loaded,
            detector,
            rate_hz=rate_hz,
            scale=scale,
            time_scale=time_scale_s,
            columns=column_names,
            channels=channels,
            floors=floors,
            progress=console.progress,
        )
        _follow_standard_input(console, detector, begin)
        return

    if channels:
        message = (
            f"names {len(channels)} voltages; give one, or pass the lines to - in place of a file."
        )
        raise TraceError(Issue("--column", message))

    result = detect_file(
        trace,
        loaded,
        detector,
        rate_hz=rate_hz,
        calibrate_s=_parse_interval(calibrate),
        floors=floors,
        scale=scale,
        time_scale=time_scale_s,
        columns=column_names,
        progress=console.progress,
    )
    console.warn(result.warnings)
    if plot is not None:
        add_to_set(plot, draw_detection(result.detection, trace.name), "--plot")

    console.result(
        as_data(result.detection, result.noise) | {"warnings": result.warnings},
        as_text(result.detection),
    )


def _choose_detector(design: Design, *, is_given: bool) -> str:
    """Return the detector of a design that was given or states one, else the article's chain."""
    # "fast" is the kind of a design that states none.
    is_stated = is_given or design.detector.kind != "fast"
    return design.detector.kind if is_stated or not design.board.has_filter else DEFAULT


def _parse_columns(columns: list[str]) -> tuple[dict[str, str], list[str]]:
    """Return the columns by their names in a trace, and the voltages where there are several."""
    pairs = [column.partition("=") for column in columns]
    invalid = ["".join(pair) for pair in pairs if not (pair[0] and pair[2])]

    if invalid:
        message = "is not of the form COLUMN=NAME; write it as voltage_v=AI0."
        raise TraceError([Issue(f"--column {text}", message) for text in invalid])

    voltages = [name for column, _, name in pairs if column == "voltage_v"]
    return {column: name for column, _, name in pairs}, voltages if len(voltages) > 1 else []


def _parse_interval(text: str | None) -> tuple[float, float] | None:
    if text is None:
        return None

    begin, _, end = text.partition(":")
    try:
        return float(begin), float(end)
    except ValueError:
        message = f"{text!r} is not of the form START:END in seconds; write it as 4.0:4.5."
        raise TraceError(Issue("--calibrate", message)) from None


def _parse_time_scale(text: str) -> float:
    from fingertip.slip.traces.sampling import TIME_UNITS_S

    try:
        return TIME_UNITS_S[text] if text in TIME_UNITS_S else float(text)
    except ValueError:
        units = ", ".join(TIME_UNITS_S)
        message = (
            f"{text!r} is no unit of time; give seconds per unit, such as 1e-3, or one of {units}."
        )
        raise TraceError(Issue("--time-scale", message)) from None


def _refuse_without_recording(options: Mapping[str, object]) -> None:
    if not sys.stdin or sys.stdin.closed:
        raise TraceError(Issue("-", "standard input is closed; pipe lines into it."))

    message = "requires the whole recording; save the lines in a file first."
    raise_issues(
        TraceError, (Issue(name, message) for name, value in options.items() if value is not None)
    )


def _follow_standard_input(
    console: Console, detector: str, begin: Callable[[], StreamDetection]
) -> None:
    """Detect slip in standard input until it ends, and report the transitions."""
    transitions: list[dict[str, Any]] = []
    data: dict[str, Any] = {
        "detector": detector,
        "transitions": transitions,
        "warnings": console.warnings,
    }
    any_on = False

    try:
        detection = begin()
        data["signals"] = list(detection.signals.columns)
        console.progress(f"detector {detector}, {detection.signals.describe()}")
        console.warn(detection.warnings)

        for transition in detection.transitions:
            any_on = True
            if console.as_json:
                force = transition.force.as_data() if transition.force else {}
                channel = {"channel": transition.channel} if transition.channel else {}
                transitions.append(
                    {"on": transition.on, "time_s": round(transition.time_s, 7)} | channel | force
                )
            else:
                force_text = f", at {transition.force.describe()}" if transition.force else ""
                text = (
                    f"{'ON ' if transition.on else 'OFF'}  {transition.time_s:9.4f} s{force_text}"
                )
                console.write(f"{text}  {transition.channel}".rstrip())
    except FingertipError as error:
        console.print_issues(error, data)
        raise typer.Exit(BAD_INPUT) from None
    except INTERRUPTIONS as error:
        console.result(data, "" if any_on else "never ON")
        raise typer.Exit(exit_code(error)) from None

    console.result(data, "" if any_on else "never ON")


@command
def validate(
    console: Console,
    design: Path | None = options.OPTIONAL_DESIGN,
    trials: int = typer.Option(120, help="Number of trials with slip (article: 120)."),
    minutes: float = typer.Option(40.0, help="Minutes of scenes without slip."),
    detector: str | None = typer.Option(
        None,
        help="Detector that the requirements apply to; all are compared. Default: the design's.",
    ),
    seed: int = typer.Option(5_000_000, help="First seed; every one from 5000000 on is held out."),
    recordings: Path | None = typer.Option(
        None,
        metavar="DIR",
        help="Recordings of fingertip record, to compare with their simulation, which is fitted.",
    ),
    jobs: int | None = options.JOBS,
    out: Path | None = typer.Option(
        None,
        "--out",
        "-o",
        help="Folder for the report, its plots and data; without it, no file is written.",
    ),
    force: bool = options.FORCE,
    verbose: bool = options.VERBOSE,
    changes: list[str] | None = CHANGES,
) -> None:
    """Test a design's detectors on simulated slips and on scenes without slip. Exit code 1: a
    requirement is missed.
    """
    from fingertip.board.analysis.board_values import find_range_warnings
    from fingertip.cli.recorded_trials import compare_recordings
    from fingertip.detection.warnings import settings_warnings
    from fingertip.foundation import extras
    from fingertip.foundation.output_set import SetWriter, hash_parameters
    from fingertip.foundation.workers import find_workers
    from fingertip.lab import validation as campaign
    from fingertip.lab.campaign.campaign import CampaignPlan, check_first_seed
    from fingertip.slip.detectors import registry

    if recordings is not None and design is None:
        design = recordings / "design.toml"

    loaded = load_design(design, changes, console)
    detector = detector or loaded.detector.kind
    registry.check_detector(loaded, detector)

    if force and out is None:
        message = (
            "has no effect without --out, as no file is written; add --out FOLDER, or leave "
            "--force out."
        )
        refuse([Issue("--force", message)])

    if recordings is not None:
        if (trials, minutes, seed) != (120, 40.0, 5_000_000):
            message = "states the trials; leave --trials, --minutes and --seed out."
            refuse([Issue("--recordings", message)])

        compare_recordings(
            console,
            design=loaded,
            detector=detector,
            recordings=recordings,
            out=out,
            force=force,
        )
        return

    plan = CampaignPlan(trials, minutes)
    check_first_seed(seed)
    find_workers(jobs)
    packages = {"matplotlib": "plots"} if out else {}
    packages["numba"] = "compiled loops (20 times faster)"
    extras.say_left_out(packages, console.progress)
    console.warn([*settings_warnings(loaded, detector), *find_range_warnings(loaded)])

    writer = None

    if out:
        parameters = hash_parameters(loaded.identity())
        writer = SetWriter(out, "validation", loaded.name, parameters, force=force)
        writer.check(campaign.FILES)

    validation = campaign.validate(
        loaded, plan, detector, progress=console.progress, first_seed=seed, jobs=jobs
    )
    if writer:
        writer.write(validation.files(with_plots=extras.is_installed("matplotlib")))

    lines = [validation.as_verdict()]
    if verbose:
        lines += ["", validation.as_text(), ""]

    lines.append(_tell_details(out, verbose))
    console.result(validation.as_data(), "\n".join(lines), validation.passed)


def _tell_details(out: Path | None, verbose: bool) -> str:
    """Return where the details of a validation are, or how to get them."""
    if out:
        return f"details: {out / 'validation.txt'}" + ("" if verbose else ", or --verbose")

    remedy = "--out FOLDER writes them to files"
    return f"details: {remedy}" if verbose else f"details: --verbose prints them, and {remedy}"
