"""Command `record`, for trials of a built finger, and comparison of its recordings."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from fingertip.cli import options
from fingertip.cli.console import CLEAR_LINE, Console
from fingertip.cli.options import CHANGES, command, load_design
from fingertip.foundation.errors import Issue, OutputError, TraceError, raise_issues

if TYPE_CHECKING:
    from fingertip.design import Design


@command
def record(
    console: Console,
    design: Path | None = options.OPTIONAL_DESIGN,
    port: str = typer.Option(
        "/dev/ttyACM0", help="Port of the controller; - reads the lines from standard input."
    ),
    out: Path | None = typer.Option(
        None, "--out", "-o", help="Folder; default: out/NAME/recordings."
    ),
    trials: int = typer.Option(
        40, help="Number of trials: of eight, five slide, one holds, one taps, one moves."
    ),
    force_n: str | None = typer.Option(
        None,
        metavar="N,N,...",
        help="Forces by weights, each for an equal part of the trials, such as 0.5,1,2,4.",
    ),
    surface: str = typer.Option(
        "", help="Surface that slides: one that simulate knows, or any other name."
    ),
    stroke_mm: float = typer.Option(40.0, help="Way of the slide."),
    onset_error_ms: float | None = typer.Option(
        None,
        help="Error of the contact of MOTION_PIN, which opens with the motion; unknown if "
        "left out.",
    ),
    temperature_c: float | None = typer.Option(None, help="Temperature of the room."),
    pace: float = typer.Option(1.0, help="Factor of all durations: 2 gives you twice the time."),
    changes: list[str] | None = CHANGES,
) -> None:
    """Record labelled trials of a finger from its controller's stream, one file each.

    The sketches stream with STREAM = true (slip_lamp.ino) or as they are (slip_stream.ino). The
    terminal says what to do, and shows voltage, force and slip. Ctrl-C ends it; the same command
    goes on with the trial that was interrupted.
    """
    from fingertip.drivers import Port, SampleReader
    from fingertip.foundation.output_set import find_place_issues
    from fingertip.recorded_trials.record import Plan, Recorder
    from fingertip.recorded_trials.trials import prepare_folder

    loaded = load_design(design, changes, console)

    try:
        forces = tuple(float(word) for word in force_n.split(",")) if force_n else ()
    except ValueError:
        raise TraceError(
            Issue("--force-n", f"{force_n!r} holds what is no number; write it as 0.5,1,2.")
        ) from None

    error_s = None if onset_error_ms is None else onset_error_ms / 1000
    plan = Plan(
        trials=trials,
        forces_n=forces,
        surface=surface,
        stroke_m=stroke_mm / 1000,
        temperature_c=temperature_c,
        onset_error_s=error_s,
        pace=pace,
    )
    folder = out or Path("out") / loaded.name / "recordings"
    raise_issues(OutputError, find_place_issues(folder, "choose another folder with --out"))
    lines: Iterable[str | bytes] = sys.stdin if port == "-" else Port(port)
    prepare_folder(folder, loaded)
    is_shown = sys.stderr.isatty() and not console.quiet
    told = set[tuple[int, str]]()

    def show(number: int, phase: str, line: str) -> None:
        if is_shown:
            print(f"{CLEAR_LINE}{line}", end="", file=sys.stderr, flush=True)
            Console.has_bar = True
        elif (number, phase) not in told:
            told.add((number, phase))
            console.progress(line.rstrip())

    recording = Recorder(
        design=loaded,
        folder=folder,
        plan=plan,
        show=show,
        note=console.progress,
    ).run(SampleReader(lines))
    console.result(
        {"folder": folder.as_posix(), **recording._asdict(), "trials": [*recording.trials]},
        (
            f"{len(recording.trials)} trials, {recording.samples} samples, {recording.lost} lost, "
            f"{recording.repeated} trials repeated\n"
            f"next: fingertip validate --recordings {folder}"
        ),
    )


def compare_recordings(
    console: Console,
    design: Design,
    detector: str,
    recordings: Path,
    out: Path | None,
    force: bool,
) -> None:
    """Compare recordings with their simulation, for `fingertip validate --recordings`."""
    from fingertip.foundation.output_set import SetWriter, hash_parameters
    from fingertip.recorded_trials.simulation_comparison import DATA, FITTED, TEXT, compare
    from fingertip.recorded_trials.trials import read_recordings

    writer = None
    if out:
        parameters = hash_parameters(design.identity())
        writer = SetWriter(out, "recordings report", design.name, parameters, force=force)
        writer.check((TEXT, DATA, FITTED))

    report = compare(design, read_recordings(recordings), detector, console.progress)
    if writer:
        writer.write(report.files())

    fitted = str(out / FITTED) if out else "--out FOLDER writes it, with this report"
    console.result(report.as_data(), f"{report.as_text()}\nfitted design: {fitted}")
