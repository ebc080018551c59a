"""`fingertip detect`: find slip in a trace, and judge it where the trace knows the truth."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fingertip.cli.console import Console, JsonOption, QuietOption, SetOption, command, picture_issues

if TYPE_CHECKING:
    from fingertip.design import Design
    from fingertip.slip import Detection, Interval, Trace
    from fingertip.slip.detectors.noise import NoiseLevel
    from fingertip.slip.traces.parsed import Wanted


@command
def detect(
    trace: Annotated[
        Path,
        typer.Argument(
            help="Trace (.csv, .npz, .npy, .tdms): time_s, voltage_v, and envelope_v if the filter board was there; "
            "- reads CSV lines as they come."
        ),
    ],
    design: Annotated[Path | None, typer.Option("--design", help="Design file; without it, the defaults.")] = None,
    detector: Annotated[
        str,
        typer.Option(
            "--detector",
            help="digital (the article's chain in software), analog (on the board's output), fft or fast (ours).",
        ),
    ] = "digital",
    rate_hz: Annotated[
        float | None, typer.Option("--rate-hz", help="Make the filters for this rate; times in a file must agree.")
    ] = None,
    quiet_s: Annotated[
        float | None,
        typer.Option("--quiet-s", help="Nothing happens for so long at the start: thresholds from the noise there."),
    ] = None,
    scale: Annotated[float, typer.Option(help="Volts for each unit of the file's voltage, as 0.00030518.")] = 1.0,
    columns: Annotated[
        list[str] | None,
        typer.Option("--column", metavar="COLUMN=NAME", help="The file's name for a column, as voltage_v=AI0."),
    ] = None,
    plot: Annotated[Path | None, typer.Option("--plot", help="Picture of the detection to write (PNG).")] = None,
    changes: SetOption = None,
    as_json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Find slip in a trace, with the article's chain or another detector.

    The detector analog takes the board's output: the trace's envelope_v or, without one, what a simulation of the
    design's board makes of the voltage.
    """
    from fingertip import slip
    from fingertip.cli.live import live
    from fingertip.cli.load import load_design
    from fingertip.design.load import load_tables
    from fingertip.errors import FingertipError, Issue, TraceError
    from fingertip.slip.detectors import noise, registry
    from fingertip.slip.detectors.noise_calibration import first_disturbance, equivalent_noise_v
    from fingertip.slip.traces.parsed import Wanted
    from fingertip.slip.traces.read import parse
    from fingertip.slip.traces.trace import remarks

    console = Console(as_json, quiet)
    if refused := list(picture_issues("--plot", plot)):
        raise TraceError(refused)
    loaded, told = load_design(design, changes)
    chosen = "threshold_v" in told.get("detector", {})
    own_window = "window_samples" in load_tables([], changes or ()).get("detector", {})
    registry.find_detector_type(detector)
    if rate_hz is not None:
        loaded, made, where = _at_rate(loaded, rate_hz, detector, chosen, own_window, quiet_s)
        console.progress(f"{made} are made for {rate_hz:g} Hz{where}")
    wanted = Wanted(_names(columns or []), rate_hz, scale)
    if not wanted.in_volts and quiet_s is None and detector != "analog":
        raise TraceError(Issue("--quiet-s", "is missing: the design's thresholds are in volts, this column is not."))
    if str(trace) == "-":
        _warn(console, noise.settings_warnings(loaded, detector) if wanted.in_volts else ())
        live(console, loaded, detector, wanted, plot, quiet_s)
        return
    parsed = parse(trace, wanted)
    stated = rate_hz is not None or design is not None or any("sample_rate_hz" in c for c in changes or ())
    found_hz = parsed.rate_hz
    if found_hz and not stated and abs(found_hz / loaded.detector.sample_rate_hz - 1) > 0.005 and not parsed.issues:
        try:
            loaded, made, where = _at_rate(loaded, found_hz, detector, chosen, own_window, quiet_s)
            console.progress(f"{trace} is sampled at {found_hz:g} Hz: {made} are made for that{where}")
        except FingertipError as error:
            why = " ".join(issue.message for issue in error.issues)
            sentence = f"is sampled at {found_hz:g} Hz, which no detector is made for: {why}"
            raise TraceError(Issue(f"{trace}, time_s", sentence)) from None
    read = parsed.checked(loaded.detector)
    if wanted.in_volts:
        _warn(console, (*remarks(read, loaded.detector), *noise.settings_warnings(loaded, detector)))
    noise_v, level = None, None
    early = slice(0, 0)
    if quiet_s is not None:
        early = _early(read, quiet_s, trace.name)
    if detector == "analog":
        read, loaded, level = _board(console, read, loaded, wanted, early, trace.name)
    elif quiet_s is not None:
        noise_v = equivalent_noise_v(detector, loaded, read.voltage_v[early], trace.name)
    found = slip.detect(read, loaded, detector, noise_v)
    level = level or found.noise
    if level:
        may_fall = detector != "analog" or quiet_s is not None
        _warn(console, noise.remarks(found.threshold_v, level, may_fall))
    if early.stop and (at := first_disturbance(loaded, read.voltage_v[early])) is not None:
        sentence = f"something happens at {read.time_s[at]:.4f} s, within the {quiet_s:g} s of --quiet-s: thresholds"
        console.progress(f"warning: {sentence} may be too high; choose a shorter part.")
    if plot is not None:
        from fingertip.files import write_file
        from fingertip.slip.plot import draw

        console.progress(f"drawing {plot}")
        write_file(plot, draw(read, found, trace.name), "--plot")
    console.result(_data(found, level), _text(found))


def _warn(console: Console, remarks: Iterable[str]) -> None:
    for remark in remarks:
        console.progress(f"warning: {remark}")


def _at_rate(
    design: Design, rate_hz: float, detector: str, chosen: bool, own_window: bool, quiet_s: float | None
) -> tuple[Design, str, str]:
    """The design at another rate, what was made for it, and where its window and threshold stand.

    A window that --set gave stays; one of a design file was for that file's rate. A threshold that was chosen stays,
    and so does one on the board's output, which has no rate.
    """
    from fingertip.slip.rate_adaptation import adapt_rate

    keep = chosen or detector == "analog"
    anew = adapt_rate(design, rate_hz, keep, own_window)
    follows = quiet_s is not None or detector not in ("digital", "analog")  # the threshold, from the noise
    volts, samples = anew.detector.threshold_v, anew.detector.window_samples
    lasts = f"{samples} samples, {1000 * samples / rate_hz:.4g} ms"
    where = f"; the window stays {lasts}, as it was set" if own_window else f"; the window is {lasts}"
    if not follows and keep:
        why = "as it was set" if chosen else "on the board's output"
        where += f"; the threshold stays {volts:.9g} V, {why}"
    elif not follows:
        where += f"; the threshold is {volts:.3g} V"
    made = ["filters", *([] if own_window else ["window"]), *([] if keep and not follows else ["threshold"])]
    return anew, " and ".join([", ".join(made[:-1]), made[-1]] if made[1:] else made), where


def _early(read: Trace, quiet_s: float, name: str) -> slice:
    """The samples of the quiet start.

    Raises
    ------
    TraceError
        If that is nothing or the whole trace, or the trace says that it slips there.
    """
    from fingertip.errors import Issue, TraceError

    early = slice(0, int((read.time_s < read.time_s[0] + quiet_s).sum()))
    if not early.stop:
        raise TraceError(Issue("--quiet-s", f"{quiet_s:g} s takes in no sample; give seconds above 0."))
    if early.stop == len(read.time_s):
        lasts = f"all {read.time_s[-1] - read.time_s[0]:.4g} s of {name}"
        remedy = "choose a part at the start in which nothing happens"
        raise TraceError(Issue("--quiet-s", f"{quiet_s:g} s takes in {lasts}; {remedy}."))
    if read.slip is not None and read.slip[early].any():
        onset_s = read.time_s[early][read.slip[early]][0] - read.time_s[0]
        raise TraceError(Issue("--quiet-s", f"{quiet_s:g} s takes in slip, from {onset_s:.4g} s on; choose less."))
    return early


def _board(
    console: Console, read: Trace, design: Design, wanted: Wanted, early: slice, name: str
) -> tuple[Trace, Design, NoiseLevel]:
    """A trace with the board's output, a design with the threshold that a quiet start asks for, and the noise."""
    from dataclasses import replace

    from fingertip.design import Design
    from fingertip.sim.electronics import board_output
    from fingertip.slip.detectors.noise import measure_noise_level

    replayed = read.envelope_v is None
    if replayed:
        column = wanted.of("voltage_v")
        volts = read.voltage_v if wanted.in_volts else board_output.bridge_v(design, read.voltage_v)
        through = "the design's board" if wanted.in_volts else "the design's bridge and board"
        console.progress(f"{name} holds no column {wanted.of('envelope_v')}: simulating {through} on {column}")
        read = replace(read, voltage_v=volts, envelope_v=board_output.envelope_v(design, volts))
    assert read.envelope_v is not None
    if early.stop:
        level = measure_noise_level(read.envelope_v[early], design, name)
        changed = design.model_dump()
        changed["detector"]["threshold_v"] = level.rounded_threshold_v
        return read, Design(**changed), level
    level_of = board_output.replayed_level if replayed else board_output.rest_level
    return read, design, level_of(design)


def _names(columns: list[str]) -> dict[str, str]:
    from fingertip.errors import Issue, TraceError

    pairs = [column.partition("=") for column in columns]
    if wrong := ["".join(pair) for pair in pairs if not (pair[0] and pair[2])]:
        raise TraceError([Issue(f"--column {w}", "names no column; write it as voltage_v=AI0.") for w in wrong])
    return {column: name for column, _, name in pairs}


def _data(found: Detection, level: NoiseLevel | None) -> dict[str, Any]:
    score = found.score
    return {
        "intervals": [_interval(i) for i in found.intervals],
        "slips": None if score is None else [_interval(i) for i in score.slips],
        "delays_s": None if score is None else [None if d is None else round(d, 7) for d in score.delays_s],
        "missed_slips": None if score is None else [_interval(i) for i in score.missed],
        "false_intervals": None if score is None else [_interval(i) for i in score.false_intervals],
        "detector": found.detector,
        "threshold_v": round(found.threshold_v, 6),
        "noise_threshold_v": round(level.threshold_v, 6) if level else None,
    }


def _interval(interval: Interval) -> dict[str, float]:
    return {"onset_s": round(interval.onset_s, 7), "end_s": round(interval.end_s, 7)}


def _text(found: Detection) -> str:
    from fingertip.slip.format import verdict

    lines = [f"ON   {i.onset_s:9.4f} s to {i.end_s:9.4f} s" for i in found.intervals] or ["never ON"]
    if found.score is None:
        return "\n".join(lines)
    score = found.score
    for slip, delay in zip(score.slips, score.delays_s, strict=True):
        lines.append(f"slip {slip.onset_s:9.4f} s to {slip.end_s:9.4f} s: {verdict(delay)}")
    lines.append(f"false intervals: {len(score.false_intervals)}")
    lines.extend(f"     {i.onset_s:9.4f} s to {i.end_s:9.4f} s" for i in score.false_intervals)
    return "\n".join(lines)
